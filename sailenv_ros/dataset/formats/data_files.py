"""Arrays and texts → files of a data set, with errors that name the file."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, BinaryIO

from numpy.typing import NDArray

from sailenv_ros.frame.pictures.codecs import encode_png
from sailenv_ros.system.files import make_folder, write_errors, write_file, written_file

__all__ = [
    "discard_drafts",
    "open_draft",
    "write_bytes",
    "write_json",
    "write_png",
]


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, whole or not at all, and the folder that it is in.

    Bringing it to the disk is left to the store that it belongs to.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    with write_errors(path):
        make_folder(path.parent)
        write_file(path, data, durable=False)


def open_draft(drafts: ExitStack, path: Path) -> BinaryIO:
    """Open a file of a data set, which takes its place when `drafts` is closed well.

    Its folder is made. `discard_drafts` gives all of them up. Errors are those of `write_bytes`.
    """
    with write_errors(path):
        make_folder(path.parent)
        return drafts.enter_context(written_file(path, durable=False))


class _BrokenOff(Exception):
    pass


def discard_drafts(drafts: ExitStack) -> None:
    """Close files that `open_draft` opened so that they do not take their places."""
    with contextlib.suppress(_BrokenOff), drafts:
        raise _BrokenOff


def write_json(path: Path, value: Any) -> None:
    """Write a value as JSON.

    An iterator in it, or in a mapping in it, becomes a list that is never in memory as a whole.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    drafts = ExitStack()
    file = open_draft(drafts, path)
    try:
        with write_errors(path):
            for piece in json_pieces(value):
                file.write(piece.encode())
            file.write(b"\n")
            drafts.close()
    finally:
        discard_drafts(drafts)


def json_pieces(value: Any) -> Iterator[str]:
    """Yield what `json.dumps` with an indent of 1 makes of a value, iterators being lists."""
    if isinstance(value, Mapping) and value:
        opening = "{\n "
        for name, one in value.items():
            yield f"{opening}{json.dumps(str(name))}: "
            opening = ",\n "
            yield from map(_indented, json_pieces(one))
        yield "\n}"
    elif isinstance(value, Iterator):
        empty = True
        for one in value:
            yield "[\n " if empty else ",\n "
            yield _indented(json.dumps(one, indent=1))
            empty = False
        yield "[]" if empty else "\n]"
    else:
        yield json.dumps(value, indent=1)


def _indented(text: str) -> str:
    return text.replace("\n", "\n ")


def write_png(path: Path, picture: NDArray[Any]) -> None:
    """Write a picture of one channel, or of red, green and blue.

    Parameters
    ----------
    path : Path
    picture : (H, W) or (H, W, 3) uint8, uint16 or bool
        Truth values become 0 and 255.
    """
    write_bytes(path, encode_png(picture, "small"))
