"""Schedule of streamed frames: when each is due, and for whom.

Counts physics steps; knows neither the wall clock nor how a frame is made.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence

from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.live_scene import LiveScene

__all__ = ["StreamSchedule"]


class StreamSchedule:
    """The frame streams of one simulation's agents.

    Parameters
    ----------
    scene : LiveScene
    render : callable
        ``render([(record, views), ...])`` returns a frame of each agent now.

    Attributes
    ----------
    skipped_frames : int
        Frames that were never rendered because the wall clock was ahead.
    """

    def __init__(
        self,
        scene: LiveScene,
        render: Callable[[Sequence[tuple[AgentRecord, Iterable[str]]]], Sequence[Frame]],
    ) -> None:
        self.skipped_frames = 0
        self._scene = scene
        self._render = render

    def open(
        self,
        agent: str,
        views: Sequence[str],
        on_change: Callable[[FrameStream], None],
        supported: Collection[str],
    ) -> FrameStream:
        """Begin to deliver an agent's frames at its rate; see `FrameStream`."""
        record = self._scene.agents[agent]
        stream = FrameStream(agent, views, on_change, supported=supported)
        record.streams.append(stream)
        if record.spec.rate_hz:
            record.skip_to(self._scene.world.step_count)
        return stream

    def discard(self) -> None:
        """Drop the frames that nobody has taken yet: their world is no more."""
        for stream in self._streams():
            stream.discard()

    def end(self, why: str) -> None:
        """Announce that no more frames will come."""
        for stream in self._streams():
            stream.end(why)

    def due_steps(self, step: int, *, every_frame: bool) -> dict[str, int]:
        """Return the step at which each agent's next frame is due, by the agents' names.

        Parameters
        ----------
        step : int
            As far as physics shall run now.
        every_frame : bool
            False: the last frame that is due by then, -1 if there is none.
        """
        return {
            record.spec.name: record.due_step() if every_frame else record.last_due_step(step)
            for record in self._wanted()
        }

    def next_due_step(self) -> int | None:
        """Return the step of the earliest streamed frame to come; None if nobody wants any."""
        return min((record.due_step() for record in self._wanted()), default=None)

    def render_due(self) -> None:
        """Render each agent's streamed frame if its time has come; once each."""
        now = self._scene.world.step_count
        self.render(r.spec.name for r in self._wanted() if r.due_step() <= now)

    def render(self, agents: Iterable[str]) -> None:
        """Render a frame of each agent for its streams, and count those it is too late for.

        Those of a rig's cameras are rendered at once.
        """
        records = [self._scene.agents[name] for name in agents]
        rigs: dict[str, list[AgentRecord]] = {}
        for record in records:
            rigs.setdefault(record.spec.body or record.spec.name, []).append(record)
        for cameras in rigs.values():
            self._render_together(cameras)

    def _render_together(self, cameras: Sequence[AgentRecord]) -> None:
        now = self._scene.world.step_count
        # Other frames of this walk may have taken so long that a stream was closed. Who changes its
        # mind while this is drawn gets it all the same: it is not drawn again.
        asked = [(record, record.wanted()) for record in cameras if record.due_step() <= now]
        due = [(record, wanted) for record, wanted in asked if wanted]
        views = [(record, frozenset().union(*wanted.values())) for record, wanted in due]
        frames = self._render(views) if due else ()
        for (record, streams), frame in zip(due, frames, strict=True):
            # One of those that are passed over is the frame just made.
            self.skipped_frames += max(0, record.skip_to(now + 1) - 1)
            for stream in streams:
                stream.put(frame)

    def _wanted(self) -> list[AgentRecord]:
        """Return the agents whose frames somebody wants now; forgets streams that were closed."""
        wanted = []
        for record in self._scene.agents:
            record.streams[:] = [stream for stream in record.streams if not stream.closed]
            if not record.spec.rate_hz:
                continue
            if record.wanted():
                wanted.append(record)
            else:
                record.skip_to(self._scene.world.step_count)
        return wanted

    def _streams(self) -> list[FrameStream]:
        return [stream for record in self._scene.agents for stream in record.streams]
