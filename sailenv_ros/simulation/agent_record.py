"""One agent of a simulation: what it saw last, when its next frame is due, who looks at it.

Used by the loop thread alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.snapshot import Observation
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.look_at_solver import LookAtSolver

__all__ = ["AgentRecord"]


@dataclass(slots=True, kw_only=True)
class AgentRecord:
    """One agent's changing state.

    Attributes
    ----------
    registered : AgentSpec
        As it was registered; what a reset goes back to.
    spec : AgentSpec
        As it is now (its follow state changes).
    pose : Pose
        Where it is while it does not follow, and how it would be turned if it faced nothing.
    gaze : LookAtSolver or None
        What it faces in the present world.
    sequence : int
        Number of its last frame.
    latest, earlier : Observation or None
        Its last frame, and its last frame of an earlier instant. Two frames of one instant share
        their past, so flow always has a time to refer to.
    due_count : int
        Number of its next streamed frame since the epoch began; see `due_step`.
    streams : list of FrameStream
    notes : list of Observation
        What `shutter.advance` notes of the last physics steps, while its shutter takes time.
    """

    registered: AgentSpec
    spec: AgentSpec
    pose: Pose
    gaze: LookAtSolver | None = None
    sequence: int = 0
    latest: Observation | None = None
    earlier: Observation | None = None
    due_count: int = 0
    streams: list[FrameStream] = field(default_factory=list)
    notes: list[Observation] = field(default_factory=list)

    @property
    def look_at(self) -> LookAt | None:
        """Its look-at target as data; None if there is none."""
        return None if self.gaze is None else self.gaze.described()

    def past(self, sim_time_ns: int) -> Observation | None:
        """Return the last observation before that instant."""
        if self.latest is not None and self.latest.snapshot.sim_time_ns < sim_time_ns:
            return self.latest
        return self.earlier

    def remember(self, observation: Observation) -> None:
        """Take note of a frame that was just rendered."""
        self.earlier = self.past(observation.snapshot.sim_time_ns)
        self.latest = observation

    def forget(self) -> None:
        """Cut its past off: the next frame has no flow."""
        self.latest = self.earlier = None
        self.notes.clear()

    def wanted(self) -> dict[FrameStream, tuple[str, ...]]:
        """Return the views that each of its streams wants now, of those that want any.

        Each is asked once: threads of others change what it wants at any time.
        """
        return {stream: views for stream in self.streams if (views := stream.views)}

    def due_step(self) -> int:
        """Return the physics step at which its next streamed frame is due."""
        return self._step_of(self.due_count)

    def last_due_step(self, step: int) -> int:
        """Return the last step not after `step` at which a frame is due; -1 if there is none."""
        if not self.wanted() or not self.spec.rate_hz or self.due_step() > step:
            return -1
        count = math.floor(step * self.spec.rate_hz / STEPS_PER_SECOND + 1e-9)
        return self._step_of(count)

    def skip_to(self, step: int) -> int:
        """Make the first frame due at or after that step the next one; say how many were passed."""
        before = self.due_count
        # The first whose exact time lies after the step before.
        count = math.floor((step - 1) * self.spec.rate_hz / STEPS_PER_SECOND + 1e-9) + 1
        self.due_count = max(before, count)
        return self.due_count - before

    def _step_of(self, count: int) -> int:
        return math.ceil(count * STEPS_PER_SECOND / self.spec.rate_hz - 1e-9)
