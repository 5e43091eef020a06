"""Pictures with poses, and points that several of them see: what reconstruction begins with.

COLMAP and nerfstudio estimate both; here both are exact. Points are what random pixels show. A
point is seen in another picture if its pixel there shows the same object, which has not moved
meanwhile, at the same distance. Nothing of a moving object becomes a point.
"""

from __future__ import annotations

import shutil
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.data_files import write_png
from sailenv_ros.dataset.formats.dataset_format import Record, Sample, WriteResult
from sailenv_ros.dataset.formats.scene_folders import SceneFolders
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.lens_rays import reach_lines, reach_of, reach_of_points
from sailenv_ros.types.camera import Camera

__all__ = ["POINTS", "PointTracks", "PosedPicture", "PosedPictures"]

POINTS = 60_000
"""About how many points are tried in all pictures together."""

LEAST_VIEWS = 2
"""In how many pictures a point must be seen."""

SAME_SHARE, SAME_M = 0.01, 0.002
"""By how much distances of one point may differ [share of the distance, m]: of a pixel's size."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PosedPicture:
    """One picture of a sequence.

    Attributes
    ----------
    number : int
        Of its frame.
    name : str
        Of its file, in ``images``.
    camera : Camera
    poses : (65536,) int32
        A number for the place of each instance, which changes where that does; -1: there is none.
    split : str
        Empty for none.
    """

    number: int
    name: str
    camera: Camera
    poses: NDArray[np.int32]
    split: str = ""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class PointTracks:
    """Points, and where pictures see them.

    Attributes
    ----------
    xyz : (N, 3) float64
        In the world [m].
    rgb : (N, 3) uint8
        As the picture that it comes from shows it.
    pictures, points : (M,) int64
        Of each observation: the number of its picture in their sequence, and that of its point;
        sorted by pictures, then by points.
    pixels : (M, 2) float64
        Where it is seen, column and row; whole numbers are the pixels' centres.
    """

    xyz: NDArray[np.float64]
    rgb: NDArray[np.uint8]
    pictures: NDArray[np.int64]
    points: NDArray[np.int64]
    pixels: NDArray[np.float64]


class PosedPictures(SceneFolders):
    """Base of formats that hold pictures, lenses, poses and points of scenes.

    ``images/`` has the pictures. Of several such formats that are written together, the first one
    finds the points.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth", "instance")

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._pictures: dict[Path, list[PosedPicture]] = {}
        self._places: dict[tuple[int, bytes], int] = {}

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's picture, and keep what its pixels see until all are known."""
        frame, folder = sample.frame, self.folder_of(sample)
        self.require_lens(frame.camera)
        poses = self._poses(frame)
        name = f"{sample.stem}.png"
        write_png(folder / "images" / name, frame["rgb"])
        self.add_more(folder, sample)
        kept = _seen_file(folder, sample.number)
        kept.parent.mkdir(parents=True, exist_ok=True)
        with kept.open("wb") as file:
            np.savez(file, reach=_reach(frame), instance=frame["instance"], rgb=frame["rgb"])
        picture = PosedPicture(
            number=sample.number, name=name, camera=frame.camera, poses=poses, split=sample.split
        )
        self._pictures.setdefault(folder, []).append(picture)
        return WriteResult(written={"pictures": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Find the points and write what is known of all pictures together."""
        for folder, pictures in self._pictures.items():
            key = tuple(picture.number for picture in pictures)
            if key not in self.shared:
                self.shared[key] = _tracks(folder, pictures)
            self.write_scene(folder, pictures, self.shared[key])
            shutil.rmtree(_seen_file(folder, 0).parent)
        self._pictures.clear()

    def close(self) -> None:
        """Remove what was kept for points that are not found any more."""
        for folder in self._pictures:
            shutil.rmtree(_seen_file(folder, 0).parent, ignore_errors=True)

    @abstractmethod
    def require_lens(self, camera: Camera) -> None:
        """Refuse a lens that the format has no model of.

        Raises
        ------
        InvalidRequest
        """

    @abstractmethod
    def add_more(self, folder: Path, sample: Sample) -> None:
        """Write what else a frame has in the format."""

    @abstractmethod
    def write_scene(
        self, folder: Path, pictures: Sequence[PosedPicture], tracks: PointTracks
    ) -> None:
        """Write lenses, poses and points."""

    def _poses(self, frame: Frame) -> NDArray[np.int32]:
        if frame.states is None:
            raise RecordingError(
                f"{self.title} needs the states of instances, which were not recorded"
            )
        result = np.full(65536, -1, np.int32)
        for id_, matrix in zip(frame.states.ids.tolist(), frame.states.matrices, strict=True):
            key = id_, matrix.tobytes()
            result[id_] = self._places.setdefault(key, len(self._places))
        return result


def _seen_file(folder: Path, number: int) -> Path:
    """Return where what a picture's pixels see is kept until the points are found."""
    return folder / ".seen" / f"{number:06d}.npz"


def _reach(frame: Frame) -> NDArray[np.float32]:
    found = reach_of(frame.views, frame.camera.intrinsics)
    assert found is not None  # depth is there
    return found


def _tracks(folder: Path, pictures: Sequence[PosedPicture]) -> PointTracks:
    """Return the points of random pixels that two pictures or more see."""
    wanted = -(-POINTS // len(pictures))
    chosen = [_chosen(folder, picture, wanted) for picture in pictures]
    xyz, rgb, place, id_ = (
        np.concatenate([points[k] for points in chosen]) for k in range(len(chosen[0]))
    )
    found: list[tuple[NDArray[np.int64], NDArray[np.float64]]] = []
    for picture in pictures:
        found.append(_observed(folder, picture, xyz, place, id_))
    times = np.bincount(np.concatenate([points for points, _ in found]), minlength=len(xyz))
    kept = times >= LEAST_VIEWS
    number = np.cumsum(kept) - 1
    return PointTracks(
        xyz=xyz[kept],
        rgb=rgb[kept],
        pictures=np.concatenate(
            [np.full(int(kept[points].sum()), k) for k, (points, _) in enumerate(found)]
        ).astype(np.int64),
        points=np.concatenate([number[points[kept[points]]] for points, _ in found]),
        pixels=np.concatenate([pixels[kept[points]] for points, pixels in found]),
    )


def _chosen(
    folder: Path, picture: PosedPicture, wanted: int
) -> tuple[NDArray[np.float64], NDArray[np.uint8], NDArray[np.int32], NDArray[np.uint16]]:
    """Return what random pixels see: places [m], colours, numbers of poses, ids."""
    with np.load(_seen_file(folder, picture.number)) as seen:
        reach, instance, rgb = seen["reach"], seen["instance"], seen["rgb"]
    shown = np.flatnonzero(np.isfinite(reach) & (instance > 0))
    random = np.random.default_rng(picture.number)
    pixels = np.sort(random.permutation(shown)[:wanted])
    rows, columns = np.divmod(pixels, reach.shape[1])
    at = np.stack([columns, rows], axis=-1).astype(np.float64)
    lens = picture.camera.intrinsics
    origins, rays = reach_lines(lens, at)
    points = origins + rays * reach[rows, columns, None].astype(np.float64)
    pose = picture.camera.world_from_camera
    ids = instance[rows, columns]
    return points @ pose[:3, :3].T + pose[:3, 3], rgb[rows, columns], picture.poses[ids], ids


def _observed(
    folder: Path,
    picture: PosedPicture,
    xyz: NDArray[np.float64],
    place: NDArray[np.int32],
    id_: NDArray[np.uint16],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return which points a picture sees, and their pixels."""
    with np.load(_seen_file(folder, picture.number)) as seen:
        reach, instance = seen["reach"], seen["instance"]
    height, width = reach.shape
    still = np.flatnonzero(picture.poses[id_] == place)
    camera = picture.camera
    local = xyz[still] @ camera.camera_from_world[:3, :3].T + camera.camera_from_world[:3, 3]
    pixels = camera.intrinsics.project(local)
    column, row = np.rint(np.where(np.isfinite(pixels), pixels, -1.0)).astype(np.int64).T
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    still, local, pixels = still[inside], local[inside], pixels[inside]
    column, row = column[inside], row[inside]
    distance = reach_of_points(local, camera.intrinsics)
    off = np.abs(reach[row, column].astype(np.float64) - distance)
    same = (instance[row, column] == id_[still]) & (off <= SAME_M + SAME_SHARE * distance)
    return still[same], pixels[same]
