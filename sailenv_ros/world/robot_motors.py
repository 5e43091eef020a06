"""Motors of robots: what they follow at first, and the targets that they take."""

from __future__ import annotations

import math
from dataclasses import replace

from sailenv_ros.scene.spec_robots import RobotSpec
from sailenv_ros.types.robots import DriveMode, RobotJoint
from sailenv_ros.world.joint_links import JointDrive

__all__ = ["GAIN", "bounds", "first_drive"]

GAIN = 24.0
"""Speed for each unit of a position's error, unless another is asked for [1/s]."""


def first_drive(spec: RobotSpec, joint: RobotJoint, position: float) -> JointDrive:
    """Return what a motor follows at first: what is described, else its joint stays there."""
    told = next((one for one in spec.joints if one.name == joint.name), None)
    drive = JointDrive(
        mode="position", target=position, gain=GAIN, effort=joint.effort, speed=joint.speed
    )
    if joint.mimic is not None:
        return replace(drive, mode="off", target=0.0)
    if told is None:
        return drive
    default = position if told.mode == "position" else 0.0
    return JointDrive(
        mode=told.mode,
        target=default if told.target is None else told.target,
        gain=told.gain,
        effort=min(told.effort or math.inf, joint.effort),
        speed=min(told.speed or math.inf, joint.speed),
    )


def bounds(
    mode: DriveMode, limits: tuple[float, float] | None, speed: float, effort: float
) -> tuple[float, float]:
    """Return the least and the greatest target of a motor."""
    if mode == "position":
        return limits or (-1e4, 1e4)
    most = speed if mode == "velocity" else effort
    return -most, most
