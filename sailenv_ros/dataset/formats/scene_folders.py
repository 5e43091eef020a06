"""Base of formats whose folder is of one scene between two resets, with a pose for each picture."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Sample
from sailenv_ros.dataset.formats.splits import SPLITS
from sailenv_ros.errors import InvalidRequest

__all__ = ["SceneFolders", "by_splits", "write_lists"]


class SceneFolders(DatasetFormat):
    """Base of formats that hold pictures of scenes with lenses and poses.

    One folder is of one scene between two resets; of a recording of several, the others have
    folders of their own, ``<scene>_<epoch>``.
    """

    is_sequence: ClassVar[bool] = True
    tells_splits: ClassVar[bool] = True
    resumable: ClassVar[bool] = False
    title: ClassVar[str]

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._scenes: dict[Path, tuple[str, int]] = {}

    def folder_of(self, sample: Sample) -> Path:
        """Return the folder of a frame's scene.

        Raises
        ------
        InvalidRequest
            If its shutter rolled while something moved: it has a pose for each row.
        """
        frame, folder = sample.frame, self.folder
        if frame.row_poses is not None:
            accepted = f"one whose rows see one instant, as {self.title} has one pose for a picture"
            raise InvalidRequest("shutter", f"a rolling one, in frame {sample.number}", accepted)
        scene = frame.scene, frame.epoch
        if self._scenes.setdefault(folder, scene) != scene:
            folder /= f"{frame.scene}_{frame.epoch}"
        return folder


def by_splits(pictures: Iterable[tuple[str, str]]) -> dict[str, list[str]]:
    """Return the names of each split's pictures, of (name, split); nothing of what has none."""
    found: dict[str, list[str]] = {}
    for name, split in pictures:
        found.setdefault(split, []).append(name)
    return {split: found[split] for split in SPLITS if split in found}


def write_lists(folder: Path, pictures: Iterable[tuple[str, str]]) -> None:
    """Write ``train.txt`` and so on: the names of a split's pictures, a line each."""
    for split, names in by_splits(pictures).items():
        write_bytes(folder / f"{split}.txt", "".join(f"{name}\n" for name in names).encode())
