"""Frames → folders as programs for scanned rooms read them: ScanNet's and Replica's.

Both have pin-holes, depth along the axis in pictures of 16 bits, and poses world-from-camera with x
right, y down, z forward. ScanNet as its SensReader unpacks it (https://github.com/ScanNet/ScanNet);
Replica as iMAP's and NICE-SLAM's renderings of it (https://github.com/cvg/nice-slam).
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from sailenv_ros.assets.category_names import names_in
from sailenv_ros.dataset.formats.annotated_objects import NO_CATEGORY
from sailenv_ros.dataset.formats.data_files import write_bytes, write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import Record, Sample, WriteResult
from sailenv_ros.dataset.formats.images import scaled_depth
from sailenv_ros.dataset.formats.nyu40 import NYU40
from sailenv_ros.dataset.formats.scene_folders import SceneFolders, write_lists
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.pictures.codecs import encode_jpeg
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["QUALITY", "ReplicaExport", "ScanExport", "ScanNetExport"]

QUALITY = 95

SCANNET_PER_METRE, REPLICA_PER_METRE = 1000.0, 6553.5
"""Steps of depth."""


class ScanExport(SceneFolders):
    """A format whose frames share one pin-hole.

    Attributes
    ----------
    picture : str
        Name of a picture's file, by its ``number``.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "depth")
    picture: ClassVar[str]

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._lenses: dict[Path, CameraIntrinsics] = {}
        self._counts: dict[Path, int] = {}
        self._split: dict[Path, list[tuple[str, str]]] = {}

    def add(self, sample: Sample) -> WriteResult:
        """Write a frame's files, which are counted from 0 in each folder."""
        folder, lens = self.folder_of(sample), sample.frame.camera.intrinsics
        lens.require_pinhole(self.title)
        if self._lenses.setdefault(folder, lens) != lens:
            accepted = f"one of the first frame, as {self.title} has one for all"
            raise InvalidRequest("lens", f"another, in frame {sample.number}", accepted)
        number = self._counts.get(folder, 0)
        self.write_frame(folder, number, sample)
        self._counts[folder] = number + 1
        name = self.picture.format(number=number)
        self._split.setdefault(folder, []).append((name, sample.split))
        return WriteResult(written={"pictures": 1})

    def finish(self, records: Sequence[Record]) -> None:
        """Write what all frames of a folder have in common."""
        for folder, lens in self._lenses.items():
            self.write_scene(folder, lens)
            write_lists(folder, self._split[folder])

    @abstractmethod
    def write_frame(self, folder: Path, number: int, sample: Sample) -> None:
        """Write the files of one frame."""

    @abstractmethod
    def write_scene(self, folder: Path, lens: CameraIntrinsics) -> None:
        """Write the files of a folder."""


class ScanNetExport(ScanExport):
    """``color/``, ``depth/`` (mm), ``pose/``, ``intrinsic/``; with ids ``label-filt/`` and others.

    ``instance-filt/`` has 16 bits. ``scannetv2-labels.combined.tsv`` names the labels.
    """

    title: ClassVar[str] = "ScanNet"
    picture: ClassVar[str] = "color/{number}.jpg"

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._categories: dict[Path, dict[int, str]] = {}

    def write_frame(self, folder: Path, number: int, sample: Sample) -> None:
        """Write the files of one frame."""
        frame = sample.frame
        write_bytes(folder / self.picture.format(number=number), encode_jpeg(frame["rgb"], QUALITY))
        depth = scaled_depth(frame["depth"], SCANNET_PER_METRE)
        write_png(folder / "depth" / f"{number}.png", depth)
        pose = frame.camera.world_from_camera
        write_bytes(folder / "pose" / f"{number}.txt", _matrix(pose))
        for view, name in (("category", "label-filt"), ("instance", "instance-filt")):
            if view in frame.views:
                write_png(folder / name / f"{number}.png", frame[view].astype(np.uint16))
        if frame.info is not None and "category" in frame.views:
            known = {one.id: one.name for one in frame.info.categories.values()}
            self._categories.setdefault(folder, {}).update(known)

    def write_scene(self, folder: Path, lens: CameraIntrinsics) -> None:
        """Write the lens, of depth too, and the names of labels."""
        camera = np.eye(4)
        camera[:3, :3] = lens.K
        for name in ("color", "depth"):
            write_bytes(folder / "intrinsic" / f"intrinsic_{name}.txt", _matrix(camera))
            write_bytes(folder / "intrinsic" / f"extrinsic_{name}.txt", _matrix(np.eye(4)))
        if folder in self._categories:
            table = _labels(self._categories[folder])
            write_bytes(folder / "scannetv2-labels.combined.tsv", table)


class ReplicaExport(ScanExport):
    """``results/`` with pictures and depth (6553.5 steps a metre), ``traj.txt``, the lens."""

    title: ClassVar[str] = "Replica"
    picture: ClassVar[str] = "results/frame{number:06d}.jpg"

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._poses: dict[Path, list[Any]] = {}

    def write_frame(self, folder: Path, number: int, sample: Sample) -> None:
        """Write the files of one frame."""
        frame, results = sample.frame, folder / "results"
        picture = encode_jpeg(frame["rgb"], QUALITY)
        write_bytes(folder / self.picture.format(number=number), picture)
        depth = scaled_depth(frame["depth"], REPLICA_PER_METRE)
        write_png(results / f"depth{number:06d}.png", depth)
        self._poses.setdefault(folder, []).append(frame.camera.world_from_camera.reshape(-1))

    def write_scene(self, folder: Path, lens: CameraIntrinsics) -> None:
        """Write poses, a line each, and the lens."""
        write_bytes(folder / "traj.txt", _matrix(self._poses[folder]))
        camera = {"w": lens.width, "h": lens.height, "fx": lens.fx, "fy": lens.fy}
        camera |= {"cx": lens.cx, "cy": lens.cy, "scale": REPLICA_PER_METRE}
        write_json(folder / "cam_params.json", {"camera": camera})


def _matrix(rows: Iterable[Iterable[float]]) -> bytes:
    """Return numbers as text that is read back as the same ones, a row a line."""
    return "".join(f"{' '.join(repr(float(v)) for v in row)}\n" for row in rows).encode()


def _labels(categories: dict[int, str]) -> bytes:
    names = names_in("nyu40")
    lines = ["id\traw_category\tcategory\tcount\tnyu40id\tnyu40class"]
    for id_, name in sorted(categories.items()):
        if id_ not in NO_CATEGORY:
            nyu = names.get(name, "")
            lines.append(f"{id_}\t{name}\t{name}\t0\t{NYU40.get(nyu, 0)}\t{nyu}")
    return "".join(f"{line}\n" for line in lines).encode()
