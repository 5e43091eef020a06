"""Frames → a preview: one MP4 file with all views side by side, in colour."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.system.files import make_folder, write_errors
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import view_spec

__all__ = ["VideoExport"]

COLUMNS = 3
LARGEST_PX = 1920
"""Greatest width of the video; larger pictures are made smaller."""


class VideoExport(DatasetFormat):
    """`preview.mp4`, at the rate of the frames."""

    is_sequence: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._path = folder / "preview.mp4"
        self._draft = folder / ".preview.unfinished.mp4"
        self._waiting: list[NDArray[np.uint8]] = []
        self._first_ns: int | None = None
        self._writer: cv2.VideoWriter | None = None
        self._shape: tuple[int, ...] = ()

    def add(self, sample: Sample) -> WriteResult:
        """Add a picture."""
        frame, info = sample.frame, sample.frame.info
        picture = _sheet(frame, info.categories if info else CategoryTable([]))
        if self._writer is None:
            self._waiting.append(picture)
            if self._first_ns is not None and frame.stamp_ns > self._first_ns:
                self._begin(1e9 / (frame.stamp_ns - self._first_ns))
            self._first_ns = frame.stamp_ns
        else:
            self._write(picture)
        return WriteResult(written={"pictures": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Finish the file."""
        if self._writer is None and self._waiting:
            self._begin(1.0)
        if self._writer is not None:
            self._writer.release()
            with write_errors(self._path):
                self._draft.replace(self._path)

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


def _sheet(frame: Frame, table: CategoryTable) -> NDArray[np.uint8]:
    """Return all views as one picture of even size."""
    pictures = [
        view_picture(view, values, table=table)
        for view, values in frame.views.items()
        if not view_spec(view).validity_of
    ]
    height, width = pictures[0].shape[:2]
    columns = min(COLUMNS, len(pictures))
    rows = math.ceil(len(pictures) / columns)
    sheet = np.zeros((rows * height, columns * width, 3), np.uint8)
    for number, picture in enumerate(pictures):
        row, column = divmod(number, columns)
        sheet[row * height : (row + 1) * height, column * width : (column + 1) * width] = picture
    scale = min(1.0, LARGEST_PX / sheet.shape[1])
    size = [max(2, round(scale * length / 2) * 2) for length in sheet.shape[1::-1]]
    return np.asarray(cv2.resize(sheet, size, interpolation=cv2.INTER_AREA), np.uint8)
