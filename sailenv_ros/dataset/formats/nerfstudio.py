"""Frames → nerfstudio's `transforms.json`, which instant-ngp reads as well, with points.

https://docs.nerf.studio/quickstart/data_conventions.html: poses are world-from-camera with x right,
y up, z backward; the world has z up; depth is in millimetres; cx and cy count from the corner of
the picture, as COLMAP does.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from sailenv_ros.dataset.formats.data_files import write_bytes, write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.dataset.formats.images import scaled_depth
from sailenv_ros.dataset.formats.photogrammetry import PointTracks, PosedPicture, PosedPictures
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.truth.ply import ply_bytes
from sailenv_ros.scene.calibration_files import COLMAP_CORNER_PX
from sailenv_ros.types.camera import Camera, CameraIntrinsics

__all__ = ["NerfstudioExport"]

PER_METRE = 1000.0
"""Steps of the depth files."""

POINTS_FILE = "sparse_pc.ply"

_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])
"""Optical axes from those of OpenGL's camera."""

_AABB_SCALE = 16
"""How far instant-ngp looks: 16 times the unit cube."""


class NerfstudioExport(PosedPictures):
    """``transforms.json``, ``images/``, ``depths/`` (16 bits, mm) and ``sparse_pc.ply``."""

    title: ClassVar[str] = "nerfstudio"

    def require_lens(self, camera: Camera) -> None:
        """Refuse a lens that nerfstudio has no model of."""
        _model(camera.intrinsics)

    def add_more(self, folder: Path, sample: Sample) -> None:
        """Write a frame's depth."""
        depth = scaled_depth(sample.frame["depth"], PER_METRE)
        write_png(folder / "depths" / f"{sample.stem}.png", depth)

    def write_scene(
        self, folder: Path, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> None:
        """Write the table of frames and the points."""
        lenses = [_lens(picture.camera.intrinsics) for picture in pictures]
        shared = lenses[0] if all(lens == lenses[0] for lens in lenses) else {}
        frames = [
            {
                "file_path": f"images/{picture.name}",
                "depth_file_path": f"depths/{picture.name}",
                "transform_matrix": (picture.camera.world_from_camera @ _OPENGL).tolist(),
                **({} if shared else lens),
            }
            for picture, lens in zip(pictures, lenses, strict=True)
        ]
        table = {**shared, "aabb_scale": _AABB_SCALE, "ply_file_path": POINTS_FILE}
        write_json(folder / "transforms.json", {**table, "frames": frames})
        places = {name: tracks.xyz[:, k].astype(np.float32) for k, name in enumerate("xyz")}
        colours = {name: tracks.rgb[:, k] for k, name in enumerate(("red", "green", "blue"))}
        write_bytes(folder / POINTS_FILE, ply_bytes({**places, **colours}))


def _model(lens: CameraIntrinsics) -> tuple[str, tuple[str, ...]]:
    """Return nerfstudio's name of a lens's model, and those of its coefficients in our order."""
    if lens.is_pinhole:
        return "OPENCV", ()
    if lens.distortion_model == "plumb_bob":
        return "OPENCV", ("k1", "k2", "p1", "p2", "k3")
    if lens.distortion_model == "equidistant":
        return "OPENCV_FISHEYE", ("k1", "k2", "k3", "k4")
    accepted = "pinhole, plumb_bob or equidistant, the models that nerfstudio has"
    raise InvalidRequest("distortion_model", lens.distortion_model, accepted)


def _lens(lens: CameraIntrinsics) -> dict[str, Any]:
    model, names = _model(lens)
    coefficients = dict(zip(names, lens.distortion, strict=False))
    return {
        "camera_model": model,
        **({"is_fisheye": True} if model == "OPENCV_FISHEYE" else {}),
        "w": lens.width,
        "h": lens.height,
        "fl_x": lens.fx,
        "fl_y": lens.fy,
        "cx": lens.cx + COLMAP_CORNER_PX,
        "cy": lens.cy + COLMAP_CORNER_PX,
        **coefficients,
    }
