"""Prims and attributes of USD as text (the format usda), line by line."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["UsdText", "array", "number", "quoted", "tokens", "vector", "vectors"]

INDENT = "    "


class UsdText:
    """Lines of a layer."""

    def __init__(self) -> None:
        self._lines: list[str] = []
        self._depth = 0

    def line(self, text: str = "") -> None:
        """Add a line at the present depth."""
        self._lines.append(INDENT * self._depth + text if text else "")

    @contextmanager
    def prim(
        self,
        kind: str,
        name: str,
        *,
        specifier: str = "def",
        schemas: Sequence[str] = (),
        metadata: Mapping[str, str] | None = None,
    ) -> Iterator[None]:
        """Begin a prim and end it with the block.

        Parameters
        ----------
        kind : str
            Its type, e.g. ``Xform``.
        name : str
            An identifier that its siblings do not have.
        specifier : str
            ``def`` or ``class``.
        schemas : sequence of str
            API schemas that are applied to it.
        metadata : mapping of str to str
            Values as they are written.
        """
        entries = dict(metadata or {})
        if schemas:
            entries["prepend apiSchemas"] = tokens(schemas)
        head = f'{specifier} {kind} "{name}"'
        if entries:
            self.line(f"{head} (")
            self._depth += 1
            for key, value in entries.items():
                self.line(f"{key} = {value}")
            self._depth -= 1
            self.line(")")
        else:
            self.line(head)
        self.line("{")
        self._depth += 1
        yield
        self._depth -= 1
        self.line("}")

    def attribute(self, kind: str, name: str, value: str = "", *, of: str = "") -> None:
        """Add an attribute; `of` is its interpolation. Without a value it is declared alone."""
        held = f"{kind} {name}" + (f" = {value}" if value else "")
        if not of:
            self.line(held)
            return
        self.line(f"{held} (")
        self.line(f'{INDENT}interpolation = "{of}"')
        self.line(")")

    def samples(self, kind: str, name: str, values: Mapping[float, str]) -> None:
        """Add the values of an attribute by time codes."""
        told = ", ".join(f"{number(code)}: {value}" for code, value in values.items())
        self.line(f"{kind} {name}.timeSamples = {{ {told} }}")

    def connect(self, kind: str, name: str, path: str) -> None:
        """Connect an input to an output."""
        self.line(f"{kind} {name}.connect = <{path}>")

    def relate(self, name: str, *paths: str) -> None:
        """Add a relationship."""
        targets = ", ".join(f"<{path}>" for path in paths)
        self.line(f"rel {name} = {targets if len(paths) == 1 else f'[{targets}]'}")

    def data(self) -> bytes:
        """Return all lines."""
        return ("\n".join(self._lines) + "\n").encode("utf-8")


def number(value: float) -> str:
    """Return a number with all its digits, without a negative zero."""
    return repr(float(value) + 0.0).removesuffix(".0")


def vector(values: Iterable[float]) -> str:
    """Return a vector or a quaternion, whose real part stands first."""
    return f"({', '.join(number(value) for value in values)})"


def vectors(values: NDArray[Any], digits: int = 9) -> str:
    """Return an array (N, K) of vectors."""
    count, width = values.shape
    one = "(" + ", ".join([f"%.{digits}g"] * width) + ")"
    rows = ", ".join([one] * count) % tuple((values + 0.0).reshape(-1).tolist())
    return f"[{rows}]"


def array(values: NDArray[np.integer[Any]]) -> str:
    """Return an array of integers."""
    return f"[{', '.join(map(str, values.reshape(-1).tolist()))}]"


def tokens(values: Iterable[str]) -> str:
    """Return an array of texts."""
    return f"[{', '.join(quoted(value) for value in values)}]"


def quoted(text: str) -> str:
    """Return a text in quotation marks."""
    return json.dumps(text, ensure_ascii=False)
