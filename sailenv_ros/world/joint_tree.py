"""Objects on joints as one body of the engine: an anchor that stands still, and a link for each.

Joints are exact: the engine knows their positions, and poses follow from these alone (see
`kinematics`). What friction holds keeps the very same position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sailenv_ros.errors import PhysicsError
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.body_creation import ROLLING_FRICTION
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.collision import build_collision
from sailenv_ros.world.kinematics import composed
from sailenv_ros.world.placement import JointPlacement, Placement

__all__ = ["JointTree", "JointLink"]

HELD = 1e-9
"""Motion in one step below which a joint is held by its friction and does not move [rad], [m]."""

STUCK = 0.02
"""Slower than this, [rad/s] or [m/s], and with torque to spare, friction has stopped a joint: the
engine's solver leaves such speeds where joints depend on one another."""

SPARE = 0.99
"""Share of the friction's torque below which there is torque to spare."""

UNLIMITED = (1.0, -1.0)
"""The engine takes limits in the wrong order for none."""

LIMIT_FORCE = 1e7


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLink:
    """One object of a tree.

    Attributes
    ----------
    placement : Placement
        With a joint.
    parent : int
        Place in the tree of the link that carries it; -1: the anchor.
    mass_kg : float
    centre_m : (3,) tuple of float
        Centre of mass in the object's frame, scale included.
    position, velocity : float
        Of the joint at the start.
    """

    placement: Placement
    parent: int
    mass_kg: float
    centre_m: tuple[float, float, float]
    position: float
    velocity: float

    @property
    def joint(self) -> JointPlacement:
        """The joint on which it moves."""
        assert self.placement.joint is not None
        return self.placement.joint


class JointTree:
    """A body of the engine.

    Parameters
    ----------
    client : BulletClient
    links : sequence of JointLink
        Parents before what they carry; the first one alone has the anchor as its parent.
    world_from_rest : Pose
        Of the first link's object while its joint's position is 0.

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
        self._driven: set[int] = set()
        self._was_driven: set[int] = set()
        self._last = [(0.0, 0.0)] * len(self._links)
        self.bullet_id = self._build(world_from_rest)
        for number, link in enumerate(self._links):
            self._set_dynamics(number, link)
            if link.joint.spec.moves:
                self.set(number, link.position, link.velocity)
            self.release(number)

    def state(self, number: int) -> tuple[float, float]:
        """Return position [rad] or [m] and velocity of a link's joint.

        Raises
        ------
        PhysicsError
            If it is no longer finite.
        """
        link = self._links[number]
        if not link.joint.spec.moves:
            return 0.0, 0.0
        position, velocity = self._client.getJointState(self.bullet_id, number)[:2]
        if not (math.isfinite(position) and math.isfinite(velocity)):
            name = link.placement.name
            raise PhysicsError(f"the motion of {name!r} is no longer finite; reset the scene")
        return position, velocity

    def set(self, number: int, position: float, velocity: float = 0.0) -> None:
        """Put a joint somewhere [rad] or [m], and let it move with a velocity from there."""
        self._client.resetJointState(self.bullet_id, number, position, velocity)
        self._last[number] = (position, velocity)

    def drive(self, number: int, velocity: float) -> None:
        """Move a joint with a velocity [rad/s] or [m/s] as long as its effort suffices."""
        self._driven.add(number)
        self._motor(number, velocity, self._links[number].joint.spec.effort)
        self.wake()

    def release(self, number: int) -> None:
        """Leave a joint to its friction."""
        self._driven.discard(number)
        self._was_driven.discard(number)
        self._motor(number, 0.0, self._links[number].joint.spec.friction)

    def wake(self) -> None:
        """Let physics move it again, if it sleeps."""
        state = self._client.constants.ACTIVATION_STATE_WAKE_UP
        self._client.changeDynamics(self.bullet_id, LINK_OF_BASE, activationState=state)

    def put(self, world_from_rest: Pose) -> None:
        """Move all of it: the first link's object is there while its joint's position is 0."""
        at = _at_origin(world_from_rest, self._links[0].joint)
        self._client.resetBasePositionAndOrientation(
            self.bullet_id, at.position_m, at.orientation_xyzw
        )
        self.wake()

    def before_step(self) -> None:
        """Leave joints to their friction that were driven in the last step and are no more."""
        for number in sorted(self._was_driven - self._driven):
            self.release(number)

    def after_step(self) -> bool:
        """Hold joints within their limits, and what friction holds; tell if something moved."""
        moved = False
        for number, link in enumerate(self._links):
            if not link.joint.spec.moves:
                continue
            position, velocity = self.state(number)
            before, speed = self._last[number]
            if position == before and velocity == speed:
                continue
            low, high = link.joint.spec.bounds
            if number not in self._driven and self._is_held(number, position - before, velocity):
                position, velocity = before, 0.0
                self.set(number, position)
            elif not low <= position <= high:
                position, velocity = min(max(position, low), high), 0.0
                self.set(number, position)
            moved |= position != before
            self._last[number] = (position, velocity)
        self._was_driven, self._driven = self._driven, set()
        return moved

    def _is_held(self, number: int, moved: float, velocity: float) -> bool:
        """Return whether friction holds a joint that nobody drives."""
        if abs(moved) < HELD:
            return True
        if abs(velocity) > STUCK:
            return False
        torque = float(self._client.getJointState(self.bullet_id, number)[3])
        return abs(torque) < SPARE * self._links[number].joint.spec.friction

    def ignore(self, other: int) -> None:
        """Let nothing of it collide with the base of another body of the engine."""
        for number in range(len(self._links)):
            self._client.setCollisionFilterPair(self.bullet_id, other, number, LINK_OF_BASE, 0)

    def remove(self) -> None:
        """Take it out of the engine."""
        self._client.removeBody(self.bullet_id)

    # -- inside ----------------------------------------------------------------------------

    def _build(self, world_from_rest: Pose) -> int:
        client, kinds = self._client, self._client.constants
        joint_types = {
            "hinge": kinds.JOINT_REVOLUTE,
            "slide": kinds.JOINT_PRISMATIC,
            "fixed": kinds.JOINT_FIXED,
        }
        shapes = [
            build_collision(
                client,
                link.placement.asset.collision,
                scale=link.placement.scale,
                # The frame of a link is at its joint's origin.
                centre_of_mass_m=link.joint.spec.origin,
                name=link.placement.name,
            )
            for link in self._links
        ]
        offsets = [self._offset(link) for link in self._links]
        at = _at_origin(world_from_rest, self._links[0].joint)
        count = len(self._links)
        body = client.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=-1,
            basePosition=at.position_m,
            baseOrientation=at.orientation_xyzw,
            linkMasses=[link.mass_kg for link in self._links],
            linkCollisionShapeIndices=shapes,
            linkVisualShapeIndices=[-1] * count,
            linkPositions=[offset.position_m for offset in offsets],
            linkOrientations=[offset.orientation_xyzw for offset in offsets],
            linkInertialFramePositions=[
                [c - o for c, o in zip(link.centre_m, link.joint.spec.origin, strict=True)]
                for link in self._links
            ],
            linkInertialFrameOrientations=[(0.0, 0.0, 0.0, 1.0)] * count,
            linkParentIndices=[link.parent + 1 for link in self._links],
            linkJointTypes=[joint_types[link.joint.spec.type] for link in self._links],
            linkJointAxis=[link.joint.spec.unit_axis for link in self._links],
        )
        return int(body)

    def _offset(self, link: JointLink) -> Pose:
        """Return where a link's frame is in that of its parent, at the joint's position 0."""
        if link.parent < 0:
            return Pose()
        ox, oy, oz = self._links[link.parent].joint.spec.origin
        here = _at_origin(link.joint.parent_from_rest, link.joint)
        x, y, z = here.position_m
        return Pose((x - ox, y - oy, z - oz), here.orientation_xyzw)

    def _set_dynamics(self, number: int, link: JointLink) -> None:
        spec, placement = link.joint.spec, link.placement
        self._client.changeDynamics(
            self.bullet_id,
            number,
            lateralFriction=placement.friction,
            restitution=placement.restitution,
            linearDamping=0.0,
            angularDamping=0.0,
            rollingFriction=ROLLING_FRICTION,
            spinningFriction=ROLLING_FRICTION,
            jointDamping=spec.damping,
        )
        low, high = UNLIMITED if spec.limits is None else spec.limits
        if spec.moves:
            self._client.changeDynamics(
                self.bullet_id,
                number,
                jointLowerLimit=low,
                jointUpperLimit=high,
                jointLimitForce=LIMIT_FORCE,
            )
        self._client.changeDynamics(
            self.bullet_id,
            LINK_OF_BASE,
            linearDamping=0.0,
            angularDamping=0.0,
            activationState=self._client.constants.ACTIVATION_STATE_ENABLE_SLEEPING,
        )

    def _motor(self, number: int, velocity: float, force: float) -> None:
        if self._links[number].joint.spec.moves:
            self._client.setJointMotorControl2(
                self.bullet_id,
                number,
                self._client.constants.VELOCITY_CONTROL,
                targetVelocity=velocity,
                force=force,
            )


def _at_origin(pose: Pose, joint: JointPlacement) -> Pose:
    """Return the frame of a link: that of its object, at the joint's origin."""
    return composed(pose, Pose(joint.spec.origin))
