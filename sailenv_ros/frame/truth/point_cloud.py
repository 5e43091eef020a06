"""Point clouds: a frame's pixels as points in space, each with its colour and labels."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.lens_rays import reach_of, tells_depth, unit_rays
from sailenv_ros.frame.truth.ply import ply_bytes
from sailenv_ros.system.files import storage_errors, write_file

if TYPE_CHECKING:
    from sailenv_ros.frame.data import FrameData

__all__ = ["PointCloud", "points_of"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PointCloud:
    """Points of one frame.

    Attributes
    ----------
    xyz : (N, 3) float32
        [m], in the world or in the camera's optical frame, whichever was asked for.
    rgb : (N, 3) uint8
        Red, green, blue (sRGB); 0 without the view ``rgb``.
    category, instance : (N,) uint16
        Labels; 0 without these views.
    pixels : (N,) int64
        Number of the pixel of each point, row by row.
    """

    xyz: NDArray[np.float32]
    rgb: NDArray[np.uint8]
    category: NDArray[np.uint16]
    instance: NDArray[np.uint16]
    pixels: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.xyz)

    def save(self, path: str | Path) -> Path:
        """Write a binary PLY file, which Open3D, trimesh and MeshLab read; return its path.

        Raises
        ------
        InvalidRequest
            If the file's name does not end in ``.ply``.
        StorageError
            If it cannot be written.
        """
        file = Path(path)
        if file.suffix.lower() != ".ply":
            raise InvalidRequest("path of the point cloud", str(path), "a name that ends in .ply")
        columns: dict[str, NDArray[Any]] = {
            **{name: self.xyz[:, k] for k, name in enumerate("xyz")},
            **{name: self.rgb[:, k] for k, name in enumerate(("red", "green", "blue"))},
            "category": self.category,
            "instance": self.instance,
        }
        with storage_errors("the point cloud", file):
            write_file(file, ply_bytes(columns))
        return file


def points_of(frame: FrameData, *, in_world: bool = True) -> PointCloud:
    """Return the points that a frame's pixels see; those without a finite depth are left out.

    See `Frame.points`.
    """
    lens = frame.camera.intrinsics
    found = frame["depth"] if tells_depth(lens) else reach_of(frame.views, lens)
    reach = np.asarray(found, np.float32).reshape(-1)
    pixels = np.flatnonzero(np.isfinite(reach))
    rows, columns = np.divmod(pixels, lens.width)
    distances = reach[pixels].astype(np.float64)
    if tells_depth(lens):
        seen = lens.points_at(np.stack([columns, rows], axis=-1), distances)
    else:
        seen = unit_rays(lens)[rows, columns] * distances[:, None]
    x, y, z = np.moveaxis(seen, -1, 0)
    pose = frame.camera.world_from_camera if in_world else np.eye(4)
    count = len(pixels)
    xyz = np.empty((count, 3), np.float32)
    if in_world and frame.row_poses is not None:
        own = frame.row_poses.world_from_camera[rows]
        points = np.stack([x, y, z], axis=-1)
        xyz[:] = np.einsum("nij,nj->ni", own[:, :3, :3], points) + own[:, :3, 3]
    else:
        for axis, (a, b, c, shift) in enumerate(pose[:3].tolist()):
            xyz[:, axis] = a * x + b * y + c * z + shift
    rgb = frame.views.get("rgb")
    category, instance = frame.views.get("category"), frame.views.get("instance")

    def labels(view: NDArray[np.uint16] | None) -> NDArray[np.uint16]:
        if view is None:
            return np.zeros(count, np.uint16)
        return view.reshape(-1)[pixels].astype(np.uint16)

    return PointCloud(
        xyz=xyz,
        rgb=np.zeros((count, 3), np.uint8) if rgb is None else rgb.reshape(-1, 3)[pixels],
        category=labels(category),
        instance=labels(instance),
        pixels=pixels,
    )
