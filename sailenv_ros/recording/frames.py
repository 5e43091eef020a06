"""The frames of a recording: which there are of an agent, and each one by its number or time.

`RecordingReader` in; frames as their messages or as `Frame` out. Images have a stamp and no
number; as for a live client, those recorded between two frames' infos belong to the second.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_msgs_py.camera_info import intrinsics_from_camera_info
from sailenv_msgs_py.frame_info import (
    camera_of_frame_info,
    lesson_of_frame_info,
    randomised_of_frame_info,
    row_poses_of_frame_info,
    states_of_frame_info,
)
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.object_truth_msgs import amodal_masks_from_msgs
from sailenv_msgs_py.scene_msgs import scene_info_from_msg
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.errors import InvalidRequest, RecordingError, UnknownName
from sailenv_ros.frame.data import DrawAmodal
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.recording.channels import (
    FACTS,
    FACTS_NAME,
    FRAME_INFO,
    IMAGE,
    OBJECTS,
    ON_REQUEST,
    SCENE_INFO,
    facts_of_message,
    is_present_form,
    message_of,
    present_form,
)
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.validation import is_integer
from sailenv_ros.types.views import VIEWS

__all__ = ["RecordedFrames", "frame_of_info", "recorded_agents"]

_log = logging.getLogger(__name__)


def frame_of_info(
    info: Any,
    views: Mapping[str, NDArray[Any]],
    intrinsics: CameraIntrinsics,
    scene_info: SceneInfo | None,
    draw_amodal: DrawAmodal | None = None,
) -> Frame:
    """Make one frame of its info and its arrays, which nobody else has.

    Parameters
    ----------
    info : sailenv_msgs/FrameInfo
    views : mapping of str to array
        In any order.
    intrinsics : CameraIntrinsics
        Of the agent that the frame is of.
    scene_info : SceneInfo or None
        The one of the frame's revision, if it is known.
    draw_amodal : callable or None
        As `Frame` has it.
    """
    return Frame(
        agent=info.agent,
        scene=info.scene,
        epoch=info.epoch,
        revision=info.revision,
        sequence=info.sequence,
        stamp_ns=ns_from_stamp(info.header.stamp),
        dt_ns=info.dt_ns,
        camera=camera_of_frame_info(info, intrinsics),
        depth_range_m=info.depth_range_m,
        views={view: views[view] for view in VIEWS if view in views},
        timings_s={"render": info.render_s},
        info=scene_info,
        draw_amodal=draw_amodal,
        states=states_of_frame_info(info),
        randomised=randomised_of_frame_info(info),
        lesson=lesson_of_frame_info(info),
        exposure=info.exposure,
        row_poses=row_poses_of_frame_info(info),
    )


def recorded_agents(reader: RecordingReader) -> dict[str, str]:
    """Return the agents whose frames were recorded, with what their topics' names begin with."""
    suffix = "/frame_info"
    names = [t.name for t in reader.topics if t.type == FRAME_INFO and t.name.endswith(suffix)]
    scenes = [t.name.removesuffix("scene_info") for t in reader.topics if t.type == SCENE_INFO]
    found = {}
    for prefix in sorted(name[: -len(suffix)] for name in names):
        # Below the simulator's namespace, where that is known: cameras of rigs have two names.
        above = max((scene for scene in scenes if prefix.startswith(scene)), key=len, default="")
        found[prefix[len(above) :] if above else prefix.split("/")[-1]] = prefix
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _FrameEntry:
    """Positions of a frame's messages: rows of the reader."""

    log_ns: int
    stamp_ns: int
    info: Any
    images: Mapping[str, int]
    facts: int | None


class RecordedFrames(Sequence[Frame]):
    """The complete frames of one agent, in the order they were recorded.

    Parameters
    ----------
    reader : RecordingReader
        Stays the caller's.
    agent : str
        Its name; empty if there is only one.

    Raises
    ------
    RecordingError
        If no agent's frames were recorded.
    UnknownName
        If there is no such agent, or several and none was named.
    """

    def __init__(self, reader: RecordingReader, agent: str = "") -> None:
        self._reader = reader
        agents = recorded_agents(reader)
        if not agents:
            raise RecordingError(f"{reader.path} has no frames of an agent in it (no frame_info)")
        if agent not in agents and (agent or len(agents) > 1):
            raise UnknownName("agent", agent, agents)
        self.agent = agent or next(iter(agents))
        self._prefix = agents[self.agent]
        self._topics = {t.name: t for t in reader.topics}
        self.views = tuple(
            view
            for view in VIEWS
            if getattr(self._topics.get(f"{self._prefix}/{view}"), "type", "") == IMAGE
        )
        self._infos = self._scene_infos()
        self._entries: list[_FrameEntry] = []
        self.incomplete = 0
        self._find_frames()
        self._stamps = np.array([entry.stamp_ns for entry in self._entries], np.int64)

    # -- which there are -------------------------------------------------------------------

    def __len__(self) -> int:
        return len(self._entries)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """Simulated time of each frame [ns]; begins again where the scene did."""
        return self._stamps.copy()

    def index_at(self, time_s: float) -> int:
        """Return the number of the last frame at or before a simulated time [s].

        Where the scene began several times, that of the last time.

        Raises
        ------
        InvalidRequest
            If the time is no finite number.
        RecordingError
            If all are later.
        """
        if not isinstance(time_s, int | float | np.number) or not np.isfinite(time_s):
            raise InvalidRequest("time_s", time_s, "a finite number [s]")
        earlier = np.flatnonzero(self._stamps <= round(time_s * 1e9))
        if not len(earlier):
            raise RecordingError(f"{self._reader.path} has no frame at or before {time_s:g} s")
        latest = earlier[self._stamps[earlier] == self._stamps[earlier].max()]
        return int(latest[-1])

    def position(self, index: int) -> int:
        """Check an index, of which negative ones count from the end.

        Raises
        ------
        InvalidRequest, IndexError
            If it is no integer, or there is no such frame.
        """
        if not is_integer(index):
            raise InvalidRequest("index", index, "an integer")
        if not -len(self) <= index < len(self):
            # Python's own: it is what ends a loop over a sequence.
            raise IndexError(f"there is no frame {index}; there are {len(self)}")
        return int(index) % len(self)

    # -- what they hold --------------------------------------------------------------------

    def __getitem__(self, index: Any) -> Any:
        """Read one frame as `Frame`, or several of a slice as a list."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        info, images = self.messages(index)
        scene_info = self.scene_info(index)
        views = {view: view_from_image(view, image) for view, image in images.items()}
        intrinsics = self._intrinsics(info, scene_info)
        frame = frame_of_info(info, views, intrinsics, scene_info, self._amodal_reader(index))
        row = self._entries[self.position(index)].facts
        return frame if row is None else replace(frame, facts=facts_of_message(self._message(row)))

    def __iter__(self) -> Iterator[Frame]:
        return (self[number] for number in range(len(self)))

    def messages(self, index: int) -> tuple[Any, dict[str, Any]]:
        """Read a frame's info and its images by their views, in the order of `VIEWS`."""
        entry = self._entries[self.position(index)]
        return entry.info, {view: self._message(entry.images[view]) for view in entry.images}

    def scene_info(self, index: int) -> SceneInfo | None:
        """Return what was told of the scene when the frame was made; None if not recorded."""
        entry = self._entries[self.position(index)]
        own = [(log, info) for log, info in self._infos if info.revision == entry.info.revision]
        if own:
            # Several only where the bag goes over several runs of a simulator.
            return ([info for log, info in own if log <= entry.log_ns] or [own[0][1]])[-1]
        # It was not recorded, or the bag is of a version whose frames had revisions of their own.
        known = [info for log_ns, info in self._infos if log_ns <= entry.log_ns]
        if known and known[-1].revision >= entry.info.revision:
            return known[-1]
        newer = [info for _, info in self._infos if info.revision >= entry.info.revision]
        return newer[0] if newer else (known[-1] if known else None)

    def _amodal_reader(self, index: int) -> DrawAmodal | None:
        """Return what reads the amodal masks of a frame; None if they were not recorded."""
        info = self._entries[self.position(index)].info
        row = self._amodal_rows.get((ns_from_stamp(info.header.stamp), info.sequence))
        if row is None:
            return None

        def read(only: int = 0) -> AmodalMasks:
            message = self._message(row)
            masks = (one.amodal for one in message.objects)
            return amodal_masks_from_msgs(masks, message.height, message.width)

        return read

    # -- inside ----------------------------------------------------------------------------

    @cached_property
    def _amodal_rows(self) -> dict[tuple[int, int], int]:
        """Rows of the messages with amodal masks, by the stamp and the number of their frames."""
        name = f"{self._prefix}/{ON_REQUEST[0]}"
        if getattr(self._topics.get(name), "type", "") != OBJECTS:
            return {}
        found = {}
        for row in self._reader.rows(name).tolist():
            message = self._message(row)
            found[ns_from_stamp(message.header.stamp), message.sequence] = row
        return found

    def _intrinsics(self, info: Any, scene_info: SceneInfo | None) -> CameraIntrinsics:
        specs = [] if scene_info is None else scene_info.agents
        for spec in specs:
            if spec.name == self.agent:
                return spec.intrinsics
        # Of an agent that no scene_info names the camera_info tells, but for rounding, the same.
        name = f"{self._prefix}/camera_info"
        rows = self._reader.rows(name) if name in self._topics else None
        if rows is None or not rows.size:
            raise RecordingError(f"{self._reader.path} has neither {name} nor a scene_info with it")
        camera_info = self._message(int(rows[0]))
        return intrinsics_from_camera_info(camera_info, near_m=info.near_m, far_m=info.far_m)

    def _message(self, row: int) -> Any:
        topic, raw = self._reader.message(row)
        return message_of(topic.type, present_form(topic, raw.data))

    def _scene_infos(self) -> list[tuple[int, SceneInfo]]:
        name = f"{self._prefix.removesuffix(f'/{self.agent}')}/scene_info"
        if getattr(self._topics.get(name), "type", "") != SCENE_INFO:
            return []
        if not is_present_form(self._topics[name]):
            _log.warning(
                "%s was recorded by an older version, whose scene_info cannot be read: names, "
                "categories and objects of its frames are not known",
                self._reader.path,
            )
            return []
        rows = self._reader.rows(name)
        return [
            (int(self._reader.log_ns(int(row))), scene_info_from_msg(self._message(int(row))))
            for row in rows
        ]

    def _find_frames(self) -> None:
        kept = self.views
        if getattr(self._topics.get(f"{self._prefix}/{FACTS_NAME}"), "type", "") == FACTS:
            kept = (*kept, FACTS_NAME)
        rows = {name: self._reader.rows(f"{self._prefix}/{name}") for name in kept}
        times = {name: self._reader.log_ns(found) for name, found in rows.items()}
        after = dict.fromkeys(kept, 0)
        for row in self._reader.rows(f"{self._prefix}/frame_info"):
            info, log_ns = self._message(int(row)), int(self._reader.log_ns(int(row)))
            images = {}
            for name in kept:
                until = int(np.searchsorted(times[name], log_ns, side="right"))
                if name in (*info.views, FACTS_NAME) and until > after[name]:
                    images[name] = int(rows[name][until - 1])
                after[name] = until
            facts = images.pop(FACTS_NAME, None)
            if set(images) == set(info.views) & set(self.views) and images:
                stamp_ns = ns_from_stamp(info.header.stamp)
                self._entries.append(
                    _FrameEntry(
                        log_ns=log_ns, stamp_ns=stamp_ns, info=info, images=images, facts=facts
                    )
                )
            else:
                self.incomplete += 1
