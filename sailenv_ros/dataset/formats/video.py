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
from sailenv_ros.dataset.formats.video_file import VideoFile
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import view_picture
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
        self._file = VideoFile(folder / "preview.mp4")

    def add(self, sample: Sample) -> WriteResult:
        """Add a picture."""
        frame, info = sample.frame, sample.frame.info
        picture = _sheet(frame, info.categories if info else CategoryTable([]))
        self._file.add(picture, frame.stamp_ns)
        return WriteResult(written={"pictures": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Finish the file."""
        self._file.finish()


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
