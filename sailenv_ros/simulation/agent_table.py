"""The agents of a simulation: where each one is, what it saw last, when its next frame is due.

Used by the loop thread alone. Knows the world for its movers and nothing of rendering.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from sailenv_ros.errors import InvalidState, NameTaken, UnknownName
from sailenv_ros.render.contract import require_drawable
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.types.agents import MAX_AGENTS, AgentPose, AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.look_at_solver import LookAtSolver
from sailenv_ros.world.world import World

__all__ = ["AgentRecord", "AgentTable"]


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

    @property
    def wanted_views(self) -> frozenset[str]:
        """Union of the views that its streams want."""
        return frozenset(view for stream in self.streams for view in stream.views)

    def due_step(self) -> int:
        """Return the physics step at which its next streamed frame is due."""
        return self._step_of(self.due_count)

    def last_due_step(self, step: int) -> int:
        """Return the last step not after `step` at which a frame is due; -1 if there is none."""
        if not self.wanted_views or not self.spec.rate_hz or self.due_step() > step:
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


class AgentTable:
    """All agents by name, in the order they came."""

    def __init__(self) -> None:
        self._records: dict[str, AgentRecord] = {}

    def __iter__(self) -> Iterator[AgentRecord]:
        return iter(self._records.values())

    def __getitem__(self, name: str | None) -> AgentRecord:
        """Return an agent by its name; None means the first."""
        if name is None:
            if not self._records:
                raise InvalidState("there is no agent; register one first")
            return next(iter(self._records.values()))
        if not isinstance(name, str) or name not in self._records:
            raise UnknownName("agent", str(name), self._records)
        return self._records[name]

    @property
    def specs(self) -> tuple[AgentSpec, ...]:
        """Present descriptions of the agents, with their look-at targets."""
        return tuple(replace(record.spec, look_at=record.look_at) for record in self)

    def add(self, spec: AgentSpec, world: World) -> AgentSpec:
        """Register an agent; return the spec as accepted, with its mover's name filled in.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest
            If the name is in use, the mover or what it faces unknown, or there are too many agents,
            or no renderer draws through its lens.
        """
        require_drawable(spec.intrinsics)
        if spec.name in self._records:
            raise NameTaken("agent", spec.name)
        if len(self._records) >= MAX_AGENTS:
            raise InvalidState(
                f"there are {MAX_AGENTS} agents, which is the most; delete one first"
            )
        mover = world.mover(spec.mover)
        pose = spec.pose or mover.pose_at(world.sim_time_ns)
        accepted = replace(spec, mover=mover.name, pose=pose)
        gaze = None if spec.look_at is None else world.gaze(spec.look_at)
        record = AgentRecord(registered=accepted, spec=accepted, pose=pose, gaze=gaze)
        if spec.rate_hz:
            record.skip_to(world.step_count)
        self._records[spec.name] = record
        return accepted

    def remove(self, name: str) -> None:
        """Delete an agent and end its streams."""
        record = self[name]
        del self._records[name]
        for stream in record.streams:
            stream.end(f"agent {name!r} was deleted")

    def pose(self, name: str | None, world: World) -> AgentPose:
        """Return where an agent is."""
        record = self[name]
        return AgentPose(
            pose=self.camera(record, world).pose,
            following=record.spec.following,
            mover=record.spec.mover,
            sim_time_ns=world.sim_time_ns,
        )

    def camera(self, record: AgentRecord, world: World) -> Camera:
        """Return an agent's camera as it stands now."""
        pose = self.carried_pose(record, world)
        if record.gaze is not None:
            pose = record.gaze.turned(pose)
        spec = record.spec
        return Camera(intrinsics=spec.intrinsics, pose=pose, picture=spec.picture, name=spec.name)

    def carried_pose(self, record: AgentRecord, world: World) -> Pose:
        """Return where an agent is, turned as if it faced nothing but what its mover faces."""
        if record.spec.following:
            return world.mover(record.spec.mover).pose_at(world.sim_time_ns)
        return record.pose

    def look_at(self, name: str | None, gaze: LookAtSolver | None, world: World) -> None:
        """Have an agent face something from now on; without anything, it stays as it is turned."""
        record = self[name]
        if gaze is None and not record.spec.following:
            record.pose = self.camera(record, world).pose
        record.gaze = gaze

    def turn_freely(self, name: str, world: World) -> bool:
        """End what an agent faces, and what the mover that it follows does; say if it was so."""
        record = self[name]
        faced, record.gaze = record.gaze, None
        if not record.spec.following:
            return faced is not None
        mover = world.mover(record.spec.mover)
        ended = faced is not None or mover.gaze is not None
        mover.face(None, world.sim_time_ns)
        return ended

    def put(self, name: str, pose: Pose, world: World, *, teleport: bool) -> None:
        """Move an agent; one that follows moves its mover, and with it all that follow it.

        It keeps facing what it faces.
        """
        record = self[name]
        moved = [record]
        if record.spec.following:
            mover = world.mover(record.spec.mover)
            mover.hold(pose, world.sim_time_ns)
            moved = [r for r in self if r.spec.following and r.spec.mover == mover.name]
        else:
            record.pose = pose
        if teleport:
            for other in moved:
                other.forget()

    def set_follow(self, name: str | None, following: bool, world: World) -> bool:
        """Follow or stop; one that stops stays where it is."""
        record = self[name]
        if record.spec.following and not following:
            record.pose = self.camera(record, world).pose
        record.spec = replace(record.spec, following=following)
        return following

    def set_rate(self, name: str | None, rate_hz: float, world: World) -> None:
        """Change how often frames are streamed, from the next time on the new rate's grid."""
        record = self[name]
        record.spec = replace(record.spec, rate_hz=rate_hz)
        record.registered = replace(record.registered, rate_hz=rate_hz)
        record.due_count = 0
        if rate_hz:
            record.skip_to(world.step_count)

    def set_intrinsics(self, name: str | None, intrinsics: CameraIntrinsics) -> None:
        """Change what an agent's camera sees; what it saw before cannot be compared with it.

        Raises
        ------
        InvalidRequest
            If its depth picture would then end before the near plane, or its picture be too large
            for its supersampling; or if no renderer draws through it.
        """
        require_drawable(intrinsics)
        record = self[name]
        if intrinsics == record.spec.intrinsics:
            return
        spec = replace(record.spec, intrinsics=intrinsics)
        record.registered = replace(record.registered, intrinsics=intrinsics)
        record.spec = spec
        record.forget()

    def set_picture(self, name: str, settings: PictureSettings) -> None:
        """Change what is done to an agent's pictures.

        Raises
        ------
        InvalidRequest
            If pictures of its size would be too large for that supersampling.
        """
        record = self[name]
        record.spec = replace(record.spec, picture=settings)
        record.registered = replace(record.registered, picture=settings)

    def require_room(self, specs: Iterable[AgentSpec]) -> None:
        """Refuse a scene whose agents would be too many beside those that there are.

        Raises
        ------
        InvalidRequest
        """
        count = len({*self._records, *(spec.name for spec in specs)})
        if count > MAX_AGENTS:
            raise InvalidState(
                f"with those of the scene there would be {count} agents, and {MAX_AGENTS} is the "
                "most; delete some first"
            )

    def add_missing(self, specs: Iterable[AgentSpec], world: World) -> None:
        """Add a scene's agents, but for those whose names are in use: they stay as they are."""
        for spec in specs:
            if spec.name not in self._records:
                self.add(spec, world)

    def begin_epoch(self, world: World, *, as_registered: bool) -> None:
        """Take the agents over into a world that has just begun.

        Parameters
        ----------
        as_registered : bool
            True puts follow state and pose back to what they were on registration.
        """
        for record in self:
            record.forget()
            record.due_count = 0
            if as_registered:
                record.spec = record.registered
                record.pose = record.registered.pose or record.pose
            record.gaze = self._gaze_in(record, world, as_registered=as_registered)
            if record.spec.mover not in world.movers:
                first = world.mover("").name
                record.spec = replace(record.spec, mover=first)
                record.registered = replace(record.registered, mover=first)

    def _gaze_in(
        self, record: AgentRecord, world: World, *, as_registered: bool
    ) -> LookAtSolver | None:
        """Return what an agent faces in a world that has just begun; nothing that it lacks."""
        faced = record.spec.look_at if as_registered else record.look_at
        try:
            return None if faced is None else world.gaze(faced)
        except UnknownName:
            return None
