"""Data set → typed frames, by their numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.frame_sources import FrameSource, frame_source
from sailenv_ros.dataset.making import job_of
from sailenv_ros.dataset.manifest import done_shards
from sailenv_ros.dataset.merging import frame_records
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.errors import RecordingError, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.system.own_process import OwnProcess

__all__ = ["Dataset", "DatasetFrame"]


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


class Dataset(Sequence[DatasetFrame]):
    """The frames of a data set, or of one of its splits.

    Can be sent to other processes, such as the workers of a PyTorch `DataLoader`: each opens the
    files itself.

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
        self._source: FrameSource = frame_source(folder, self.recipe)
        self._process = OwnProcess("Dataset")

    def __len__(self) -> int:
        return len(self._records)

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        return self.frame_at(index)

    @property
    def keeps_arrays(self) -> bool:
        """Whether arrays of a frame are kept for another look at it."""
        return self._source.keeps_arrays

    def frame_at(self, index: int, *, objects: bool = True) -> DatasetFrame:
        """Return one frame; with `objects` False without what is told of its objects, quicker."""
        if self._process.is_inherited:
            # Where a file is read next is the parent's, too.
            self._source = frame_source(self.folder, self.recipe)
            self._process = OwnProcess("Dataset")
        record = self._records[index]
        frame, told = self._source.frame(record, objects=objects)
        return DatasetFrame(
            number=record["number"],
            split=record["split"],
            clip=record["clip"],
            time=record["time"],
            camera=record["camera"],
            frame=frame,
            objects=told,
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
