"""Data set → typed frames, by their numbers: from WebDataset's tar files or from MCAP bags."""

from __future__ import annotations

import io
import json
import tarfile
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.making import job_of
from sailenv_ros.dataset.manifest import done_shards
from sailenv_ros.dataset.merging import frame_records
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.shard_plan import ShardPlan
from sailenv_ros.errors import RecordingError, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.codecs import decode_picture
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.views import VIEWS

__all__ = ["Dataset", "DatasetFrame", "open_dataset"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DatasetFrame:
    """One frame of a data set.

    Attributes
    ----------
    number : int
        In the data set.
    split : str
    clip : int
        Number of the clip that it belongs to.
    time : int
        Number of the frame in its clip, from 0.
    camera : str
    frame : Frame
        With all its views.
    objects : tuple of mapping
        What is known of each visible object; see `object_records.object_record`. Empty where the
        frames come from bags: there `frame.objects` has it all.
    """

    number: int
    split: str
    clip: int
    time: int
    camera: str
    frame: Frame
    objects: tuple[Mapping[str, Any], ...] = ()

    def __repr__(self) -> str:
        return (
            f"<DatasetFrame {self.number} of {self.split}: clip {self.clip}, time {self.time}, "
            f"camera {self.camera!r}, {len(self.objects)} objects\n {self.frame.about}>"
        )


def open_dataset(folder: str | Path, split: str = "") -> Dataset:
    """Open a data set that `sailenv dataset make` has made, or is making.

    Parameters
    ----------
    folder : str or Path
    split : str
        Only that one; empty for all.

    Raises
    ------
    RecordingError
        If there is none, or it has neither of the formats that keep frames exactly.
    UnknownName
        If it has no such split.
    """
    return Dataset(Path(folder), split)


class Dataset(Sequence[DatasetFrame]):
    """The frames of a data set, or of one of its splits.

    Can be sent to other processes, such as the workers of a PyTorch `DataLoader`: each opens the
    files anew.

    Attributes
    ----------
    folder : Path
    recipe : DatasetRecipe
    split : str
        Empty for all.
    """

    def __init__(self, folder: Path, split: str = "") -> None:
        self.folder = folder
        self.split = split
        if not folder.is_dir():
            raise RecordingError(f"{folder} holds no data set: there is no such folder")
        storage = FolderStorage(folder)
        self.recipe: DatasetRecipe = job_of(storage).recipe
        if split and split not in self.recipe.clips.by_name:
            raise UnknownName("split", split, self.recipe.clips.by_name)
        self._records = [
            record
            for record in frame_records(storage, done_shards(storage))
            if split in ("", record["split"])
        ]
        self._source = self._opened()

    def __len__(self) -> int:
        return len(self._records)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        record = self._records[index]
        frame, objects = self._source.frame(record)
        return DatasetFrame(
            number=record["number"],
            split=record["split"],
            clip=record["clip"],
            time=record["time"],
            camera=record["camera"],
            frame=frame,
            objects=objects,
        )

    def __iter__(self) -> Iterator[DatasetFrame]:
        return (self[number] for number in range(len(self)))

    def close(self) -> None:
        """Close the files; another look at a frame opens them again."""
        self._source.close()

    def __enter__(self) -> Dataset:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {"folder": self.folder, "split": self.split}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(**state)  # type: ignore[misc]

    def _opened(self) -> _Source:
        if "webdataset" in self.recipe.formats:
            return _TarSource(self.folder, self.recipe)
        if "mcap" in self.recipe.formats:
            return _BagSource(self.folder, self.recipe)
        raise RecordingError(
            f"{self.folder} keeps frames as {', '.join(self.recipe.formats)} alone, for which "
            "there are readers of their own; frames are read here from webdataset or mcap"
        )


class _Source(ABC):
    """Base of the sources from which frames are read."""

    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        self._folder = folder
        self._plan = ShardPlan(recipe)

    @abstractmethod
    def frame(self, record: Mapping[str, Any]) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        """Return a frame and its objects."""

    @abstractmethod
    def close(self) -> None:
        """Close all files."""


class _TarSource(_Source):
    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        super().__init__(folder, recipe)
        self._tars: dict[int, tuple[tarfile.TarFile, dict[str, tarfile.TarInfo]]] = {}

    def frame(self, record: Mapping[str, Any]) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        shard = self._plan.shard_of_clip(record["clip"])
        path = self._folder / "webdataset" / f"{record['split']}-{shard:05d}.tar"
        try:
            tar, members = self._opened(shard, path)
            name = f"{record['number']:08d}"
            told = json.loads(_read(tar, members[f"{name}.json"]))
            views = {}
            for view in VIEWS:
                for ending, decode in (("png", _from_png), ("npy", _from_npy)):
                    member = members.get(f"{name}.{view}.{ending}")
                    if member is not None:
                        views[view] = decode(view, _read(tar, member))
            frame = Frame(
                agent=told["agent"],
                scene=told["scene"],
                epoch=told["epoch"],
                revision=0,
                sequence=told["sequence"],
                stamp_ns=told["stamp_ns"],
                dt_ns=told["dt_ns"],
                camera=Camera(
                    intrinsics=CameraIntrinsics(**told["lens"]),
                    pose=Pose(tuple(told["position"]), tuple(told["orientation_xyzw"])),
                ),
                depth_range_m=told["depth_range_m"],
                views=views,
            )
        except (OSError, tarfile.TarError, KeyError, ValueError, TypeError) as problem:
            raise RecordingError(f"{path} cannot be read: {problem}") from None
        return frame, tuple(told.get("objects", ()))

    def _opened(self, shard: int, path: Path) -> tuple[tarfile.TarFile, dict[str, tarfile.TarInfo]]:
        if shard not in self._tars:
            tar = tarfile.TarFile(path)
            self._tars[shard] = tar, {one.name: one for one in tar.getmembers()}
        return self._tars[shard]

    def close(self) -> None:
        """Close all files."""
        for tar, _ in self._tars.values():
            tar.close()
        self._tars.clear()


class _BagSource(_Source):
    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        super().__init__(folder, recipe)
        self._several = len(recipe.cameras) > 1
        self._open: tuple[Path, RecordingReader, RecordedFrames] | None = None

    def frame(self, record: Mapping[str, Any]) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        name = f"{record['clip']:06d}" + (f"_{record['camera']}" if self._several else "")
        path = self._folder / "mcap" / record["split"] / name / "bag"
        if self._open is None or self._open[0] != path:
            self.close()
            reader = RecordingReader(path)
            self._open = path, reader, RecordedFrames(reader)
        return self._open[2][record["time"]], ()

    def close(self) -> None:
        """Close the bag."""
        if self._open is not None:
            self._open[1].close()
            self._open = None


def _read(tar: tarfile.TarFile, member: tarfile.TarInfo) -> bytes:
    file = tar.extractfile(member)
    assert file is not None  # only files are written
    return file.read()


def _from_png(view: str, data: bytes) -> NDArray[Any]:
    picture = decode_picture(data)
    if VIEWS[view].dtype == np.bool_:
        return np.asarray(picture > 0)
    return picture


def _from_npy(view: str, data: bytes) -> NDArray[Any]:
    return np.asarray(np.load(io.BytesIO(data), allow_pickle=False))
