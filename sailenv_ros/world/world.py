"""The world: rigid bodies, movers and lights of one scene, stepped by PyBullet.

A `SceneSpec` comes in through `world.build`, `WorldSnapshot`s go out. Time is a count of steps;
there is no wall clock and no global random state here, so the same scene, seed and calls give
the same bytes.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.joints import JointState
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.types.validation import vector
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.mover_motion import MoverCommand
from sailenv_ros.world.world_robots import WorldRobots

__all__ = ["MAX_VELOCITY_M_S", "MAX_VELOCITY_RAD_S", "World"]

MAX_VELOCITY_M_S = 1e3
MAX_VELOCITY_RAD_S = 1.7e3

NOT_MOVING = (0.0, 0.0, 0.0)


class World(WorldRobots):
    """The live state of one scene, and all that changes it; see `WorldState` for its parameters."""

    @property
    def added_ids(self) -> tuple[int, ...]:
        """Ids of the objects that were spawned since the start."""
        return self._first.added()

    def enter(self, instance_id: int, *, seed: int) -> None:
        """Put an object that waits where it stands at the start; its behaviours begin now."""
        now_s = self._step / STEPS_PER_SECOND
        self._bodies.enter(instance_id, seed=seed, start_s=now_s)
        self._moved_in_or_out(self._bodies[instance_id].placement)

    def require_free(self, instance_id: int) -> None:
        """Refuse to let an object come and go that joints hold.

        Raises
        ------
        InvalidRequest
            If it is on a joint, or something is on a joint of its own on it.
        """
        self._bodies.require_free(instance_id)

    def leave(self, instance_id: int) -> None:
        """Take an object out of the world; it keeps its id and waits until it may `enter`."""
        placement = self._bodies[instance_id].placement
        self._bodies.leave(instance_id)
        self._moved_in_or_out(placement)

    def wait_as(self, instance_id: int, placement: Placement) -> None:
        """Let an object that waits enter as another placement says."""
        self._bodies.waiting.take(instance_id, placement)

    def spawn(self, placement: Placement) -> int:
        """Put one more object into the world.

        Returns
        -------
        instance_id : int
            Never used before in this world.

        Raises
        ------
        NameTaken
            If an object of that name is there.
        """
        self._require_no_robot(placement.name)
        instance_id = self._bodies.add(placement)
        self._placing_log.note(self.body(instance_id), self._step)
        self._changed_step = self._step
        self._changed()
        return instance_id

    def despawn(self, instance_id: int) -> None:
        """Take an object out of the world with its parts; their ids are not used again.

        Raises
        ------
        InvalidRequest
            If it is a link of a robot, or carries something on a joint.
        """
        self._require_no_link(instance_id, "to be removed")
        for part in self._opening_parts(instance_id):
            self._bodies.remove(part)
        self._bodies.remove(instance_id)
        self._changed_step = self._step
        self._changed()

    def replace_body(
        self, instance_id: int, placement: Placement, described: SceneSpec | None = None
    ) -> None:
        """Make of an object what another placement says; it stays where it is, and its id too.

        It keeps its motion and its behaviours. Another scale cuts its past off: a point of its
        surface has no place of before.

        Parameters
        ----------
        instance_id : int
        placement : Placement
        described : SceneSpec or None
            What a scene file says of it all from now on; None leaves it.

        Raises
        ------
        NameTaken
            If another object has the placement's name.
        InvalidRequest
            If it cannot be such an object; it is as it was then.
        """
        old = self.body(instance_id)
        if placement.name != old.placement.name:
            self._require_no_link(instance_id, "to be renamed")
            self._require_no_robot(placement.name)
        self._bodies.rebuild(instance_id, placement)
        self.robots.renew()
        if placement.scale != old.placement.scale:
            self._bodies.reset_motion_history(instance_id)
            self._shown.forget_charts(self._bodies.ids_of(instance_id))
        self.described = described or self.described
        self._changed_step = self._step
        self._changed()

    def replace_room(
        self,
        placements: Iterable[Placement],
        described: SceneSpec,
        *,
        without: Collection[int] = (),
    ) -> None:
        """Exchange the parts of the room; all else stays where it is.

        Baked light was that of the old room and is taken off.

        Parameters
        ----------
        placements : iterable of Placement
            The parts that there shall be; one of the same name keeps its id.
        described : SceneSpec
            What a scene file says of it all from now on.
        without : collection of int
            Ids of objects whose places the parts take.

        Raises
        ------
        NameTaken, InvalidState
            If another object has the name of a part, or no ids are left; nothing is changed then.
        """
        self._bodies.replace_room(placements, without)
        for body in (*self._bodies, *self._stands.bodies):
            body.wake()
        self._shown.baked = None
        self.described = described
        self._changed()

    def put_body(self, instance_id: int, pose: Pose, *, teleport: bool = False) -> None:
        """Move an object and stop it; `teleport` cuts its past off, so flow does not see a jump."""
        moved = self.body(instance_id)
        moved.require_free()
        self._bodies.wake_neighbours(moved)
        moved.put(pose)
        self._placing_log.note(moved, self._step)
        self._bodies.joints.follow(moved)
        carried = set(self._bodies.joints.above(moved))
        if moved.placement.static:
            self._changed_step = self._step
        if teleport:
            for id_, body in self._bodies.items():
                if id_ == instance_id or body in carried:
                    self._bodies.reset_motion_history(id_)
        self._snapshot = self._states = None

    def set_velocity(
        self, instance_id: int, linear_m_s: Sequence[float], angular_rad_s: Sequence[float]
    ) -> None:
        """Let an object move on at a velocity.

        Parameters
        ----------
        instance_id : int
        linear_m_s : (3,) sequence of float
            Of its own frame's origin, world axes; each within `MAX_VELOCITY_M_S`.
        angular_rad_s : (3,) sequence of float
            World axes; each within `MAX_VELOCITY_RAD_S`.

        Raises
        ------
        InvalidRequest
            If it is static or on a joint, or a velocity is not accepted.
        """
        moved = self.body(instance_id)
        linear = vector("linear velocity", linear_m_s, limit=MAX_VELOCITY_M_S)
        angular = vector("angular velocity", angular_rad_s, limit=MAX_VELOCITY_RAD_S)
        if moved.placement.static:
            accepted = "one that is not static: only those have a velocity"
            raise InvalidRequest("object", moved.placement.name, accepted)
        moved.require_free()
        placement = moved.placement
        offset = np.multiply(placement.asset.centre_of_mass_m, placement.scale)
        arm = moved.world_from_body()[:3, :3] @ offset
        centre = np.asarray(linear) + np.cross(angular, arm)
        moved.wake()
        self._client.resetBaseVelocity(moved.bullet_id, centre.tolist(), angular)
        self._snapshot = self._states = None

    def put_back(self) -> None:
        """Put what was there at the start, and still is, where it was then and as it moved."""
        for id_, pose, placement in self._first.moved():
            self.put_body(id_, pose, teleport=True)
            if placement.linear_velocity != NOT_MOVING or placement.angular_velocity != NOT_MOVING:
                self._client.resetBaseVelocity(
                    self.body(id_).bullet_id, placement.linear_velocity, placement.angular_velocity
                )
        for id_, position in self._first.turned():
            self.set_joint(id_, position)
        for number in self.robots.put_back():
            self._bodies.reset_motion_history(number)

    def joint(self, instance_id: int) -> JointState | None:
        """Return the state of an object's joint; None where it has none that moves."""
        body = self.body(instance_id)
        return body.described_joint(instance_id) if isinstance(body, JointedBody) else None

    def joints(self) -> tuple[JointState, ...]:
        """Return the states of all joints that move, in the order of the objects' ids."""
        states = (self.joint(id_) for id_, _ in self._bodies.items())
        return tuple(state for state in states if state is not None)

    def set_joint(self, instance_id: int, position: float, seconds: float = 0.0) -> None:
        """Move the joint of an object to a position [rad] or [m], at once or within a time [s].

        Raises
        ------
        InvalidRequest
            If it has none that moves, the position is beyond its limits, or the time is not
            accepted; nothing is changed then.
        """
        body = self.body(instance_id)
        if not isinstance(body, JointedBody):
            names = [state.name for state in self.joints()]
            accepted = f"one on a joint: {', '.join(names[:20]) or 'this scene has none'}"
            raise InvalidRequest("object", body.placement.name, accepted)
        if body.placement.robot:
            accepted = "no link of a robot: drive_joints and put_joints move these"
            raise InvalidRequest("object", body.placement.name, accepted)
        body.set_joint(position, seconds, self._step / STEPS_PER_SECOND)
        self._bodies.wake_neighbours(body)
        if not seconds:
            self._changed_step = self._step
        self._snapshot = self._states = None

    def drive(
        self,
        mover: str,
        linear_m_s: Any = (0.0, 0.0, 0.0),
        angular_rad_s: Any = (0.0, 0.0, 0.0),
    ) -> None:
        """Have a mover walk, stopped by what it meets; see `MoverCommand` for the velocities.

        Raises
        ------
        UnknownName, InvalidRequest, InvalidState
            If there is no such mover, the command cannot be accepted, or waypoints drive it.
        """
        command = MoverCommand(linear_m_s=linear_m_s, angular_rad_s=angular_rad_s)
        self._stands.drive(mover, command, self.sim_time_ns)

    def set_mover_body(self, mover: str, rigid: RigidBody | None) -> bool:
        """Make a mover a rigid body, or none any more; return whether that changed anything.

        It stays where it is. One that is another body already keeps its motion and what pushes it.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such mover, or waypoints drive it; nothing is changed then.
        """
        return self._stands.set_mover_body(mover, rigid, self.sim_time_ns)

    def set_lights(self, lights: Sequence[Light]) -> None:
        """Replace the lights."""
        self._shown.lights = tuple(lights)
        self._changed()

    def set_environment(self, environment: Environment) -> None:
        """Replace ambient light, background and exposure."""
        self._shown.environment = environment
        self._changed()

    def set_baked(self, baked: BakedLight | None) -> None:
        """Replace the light that was computed beforehand for what stands still."""
        self._shown.baked = baked and replace(baked, environment=self._shown.environment)
        self._changed()

    def set_gravity(self, gravity: tuple[float, float, float]) -> None:
        """Change the acceleration that pulls every body with gravity; what sleeps wakes."""
        for body in (*self.bodies, *self._stands.bodies):
            body.wake()
        self._client.gravity = gravity  # bodies that sleep would keep the old one

    # -- inside ----------------------------------------------------------------------------

    def _moved_in_or_out(self, placement: Placement) -> None:
        if placement.static:
            self._changed_step = self._step
        self._changed()

    def _opening_parts(self, instance_id: int) -> tuple[int, ...]:
        """Return the ids of what opens of a piece; none if it carries anything else on a joint."""
        if instance_id in self._bodies.waiting:
            return ()
        carried = self._bodies.joints.carried_by(self._bodies[instance_id])
        if not all(body.placement.asset.opens for body in carried):
            return ()
        return tuple(number for number, body in self._bodies.items() if body in carried)
