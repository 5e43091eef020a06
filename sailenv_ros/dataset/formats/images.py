"""Frames → picture files: PNG of each view, Middlebury's .flo."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_bytes, write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.flow_files import backward_px, flo_from_backward
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.views import view_spec

__all__ = ["FloExport", "PngExport", "frame_record", "scaled_depth"]


def frame_record(number: int, frame: Frame) -> dict[str, Any]:
    """Return what belongs to a frame beside its views, for a table of frames.

    ``randomised`` is the record of what was drawn at random for it, which makes it again; it is
    missing where nothing was. So are the model of the lens and its coefficients D of a pin-hole,
    and the angle from the axis at which the picture ends where no image circle does.
    """
    lens = frame.camera.intrinsics
    distortion: dict[str, Any] = {}
    if not lens.is_pinhole:
        distortion = {"distortion_model": lens.distortion_model, "D": lens.D.tolist()}
        if lens.max_angle_deg:
            distortion["max_angle_deg"] = lens.max_angle_deg
    return {
        **({} if frame.randomised is None else {"randomised": dict(frame.randomised)}),
        "number": number,
        "sequence": frame.sequence,
        "stamp_ns": frame.stamp_ns,
        "dt_ns": frame.dt_ns,
        "scene": frame.scene,
        "K": lens.K.tolist(),
        **distortion,
        "world_from_camera": frame.camera.world_from_camera.tolist(),
    }


def scaled_depth(values: NDArray[np.float32], per_unit: float) -> NDArray[np.uint16]:
    """Return depths as numbers of 16 bits, so many steps a metre; 0 where it does not fit."""
    with np.errstate(invalid="ignore"):
        steps = np.rint(values.astype(np.float64) * per_unit)
        fits = (steps >= 1) & (steps <= 65535)
    result = np.zeros(values.shape, np.uint16)
    result[fits] = steps[fits].astype(np.uint16)
    return result


class PngExport(DatasetFormat):
    """One folder for each view, one PNG for each frame, and `frames.json`.

    Integers as they are; depth 16 bits [mm], 0 where nothing was hit or it is beyond 65.535 m;
    truth values 0 and 255; other real numbers (flow, normals) as pictures in colour.
    """

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's files."""
        frame, folder = sample.frame, self.folder / sample.split
        for view, values in frame.views.items():
            write_png(folder / view / f"{sample.stem}.png", _png(view, values))
        record = frame_record(sample.number, frame)
        return WriteResult(record=record, written={"pictures": len(frame.views)})

    def finish(self, records: Sequence[Record]) -> None:
        """Write the table of frames of each split."""
        for split in sorted({record.split for record in records}):
            table = [record.value for record in records if record.split == split]
            write_json(self.folder / split / "frames.json", table)


def _png(view: str, values: NDArray[Any]) -> NDArray[Any]:
    spec = view_spec(view)
    if spec.png_per_unit is not None:
        return scaled_depth(values, spec.png_per_unit)
    if np.issubdtype(spec.dtype, np.floating):
        return view_picture(view, values, table=CategoryTable([]))
    return values


class FloExport(DatasetFormat):
    """One .flo file for each frame: the displacement to the one before, p_{t-1} - p_t [px]."""

    views: ClassVar[tuple[str, ...]] = ("flow",)

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's file."""
        backward = backward_px(sample.frame["flow"], sample.frame.dt_s)
        path = self.folder / sample.split / f"{sample.stem}.flo"
        write_bytes(path, flo_from_backward(backward))
        return WriteResult(written={"fields": 1})
