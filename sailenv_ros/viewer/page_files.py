"""The files of the page, which lie beside this module as the package's data.

Names in, media types and bytes out; no path ever comes from a client.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from types import MappingProxyType

__all__ = ["page_file"]

_KINDS: Mapping[str, str] = MappingProxyType(
    {"html": "text/html", "css": "text/css", "js": "text/javascript", "svg": "image/svg+xml"}
)


def page_file(name: str) -> tuple[str, bytes] | None:
    """Return a file's media type and bytes; None if the page has no such file."""
    return _files().get(name)


@cache
def _files() -> Mapping[str, tuple[str, bytes]]:
    return {
        entry.name: (_KINDS[entry.name.rpartition(".")[2]], entry.read_bytes())
        for entry in (files("sailenv_ros.viewer") / "page").iterdir()
        if entry.name.rpartition(".")[2] in _KINDS
    }
