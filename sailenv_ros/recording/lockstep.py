"""A lockstep `Simulation` → a recording, without DDS: every frame exactly once, as fast as it goes.

The same scene, seed and options give the same bytes, if the simulation was made with ``light`` of
``baked`` or ``plain``. While one frame is written the next one is being rendered.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Protocol

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.scene_facts import SceneFacts
from sailenv_ros.frame.motion import FORWARD_VIEWS, with_forward_motion
from sailenv_ros.recording.channels import (
    FACTS,
    FACTS_NAME,
    ON_REQUEST,
    SCENE_INFO,
    agent_topics,
    facts_message,
    frame_messages,
    scene_info_message,
    topic,
)
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scene_facts import scene_facts
from sailenv_ros.system.futures import wait_for
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import checked_views

__all__ = [
    "FRAME_TIMEOUT_S",
    "FrameRecorder",
    "MessageSink",
    "record_lockstep",
    "rendered",
    "rendered_ahead",
]

FRAME_TIMEOUT_S = 120.0
"""Time limit for rendering one frame [s]."""


class MessageSink(Protocol):
    """Takes messages by their topics: a `RecordingWriter`, or publishers."""

    def add_topic(self, topic: RecordedTopic) -> None:
        """Make a topic known."""

    def write(self, topic: str, parts: Sequence[Any], log_ns: int) -> None:
        """Take one message in CDR, cut anywhere."""


class FrameRecorder:
    """Writes frames and scene infos as the node would publish them; times are simulated.

    A new epoch, whose time begins at 0 again, is recorded behind the one before.

    Parameters
    ----------
    writer : MessageSink
        Stays the caller's.
    namespace : str
        What the topics' names begin with.
    """

    def __init__(self, writer: MessageSink, namespace: str = "/sailenv") -> None:
        self._writer = writer
        self._namespace = "/" + namespace.strip("/") if namespace.strip("/") else ""
        self._epoch: int | None = None
        self._base_ns = 0
        self._last_ns = 0
        self._known: set[str] = set()
        self._told: SceneInfo | None = None

    def announce(self, frame: Frame) -> None:
        """Make the topics of frames like this one known."""
        for entry in agent_topics(self._namespace, frame.agent, tuple(frame.views)):
            self._add(entry)

    def write_told(self, frame: Frame) -> None:
        """Record a frame, after what is known of its scene if that is new."""
        if frame.info is not None and frame.info is not self._told:
            self.write_info(frame.info)
            self._told = frame.info
        self.write_frame(frame, frame.depth_range_m)

    def write_info(self, info: SceneInfo) -> None:
        """Record what clients are told of the scene."""
        name = f"{self._namespace}/scene_info"
        self._add(topic(name, SCENE_INFO))
        log_ns = self._log_ns(info.epoch, info.sim_time_ns)
        self._writer.write(name, scene_info_message(info), log_ns)

    def write_frame(
        self,
        frame: Frame,
        depth_range_m: float,
        *,
        amodal: bool = False,
        facts: SceneFacts | None = None,
    ) -> None:
        """Record a frame; its views are those that it has.

        With `amodal` its amodal masks too; and `facts`, its own if it has some.
        """
        kept = (*frame.views, *(ON_REQUEST if amodal else ()))
        for entry in agent_topics(self._namespace, frame.agent, kept):
            self._add(entry)
        log_ns = self._log_ns(frame.epoch, frame.stamp_ns)
        known = facts or frame.facts
        if known is not None:
            name = f"{self._namespace}/{frame.agent}/{FACTS_NAME}"
            self._add(topic(name, FACTS))
            self._writer.write(name, facts_message(known), log_ns)
        for name, parts in frame_messages(frame, depth_range_m, amodal=amodal):
            self._writer.write(f"{self._namespace}/{frame.agent}/{name}", parts, log_ns)

    def _add(self, entry: RecordedTopic) -> None:
        if entry.name not in self._known:
            self._known.add(entry.name)
            self._writer.add_topic(entry)

    def _log_ns(self, epoch: int, stamp_ns: int) -> int:
        if epoch != self._epoch:
            # Log times never go back, so that every reader gives the epochs one after another.
            self._base_ns = self._last_ns + 1 if self._epoch is not None else 0
            self._epoch = epoch
        self._last_ns = max(self._last_ns, self._base_ns + stamp_ns)
        return self._last_ns


@dataclass(frozen=True, slots=True)
class _Shot:
    step: int
    spec: AgentSpec


def rendered_ahead(asked: Iterable[Future[Frame]]) -> Iterator[Frame]:
    """Return frames in order; each is asked for before the one before is used.

    Parameters
    ----------
    asked : iterable of Future
        Asks for a frame when it is asked itself.

    Raises
    ------
    DeadlineExceeded
        If a frame takes longer than `FRAME_TIMEOUT_S`.
    """
    before: Future[Frame] | None = None
    for following in asked:
        if before is not None:
            yield rendered(before)
        before = following
    if before is not None:
        yield rendered(before)


def rendered(asked: Future[Frame]) -> Frame:
    """Wait for a frame that was asked for; see `rendered_ahead`."""
    frame: Frame = wait_for(asked, "a frame to be rendered", FRAME_TIMEOUT_S)
    return frame


def record_lockstep(
    simulation: Simulation,
    writer: RecordingWriter,
    *,
    frames: int,
    agents: Sequence[str] = (),
    views: Views = (),
    amodal: bool = False,
    facts: bool = False,
    namespace: str = "/sailenv",
    on_frame: Callable[[int], None] = lambda count: None,
) -> int:
    """Record so many frames of each agent.

    Parameters
    ----------
    simulation : Simulation
        In lockstep mode; nobody else should step it meanwhile.
    writer : RecordingWriter
    frames : int
        Of each agent.
    agents : sequence of str
        Names; none means all.
    views : str or iterable of str
        Views of every frame; none means each agent's own. Of ``flow_forward`` and ``scene_flow``
        the last frame of each agent has none (nan).
    amodal : bool
        True records amodal masks too.
    facts : bool
        True records what `scene_facts` knows at each frame, which takes up to some seconds.
    namespace : str
        What the topics' names begin with.
    on_frame : callable
        Called with the number of frames that have been written, after each.

    Returns
    -------
    count : int
        Frames that were written.

    Raises
    ------
    InvalidRequest
        If the simulation is not in lockstep mode, or a number or name cannot be accepted.
    RecordingError
        If it cannot be written on; what was written is readable.
    """
    specs = _chosen(simulation.info, agents)
    if simulation.info.mode != "lockstep":
        raise InvalidRequest("mode of the simulation", simulation.info.mode, "'lockstep'")
    if frames < 1:
        raise InvalidRequest("frames", frames, "1 or more")
    wanted = checked_views(views) if views else None
    shots = sorted(
        (_Shot(step, spec) for spec in specs for step in due_steps(spec.rate_hz, frames)),
        key=lambda shot: shot.step,
    )
    ranges = {spec.name: spec.depth_range_m for spec in specs}
    infos: list[SceneInfo] = []
    recorder = FrameRecorder(writer, namespace)
    stop_listening = simulation.on_info(infos.append)
    count = 0
    try:
        late = tuple(view for view in wanted or () if view in FORWARD_VIEWS)
        known: deque[SceneFacts] | None = deque() if facts else None
        made = rendered_ahead(_asked(simulation, shots, _views_to_render(wanted), known))
        for frame in with_forward_motion(made, late) if late else made:
            # The next frame is being made: what is told for it must not come before this one.
            while infos and infos[0].revision <= frame.revision:
                recorder.write_info(infos.pop(0))
            told = known.popleft() if known is not None else None
            recorder.write_frame(frame, ranges[frame.agent], amodal=amodal, facts=told)
            count += 1
            on_frame(count)
    finally:
        stop_listening()
    return count


def _chosen(info: SceneInfo, names: Sequence[str]) -> list[AgentSpec]:
    by_name = {spec.name: spec for spec in info.agents}
    for name in names:
        if name not in by_name:
            raise UnknownName("agent", name, by_name)
    chosen = [by_name[name] for name in dict.fromkeys(names)] if names else list(by_name.values())
    if not chosen:
        raise InvalidRequest("agents", (), "at least one; the scene has none")
    for spec in chosen:
        if not spec.rate_hz:
            raise InvalidRequest(f"rate_hz of agent {spec.name!r}", 0.0, "above 0 to be recorded")
    return chosen


def _views_to_render(views: tuple[str, ...] | None) -> tuple[str, ...] | None:
    """Return the views to render: those that are known later are made of depth and ids."""
    rendered = tuple(view for view in views or () if view not in FORWARD_VIEWS)
    if views is None or rendered == views:
        return views
    return checked_views((*rendered, "depth", "instance"))


def _asked(
    simulation: Simulation,
    shots: Sequence[_Shot],
    views: tuple[str, ...] | None,
    known: deque[SceneFacts] | None,
) -> Iterator[Future[Frame]]:
    """Ask for frames; what is known at the instant of each is added to `known`."""
    step, told = 0, None
    for shot in shots:
        if shot.step > step:
            simulation.step.submit(shot.step - step)
            step, told = shot.step, None
        asked = simulation.capture.submit(views, agent=shot.spec.name)
        if known is not None:
            told = told or simulation.read(scene_facts, timeout_s=FRAME_TIMEOUT_S)
            known.append(told)
        yield asked
