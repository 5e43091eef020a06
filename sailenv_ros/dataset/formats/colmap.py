"""Frames → a COLMAP model with points and their tracks, which Gaussian splatting begins with.

Written is what https://colmap.github.io/format.html says of text files. COLMAP's axes are x right,
y down, z forward; (0, 0) is the corner of the picture.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np

from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.dataset.formats.photogrammetry import PointTracks, PosedPicture, PosedPictures
from sailenv_ros.dataset.formats.scene_folders import write_lists
from sailenv_ros.scene.calibration_files import COLMAP_CORNER_PX, colmap_camera
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose

__all__ = ["ColmapExport"]


class ColmapExport(PosedPictures):
    """``images/`` and ``sparse/0/`` with ``cameras.txt``, ``images.txt`` and ``points3D.txt``."""

    title: ClassVar[str] = "COLMAP"

    def require_lens(self, camera: Camera) -> None:
        """Refuse a lens that COLMAP has no model of."""
        colmap_camera(camera.intrinsics)

    def add_more(self, folder: Path, sample: Sample) -> None:
        """Write nothing: pictures are all that COLMAP has of a frame."""

    def write_scene(
        self, folder: Path, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> None:
        """Write the three text files."""
        model = folder / "sparse" / "0"
        lenses = list(dict.fromkeys(picture.camera.intrinsics for picture in pictures))
        cameras = []
        for number, lens in enumerate(lenses, 1):
            name, parameters = colmap_camera(lens)
            cameras.append(f"{number} {name} {lens.width} {lens.height} {_words(parameters)}")
        first = np.searchsorted(tracks.pictures, np.arange(len(pictures) + 1))
        images = []
        for number, picture in enumerate(pictures):
            own = slice(first[number], first[number + 1])
            seen = zip(
                (tracks.pixels[own] + COLMAP_CORNER_PX).tolist(),
                tracks.points[own].tolist(),
                strict=True,
            )
            x, y, z, w = Pose.from_matrix(picture.camera.camera_from_world).orientation_xyzw
            shift = picture.camera.camera_from_world[:3, 3].tolist()
            lens_number = lenses.index(picture.camera.intrinsics) + 1
            pose = _words((w, x, y, z, *shift))
            images.append(f"{number + 1} {pose} {lens_number} {picture.name}")
            images.append(" ".join(f"{u:.6f} {v:.6f} {point + 1}" for (u, v), point in seen))
        for name, lines in (
            ("cameras.txt", cameras),
            ("images.txt", images),
            ("points3D.txt", _points(tracks, first)),
        ):
            write_bytes(model / name, "".join(f"{line}\n" for line in lines).encode())
        # Where 3-D Gaussian splatting looks for those that are held back.
        write_lists(model, [(picture.name, picture.split) for picture in pictures])


def _points(tracks: PointTracks, first: np.ndarray) -> Iterator[str]:
    """Return a line for each point: place, colour, error, and what sees it."""
    within = np.arange(len(tracks.points)) - first[tracks.pictures]
    order = np.argsort(tracks.points, kind="stable")
    ends = np.searchsorted(tracks.points[order], np.arange(len(tracks.xyz) + 1))
    for point, (place, colour) in enumerate(zip(tracks.xyz, tracks.rgb, strict=True)):
        own = order[ends[point] : ends[point + 1]]
        seen = np.stack([tracks.pictures[own] + 1, within[own]], axis=-1).ravel().tolist()
        red, green, blue = colour.tolist()
        track = " ".join(map(str, seen))
        yield f"{point + 1} {_words(place.tolist())} {red} {green} {blue} 0 {track}"


def _words(values: Sequence[float]) -> str:
    """Return numbers as text that is read back as the same ones."""
    return " ".join(repr(float(value)) for value in values)
