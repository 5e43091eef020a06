"""Arrays and texts → files of a data set, with errors that name the file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, RecordingError

__all__ = ["make_folder", "write_bytes", "write_json", "write_png"]

_COMPRESSION = [cv2.IMWRITE_PNG_COMPRESSION, 3]


def make_folder(folder: Path) -> None:
    """Make the folder of a data set, which must not exist or be empty.

    Raises
    ------
    RecordingError
        If something is in it, or it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        filled = any(folder.iterdir())
    except OSError as problem:
        raise RecordingError(f"{folder} cannot be made: {problem.strerror}") from None
    if filled:
        raise RecordingError(f"{folder} is not empty; nothing is overwritten, choose another")


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file, and the folder that it is in.

    Raises
    ------
    RecordingError
        If it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    except OSError as problem:
        raise RecordingError(f"{path} cannot be written: {problem.strerror}") from None


def write_json(path: Path, value: Any) -> None:
    """Write a value as JSON."""
    write_bytes(path, (json.dumps(value, indent=1) + "\n").encode())


def write_png(path: Path, picture: NDArray[Any]) -> None:
    """Write a picture of one channel, or of red, green and blue, 8 or 16 bits deep."""
    if picture.dtype not in (np.uint8, np.uint16):
        raise InvalidRequest("picture", str(picture.dtype), "8 or 16 bits deep")
    ordered = picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., ::-1])
    _, data = cv2.imencode(".png", ordered, _COMPRESSION)
    write_bytes(path, bytes(data))
