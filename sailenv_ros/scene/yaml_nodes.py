"""YAML text → plain data and the place of every part of it; all errors of the text at once.

PyYAML parses, this module composes: without tags, merge keys or recursion of the text's own
choosing, so hostile files cost no more than honest ones. Words mean what YAML 1.2 says:
``yes`` is a text, ``1e3`` a number. Knows nothing of scenes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import yaml

from sailenv_ros.system.yaml_text import LOADER

__all__ = ["Loc", "Mark", "Node", "TextDiagnostic", "compose", "plain_scalar"]

MAX_DEPTH = 32
MAX_NODES = 200_000

Loc: TypeAlias = tuple[str | int, ...]
"""Keys and indices that lead from the top of a file to one of its parts."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A place in a text; line and column count from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class TextDiagnostic:
    """An error in a text, and its place."""

    mark: Mark
    message: str


@dataclass(slots=True)
class Node:
    """A part of a YAML text.

    Attributes
    ----------
    mark : Mark
    value : object
        A scalar's value; ``dict[str, Node]`` of a mapping, ``list[Node]`` of a sequence.
    key_marks : dict of Mark
        Where each key of a mapping stands.
    size : int
        How many nodes it stands for, aliases written out.
    """

    mark: Mark
    value: Any
    key_marks: dict[str, Mark] = field(default_factory=dict)
    size: int = 1

    def plain(self) -> Any:
        """Return dicts, lists and scalars; new objects each time."""
        if isinstance(self.value, dict):
            return {key: child.plain() for key, child in self.value.items()}
        if isinstance(self.value, list):
            return [child.plain() for child in self.value]
        return self.value

    def child(self, part: str | int) -> Node | None:
        """Return the value of a key or the entry of an index; ``None`` if there is none."""
        if isinstance(self.value, dict):
            found = self.value.get(part) if isinstance(part, str) else None
            return found if isinstance(found, Node) else None
        if isinstance(self.value, list) and isinstance(part, int) and 0 <= part < len(self.value):
            entry: Node = self.value[part]
            return entry
        return None

    def place(self, loc: Loc, *, of_key: bool = False) -> Mark:
        """Find where a part stands, or the innermost part around it that exists.

        Parameters
        ----------
        loc : tuple of str or int
        of_key : bool
            True for the place of the last key instead of its value.
        """
        node = self
        for part in loc[:-1] if of_key else loc:
            child = node.child(part)
            if child is None:
                return node.mark
            node = child
        if of_key and loc and isinstance(loc[-1], str):
            return node.key_marks.get(loc[-1], node.mark)
        return node.mark


def compose(text: str) -> tuple[Node | None, list[TextDiagnostic]]:
    """Read a YAML text of one document.

    Returns
    -------
    node : Node or None
        The top of what could be read; ``None`` if nothing could.
    diagnostics : list of TextDiagnostic
        In the order they were found; empty if all is well.
    """
    composer = _Composer(text)
    node: Node | None = None
    try:
        node = composer.document()
    except _ReadingError:
        pass
    except yaml.YAMLError as error:
        composer.diagnostics.append(_syntax_diagnostic(error, text))
    return node, composer.diagnostics


class _ReadingError(Exception):
    """Reading on makes no sense; the error is in the list."""


class _Composer:
    """Turns PyYAML's events into nodes."""

    def __init__(self, text: str) -> None:
        self.diagnostics: list[TextDiagnostic] = []
        self._events = _parse(text)
        self._anchors: dict[str, Node | None] = {}
        self._count = 0

    def document(self) -> Node | None:
        """Read the one document; ``None`` if the text is empty."""
        next(self._events)  # the stream's start
        if isinstance(next(self._events), yaml.StreamEndEvent):
            return None
        node = self._node(next(self._events), 0)
        next(self._events)  # the document's end
        event = next(self._events)
        if isinstance(event, yaml.DocumentStartEvent):
            self._report(event, "starts a second document; a file holds one")
        return node

    def _node(self, event: yaml.Event, depth: int) -> Node:
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event)
        if not isinstance(event, yaml.ScalarEvent | yaml.CollectionStartEvent):
            raise self._stop(event, "is no scalar, sequence or mapping")
        if depth > MAX_DEPTH:
            raise self._stop(event, f"is nested deeper than {MAX_DEPTH} levels")
        if event.tag is not None:
            self._report(event, f"tags such as {event.tag[:40]} are not accepted; leave it out")
        if event.anchor is not None:
            self._anchors[event.anchor] = None
        node = self._content(event, depth)
        self._count += 1
        if max(node.size, self._count) > MAX_NODES:
            raise self._stop(event, f"the file stands for more than {MAX_NODES} values")
        if event.anchor is not None:
            self._anchors[event.anchor] = node
        return node

    def _content(self, event: yaml.ScalarEvent | yaml.CollectionStartEvent, depth: int) -> Node:
        if isinstance(event, yaml.ScalarEvent):
            return Node(_mark(event), event.value if event.style else plain_scalar(event.value))
        if isinstance(event, yaml.SequenceStartEvent):
            return self._sequence(event, depth)
        return self._mapping(event, depth)

    def _sequence(self, event: yaml.Event, depth: int) -> Node:
        node = Node(_mark(event), [])
        while not isinstance(entry := next(self._events), yaml.SequenceEndEvent):
            child = self._node(entry, depth + 1)
            node.value.append(child)
            node.size += child.size
        return node

    def _mapping(self, event: yaml.Event, depth: int) -> Node:
        node = Node(_mark(event), {})
        while not isinstance(entry := next(self._events), yaml.MappingEndEvent):
            key = self._key(entry, depth)
            child = self._node(next(self._events), depth + 1)
            if key is None:
                continue
            if key in node.value:
                first = node.key_marks[key]
                self._report(entry, f"the key {key[:40]!r} stands in line {first.line} already")
                continue
            node.value[key] = child
            node.key_marks[key] = _mark(entry)
            node.size += child.size
        return node

    def _key(self, event: yaml.Event, depth: int) -> str | None:
        self._node(event, depth + 1)
        if not isinstance(event, yaml.ScalarEvent):
            self._report(event, "a key must be a word")
            return None
        if event.value == "<<" and not event.style:
            self._report(event, "merge keys (<<) are not accepted; write the keys out")
            return None
        # A key such as 2 or true, too, is meant as a name.
        return str(event.value)

    def _alias(self, event: yaml.AliasEvent) -> Node:
        if event.anchor not in self._anchors:
            raise self._stop(event, f"*{event.anchor} refers to nothing that stands before it")
        node = self._anchors[event.anchor]
        if node is None:
            raise self._stop(event, f"*{event.anchor} refers to itself")
        self._count += 1
        return node

    def _report(self, event: yaml.Event, message: str) -> None:
        self.diagnostics.append(TextDiagnostic(_mark(event), message))

    def _stop(self, event: yaml.Event, message: str) -> _ReadingError:
        self._report(event, message)
        return _ReadingError(message)


def _parse(text: str) -> Iterator[yaml.Event]:
    """Yield PyYAML's events."""
    return iter(yaml.parse(text, Loader=LOADER))


def _mark(event: yaml.Event) -> Mark:
    start = event.start_mark
    return Mark(1, 1) if start is None else Mark(start.line + 1, start.column + 1)


def _syntax_diagnostic(error: yaml.YAMLError, text: str) -> TextDiagnostic:
    mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
    problem = getattr(error, "problem", None) or getattr(error, "reason", None) or "cannot be read"
    context = getattr(error, "context", None)
    message = f"is not YAML: {context + ', ' if context else ''}{problem}"
    if mark is None:
        return TextDiagnostic(Mark(1, 1), message)
    # libyaml does not say which character it stumbled over.
    lines = text.split("\n")
    if mark.line < len(lines) and lines[mark.line][mark.column : mark.column + 1] == "\t":
        message += " (indent with spaces, not tabs)"
    return TextDiagnostic(Mark(mark.line + 1, mark.column + 1), message)


_INTEGER = re.compile(r"[-+]?[0-9]{1,400}")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"[-+]?\.(inf|Inf|INF)")
_WORDS: dict[str, object] = {
    "": None,
    "~": None,
    "null": None,
    "Null": None,
    "NULL": None,
    "true": True,
    "True": True,
    "TRUE": True,
    "false": False,
    "False": False,
    "FALSE": False,
    ".nan": float("nan"),
    ".NaN": float("nan"),
    ".NAN": float("nan"),
}


def plain_scalar(text: str) -> object:
    """Return the value of an unquoted scalar (the core schema of YAML 1.2, without 0x and 0o)."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _FLOAT.fullmatch(text):
        return float(text)
    if _INFINITE.fullmatch(text):
        return float("-inf") if text.startswith("-") else float("inf")
    return text
