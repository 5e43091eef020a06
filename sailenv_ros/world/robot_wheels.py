"""Wheels of mobile robots: velocities of the robot in, of its wheels and its steering out.

Differential, mecanum and Ackermann steering; arithmetic alone, no engine.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.spec_robots import WheelsSpec
from sailenv_ros.types.robots import Mount, RobotLink, RobotModel
from sailenv_ros.world.robot_kinematics import all_positions, base_from_frame, joint_links

__all__ = ["Planar", "Wheels", "is_wheel"]

Doubles = NDArray[np.float64]
Planar = tuple[float, float, float]
"""Forward and left [m/s], turning left [rad/s]."""

PULL_PER_S, TURN_PER_S = 2.0, 3.0
"""Speed for each unit of the way, and of the turn, that are left to a mover [1/s]."""

NEAR_M, AT_GOAL, AHEAD_RAD = 0.05, 0.05, 0.7
"""Nearer, a mover is reached; slower turns [rad/s] are none; and where it counts as ahead."""

LEVEL = 0.2
"""Greatest vertical part of a wheel's axis."""


def is_wheel(model: RobotModel, link: RobotLink, spec: WheelsSpec) -> bool:
    """Return whether a link is a wheel: named, or turning without end about a level axis."""
    if spec.joints:
        return link.joint.name in spec.joints
    if link.joint.type != "hinge" or link.joint.limits is not None:
        return False
    return abs(float(_axis(model, link)[2])) < LEVEL


def _axis(model: RobotModel, link: RobotLink) -> Doubles:
    """Return a joint's unit axis in the first link's frame at rest."""
    turn = base_from_frame(model, link.name, all_positions(model, {}))[:3, :3]
    axis = turn @ np.asarray(link.joint.axis)
    return np.asarray(axis / np.linalg.norm(axis))


@dataclass(frozen=True, slots=True)
class _Wheel:
    joint: str
    x_m: float
    y_m: float
    radius_m: float
    sign: float
    steering: str


class Wheels:
    """The wheels of one robot.

    Parameters
    ----------
    mount : str
        ``differential``, ``mecanum`` or ``ackermann``.
    model : RobotModel
    spec : WheelsSpec

    Attributes
    ----------
    track_m, wheelbase_m : float

    Raises
    ------
    UnknownName, InvalidRequest
        If the description names joints that are not there, or no wheels are found.
    """

    def __init__(self, mount: Mount, model: RobotModel, spec: WheelsSpec) -> None:
        self._mount, self._spec = mount, spec
        named = joint_links(model)
        for name in spec.joints:
            if name not in named:
                raise UnknownName("wheel", name, named)
        found = [link for link in model.moving if is_wheel(model, link, spec)]
        if not found:
            accepted = "fixed or free, or names of the joints of its wheels: none was found"
            raise InvalidRequest(f"mount of a {model.name}", mount, accepted)
        rest = all_positions(model, {})
        places = [base_from_frame(model, link.name, rest)[:3, 3] for link in found]
        middle = np.mean(places, axis=0)
        self.track_m = spec.track or max(2.0 * max(abs(p[1] - middle[1]) for p in places), 1e-3)
        self.wheelbase_m = spec.wheelbase or max(float(np.ptp([p[0] for p in places])), 1e-3)
        # Steered wheels are in front of the axle about which the robot turns.
        self._rear_m = min(float(p[0]) for p in places)
        by_name = {link.name: link for link in model.links}
        self._wheels = []
        for link, place in zip(found, places, strict=True):
            side = math.copysign(0.5 * self.track_m, place[1] - middle[1])
            self._wheels.append(
                _Wheel(
                    joint=link.joint.name,
                    x_m=float(place[0]),
                    y_m=side if abs(place[1] - middle[1]) > 1e-3 else 0.0,
                    radius_m=spec.radius or _radius_m(link),
                    sign=math.copysign(1.0, float(_axis(model, link)[1])),
                    steering=_steering(model, by_name.get(link.parent)),
                )
            )

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints of the wheels and their steering."""
        steered = (wheel.steering for wheel in self._wheels if wheel.steering)
        return (*(wheel.joint for wheel in self._wheels), *dict.fromkeys(steered))

    def possible(self, command: Planar) -> Planar:
        """Return what the wheels can do of a command."""
        limit, turn_limit = self._spec.speed, self._spec.turn
        forward, left, turn = command
        if self._mount != "mecanum":
            left = 0.0
        speed = math.hypot(forward, left)
        if speed > limit:
            forward, left = forward * limit / speed, left * limit / speed
        turn = min(max(turn, -turn_limit), turn_limit)
        if self._mount == "ackermann":
            most = abs(forward) * math.tan(self._spec.steering) / self.wheelbase_m
            turn = min(max(turn, -most), most)
        return forward, left, turn

    def towards(self, here_from_goal: Doubles) -> Planar:
        """Return what takes the robot to a (4, 4) pose in its first link's frame.

        Mecanum wheels take it there straight; others turn first where the goal is not ahead.
        """
        x, y = float(here_from_goal[0, 3]), float(here_from_goal[1, 3])
        way = math.hypot(x, y)
        if self._mount == "mecanum":
            turn = TURN_PER_S * math.atan2(here_from_goal[1, 0], here_from_goal[0, 0])
            near = way < NEAR_M
            pull = 0.0 if near else PULL_PER_S
            return self.possible((pull * x, pull * y, turn if abs(turn) > AT_GOAL else 0.0))
        if way < NEAR_M:
            return 0.0, 0.0, 0.0
        bearing = math.atan2(y, x)
        if self._mount == "differential" and abs(bearing) > AHEAD_RAD:
            return self.possible((0.0, 0.0, TURN_PER_S * bearing))
        forward = min(PULL_PER_S * way, self._spec.speed)
        return self.possible((forward, 0.0, 2.0 * forward * math.sin(bearing) / way))

    def step(self, now: Planar, wanted: Planar, seconds: float) -> Planar:
        """Return the velocity after a time: as near to what is wanted as traction allows."""
        most = self._spec.acceleration * seconds
        way = math.hypot(wanted[0] - now[0], wanted[1] - now[1])
        share = 1.0 if way <= most else most / way
        most_turn = 2.0 * most / self.track_m
        turn = min(max(wanted[2] - now[2], -most_turn), most_turn)
        return (
            now[0] + share * (wanted[0] - now[0]),
            now[1] + share * (wanted[1] - now[1]),
            now[2] + turn,
        )

    def speeds(self, moving: Planar) -> dict[str, float]:
        """Return how fast each wheel turns [rad/s] so that it rolls at a velocity."""
        forward, left, turn = moving
        found = {}
        for wheel in self._wheels:
            ahead = forward - turn * wheel.y_m
            if self._mount == "mecanum":
                # Rollers of front left and rear right wheels point one way, the others the other.
                side = math.copysign(1.0, wheel.y_m) * math.copysign(1.0, wheel.x_m)
                ahead -= side * (left + turn * wheel.x_m)
            elif self._mount == "ackermann":
                across = turn * (wheel.x_m - self._rear_m)
                ahead = math.copysign(math.hypot(ahead, across), ahead or 1.0)
            found[wheel.joint] = wheel.sign * ahead / wheel.radius_m
        return found

    def angles(self, moving: Planar) -> dict[str, float]:
        """Return how far steering joints turn [rad]; nothing where no wheel is steered."""
        forward, _, turn = moving
        found = {}
        for wheel in self._wheels:
            if wheel.steering:
                ahead = forward - turn * wheel.y_m
                across = turn * (wheel.x_m - self._rear_m)
                angle = math.atan2(across, abs(ahead)) * math.copysign(1.0, ahead or 1.0)
                found[wheel.steering] = angle if abs(ahead) > 1e-3 else 0.0
        return found


def _radius_m(link: RobotLink) -> float:
    """Return half of the greatest extent of a wheel across its axis."""
    low, high = link.asset.model.bounds()
    axis = np.abs(np.asarray(link.joint.axis))
    across = (high - low)[axis < 0.9 * axis.max()]
    radius = 0.5 * float(across.max()) if len(across) else 0.0
    return radius if radius > 1e-3 else 0.1


def _steering(model: RobotModel, carrier: RobotLink | None) -> str:
    """Return the joint of what carries a wheel, if that turns it about an upright axis."""
    if carrier is None or carrier.joint.type != "hinge" or carrier.joint.limits is None:
        return ""
    return carrier.joint.name if abs(_axis(model, carrier)[2]) > 1.0 - LEVEL else ""
