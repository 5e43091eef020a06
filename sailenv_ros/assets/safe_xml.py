"""Untrusted XML → a tree: no entities, no document types, nothing without a limit."""

from __future__ import annotations

import math
import xml.parsers.expat
from collections.abc import Iterator
from dataclasses import dataclass, field

from sailenv_ros.errors import AssetError

__all__ = ["XmlNode", "read_xml"]

MOST_BYTES = 64 * 2**20
MOST_NODES = 200_000
DEEPEST = 64
LONGEST_TEXT = 1_000_000


@dataclass(eq=False, slots=True)
class XmlNode:
    """An element.

    Attributes
    ----------
    tag : str
    attributes : dict of str to str
    children : list of XmlNode
    file : str
        Whose it is, for errors.
    line, column : int
        Where it begins there, from 1.
    """

    tag: str
    attributes: dict[str, str]
    file: str
    children: list[XmlNode] = field(default_factory=list)
    line: int = 1
    column: int = 1

    @property
    def place(self) -> str:
        """Where it is, as ``file:line:column``."""
        return f"{self.file}:{self.line}:{self.column}"

    def all(self, *tags: str) -> Iterator[XmlNode]:
        """Yield the children of some tags."""
        return (child for child in self.children if child.tag in tags)

    def first(self, tag: str) -> XmlNode | None:
        """Return the first child of a tag; None if there is none."""
        return next(self.all(tag), None)

    def walk(self) -> Iterator[XmlNode]:
        """Yield this element and all below it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def text(self, name: str, default: str = "") -> str:
        """Return an attribute."""
        return self.attributes.get(name, default)

    def flag(self, name: str, default: bool = False) -> bool:
        """Return an attribute that is true or false."""
        return self.attributes.get(name, str(default).lower()).strip().lower() in ("true", "1")

    def number(self, name: str, default: float = 0.0, *, most: float = 1e7) -> float:
        """Return an attribute that is a number.

        Raises
        ------
        AssetError
            If it is none, or beyond what a scene can have.
        """
        given = self.attributes.get(name)
        if given is None:
            return default
        try:
            value = float(given)
        except ValueError:
            value = math.nan
        if not abs(value) <= most:
            raise AssetError(
                self.place,
                f"{name} of <{self.tag}> must be a number within ±{most:g}, got {given[:40]!r}",
            )
        return value

    def numbers(self, name: str, count: int) -> list[float] | None:
        """Return an attribute that is a list of numbers; None if it is not there.

        Raises
        ------
        AssetError
            If it is no list of so many finite numbers.
        """
        given = self.attributes.get(name)
        if given is None:
            return None
        try:
            values = [float(part) for part in given.split()]
        except ValueError:
            values = []
        if len(values) != count or not all(abs(value) <= 1e7 for value in values):
            raise AssetError(
                self.place,
                f"{name} of <{self.tag}> must be {count} finite numbers, got {given[:40]!r}",
            )
        return values


def read_xml(data: bytes, file: str) -> XmlNode:
    """Read a document.

    Parameters
    ----------
    data : bytes
    file : str
        Its name, for errors.

    Raises
    ------
    AssetError
        If it is malformed, too large, or declares a document type, with which come entities.
    """
    if len(data) > MOST_BYTES:
        raise AssetError(file, f"it is larger than {MOST_BYTES // 2**20} MB")
    root = XmlNode("", {}, file)
    open_: list[XmlNode] = [root]
    count = 0

    def place() -> str:
        return f"{file}:{parser.CurrentLineNumber}:{parser.CurrentColumnNumber + 1}"

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > MOST_NODES or len(open_) > DEEPEST:
            why = f"it has more than {MOST_NODES} elements, or {DEEPEST} levels"
            raise AssetError(place(), why)
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        node = XmlNode(tag, attributes, file, line=line, column=column)
        open_[-1].children.append(node)
        open_.append(node)

    def refuse(*_: object) -> None:
        raise AssetError(place(), "it declares a document type or entities, which are not read")

    parser = xml.parsers.expat.ParserCreate()
    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: open_.pop()
    parser.StartDoctypeDeclHandler = refuse
    parser.EntityDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except xml.parsers.expat.ExpatError as problem:
        why = xml.parsers.expat.ErrorString(problem.code)
        raise AssetError(
            f"{file}:{problem.lineno}:{problem.offset + 1}",
            f"it is no XML that can be read ({why})",
        ) from None
    except (LookupError, ValueError, UnicodeError) as problem:
        raise AssetError(file, f"its encoding cannot be read ({problem})") from None
    return root.children[0]
