"""Orders to the motors of joints of a tree: the calls of PyBullet, and the couplings."""

from __future__ import annotations

from sailenv_ros.world.bullet import STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.engine_settings import ROBOT_SUBSTEPS
from sailenv_ros.world.joint_links import JointDrive

__all__ = ["couple", "force_motor", "position_motor", "velocity_motor"]

GEAR_ERP = 0.5
"""Share of the error between coupled joints that a step takes away."""

GEAR_FORCE = 1e4


def velocity_motor(
    client: BulletClient, body: int, link: int, velocity: float, force: float
) -> None:
    """Aim at a velocity [rad/s] or [m/s] with at most a torque [N m] or force [N]."""
    kind = client.constants.VELOCITY_CONTROL
    client.setJointMotorControl2(body, link, kind, targetVelocity=velocity, force=force)


def position_motor(client: BulletClient, body: int, link: int, drive: JointDrive) -> None:
    """Aim at the position of a drive."""
    client.setJointMotorControl2(
        body,
        link,
        client.constants.POSITION_CONTROL,
        targetPosition=drive.target,
        targetVelocity=0.0,
        positionGain=min(drive.gain / (STEPS_PER_SECOND * ROBOT_SUBSTEPS), 1.0),
        velocityGain=1.0,
        force=drive.effort,
        maxVelocity=drive.speed,
    )


def force_motor(client: BulletClient, body: int, link: int, force: float) -> None:
    """Exert a torque [N m] or force [N] in the next step."""
    kind = client.constants.TORQUE_CONTROL
    client.setJointMotorControl2(body, link, kind, force=force)


def couple(
    client: BulletClient, body: int, leader: int, follower: int, multiplier: float, offset: float
) -> int:
    """Let a joint go with another: position = multiplier · the other's + offset.

    Returns the engine's number of the constraint.
    """
    gear = client.createConstraint(
        body,
        leader,
        body,
        follower,
        client.constants.JOINT_GEAR,
        (1.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
    )
    client.changeConstraint(
        gear,
        gearRatio=-multiplier,
        relativePositionTarget=offset,
        erp=GEAR_ERP,
        maxForce=GEAR_FORCE,
    )
    return int(gear)
