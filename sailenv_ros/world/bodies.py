"""One rigid body: a placement becomes a PyBullet body whose pose can be read and set.

PyBullet reports the pose of the centre of mass; here poses are those of the body frame, the one
in which the model's vertices stand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import Action, BodyState, RunningBehaviour
from sailenv_ros.errors import InvalidRequest, PhysicsError
from sailenv_ros.geometry import Pose
from sailenv_ros.labels import Instance
from sailenv_ros.model import Asset, TriangleShape
from sailenv_ros.objects import ObjectState
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.collision import build_collision

__all__ = ["Body", "Placement"]

Vector3 = tuple[float, float, float]

_LINK_OF_BASE = -1


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """An object to put into the world.

    Attributes
    ----------
    name : str
        Unique in its scene.
    asset : Asset
    category_id : int
    pose : Pose
        Of the body frame.
    scale : (3,) tuple of float
        Each above 0.
    static : bool
        True if physics never moves it.
    mass_kg : float or None
        None takes the asset's mass times the scale's volume [kg].
    gravity : bool
        False if gravity does not pull it.
    friction, restitution : float
    linear_velocity : (3,) tuple of float
        At the start, world frame [m/s].
    angular_velocity : (3,) tuple of float
        At the start, world frame [rad/s].
    behaviours : tuple of RunningBehaviour
    """

    name: str
    asset: Asset
    category_id: int
    pose: Pose
    scale: Vector3 = (1.0, 1.0, 1.0)
    static: bool = False
    mass_kg: float | None = None
    gravity: bool = True
    friction: float = 0.5
    restitution: float = 0.0
    linear_velocity: Vector3 = (0.0, 0.0, 0.0)
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    behaviours: tuple[RunningBehaviour, ...] = ()

    def __post_init__(self) -> None:
        hollow = any(isinstance(shape, TriangleShape) for shape in self.asset.collision)
        if hollow and not self.static:
            raise InvalidRequest(
                f"static of {self.name!r}", False, f"true: {self.asset.name!r} is hollow geometry"
            )
        if self.behaviours and self.static:
            raise InvalidRequest(
                f"static of {self.name!r}", True, "false for an object that has behaviours"
            )


class Body:
    """A placed object; static ones keep the very pose that they were given."""

    def __init__(self, client: BulletClient, placement: Placement, gravity: Vector3) -> None:
        self.placement = placement
        self._client = client
        self._centre = tuple(
            c * s for c, s in zip(placement.asset.centre_of_mass_m, placement.scale, strict=True)
        )
        self.mass_kg = 0.0 if placement.static else _mass_kg(placement)
        self._id = self._build()
        self._static_pose = placement.pose
        self._matrix = placement.pose.matrix()
        # PyBullet has no per-body gravity; the weight of those it must not pull is given back.
        self._lift = None
        if not placement.static and not placement.gravity:
            self._lift = tuple(-self.mass_kg * g for g in gravity)

    @property
    def bullet_id(self) -> int:
        """PyBullet's number of this body."""
        return self._id

    def world_from_body(self) -> NDArray[np.float64]:
        """Give the (4, 4) pose now.

        Raises
        ------
        PhysicsError
            If the engine's state is no longer finite.
        """
        if self.placement.static:
            return self._matrix
        position, quat = self._client.getBasePositionAndOrientation(self._id)
        return self._matrix_of(position, quat)

    def pose(self) -> Pose:
        """Give the pose of the body frame now."""
        if self.placement.static:
            return self._static_pose
        return Pose.from_matrix(self.world_from_body())

    def put(self, pose: Pose) -> None:
        """Set the pose and stop the body."""
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
            state = self._client.constants.ACTIVATION_STATE_WAKE_UP
            self._client.changeDynamics(self._id, _LINK_OF_BASE, activationState=state)

    def velocity(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Give the velocity of the centre of mass [m/s] and the angular velocity [rad/s]."""
        linear, angular = self._client.getBaseVelocity(self._id)
        return np.asarray(linear), np.asarray(angular)

    def state(self, instance: Instance, sim_time_ns: int) -> ObjectState:
        """Give all that clients may know of it now."""
        placement = self.placement
        low, high = placement.asset.model.bounds()
        linear, angular = self.velocity()
        return ObjectState(
            id=instance.id,
            name=instance.name,
            asset=instance.asset,
            category_id=instance.category_id,
            category=instance.category,
            pose=self.pose(),
            scale=placement.scale,
            size_m=_three((high - low) * np.asarray(placement.scale)),
            static=placement.static,
            mass_kg=self.mass_kg,
            linear_velocity=_three(linear),
            angular_velocity=_three(angular),
            behaviours=tuple(
                {"type": running.kind.type, **running.parameters.model_dump()}
                for running in placement.behaviours
            ),
            sim_time_ns=sim_time_ns,
        )

    def act(self, time_s: float) -> None:
        """Do what its behaviours and its want of gravity ask for the step that begins now."""
        for running in self.placement.behaviours:
            linear, angular = self.velocity()
            state = BodyState(
                pose=self.pose(),
                linear_velocity=linear,
                angular_velocity=angular,
                mass_kg=self.mass_kg,
            )
            self._apply(running.act(time_s, state))
        if self._lift is not None:
            self._push(self._lift)

    @property
    def collides(self) -> bool:
        """True if it has a collision shape."""
        return bool(self.placement.asset.collision)

    @property
    def acts(self) -> bool:
        """True if `act` has anything to do."""
        return self._lift is not None or bool(self.placement.behaviours)

    def remove(self) -> None:
        """Take the body out of the engine."""
        self._client.removeBody(self._id)

    def _build(self) -> int:
        placement = self.placement
        shape = build_collision(
            self._client,
            placement.asset.collision,
            scale=placement.scale,
            centre_of_mass_m=self._centre,  # type: ignore[arg-type]  # three floats, see __init__
            name=placement.name,
        )
        body = self._client.createMultiBody(
            baseMass=self.mass_kg,
            baseCollisionShapeIndex=shape,
            basePosition=self._centre_in_world(placement.pose),
            baseOrientation=placement.pose.orientation_xyzw,
        )
        self._client.changeDynamics(
            body,
            _LINK_OF_BASE,
            lateralFriction=placement.friction,
            restitution=placement.restitution,
            # Bullet's own default of 0.04 /s would make free fall and free flight inexact.
            linearDamping=0.0,
            angularDamping=0.0,
            rollingFriction=0.002 if self.mass_kg else 0.0,
            spinningFriction=0.002 if self.mass_kg else 0.0,
        )
        if not placement.static:
            # What has come to rest sleeps: it keeps the very same pose, and costs nothing.
            states = self._client.constants
            self._client.changeDynamics(
                body, _LINK_OF_BASE, activationState=states.ACTIVATION_STATE_ENABLE_SLEEPING
            )
            self._client.resetBaseVelocity(
                body, placement.linear_velocity, placement.angular_velocity
            )
        return int(body)

    def _apply(self, action: Action) -> None:
        if action != Action():
            self.wake()
        if action.linear_velocity is not None or action.angular_velocity is not None:
            linear, angular = self.velocity()
            self._client.resetBaseVelocity(
                self._id,
                action.linear_velocity if action.linear_velocity is not None else linear.tolist(),
                action.angular_velocity
                if action.angular_velocity is not None
                else angular.tolist(),
            )
        if action.force_n is not None:
            self._push(action.force_n)
        if action.torque_nm is not None:
            frame = self._client.constants.WORLD_FRAME
            self._client.applyExternalTorque(self._id, _LINK_OF_BASE, action.torque_nm, frame)

    def _push(self, force_n: tuple[float, ...]) -> None:
        position, _ = self._client.getBasePositionAndOrientation(self._id)
        frame = self._client.constants.WORLD_FRAME
        self._client.applyExternalForce(self._id, _LINK_OF_BASE, force_n, position, frame)

    def _centre_in_world(self, pose: Pose) -> list[float]:
        if not any(self._centre):
            return list(pose.position_m)
        matrix = pose.matrix()
        return (matrix[:3, :3] @ np.asarray(self._centre) + matrix[:3, 3]).tolist()  # type: ignore[no-any-return]  # tolist is Any

    def _matrix_of(self, position: Any, quat: Any) -> NDArray[np.float64]:
        if not np.isfinite(position).all() or not np.isfinite(quat).all():
            raise PhysicsError(
                f"the motion of {self.placement.name!r} is no longer finite; reset the scene"
            )
        matrix = Pose((0.0, 0.0, 0.0), quat).matrix()
        matrix[:3, 3] = np.asarray(position) - matrix[:3, :3] @ np.asarray(self._centre)
        return matrix


def _three(values: NDArray[np.float64]) -> Vector3:
    return float(values[0]), float(values[1]), float(values[2])


def _mass_kg(placement: Placement) -> float:
    if placement.mass_kg is not None:
        return placement.mass_kg
    sx, sy, sz = placement.scale
    return placement.asset.mass_kg * sx * sy * sz
