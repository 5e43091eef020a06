"""A mover's collision proxy: a ball that commands push about and that walls stop.

A `Mover` with a command in, its next pose out. The ball is in the engine alone: it is no object,
has no instance id and is never drawn. It meets things only while a command moves it, so a mover
that was put somewhere stays exactly there.
"""

from __future__ import annotations

import math

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_motion import turned

__all__ = ["PROXY_RADIUS_M", "CollisionProxy"]

PROXY_RADIUS_M = 0.15
"""Room that a camera wants around it."""

PROXY_MASS_KG = 1.0

_UPRIGHT = (0.0, 0.0, 0.0, 1.0)
_STILL = (0.0, 0.0, 0.0)
_NOTHING, _EVERYTHING = 0, -1


class CollisionProxy:
    """The body of one mover.

    Parameters
    ----------
    client : BulletClient
    mover : Mover
    """

    def __init__(self, client: BulletClient, mover: Mover) -> None:
        self._client = client
        self._mover = mover
        self._moves = False
        shape = client.createCollisionShape(client.constants.GEOM_SPHERE, radius=PROXY_RADIUS_M)
        self._id = client.createMultiBody(baseMass=PROXY_MASS_KG, baseCollisionShapeIndex=shape)
        # It slides along walls, does not roll, and bounces off nothing.
        client.changeDynamics(
            self._id,
            LINK_OF_BASE,
            lateralFriction=0.0,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
        )
        self._meet(_NOTHING)

    @property
    def bullet_id(self) -> int:
        """PyBullet's number of the ball."""
        return int(self._id)

    def before_step(self, time_ns: int) -> None:
        """Push the body for the step that begins at a simulated time [ns]."""
        command = self._mover.command_at(time_ns)
        if command is None:
            self._stop()
            return
        here = self._mover.pose_at(time_ns)
        self._client.resetBasePositionAndOrientation(self._id, here.position_m, _UPRIGHT)
        self._client.resetBaseVelocity(self._id, _along(here, command.linear_m_s), _STILL)
        frame = self._client.constants.WORLD_FRAME
        lift = tuple(-PROXY_MASS_KG * g for g in self._client.gravity)
        self._client.applyExternalForce(self._id, LINK_OF_BASE, lift, here.position_m, frame)
        if not self._moves:
            self._meet(_EVERYTHING)
            self._moves = True

    def after_step(self, time_ns: int) -> None:
        """Report to the mover where the step that began at a simulated time [ns] has brought it."""
        command = self._mover.command_at(time_ns)
        if command is None:
            return
        position, _ = self._client.getBasePositionAndOrientation(self._id)
        here = self._mover.pose_at(time_ns)
        _, pitch_rate, yaw_rate = command.angular_rad_s
        if not pitch_rate and not yaw_rate:
            self._mover.moved(Pose(position, here.orientation_xyzw))
            return
        brought = Pose(position, here.orientation_xyzw)
        by = (pitch_rate / STEPS_PER_SECOND, yaw_rate / STEPS_PER_SECOND)
        self._mover.moved(turned(brought, *by))

    def _stop(self) -> None:
        # It falls meanwhile, by a hair at each step, and meets nothing: nobody can tell.
        self._client.resetBaseVelocity(self._id, _STILL, _STILL)
        if self._moves:
            self._meet(_NOTHING)
            self._moves = False

    def _meet(self, what: int) -> None:
        group = 1 if what else 0
        self._client.setCollisionFilterGroupMask(self._id, LINK_OF_BASE, group, what)


def _along(here: Pose, linear_m_s: tuple[float, float, float]) -> list[float]:
    """Turn a walker's speeds forward, left and up into the world's axes."""
    yaw = math.radians(here.rpy_deg[2])
    forward, left, up = linear_m_s
    x = math.cos(yaw) * forward - math.sin(yaw) * left
    y = math.sin(yaw) * forward + math.cos(yaw) * left
    return [x, y, up]
