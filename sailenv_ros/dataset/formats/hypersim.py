"""Frames → Hypersim's folders: HDF5 files of images, geometry and cameras.

https://github.com/apple/ml-hypersim. Cameras look along their -z, with y up; ``depth_meters`` is
the distance to the optical centre, NaN where nothing is; NYU's 40 classes number semantics, -1 is
none. An asset unit is one metre. Pictures are those after the camera's tone curve: files of
radiance are left out.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.category_names import names_in
from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.dataset.formats.nyu40 import NYU40
from sailenv_ros.dataset.formats.scans import QUALITY, ScanExport
from sailenv_ros.extras import need
from sailenv_ros.frame.pictures.codecs import encode_jpeg
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.labels import CategoryTable

__all__ = ["HypersimExport"]

_OPENGL = np.diag([1.0, -1.0, -1.0])
"""Optical axes from those of OpenGL's camera."""

_PREVIEW, _GEOMETRY = "scene_cam_00_final_preview", "scene_cam_00_geometry_hdf5"


class HypersimExport(ScanExport):
    """``images/`` and ``_detail/`` of one camera, ``cam_00``."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "category", "instance")
    title: ClassVar[str] = "Hypersim"
    picture: ClassVar[str] = f"images/{_PREVIEW}/frame.{{number:04d}}.tonemap.jpg"
    packages: ClassVar[tuple[str, ...]] = ("h5py",)

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._poses: dict[Path, list[NDArray[np.float64]]] = {}

    def write_frame(self, folder: Path, number: int, sample: Sample) -> None:
        """Write the files of one frame."""
        frame, images = sample.frame, folder / "images"
        stem = f"frame.{number:04d}"
        picture = encode_jpeg(frame["rgb"], QUALITY)
        write_bytes(folder / self.picture.format(number=number), picture)
        lens, pose = frame.camera.intrinsics, frame.camera.world_from_camera
        rays = lens.rays()
        depth = np.where(np.isfinite(frame["depth"]), frame["depth"], np.nan).astype(np.float64)
        classes = _nyu(sample.scene_info("hypersim").categories)
        instance = frame["instance"].astype(np.int32)
        arrays = {
            "depth_meters": (depth * np.linalg.norm(rays, axis=-1)).astype(np.float32),
            "position": (rays * depth[..., None] @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32),
            "semantic": classes[frame["category"]],
            "semantic_instance": np.where(instance > 0, instance, -1),
        }
        if "normals" in frame.views:
            arrays["normal_world"] = frame["normals"] @ pose[:3, :3].T.astype(np.float32)
        for name, values in arrays.items():
            write_bytes(images / _GEOMETRY / f"{stem}.{name}.hdf5", _hdf5(values))
        self._poses.setdefault(folder, []).append(pose)

    def write_scene(self, folder: Path, lens: CameraIntrinsics) -> None:
        """Write the camera's track and lens, and the unit."""
        poses, detail = np.array(self._poses[folder]), folder / "_detail"
        keyframes: dict[str, NDArray[Any]] = {
            "frame_indices": np.arange(len(poses), dtype=np.int32),
            "orientations": poses[:, :3, :3] @ _OPENGL,
            "positions": poses[:, :3, 3],
        }
        for name, values in keyframes.items():
            write_bytes(detail / "cam_00" / f"camera_keyframe_{name}.hdf5", _hdf5(values))
        tables = {
            "metadata_cameras": "camera_name\ncam_00\n",
            "metadata_scene": "parameter_name,parameter_value\nmeters_per_asset_unit,1.0\n",
        }
        for name, text in tables.items():
            write_bytes(detail / f"{name}.csv", text.encode())
        projection = lens.clip_from_optical() @ np.diag([1.0, -1.0, -1.0, 1.0])
        # Rays of the camera by places in the picture, -1 to 1.
        rays = np.linalg.inv(projection[[0, 1, 3], :3])
        told: dict[str, Any] = {
            "scene_name": "scene",
            "settings_output_img_width": lens.width,
            "settings_output_img_height": lens.height,
            "settings_units_info_meters_scale": 1.0,
        }
        for name, matrix in (("M_proj", projection), ("M_cam_from_uv", rays)):
            for (row, column), value in np.ndenumerate(matrix):
                told[f"{name}_{row}{column}"] = float(value)
        table = f"{','.join(told)}\n{','.join(map(str, told.values()))}\n"
        write_bytes(detail / "metadata_camera_parameters.csv", table.encode())


def _hdf5(values: NDArray[Any]) -> bytes:
    """Return an HDF5 file that holds an array by the name that Hypersim's have."""
    file = io.BytesIO()
    with need("h5py", "the format hypersim").File(file, "w") as opened:
        opened.create_dataset("dataset", data=values)
    return file.getvalue()


def _nyu(categories: CategoryTable) -> NDArray[np.int16]:
    """Return the numbers of NYU's classes by ids of categories; -1 for none."""
    names = names_in("nyu40")
    found = np.full(65536, -1, np.int16)
    for one in categories.values():
        found[one.id] = NYU40.get(names.get(one.name, ""), -1)
    return found
