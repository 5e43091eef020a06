"""Objects on joints as one body of the engine: what carries them all, and a link for each.

That is an anchor that stands still, or the first object, where it moves freely. Joints are exact:
the engine knows their positions, and poses follow from these alone (see `kinematics`). What
friction holds keeps the very same position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from sailenv_ros.errors import PhysicsError
from sailenv_ros.types.geometry import POSITION_LIMIT_M, Pose, invert
from sailenv_ros.world import tree_motors
from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.collision import hull_files
from sailenv_ros.world.joint_law import Motor, law_of
from sailenv_ros.world.joint_links import STANDING, JointDrive, JointLink, at_origin
from sailenv_ros.world.kinematics import composed
from sailenv_ros.world.tree_building import build_tree, set_dynamics

__all__ = ["JointTree"]

HELD = 1e-9
"""Motion in one step below which a joint is held by its friction and does not move [rad], [m]."""

STUCK = 0.02
"""Slower than this, [rad/s] or [m/s], and with torque to spare, friction has stopped a joint: the
engine's solver leaves such speeds where joints depend on one another."""

SPARE = 0.99
"""Share of the friction's torque below which there is torque to spare."""


class JointTree:
    """A body of the engine.

    Parameters
    ----------
    client : BulletClient
    links : sequence of JointLink
        Parents before what they carry; the first one alone has the anchor as its parent.
    world_from_rest : Pose
        Of the first link's object while its joint's position is 0.

    Attributes
    ----------
    is_driven : bool
        False if nothing is to be told to its motors before the next step.

    Raises
    ------
    InvalidRequest
        If an object's collision shape cannot have its scale; nothing is in the engine then.
    """

    def __init__(
        self, client: BulletClient, links: Sequence[JointLink], world_from_rest: Pose
    ) -> None:
        self._client = client
        self._links = tuple(links)
        first = self._links[0]
        self._is_free = first.joint.spec.type == "free"
        # In the engine, links are counted from 0 without what carries them all.
        self._shift = 1 if self._is_free else 0
        self._centre = Pose(first.centre_m, first.axes_xyzw)
        self._read: tuple[object, Pose] | None = None
        self._gears: list[int] = []
        self._motors: dict[int, JointDrive] = {}
        laws = ((number, law_of(link.joint.spec)) for number, link in enumerate(self._links))
        self._laws = {number: law for number, law in laws if law is not None}
        self._lawful: dict[int, Motor] = {}
        self._rolled: dict[int, tuple[float, float]] = {}
        self._driven: set[int] = set()
        self._was_driven: set[int] = set()
        self._last = [(0.0, 0.0)] * len(self._links)
        self._moves = tuple(link.joint.spec.moves for link in self._links)
        self._moving = tuple(
            (number, number - self._shift, link.joint.spec.bounds)
            for number, link in enumerate(self._links)
            if self._moves[number]
        )
        self._known_at = -1
        self.is_driven, self._version = False, 0
        with hull_files(client) as files:
            self.bullet_id = build_tree(files, self._links, world_from_rest)
        for number, link in enumerate(self._links):
            set_dynamics(client, self.bullet_id, self.link_of(number), link)
            if self._moves[number]:
                self.set(number, link.position, link.velocity)
            self.release(number)
        if self._is_free:
            self._client.resetBaseVelocity(self.bullet_id, *first.motion)

    @property
    def known_version(self) -> int:
        """The number of what it carries: another one after that may have been moved.

        -1 while the engine alone knows where that is: amidst a step, or if it moves freely.
        """
        return self._version if self._known_at == self._client.moments and not self._is_free else -1

    def link_of(self, number: int) -> int:
        """Return the engine's number of the link at a place in the tree."""
        return number - self._shift

    def free_pose(self) -> Pose:
        """Return where the first object is, which moves freely; the same while it rests.

        Raises
        ------
        PhysicsError
            If that is no longer finite.
        """
        read = self._client.getBasePositionAndOrientation(self.bullet_id)
        if self._read is None or self._read[0] != read:
            if not all(map(math.isfinite, (*read[0], *read[1]))):
                name = self._links[0].placement.name
                raise PhysicsError(f"the motion of {name!r} is no longer finite; reset the scene")
            limit = POSITION_LIMIT_M
            x, y, z = (min(max(value, -limit), limit) for value in read[0])
            inertial = Pose.from_matrix(invert(self._centre.matrix()))
            self._read = read, composed(Pose((x, y, z), read[1]), inertial)
        return self._read[1]

    def state(self, number: int) -> tuple[float, float]:
        """Return position [rad] or [m] and velocity of a link's joint.

        Raises
        ------
        PhysicsError
            If it is no longer finite.
        """
        if not self._moves[number]:
            return 0.0, 0.0
        if number in self._rolled:
            return self._rolled[number]
        if self._known_at == self._client.moments:
            return self._last[number]
        position, velocity = self._client.getJointState(self.bullet_id, self.link_of(number))[:2]
        self._require_finite(number, position, velocity)
        return position, velocity

    def set(self, number: int, position: float, velocity: float = 0.0) -> None:
        """Put a joint somewhere [rad] or [m], and let it move with a velocity from there."""
        self._client.resetJointState(self.bullet_id, self.link_of(number), position, velocity)
        self._last[number] = (position, velocity)
        self._version += 1
        if number in self._lawful:
            self._obey(number, position, velocity)

    def drive(self, number: int, velocity: float) -> None:
        """Move a joint with a velocity [rad/s] or [m/s] as long as its effort suffices."""
        self._driven.add(number)
        self.is_driven = True
        self._lawful.pop(number, None)
        self._motor(number, velocity, self._links[number].joint.spec.effort)
        self.wake()

    def release(self, number: int) -> None:
        """Leave a joint to its motor, if that follows a target, else to its law or friction."""
        self._driven.discard(number)
        self._was_driven.discard(number)
        if number in self._motors:
            self.follow(number, self._motors[number])
        elif number in self._laws:
            self._obey(number, *self.state(number))
        else:
            self._motor(number, 0.0, self._links[number].joint.spec.friction)

    def roll(self, number: int, speed: float) -> None:
        """Let a wheel turn with a speed [rad/s] that nothing changes.

        In the engine it stands still: its shape, a polygon there, would shake what it carries.
        """
        if number not in self._rolled:
            angle = self.state(number)[0]
            self._rolled[number] = angle, 0.0
            held = JointDrive(mode="position", target=angle, gain=60.0, effort=1e4, speed=10.0)
            self.follow(number, held)
        self._rolled[number] = self._rolled[number][0], speed

    def follow(self, number: int, drive: JointDrive) -> None:
        """Let a joint's motor follow a target until something else is asked for."""
        self._motors[number] = drive
        self._lawful.pop(number, None)
        self.is_driven = True
        friction = self._links[number].joint.spec.friction
        if drive.mode == "position":
            link = self.link_of(number)
            tree_motors.position_motor(self._client, self.bullet_id, link, drive)
        elif drive.mode == "velocity":
            self._motor(number, drive.target, drive.effort)
        else:
            self._motor(number, 0.0, friction)
        self.wake()

    def effort(self, number: int) -> float:
        """Return what a joint's motor exerted in the last step [N m] or [N]."""
        drive = self._motors.get(number)
        told = drive.target if drive is not None and drive.mode == "effort" else 0.0
        return told + float(self._client.getJointState(self.bullet_id, self.link_of(number))[3])

    def couple(self, leader: int, follower: int, multiplier: float, offset: float) -> None:
        """Let a joint go with another: position = multiplier · the other's + offset."""
        first, second = self.link_of(leader), self.link_of(follower)
        gear = tree_motors.couple(self._client, self.bullet_id, first, second, multiplier, offset)
        self._gears.append(gear)

    def wake(self) -> None:
        """Let physics move it again, if it sleeps."""
        state = self._client.constants.ACTIVATION_STATE_WAKE_UP
        self._client.changeDynamics(self.bullet_id, LINK_OF_BASE, activationState=state)

    def put(self, world_from_rest: Pose) -> None:
        """Move all of it: the first link's object is there while its joint's position is 0.

        What moves freely is stopped.
        """
        if self._is_free:
            self._client.resetBaseVelocity(self.bullet_id, *STANDING)
        at = self._placed(world_from_rest)
        self._client.resetBasePositionAndOrientation(
            self.bullet_id, at.position_m, at.orientation_xyzw
        )
        self._version += 1
        self.wake()

    def before_step(self) -> None:
        """Leave joints to their friction that were driven in the last step and are no more."""
        for number, drive in self._motors.items():
            if drive.mode == "effort" and drive.target:
                link = self.link_of(number)
                tree_motors.force_motor(self._client, self.bullet_id, link, drive.target)
        if self._was_driven:
            for number in sorted(self._was_driven - self._driven):
                self.release(number)
        self.is_driven = bool(self._motors or self._driven or self._was_driven)

    def after_step(self) -> bool:
        """Hold joints within their limits, and what friction holds; tell if something moved."""
        moved, rolled, last = False, self._rolled, self._last
        read, body = self._client.getJointState, self.bullet_id
        for number, engine_link, (low, high) in self._moving:
            if number in rolled:
                angle, speed = rolled[number]
                rolled[number] = angle + speed / STEPS_PER_SECOND, speed
                moved |= speed != 0.0
                continue
            position, velocity = read(body, engine_link)[:2]
            before, speed = last[number]
            if position == before and velocity == speed:
                last[number] = position, velocity  # of a zero the sign may be another
                continue
            self._require_finite(number, position, velocity)
            free = number not in self._driven and number not in self._motors
            if free and self._is_held(number, position - before, velocity):
                position, velocity = before, 0.0
                self.set(number, position)
            elif not low <= position <= high:
                position, velocity = min(max(position, low), high), 0.0
                self.set(number, position)
            moved |= position != before
            last[number] = (position, velocity)
            if number in self._lawful:
                self._obey(number, position, velocity)
        if self._was_driven or self._driven:
            self._was_driven, self._driven = self._driven, set()
        if moved:
            self._version += 1
        # What the engine knows of joints changes by a step, or by `set`, and by nothing else.
        self._known_at = self._client.moments
        return moved

    def _require_finite(self, number: int, position: float, velocity: float) -> None:
        if not (math.isfinite(position) and math.isfinite(velocity)):
            name = self._links[number].placement.name
            raise PhysicsError(f"the motion of {name!r} is no longer finite; reset the scene")

    def _is_held(self, number: int, moved: float, velocity: float) -> bool:
        """Return whether friction holds a joint that nobody drives."""
        if abs(moved) < HELD:
            return True
        if abs(velocity) > STUCK:
            return False
        aim, limit = self._lawful.get(number, (0.0, self._links[number].joint.spec.friction))
        return not aim and abs(self.effort(number)) < SPARE * limit

    def ignore(self, other: int) -> None:
        """Let nothing of it collide with the base of another body of the engine."""
        for number in range(len(self._links)):
            link = self.link_of(number)
            self._client.setCollisionFilterPair(self.bullet_id, other, link, LINK_OF_BASE, 0)

    def let_pass(self, first: int, second: int) -> None:
        """Let two of its own links not collide."""
        one, two = self.link_of(first), self.link_of(second)
        self._client.setCollisionFilterPair(self.bullet_id, self.bullet_id, one, two, 0)

    def remove(self) -> None:
        """Take it out of the engine."""
        for gear in self._gears:
            self._client.removeConstraint(gear)
        self._client.removeBody(self.bullet_id)

    # -- inside ----------------------------------------------------------------------------

    def _placed(self, world_from_rest: Pose) -> Pose:
        """Return where what carries all is: principal axes of what is free, or the anchor."""
        if self._is_free:
            return composed(world_from_rest, self._centre)
        return at_origin(world_from_rest, self._links[0].joint)

    def _obey(self, number: int, position: float, velocity: float) -> None:
        """Tell a joint's motor what its law wants in the next step."""
        motor = self._laws[number].motor(position, velocity, self.effort(number))
        if motor != self._lawful.get(number):
            self._lawful[number] = motor
            self._motor(number, *motor)
        if motor[0]:
            self.wake()

    def _motor(self, number: int, velocity: float, force: float) -> None:
        if self._moves[number]:
            link = self.link_of(number)
            tree_motors.velocity_motor(self._client, self.bullet_id, link, velocity, force)
