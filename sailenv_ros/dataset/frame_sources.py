"""Files of a data set → frames by their records: WebDataset's tar files, or MCAP bags."""

from __future__ import annotations

import io
import json
import os
import tarfile
from abc import ABC, abstractmethod
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from sailenv_ros.dataset.formats.view_files import ENDINGS, decoded
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.shard_plan import ShardPlan
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.views import VIEWS

if TYPE_CHECKING:
    from sailenv_ros.recording.frames import RecordedFrames
    from sailenv_ros.recording.reader import RecordingReader

__all__ = ["FrameSource", "frame_source"]

_Place: TypeAlias = tuple[int, int]
"""First byte of a member in its tar file, and its size [B]."""


def frame_source(folder: Path, recipe: DatasetRecipe) -> FrameSource:
    """Return what reads the frames of a data set.

    Raises
    ------
    RecordingError
        If it has neither of the formats that keep frames exactly.
    """
    if "webdataset" in recipe.formats:
        return _TarSource(folder, recipe)
    if "mcap" in recipe.formats:
        return _BagSource(folder, recipe)
    raise RecordingError(
        f"{folder} keeps frames as {', '.join(recipe.formats)} alone, for which there are readers "
        "of their own; frames are read here from webdataset or mcap"
    )


class FrameSource(ABC):
    """Base of the sources from which frames are read."""

    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        self._folder = folder
        self._plan = ShardPlan(recipe)

    @abstractmethod
    def frame(
        self, record: Mapping[str, Any], *, objects: bool = True
    ) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        """Return a frame and its objects, or none of them, which is quicker."""

    @abstractmethod
    def close(self) -> None:
        """Close all files."""


class _TarSource(FrameSource):
    """Reads each file at places of its own, so processes and threads do not disturb each other."""

    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        super().__init__(folder, recipe)
        self._places: dict[Path, Mapping[str, _Place]] = {}
        self._lenses: dict[str, tuple[Mapping[str, Any], CameraIntrinsics]] = {}

    def frame(
        self, record: Mapping[str, Any], *, objects: bool = True
    ) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        shard = self._plan.shard_of_clip(record["clip"])
        path = self._folder / "webdataset" / f"{record['split']}-{shard:05d}.tar"
        name = f"{record['number']:08d}"
        try:
            with path.open("rb", buffering=0) as file:
                places = self._places_in(path)
                told = _told(_read(file, places[f"{name}.json"]), objects=objects)
                views = {}
                for view in VIEWS:
                    for ending in ENDINGS:
                        place = places.get(f"{name}.{view}.{ending}")
                        if place is not None:
                            views[view] = decoded(view, ending, _read(file, place))
            frame = Frame(
                agent=told["agent"],
                scene=told["scene"],
                epoch=told["epoch"],
                revision=0,
                sequence=told["sequence"],
                stamp_ns=told["stamp_ns"],
                dt_ns=told["dt_ns"],
                camera=Camera(
                    intrinsics=self._lens(record["camera"], told["lens"]),
                    pose=Pose(tuple(told["position"]), tuple(told["orientation_xyzw"])),
                ),
                depth_range_m=told["depth_range_m"],
                views=views,
                randomised=told.get("randomised"),
                exposure=told.get("exposure", 0.0),
            )
        except (OSError, tarfile.TarError, KeyError, ValueError, TypeError) as problem:
            raise RecordingError(f"{path} cannot be read: {problem}") from None
        return frame, tuple(told.get("objects", ()))

    def _lens(self, camera: str, told: Mapping[str, Any]) -> CameraIntrinsics:
        """Return a camera's lens, which is the same in most of its frames."""
        kept = self._lenses.get(camera)
        if kept is None or kept[0] != told:
            kept = self._lenses[camera] = told, CameraIntrinsics(**told)
        return kept[1]

    def _places_in(self, path: Path) -> Mapping[str, _Place]:
        if path not in self._places:
            with tarfile.TarFile(path) as tar:
                self._places[path] = {
                    one.name: (one.offset_data, one.size) for one in tar.getmembers()
                }
        return self._places[path]

    def close(self) -> None:
        """Forget what is where; no file is open."""
        self._places.clear()


class _BagSource(FrameSource):
    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        super().__init__(folder, recipe)
        self._several = len(recipe.cameras) > 1
        self._open: tuple[Path, RecordingReader, RecordedFrames] | None = None

    def frame(
        self, record: Mapping[str, Any], *, objects: bool = True
    ) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        name = f"{record['clip']:06d}" + (f"_{record['camera']}" if self._several else "")
        path = self._folder / "mcap" / record["split"] / name / "bag"
        if self._open is None or self._open[0] != path:
            # These need the message packages of ROS, which tar files do not.
            from sailenv_ros.recording.frames import RecordedFrames
            from sailenv_ros.recording.reader import RecordingReader

            self.close()
            reader = RecordingReader(path)
            self._open = path, reader, RecordedFrames(reader)
        return self._open[2][record["time"]], ()

    def close(self) -> None:
        """Close the bag."""
        if self._open is not None:
            self._open[1].close()
            self._open = None


def _read(file: io.FileIO, place: _Place) -> bytes:
    first, size = place
    data = os.pread(file.fileno(), size, first)
    if len(data) != size:
        raise OSError(f"it ends within the {size} bytes at {first}")
    return data


def _told(data: bytes, *, objects: bool) -> dict[str, Any]:
    """Read what is told of a frame; without its objects, which are most of it and come last."""
    # Quotes within a text are escaped: these bytes are a key. The last one is the frame's own, as
    # records of what was drawn at random may have one, too, and stand before it.
    end = -1 if objects else data.rfind(b', "objects": [')
    told: dict[str, Any] = json.loads(data if end < 0 else data[:end] + b"}")
    return told
