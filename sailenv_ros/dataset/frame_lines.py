"""Frames of shards as they are made, through a line of bounded length: without files.

The maker works in a thread of its own, and is ahead by no more frames than the line holds.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TypeAlias

from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.dataset.formats.object_records import told_objects
from sailenv_ros.dataset.formats.view_files import as_kept
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.reader import DatasetFrame
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.dataset.shard_plan import Clip
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera

__all__ = ["FrameLine", "frames_into"]

LOOK_INTERVAL_S = 0.1

_Entry: TypeAlias = DatasetFrame | BaseException | None
"""A frame, what ended the work, or None: that was all."""


class _Closed(BaseException):
    """Ends the work of a maker whose frames nobody wants any more."""


class _Frames:
    """Sink of a `ShardMaker`: frames as `dataset.open` reads them from files, in their order."""

    def __init__(self, job: Job, put: Callable[[DatasetFrame], None]) -> None:
        self._recipe = job.recipe
        self._rules = job.recipe.annotation_rules
        self._put = put
        self._places = {one.name: place for place, one in enumerate(job.recipe.cameras)}
        self._clip: Clip | None = None
        self._counts: dict[str, int] = {}
        self._held: list[DatasetFrame] = []

    def begin_clip(self, clip: Clip) -> None:
        """Begin with the frames of a clip."""
        self._clip, self._counts, self._held = clip, dict.fromkeys(self._places, 0), []

    def add(self, camera: str, frame: Frame) -> None:
        """Pass on a frame of the first camera; those of others come after all of that."""
        assert self._clip is not None
        time, place = self._counts[camera], self._places[camera]
        self._counts[camera] += 1
        sequence = self._clip.sequence(place, len(self._places))
        number = sequence * self._recipe.clip.frames + time
        objects, _ = (
            told_objects(Sample(number=number, frame=frame, rules=self._rules), "a stream")
            if "instance" in frame.views
            else ([], {})
        )
        # What files do not keep is not here either, so that nobody comes to need it.
        plain = replace(
            frame,
            views={
                view: as_kept(view, values, self._recipe.compression_of_views.get(view))
                for view, values in frame.views.items()
            },
            camera=Camera(intrinsics=frame.camera.intrinsics, pose=frame.camera.pose),
            info=None,
            states=None,
            lesson=None,
            draw_amodal=None,
            revision=0,
        )
        made = DatasetFrame(
            number=number,
            split=self._clip.split,
            clip=self._clip.number,
            time=time,
            camera=camera,
            frame=plain,
            objects=tuple(objects),
        )
        if place == 0:
            self._put(made)
        else:
            self._held.append(made)

    def end_clip(self) -> None:
        """Pass on the frames of the other cameras."""
        for one in sorted(self._held, key=lambda made: made.number):
            self._put(one)
        self._held = []


def frames_into(job: Job, shards: Sequence[int], put: Callable[[DatasetFrame], None]) -> None:
    """Make shards, and hand each frame on."""
    with ShardMaker(job, None) as maker:
        for shard in shards:
            maker.take(shard, _Frames(job, put))


class FrameLine:
    """Frames of shards, made in a thread of this process.

    Parameters
    ----------
    job : Job
    shards : sequence of int
    ahead : int
        How many frames are made before they are taken.
    """

    def __init__(self, job: Job, shards: Sequence[int], ahead: int) -> None:
        self._waiting: queue.Queue[_Entry] = queue.Queue(ahead)
        self._closed = threading.Event()
        self._thread = threading.Thread(
            target=self._make, args=(job, shards), name="sailenv-stream", daemon=True
        )
        self._thread.start()

    def __iter__(self) -> Iterator[DatasetFrame]:
        while (entry := self._waiting.get()) is not None:
            if isinstance(entry, BaseException):
                raise entry
            yield entry

    def close(self) -> None:
        """End the work, and wait for its thread; a second call does nothing."""
        self._closed.set()
        self._thread.join()

    def _make(self, job: Job, shards: Sequence[int]) -> None:
        try:
            frames_into(job, shards, self._put)
            self._put(None)
        except _Closed:
            pass
        except BaseException as problem:
            with contextlib.suppress(_Closed):
                self._put(problem)

    def _put(self, entry: _Entry) -> None:
        while not self._closed.is_set():
            try:
                self._waiting.put(entry, timeout=LOOK_INTERVAL_S)
                return
            except queue.Full:
                continue
        raise _Closed
