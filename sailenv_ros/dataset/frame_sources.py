"""Files of a data set → frames by their records: WebDataset's tar files, or MCAP bags."""

from __future__ import annotations

import contextlib
import io
import json
import os
import tarfile
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import numpy as np

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

_HEAD_BYTES = 4096
"""A frame's record is seldom longer, without its objects [B]."""


@dataclass(slots=True)
class _Members:
    """Where the files of one frame are: what is told of it, and views with their endings."""

    told: _Place | None = None
    views: list[tuple[str, str, _Place]] = field(default_factory=list)


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

    keeps_arrays: ClassVar[bool] = True
    """Whether arrays of a frame may be read again, and so must not be written to."""

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

    keeps_arrays = False

    def __init__(self, folder: Path, recipe: DatasetRecipe) -> None:
        super().__init__(folder, recipe)
        self._members: dict[Path, Mapping[str, _Members]] = {}
        self._lenses: dict[str, tuple[Mapping[str, Any], CameraIntrinsics]] = {}

    def frame(
        self, record: Mapping[str, Any], *, objects: bool = True
    ) -> tuple[Frame, tuple[Mapping[str, Any], ...]]:
        shard = self._plan.shard_of_clip(record["clip"])
        path = self._folder / "webdataset" / f"{record['split']}-{shard:05d}.tar"
        name = f"{record['number']:08d}"
        try:
            with path.open("rb", buffering=0) as file:
                members = self._members_in(path).get(name, _Members())
                if members.told is None:
                    raise KeyError(f"{name}.json")
                told = _told(file, members.told, objects=objects)
                views = {
                    view: decoded(view, ending, _read(file, place))
                    for view, ending, place in members.views
                }
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

    def _members_in(self, path: Path) -> Mapping[str, _Members]:
        """Return where the files of each frame are, by the frame's name."""
        if path not in self._members:
            found: dict[str, _Members] = {}
            with tarfile.TarFile(path) as tar:
                for one in tar.getmembers():
                    place = one.offset_data, one.size
                    name, _, rest = one.name.partition(".")
                    view, _, ending = rest.partition(".")
                    if rest == "json":
                        found.setdefault(name, _Members()).told = place
                    elif view in VIEWS and ending in ENDINGS:
                        found.setdefault(name, _Members()).views.append((view, ending, place))
            self._members[path] = found
        return self._members[path]

    def close(self) -> None:
        """Forget what is where; no file is open."""
        self._members.clear()


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


def _read(file: io.FileIO, place: _Place) -> memoryview:
    """Return what stands at a place, in memory of its own that may be written to."""
    first, size = place
    data = np.empty(size, np.uint8).data
    if os.preadv(file.fileno(), [data], first) != size:
        raise OSError(f"it ends within the {size} bytes at {first}")
    return data


def _told(file: io.FileIO, place: _Place, *, objects: bool) -> dict[str, Any]:
    """Read what is told of a frame; without its objects, which are most of it and come last."""
    first, size = place
    if not objects and size > _HEAD_BYTES:
        told = _without_objects(bytes(_read(file, (first, _HEAD_BYTES))))
        if told is not None:
            return told
    whole: dict[str, Any] = json.loads(bytes(_read(file, place)))
    return whole


def _without_objects(data: bytes) -> dict[str, Any] | None:
    """Return what stands before the objects of a frame; None if these do not begin there."""
    end = 0
    # Quotes within a text are escaped: these bytes are a key. Records of what was drawn at random
    # may have one, too; there the braces around it are open still.
    while (end := data.find(b', "objects": [', end + 1)) >= 0:
        with contextlib.suppress(ValueError):
            told: dict[str, Any] = json.loads(data[:end] + b"}")
            return told
    return None
