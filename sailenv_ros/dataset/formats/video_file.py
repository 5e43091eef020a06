"""Pictures with stamps → one MP4 file, which is there when it is whole."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError
from sailenv_ros.system.files import make_folder, write_errors

__all__ = ["VideoFile"]


class VideoFile:
    """A video at the rate of its first two pictures.

    Parameters
    ----------
    path : Path
        Its folder is made with the first picture.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._draft = path.with_name(f".{path.stem}.unfinished{path.suffix}")
        self._waiting: list[NDArray[np.uint8]] = []
        self._first_ns: int | None = None
        self._writer: cv2.VideoWriter | None = None
        self._shape: tuple[int, ...] = ()

    def add(self, picture: NDArray[np.uint8], stamp_ns: int) -> None:
        """Add a picture (H, W, 3) of red, green and blue; its sides are even.

        Raises
        ------
        RecordingError
            If its size differs from that of the first, or the file cannot be written.
        """
        if self._writer is not None:
            self._write(picture)
            return
        self._waiting.append(picture)
        if self._first_ns is not None and stamp_ns > self._first_ns:
            self._begin(1e9 / (stamp_ns - self._first_ns))
        self._first_ns = stamp_ns

    def finish(self) -> None:
        """Put the file in its place; nothing if no picture was added."""
        if self._writer is None and self._waiting:
            self._begin(1.0)
        if self._writer is not None:
            self._writer.release()
            with write_errors(self._path):
                self._draft.replace(self._path)
            self._writer = None

    def _begin(self, rate_hz: float) -> None:
        height, width = self._waiting[0].shape[:2]
        code = cv2.VideoWriter.fourcc(*"mp4v")
        self._shape = self._waiting[0].shape
        make_folder(self._path.parent)
        self._writer = cv2.VideoWriter(str(self._draft), code, rate_hz, (width, height))
        if not self._writer.isOpened():
            raise RecordingError(f"{self._path} cannot be written")
        for picture in self._waiting:
            self._write(picture)
        self._waiting.clear()

    def _write(self, picture: NDArray[np.uint8]) -> None:
        if picture.shape != self._shape:
            raise RecordingError("a video needs frames of one size, with the same views")
        assert self._writer is not None
        self._writer.write(picture[..., ::-1])
