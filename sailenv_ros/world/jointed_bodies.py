"""An object on a joint: like other bodies, but its pose follows from its joint's position.

Belongs to a `JointTree`, which `JointTable` makes of all that hangs together.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import BodyState, JointMotion, RunningBehaviour, running_motion
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.postures.limbs import cross
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.joints import JointState
from sailenv_ros.types.validation import checked_number
from sailenv_ros.world import actuation
from sailenv_ros.world.bodies import NOT_THERE, Body, FrustumPlanes, Vector3, vector3
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.joint_links import STANDING, JointLink
from sailenv_ros.world.joint_tree import JointTree
from sailenv_ros.world.kinematics import Twist, composed, link_pose, link_velocity
from sailenv_ros.world.person_body import PersonBody
from sailenv_ros.world.placement import JointPlacement, Placement

__all__ = ["JointedBody", "make_bodies", "make_body"]

LONGEST_S = 1e4
"""Longest time that a motion to a position may take [s]."""

_ORIGIN, _STILL = Pose(), (np.zeros(3), np.zeros(3))
for _zeros in _STILL:
    _zeros.flags.writeable = False


def make_body(client: BulletClient, placement: Placement) -> Body:
    """Make the body of a placement; one on a joint is in the engine once a tree has it."""
    if placement.joint is not None:
        return JointedBody(client, placement)
    if placement.asset.rig is not None:
        return PersonBody(client, placement)
    return Body(client, placement)


def make_bodies(client: BulletClient, placements: Iterable[Placement]) -> list[Body]:
    """Make the bodies of placements, all of them or none."""
    made: list[Body] = []
    try:
        for placement in placements:
            made.append(make_body(client, placement))
    except BaseException:
        for body in made:
            body.remove()
        raise
    return made


class JointedBody(Body):
    """An object on a joint.

    Parameters
    ----------
    client : BulletClient
    placement : Placement
        With a joint.
    """

    def __init__(self, client: BulletClient, placement: Placement) -> None:
        assert placement.joint is not None
        self.joint: JointPlacement = placement.joint
        self.is_free = placement.joint.spec.type == "free"  # the first of its tree, held by nothing
        self.tree: JointTree | None = None
        self.parent: Body | None = None
        self._number = 0
        self._at = (placement.joint.spec.start, placement.joint.spec.velocity)
        self._motion: RunningBehaviour | None = None
        # Most joints rest, and what follows from the same numbers is the same.
        self._resting: tuple[Pose, Pose] | None = None
        self._posed: tuple[Pose, float, Pose, NDArray[np.float64]] | None = None
        self._version = -1
        super().__init__(client, placement)

    # -- where it is -----------------------------------------------------------------------

    def as_link(self, parent: int) -> JointLink:
        """Return what a tree is made of."""
        position, velocity = self.joint_state()
        return JointLink(
            placement=self.placement,
            parent=parent,
            mass_kg=self.mass_kg,
            centre_m=self._centre,
            position=position,
            velocity=velocity,
            motion=self._motion_of_centre() if self.is_free else STANDING,
        )

    def _motion_of_centre(self) -> tuple[Vector3, Vector3]:
        if self.tree is None:
            return self.placement.linear_velocity, self.placement.angular_velocity
        linear, angular = actuation.velocity(self._client, self._id)
        return vector3(linear), vector3(angular)

    def hang(self, tree: JointTree, number: int, parent: Body | None) -> None:
        """Become a link of a tree; `parent` carries it, None is the world."""
        self.tree, self._number, self.parent = tree, number, parent
        self._resting = self._posed = None
        self._id = tree.bullet_id
        self.inertia_kg_m2 = np.asarray(self._client.getDynamicsInfo(self._id, self.link)[2])

    @property
    def link(self) -> int:
        """PyBullet's number of its link."""
        return self._number if self.tree is None else self.tree.link_of(self._number)

    @property
    def place(self) -> int:
        """Place in its tree."""
        return self._number

    def joint_state(self) -> tuple[float, float]:
        """Return position and velocity of its joint [rad, rad/s] or [m, m/s]."""
        return self._at if self.tree is None else self.tree.state(self._number)

    def rest_pose(self) -> Pose:
        """Return where it is while its joint's position is 0, and those above stay."""
        if self.is_free and self.tree is not None:
            return self.tree.free_pose()
        if self.parent is None:
            return self.joint.parent_from_rest
        carrier = self.parent.pose()
        if self._resting is None or self._resting[0] is not carrier:
            self._resting = carrier, composed(carrier, self.joint.parent_from_rest)
        return self._resting[1]

    def pose(self) -> Pose:
        """Return the pose of the body frame now."""
        return self._pose_now()[0]

    def world_from_body(self) -> NDArray[np.float64]:
        """Return the (4, 4) pose now; read-only."""
        return self._pose_now()[1]

    def _pose_now(self) -> tuple[Pose, NDArray[np.float64]]:
        posed, version = self._posed, -1 if self.tree is None else self.tree.known_version
        if posed is not None and version == self._version != -1:
            return posed[2], posed[3]
        self._version = version
        rest, position = self.rest_pose(), self.joint_state()[0]
        if posed is None or posed[0] is not rest or posed[1] != position:
            pose = link_pose(rest, self.joint, position)
            matrix = pose.matrix()
            matrix.flags.writeable = False
            self._posed = posed = rest, position, pose, matrix
            self._quat = pose.orientation_xyzw
        return posed[2], posed[3]

    def twist(self) -> Twist:
        """Return the velocity of its frame's origin [m/s] and the angular one [rad/s]."""
        if self.is_free and self.tree is not None:
            linear, angular = actuation.velocity(self._client, self._id)
            arm = self.world_from_body()[:3, :3] @ np.asarray(self._centre)
            return linear - cross(angular, arm), angular
        parent, rate = self.parent, self.joint_state()[1]
        carried = parent.twist() if isinstance(parent, JointedBody) else _STILL
        if not rate and carried is _STILL:
            return _STILL
        carrier = np.eye(4) if parent is None else parent.world_from_body()
        rest, now = self.rest_pose().matrix(), self.world_from_body()
        return link_velocity(carrier, carried, rest, now, self.joint, rate)

    def velocity(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the velocity of the centre of mass [m/s] and the angular velocity [rad/s]."""
        linear, angular = self.twist()
        arm = self.world_from_body()[:3, :3] @ np.asarray(self._centre)
        return linear + cross(angular, arm), angular

    def origin_velocity(self, world_from_body: NDArray[np.float64]) -> tuple[Vector3, Vector3]:
        """Return the velocity of the body frame's origin [m/s] and the angular one [rad/s]."""
        twist = self.twist()
        if twist is _STILL:  # as most are
            return STANDING
        (vx, vy, vz), (wx, wy, wz) = (part.tolist() for part in twist)
        return (vx, vy, vz), (wx, wy, wz)

    def described_joint(self, instance_id: int) -> JointState | None:
        """Return all that clients may know of its joint; None of one that is fixed."""
        spec = self.joint.spec
        if spec.type != "hinge" and spec.type != "slide":
            return None
        position, velocity = self.joint_state()
        low, high = spec.bounds
        return JointState(
            id=instance_id,
            name=self.placement.name,
            type=spec.type,
            parent=self.joint.parent,
            position=position,
            velocity=velocity,
            low=low,
            high=high,
            effort=spec.effort,
        )

    # -- what moves it ---------------------------------------------------------------------

    def set_joint(self, position: float, seconds: float, now_s: float) -> None:
        """Move its joint to a position [rad] or [m], at once or within a time [s].

        Raises
        ------
        InvalidRequest
            If it is fixed, the position is beyond its limits, or the time is not accepted;
            nothing is changed then.
        """
        assert self.tree is not None
        spec, name = self.joint.spec, self.placement.name
        if not spec.moves:
            raise InvalidRequest(
                "object", name, f"one on a hinge or a slide; this one is {spec.type}"
            )
        low, high = spec.bounds
        unit = "rad" if spec.type == "hinge" else "m"
        what = f"position of {name!r}"
        if spec.limits is None:
            low, high = -1e4, 1e4
        position = checked_number(what, position, low, high, unit=unit)
        seconds = checked_number("seconds", seconds, 0.0, LONGEST_S, unit="s")
        if seconds:
            motion = JointMotion(first=self.joint_state()[0], position=position, seconds=seconds)
            self._motion = running_motion(motion, now_s)
            return
        self.stop()
        self.tree.set(self._number, position)
        self.tree.wake()

    def stop(self) -> None:
        """End a motion to a position; friction holds the joint then."""
        self._motion = None
        if self.tree is not None:
            self.tree.release(self._number)

    def require_free(self) -> None:
        """Refuse to put it elsewhere.

        Raises
        ------
        InvalidRequest
            If its joint alone moves it.
        """
        if self.is_free:
            return
        accepted = "one without a joint; set_joint_position moves this one"
        raise InvalidRequest("object to be moved", self.placement.name, accepted)

    def put(self, pose: Pose) -> None:
        """Set its pose and stop it, with all that it carries; see `require_free`."""
        self.require_free()
        assert self.tree is not None
        self.arranged = False
        self.tree.put(pose)

    def wake(self) -> None:
        """Let physics move it again, if it has come to rest and sleeps."""
        if self.tree is not None:
            self.tree.wake()

    def forces(self) -> tuple[RunningBehaviour, ...]:
        """Return all that acts upon it."""
        if self._motion is not None and self._motion.is_over:
            self._motion = None
        motion = () if self._motion is None else (self._motion,)
        return (*super().forces(), *motion)

    @property
    def acts(self) -> bool:
        """True if something is done to it before steps."""
        return super().acts or self._motion is not None

    def detach(self) -> None:
        """Let no behaviour move it any more."""
        super().detach()
        self.stop()

    def behave(
        self, running: RunningBehaviour, time_s: float, frustum_planes: FrustumPlanes
    ) -> None:
        """Do what a behaviour asks; velocities count along the joint, if it has one that moves."""
        assert self.tree is not None
        if self.is_free:
            super().behave(running, time_s, frustum_planes)
            return
        action = running.act(time_s, self._state(running, frustum_planes))
        rate = action.joint_velocity
        slides = self.joint.spec.type == "slide"
        asked = action.linear_velocity if slides else action.angular_velocity
        if rate is None and asked is not None:
            axis = self.rest_pose().matrix()[:3, :3] @ np.asarray(self.joint.spec.unit_axis)
            rate = float(axis @ np.asarray(asked))
        if action.joint_position is not None:
            self.tree.set(self._number, action.joint_position)
        if rate is not None and self.joint.spec.moves:
            self.tree.drive(self._number, rate)
        elif action.acts:
            self.tree.wake()
        if action.force_n is not None:
            actuation.push(self._client, self._id, action.force_n, link=self.link)
        if action.torque_nm is not None:
            frame = self._client.constants.WORLD_FRAME
            self._client.applyExternalTorque(self._id, self.link, action.torque_nm, frame)

    def rebuilt(self, placement: Placement) -> Body:
        """Make the body that another placement says, where this one is; no tree has it yet."""
        if placement.joint is None:
            accepted = "one that keeps its joint"
            raise InvalidRequest("change of object", self.placement.name, accepted)
        if self.is_free:
            rest = replace(placement.joint, parent_from_rest=self.pose())
            placement = replace(placement, joint=rest)
        new = JointedBody(self._client, placement)
        new._at = self.joint_state()
        new._behaviours = self._behaviours
        new.placement = placement
        new.arranged = self.arranged
        new.behaviours_unchanged = self.behaviours_unchanged
        new._wrenches, new._motion = self._wrenches, self._motion
        return new

    def remove(self) -> None:
        """Do nothing: its tree is made again without it."""

    def _build(self) -> int:
        return NOT_THERE  # a tree will have it

    def _state(self, running: RunningBehaviour, frustum_planes: FrustumPlanes) -> BodyState:
        position, velocity = self.joint_state()
        limits = self.joint.spec.bounds
        if running.kind.joint_alone:
            return BodyState(
                pose=_ORIGIN, linear_velocity=_STILL[0], angular_velocity=_STILL[1], mass_kg=0.0,
                joint_position=position, joint_velocity=velocity, joint_limits=limits,
            )  # fmt: skip
        return replace(
            super()._state(running, frustum_planes),
            joint_position=position, joint_velocity=velocity, joint_limits=limits,
        )  # fmt: skip
