"""One rigid body: a placement becomes a PyBullet body whose pose can be read and set.

PyBullet reports the pose of the centre of mass; here poses are those of the model's own frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S, BodyState, RunningBehaviour
from sailenv_ros.errors import InvalidRequest, InvalidState, PhysicsError
from sailenv_ros.types.geometry import POSITION_LIMIT_M, Pose
from sailenv_ros.world import actuation
from sailenv_ros.world.body_creation import create_rigid_body, mass_of
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.placement import Placement

__all__ = ["MAX_BEHAVIOURS", "Body", "FrustumPlanes", "Placement", "vector3"]

Vector3 = tuple[float, float, float]

FrustumPlanes: TypeAlias = Callable[[str, float], NDArray[np.float64]]
"""``frustum_planes(agent, distance_m)`` returns planes of an agent's view frustum."""

MAX_BEHAVIOURS, MAX_WRENCHES = 16, 64
TOUCH_M = 0.02
"""Greatest distance at which another body may rest on a body [m]."""

NOT_THERE = -1
"""PyBullet's number of what is not in the engine yet."""

_NO_PLANES = np.zeros((0, 4))


class Body:
    """A placed object; static ones keep the very pose that they were given.

    Attributes
    ----------
    placement : Placement
    mass_kg : float
        0 for what is static [kg].
    arranged : bool
        True until it is put elsewhere by hand: whatever moves it since is physics.
    entry_pose : Pose
        Where its entry puts it.
    behaviours_unchanged : bool
        True while its behaviours are those of its entry.
    is_fast : bool
        True if it must be kept out of walls at the next step, too.
    floats : bool
        True if gravity does not pull it.
    inertia_kg_m2 : (3,) float64
        About its own axes; 1 for what is static.
    """

    def __init__(self, client: BulletClient, placement: Placement) -> None:
        self.placement = placement
        self.arranged = True
        self.entry_pose = placement.pose
        self.behaviours_unchanged = True
        self._behaviours = placement.behaviours
        self.is_fast = False
        self._wrenches: tuple[RunningBehaviour, ...] = ()
        self._client = client
        self._centre = vector3(np.multiply(placement.asset.centre_of_mass_m, placement.scale))
        self.mass_kg = mass_of(placement)
        self._id = self._build()
        self.inertia_kg_m2 = np.ones(3)
        if self._id != NOT_THERE and not placement.static:
            self.inertia_kg_m2 = np.asarray(client.getDynamicsInfo(self._id, LINK_OF_BASE)[2])
        self._static_pose = placement.pose
        self._quat = placement.pose.orientation_xyzw
        self._matrix = self._matrix_read = placement.pose.matrix()
        self._read: object = None
        # PyBullet has no per-body gravity; the weight of those it must not pull is given back.
        self.floats = not placement.static and not placement.gravity

    @property
    def bullet_id(self) -> int:
        """PyBullet's number of this body."""
        return self._id

    @property
    def limb_ids(self) -> Sequence[int]:
        """PyBullet's numbers of what else of it is in the engine."""
        return ()

    @property
    def link(self) -> int:
        """PyBullet's number of the link of that body which this one is."""
        return LINK_OF_BASE

    def world_from_body(self) -> NDArray[np.float64]:
        """Return the (4, 4) pose now; not to be written to.

        Raises
        ------
        PhysicsError
            If the engine's state is no longer finite.
        """
        if self.placement.static:
            return self._matrix
        read = self._client.getBasePositionAndOrientation(self._id)
        # Most bodies rest, and what is read is the same.
        if read != self._read:
            self._matrix_read, self._read = self._matrix_of(*read), read
        return self._matrix_read

    def placed_pose(self) -> Pose:
        """Return the pose with which a scene places it where it is."""
        return self.pose()

    def pose(self) -> Pose:
        """Return the pose of the body frame now; what fell out of the world is at its edge."""
        if self.placement.static:
            return self._static_pose
        if not any(self._centre):
            position, quat = self._client.getBasePositionAndOrientation(self._id)
            self._require_finite(position, quat)
            return Pose(np.clip(position, -POSITION_LIMIT_M, POSITION_LIMIT_M), quat)
        matrix = self.world_from_body().copy()
        np.clip(matrix[:3, 3], -POSITION_LIMIT_M, POSITION_LIMIT_M, out=matrix[:3, 3])
        return Pose.from_matrix(matrix)

    def require_free(self) -> None:
        """Refuse to put it elsewhere where a joint alone moves it; here it does nothing."""

    def put(self, pose: Pose) -> None:
        """Set the pose and stop the body."""
        self.arranged = False
        self._static_pose = pose
        self._matrix = pose.matrix()
        self._client.resetBasePositionAndOrientation(
            self._id, self._centre_in_world(pose), pose.orientation_xyzw
        )
        if not self.placement.static:
            self._client.resetBaseVelocity(self._id, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
            self.wake()

    def wake(self) -> None:
        """Let physics move it again, if it has come to rest and sleeps."""
        if not self.placement.static:
            actuation.wake(self._client, self._id)

    def velocity(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the velocity of the centre of mass [m/s] and the angular velocity [rad/s]."""
        return actuation.velocity(self._client, self._id)

    def orientation_of_matrix(self) -> tuple[float, float, float, float]:
        """Return the quaternion x, y, z, w that the last `world_from_body` was made of."""
        return self._static_pose.orientation_xyzw if self.placement.static else self._quat

    def origin_velocity(self, world_from_body: NDArray[np.float64]) -> tuple[Vector3, Vector3]:
        """Return the velocity of the body frame's origin [m/s] and the angular one [rad/s].

        Parameters
        ----------
        world_from_body : (4, 4) float64
            As it is now.
        """
        if self.placement.static:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        (vx, vy, vz), (wx, wy, wz) = self._client.getBaseVelocity(self._id)
        if any(self._centre):
            # The engine knows the velocity of the centre of mass.
            x, y, z = world_from_body[:3, :3].dot(self._centre).tolist()
            vx, vy, vz = vx - (wy * z - wz * y), vy - (wz * x - wx * z), vz - (wx * y - wy * x)
        return (vx, vy, vz), (wx, wy, wz)

    def rebuilt(self, placement: Placement) -> Body:
        """Make the body that another placement says, in the place and the motion of this one.

        Both are in the engine then; `remove` takes this one out of it.

        Raises
        ------
        InvalidRequest
            If it cannot be such a body.
        """
        linear, angular = self.velocity()
        moving = replace(
            placement,
            pose=self.pose(),
            linear_velocity=vector3(linear),
            angular_velocity=vector3(angular),
            behaviours=self._behaviours,
        )
        new = Body(self._client, moving)
        new.arranged = self.arranged and placement.scale == self.placement.scale
        new.entry_pose = self.entry_pose
        new.behaviours_unchanged = self.behaviours_unchanged
        new._wrenches = () if placement.static else self._wrenches
        return new

    @property
    def behaviours(self) -> tuple[RunningBehaviour, ...]:
        """The behaviours that move it, in the order in which they are evaluated."""
        return self._behaviours

    def push(self, wrench: RunningBehaviour) -> None:
        """Let a force act upon it from the step after the next until it ends.

        A scene that is saved knows nothing of it.

        Raises
        ------
        InvalidRequest
            If it is static.
        InvalidState
            If `MAX_WRENCHES` act already.
        """
        name = self.placement.name
        if self.placement.static:
            raise InvalidRequest("object", name, "one that is not static: only those can be pushed")
        self.forces()  # forgets those that have ended
        if len(self._wrenches) >= MAX_WRENCHES:
            raise InvalidState(
                f"{MAX_WRENCHES} wrenches act upon {name!r}, which is the most; "
                "wait until one has ended"
            )
        # The engine takes one step to wake what sleeps, and applies no force in it.
        self.wake()
        wrench.start_s += STEP_S
        self._wrenches = (*self._wrenches, wrench)

    def forces(self) -> tuple[RunningBehaviour, ...]:
        """Return all that acts upon it, its behaviours first; forgets wrenches that have ended."""
        if self._wrenches:
            self._wrenches = tuple(w for w in self._wrenches if not w.is_over)
        return (*self._behaviours, *self._wrenches)

    def attach(self, running: RunningBehaviour) -> None:
        """Let one more behaviour move it.

        Raises
        ------
        InvalidRequest
            If it is static, has `MAX_BEHAVIOURS` already, or lacks the joint that is moved.
        """
        name = self.placement.name
        if self.placement.static:
            accepted = "false for an object that has behaviours"
            raise InvalidRequest(f"static of {name!r}", True, accepted)
        if running.parameters.needs_joint and self.placement.joint is None:
            accepted = f"one on a joint for the behaviour {running.kind.type!r}"
            raise InvalidRequest("object", name, accepted)
        rig, legs = self.placement.asset.rig, running.parameters.legs
        if legs and (rig is None or rig.legs not in legs):
            accepted = f"a person for the behaviour {running.kind.type!r}"
            raise InvalidRequest("object", name, accepted)
        if len(self._behaviours) >= MAX_BEHAVIOURS:
            raise InvalidState(
                f"object {name!r} has {MAX_BEHAVIOURS} behaviours, which is the most; "
                "remove them first"
            )
        self._behaviours = (*self._behaviours, running)
        self.behaviours_unchanged = False

    def detach(self) -> None:
        """Let no behaviour move it any more; its speed remains."""
        self._behaviours = ()
        self.behaviours_unchanged = False

    def behave(
        self, running: RunningBehaviour, time_s: float, frustum_planes: FrustumPlanes
    ) -> None:
        """Do what one of its behaviours asks for the step that begins at a time [s]."""
        action = running.act(time_s, self._state(running, frustum_planes))
        actuation.apply_action(self._client, self._id, action)

    def touching_ids(self) -> frozenset[int]:
        """Return PyBullet's numbers of the bodies whose boxes touch its own, itself among them."""
        low, high = self._client.getAABB(self._id, self.link)
        found = self._client.getOverlappingObjects(
            [edge - TOUCH_M for edge in low], [edge + TOUCH_M for edge in high]
        )
        return frozenset(body for body, _ in found or ())

    @property
    def collides(self) -> bool:
        """True if it has a collision shape."""
        return bool(self.placement.asset.collision)

    @property
    def acts(self) -> bool:
        """True if something is done to it before steps."""
        return self.floats or bool(self._behaviours or self._wrenches)

    @property
    def thrown(self) -> bool:
        """True if it begins in motion."""
        return any((*self.placement.linear_velocity, *self.placement.angular_velocity))

    @property
    def off_centre(self) -> bool:
        """True if its origin is not its centre of mass."""
        return any(self._centre)

    def remove(self) -> None:
        """Take the body out of the engine."""
        self._client.removeBody(self._id)

    def _build(self) -> int:
        centre = self._centre_in_world(self.placement.pose)
        return create_rigid_body(self._client, self.placement, self.mass_kg, self._centre, centre)

    def _state(self, running: RunningBehaviour, frustum_planes: FrustumPlanes) -> BodyState:
        linear, angular = self.velocity()
        viewer, away_m = running.parameters.viewer, running.parameters.view_distance_m
        planes = frustum_planes(viewer, away_m) if viewer else _NO_PLANES
        return BodyState(
            pose=self.pose(),
            linear_velocity=linear,
            angular_velocity=angular,
            mass_kg=self.mass_kg,
            inertia_kg_m2=self.inertia_kg_m2,
            frustum_planes=planes,
            centre_of_mass_m=np.asarray(self._centre),
        )

    def _centre_in_world(self, pose: Pose) -> list[float]:
        if not any(self._centre):
            return list(pose.position_m)
        matrix = pose.matrix()
        return (matrix[:3, :3] @ np.asarray(self._centre) + matrix[:3, 3]).tolist()  # type: ignore[no-any-return]  # tolist is Any

    def _require_finite(self, position: Any, quat: Any) -> None:
        if not np.isfinite(position).all() or not np.isfinite(quat).all():
            raise PhysicsError(
                f"the motion of {self.placement.name!r} is no longer finite; reset the scene"
            )

    def _matrix_of(self, position: Any, quat: Any) -> NDArray[np.float64]:
        self._require_finite(position, quat)
        pose = Pose((0.0, 0.0, 0.0), quat)
        self._quat = pose.orientation_xyzw
        matrix = pose.matrix()
        matrix[:3, 3] = np.asarray(position) - matrix[:3, :3] @ np.asarray(self._centre)
        return matrix


def vector3(values: NDArray[np.float64]) -> Vector3:
    """Return three numbers of an array as a tuple."""
    return float(values[0]), float(values[1]), float(values[2])
