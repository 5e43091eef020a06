"""The agents of a simulation: which there are, where each one is, what carries it.

Used by the loop thread alone. Knows the world for its movers and nothing of rendering.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace

from sailenv_ros.errors import InvalidRequest, InvalidState, NameTaken, UnknownName
from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.types.agents import MAX_AGENTS, AgentPose, AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigs import camera_of
from sailenv_ros.world.look_at_solver import LookAtSolver
from sailenv_ros.world.world import World

__all__ = ["AgentTable"]


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
                raise InvalidState(
                    "there is no agent; call register_agent, or give Simulation an agent or a width"
                )
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

        The cameras of a rig are registered with it, each as an agent of its own.

        Raises
        ------
        NameTaken, UnknownName, InvalidRequest
            If the name is in use, the mover, what it faces or what carries it unknown, or there are
            too many agents.
        """
        cameras = spec.camera_specs
        for one in (spec, *cameras):
            if one.name in self._records:
                raise NameTaken("agent", one.name)
        count = len(self._records) + 1 + len(cameras)
        if count > MAX_AGENTS:
            raise InvalidState(
                f"there would be {count} of {MAX_AGENTS} agents, which is the most; "
                "delete one first"
            )
        if spec.body:
            self[spec.body]  # which must exist
            return self._begin(spec, Pose(), None, world)
        if spec.carrier:
            held = spec.pose or Pose()
            at = world.frame_pose(spec.carrier).carried(held)
            self._begin(replace(spec, cameras=None), at, None, world)
            for camera in cameras:
                self._begin(camera, Pose(), None, world)
            return spec
        mover = world.mover(spec.mover)
        pose = spec.pose or mover.pose_at(world.sim_time_ns)
        gaze = None if spec.look_at is None else world.gaze(spec.look_at)
        accepted = replace(spec, mover=mover.name, pose=pose)
        self._begin(replace(accepted, cameras=None), pose, gaze, world)
        for camera in cameras:
            self._begin(camera, Pose(), None, world)
        return accepted

    def remove(self, name: str) -> None:
        """Delete an agent, with its cameras, and end their streams."""
        for record in (self[name], *self._carried_by(name)):
            del self._records[record.spec.name]
            for stream in record.streams:
                stream.end(f"agent {record.spec.name!r} was deleted")

    def rig(self, name: str | None) -> tuple[AgentRecord, ...]:
        """Return the cameras of a rig, in the order they were given.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such agent, or it has no cameras.
        """
        body = self[name].spec.name
        cameras = self._carried_by(body)
        if not cameras:
            raise InvalidState(
                f"agent {body!r} is no rig; register one with cameras, each with its extrinsics"
            )
        return cameras

    def with_cameras(self, record: AgentRecord) -> AgentSpec:
        """Return an agent as it is now, with its cameras beside it if it is a rig."""
        cameras = {
            camera_of(one.spec.name): one.spec.as_camera()
            for one in self._carried_by(record.spec.name)
        }
        return replace(record.spec, look_at=record.look_at, cameras=cameras or None)

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
        if record.spec.extrinsics is not None:
            body = self.camera(self[record.spec.body], world).pose
            return body.carried(record.spec.extrinsics)
        if record.spec.carrier:
            # Where what carried it was last, once that is gone.
            with suppress(UnknownName, InvalidRequest):
                here = world.frame_pose(record.spec.carrier)
                record.pose = here.carried(record.spec.pose or Pose())
        if record.spec.following:
            return world.mover(record.spec.mover).pose_at(world.sim_time_ns)
        return record.pose

    def look_at(self, name: str | None, gaze: LookAtSolver | None, world: World) -> None:
        """Have an agent face something from now on; without anything, it stays as it is turned."""
        record = self._mobile(name)
        if gaze is None and not record.spec.following:
            record.pose = self.camera(record, world).pose
        record.gaze = gaze

    def turn_freely(self, name: str, world: World) -> bool:
        """End what an agent faces, and what the mover that it follows does; say if it was so."""
        record = self._mobile(name)
        faced, record.gaze = record.gaze, None
        if not record.spec.following:
            return faced is not None
        mover = world.mover(record.spec.mover)
        ended = faced is not None or mover.gaze is not None
        mover.face(None, world.sim_time_ns)
        return ended

    def put(self, name: str, pose: Pose, world: World, *, teleport: bool) -> None:
        """Move an agent; one that follows moves its mover, and with it all that follow it.

        It keeps facing what it faces, and carries its cameras along.
        """
        record = self._mobile(name)
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
                for camera in self._carried_by(other.spec.name):
                    camera.forget()

    def set_follow(self, name: str | None, following: bool, world: World) -> bool:
        """Follow or stop; one that stops stays where it is."""
        record = self._mobile(name)
        if record.spec.following and not following:
            record.pose = self.camera(record, world).pose
        record.spec = replace(record.spec, following=following)
        return following

    def set_rate(self, name: str | None, rate_hz: float, world: World) -> None:
        """Change how often frames are streamed, from the next time on the new rate's grid.

        The cameras of a rig take over its rate.
        """
        first = self[name]
        for record in (first, *self._carried_by(first.spec.name)):
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
            If its depth picture would then end before the near plane, its picture be too large for
            its supersampling, or its depth sensor have parallel rays.
        """
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
            If pictures of its size would be too large for that supersampling, or the depth sensor
            would have parallel rays.
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
        brought = {one.name for spec in specs for one in (spec, *spec.camera_specs)}
        count = len({*self._records, *brought})
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
            held = record.spec.body or record.spec.carrier
            if not held and record.spec.mover not in world.movers:
                first = world.mover("").name
                record.spec = replace(record.spec, mover=first)
                record.registered = replace(record.registered, mover=first)

    def _begin(
        self, spec: AgentSpec, pose: Pose, gaze: LookAtSolver | None, world: World
    ) -> AgentSpec:
        """Begin the record of an agent that was checked."""
        record = AgentRecord(registered=spec, spec=spec, pose=pose, gaze=gaze)
        if spec.rate_hz:
            record.skip_to(world.step_count)
        self._records[spec.name] = record
        return spec

    def _carried_by(self, body: str) -> tuple[AgentRecord, ...]:
        return tuple(record for record in self if record.spec.body == body)

    def _mobile(self, name: str | None) -> AgentRecord:
        """Return an agent that can be moved and turned: no camera of a rig.

        Raises
        ------
        InvalidState
        """
        record = self[name]
        if record.spec.body:
            raise InvalidState(
                f"camera {record.spec.name!r} is fixed to its rig; move agent {record.spec.body!r}"
            )
        if record.spec.carrier:
            raise InvalidState(
                f"agent {record.spec.name!r} goes where {record.spec.carrier!r} goes, which is to "
                "be moved"
            )
        return record

    def _gaze_in(
        self, record: AgentRecord, world: World, *, as_registered: bool
    ) -> LookAtSolver | None:
        """Return what an agent faces in a world that has just begun; nothing that it lacks."""
        faced = record.spec.look_at if as_registered else record.look_at
        try:
            return None if faced is None else world.gaze(faced)
        except UnknownName:
            return None
