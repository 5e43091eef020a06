"""Frames → `transforms.json` of nerfstudio and of instant-ngp, with points.

https://docs.nerf.studio/quickstart/data_conventions.html: poses are world-from-camera with x right,
y up, z backward; the world has z up; depth is in millimetres; cx and cy count from the corner of
the picture, as COLMAP does. instant-ngp (docs/nerf_dataset_tips.md there) has the same axes and
corner; it shrinks the scene into a unit cube, and names depth otherwise.
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
from sailenv_ros.dataset.formats.scene_folders import by_splits
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.truth.ply import ply_bytes
from sailenv_ros.scene.calibration_files import COLMAP_CORNER_PX
from sailenv_ros.types.camera import Camera, CameraIntrinsics

__all__ = ["InstantNgpExport", "NerfstudioExport"]

PER_METRE = 1000.0
"""Steps of the depth files."""

POINTS_FILE = "sparse_pc.ply"

_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])
"""Optical axes from those of OpenGL's camera."""

_AABB_SCALE = 4
"""How far instant-ngp looks: 4 times the cube around cameras and points."""


class NerfstudioExport(PosedPictures):
    """``transforms.json``, ``images/``, ``depths/`` (16 bits, mm) and ``sparse_pc.ply``."""

    title: ClassVar[str] = "nerfstudio"
    depth_key: ClassVar[str] = "depth_file_path"

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
                self.depth_key: f"depths/{picture.name}",
                "transform_matrix": (picture.camera.world_from_camera @ _OPENGL).tolist(),
                **({} if shared else lens),
            }
            for picture, lens in zip(pictures, lenses, strict=True)
        ]
        names = by_splits((f"images/{picture.name}", picture.split) for picture in pictures)
        splits = {f"{split}_filenames": files for split, files in names.items()}
        table = {**shared, **self.more_of_scene(pictures, tracks), **splits, "frames": frames}
        write_json(folder / "transforms.json", table)
        places = {name: tracks.xyz[:, k].astype(np.float32) for k, name in enumerate("xyz")}
        colours = {name: tracks.rgb[:, k] for k, name in enumerate(("red", "green", "blue"))}
        write_bytes(folder / POINTS_FILE, ply_bytes({**places, **colours}))

    def more_of_scene(
        self, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> dict[str, Any]:
        """Return what the table has beside lenses and frames."""
        return {"ply_file_path": POINTS_FILE}


class InstantNgpExport(NerfstudioExport):
    """The same files; the cube around cameras and points becomes instant-ngp's unit cube."""

    title: ClassVar[str] = "instant-ngp"
    depth_key: ClassVar[str] = "depth_path"

    def require_lens(self, camera: Camera) -> None:
        """Refuse a lens that instant-ngp has no model of: it has no k3 of a pin-hole's lens."""
        model, names = _model(camera.intrinsics)
        coefficients = dict(zip(names, camera.intrinsics.distortion, strict=False))
        if model == "OPENCV" and coefficients.get("k3", 0.0):
            raise InvalidRequest("k3", coefficients["k3"], "0, as instant-ngp does not have it")

    def more_of_scene(
        self, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> dict[str, Any]:
        """Return the cube, and the unit of depth."""
        cameras = [picture.camera.world_from_camera[:3, 3] for picture in pictures]
        seen = np.concatenate([np.array(cameras), tracks.xyz])
        return {
            "aabb": [seen.min(axis=0).tolist(), seen.max(axis=0).tolist()],
            "aabb_scale": _AABB_SCALE,
            "enable_depth_loading": True,
            "integer_depth_scale": 1.0 / PER_METRE,
        }


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
