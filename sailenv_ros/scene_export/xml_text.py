"""Numbers and documents of XML formats."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, indent, tostring

__all__ = ["document", "numbers"]


def numbers(values: Iterable[float]) -> str:
    """Return numbers with all their digits, without a negative zero."""
    return " ".join(repr(float(value) + 0.0).removesuffix(".0") for value in values)


def document(root: Element) -> bytes:
    """Return a whole document, an element a line."""
    indent(root, " ")
    data: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return data + b"\n"
