"""Frames → what 3-D Gaussian splatting's own program reads: COLMAP's model, and inverse depth.

https://github.com/graphdeco-inria/gaussian-splatting: pin-holes alone, whose axis is seen in the
middle of the picture; ``depths/`` of 16 bits are inverse depth over the scale that
``sparse/0/depth_params.json`` tells.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from sailenv_ros.dataset.formats.colmap import ColmapExport
from sailenv_ros.dataset.formats.data_files import write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.dataset.formats.photogrammetry import PointTracks, PosedPicture
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import Camera

__all__ = ["GaussiansExport"]

MOST_PER_METRE = 5.0
"""Inverse depth of the greatest number, that of 0.2 m [1/m]."""

_STEPS = 65536


class GaussiansExport(ColmapExport):
    """``images/``, ``depths/``, and ``sparse/0/`` with COLMAP's files."""

    title: ClassVar[str] = "3-D Gaussian splatting"

    def require_lens(self, camera: Camera) -> None:
        """Refuse what its reader would take for a pin-hole with its axis in the middle."""
        lens = camera.intrinsics
        lens.require_pinhole(self.title)
        if lens.cx_offset_px or lens.cy_offset_px:
            accepted = f"0, 0: {self.title} takes the axis to be in the middle"
            raise InvalidRequest(
                "offset of the axis", (lens.cx_offset_px, lens.cy_offset_px), accepted
            )

    def add_more(self, folder: Path, sample: Sample) -> None:
        """Write a frame's inverse depth; 0 is infinitely far."""
        with np.errstate(divide="ignore"):
            inverse = 1.0 / sample.frame["depth"].astype(np.float64)
        inverse = np.clip(np.nan_to_num(inverse, nan=0.0), 0.0, MOST_PER_METRE)
        steps = np.rint(inverse / MOST_PER_METRE * _STEPS)
        name = f"{sample.stem}.png"
        write_png(folder / "depths" / name, steps.clip(0, _STEPS - 1).astype(np.uint16))

    def write_scene(
        self, folder: Path, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> None:
        """Write COLMAP's files, and the scale of each picture's inverse depth."""
        super().write_scene(folder, pictures, tracks)
        scale = {"scale": MOST_PER_METRE, "offset": 0.0}
        table = {picture.name.removesuffix(".png"): scale for picture in pictures}
        write_json(folder / "sparse" / "0" / "depth_params.json", table)
