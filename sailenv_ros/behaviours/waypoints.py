"""`linear_waypoints` and `catmull_waypoints`: an object runs along a track of poses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from sailenv_ros.behaviours.base import (
    STEP_S,
    Action,
    BehaviourParameters,
    BodyState,
    behaviour,
)
from sailenv_ros.behaviours.steering import towards, turn_vector
from sailenv_ros.scene.field_types import Number, Switch
from sailenv_ros.scene.fields import Position, Rotation
from sailenv_ros.types.geometry import Pose, interpolate

__all__ = [
    "ObjectWaypoint",
    "Waypoints",
    "catmull_pose",
    "catmull_waypoints",
    "linear_pose",
    "linear_waypoints",
]

ARRIVED = 1e-6
"""A body nearer than this to its goal has arrived [m], [rad]."""


class ObjectWaypoint(BaseModel):
    """One pose of an object's track."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    position: Position = Field(description="of the object's origin [m]")
    rotation: Rotation = Field(
        default=(0.0, 0.0, 0.0), description="roll, pitch, yaw about fixed axes [deg]"
    )


class Waypoints(BehaviourParameters):
    """Parameters of `linear_waypoints` and `catmull_waypoints`."""

    waypoints: tuple[ObjectWaypoint, ...] = Field(
        min_length=1, max_length=1000, description="the track, run through at equal times"
    )
    total_time: Annotated[float, Number(above=0.0, most=1e6, unit="s")] = Field(
        default=10.0, description="time to run through all the waypoints once [s]"
    )
    loop: Annotated[bool, Switch()] = Field(
        default=True, description="true: the last waypoint leads on to the first"
    )

    rest: Annotated[float, Number(least=0.0, most=1e6, unit="s")] = Field(
        default=0.0,
        description="time that it stands at the first waypoint after each round [s], if it loops",
    )

    @property
    def duration_s(self) -> float | None:
        """Time until the last waypoint is reached for the first time [s]."""
        return self.total_time

    def rests_at(self, time_s: float) -> bool:
        """Return whether a time [s] falls into a rest."""
        if not self.loop or not self.rest:
            return False
        return max(0.0, time_s) % (self.total_time + self.rest) >= self.total_time

    @cached_property
    def poses(self) -> tuple[Pose, ...]:
        """The poses of the track, in order."""
        return tuple(Pose.from_rpy_deg(w.position, w.rotation) for w in self.waypoints)

    def leg_at(self, time_s: float) -> tuple[int, float]:
        """Return the leg at a time from 0 on [s], and the fraction of it that is done, 0 to 1."""
        legs = len(self.waypoints) if self.loop else len(self.waypoints) - 1
        if len(self.waypoints) == 1:
            return 0, 0.0
        time_s = max(0.0, time_s)
        if self.loop and self.rest:
            if self.rests_at(time_s):
                return legs - 1, 1.0
            time_s %= self.total_time + self.rest
        progress = time_s / self.total_time * legs
        if not self.loop and progress >= legs:
            return legs - 1, 1.0
        leg = int(progress)
        return leg % legs, progress - leg


def linear_pose(parameters: Waypoints, time_s: float) -> Pose:
    """Return the pose on straight legs, orientations by shorter arcs, at a time [s]."""
    leg, fraction = parameters.leg_at(time_s)
    poses = parameters.poses
    return interpolate(poses[leg], poses[(leg + 1) % len(poses)], fraction)


def catmull_pose(parameters: Waypoints, time_s: float) -> Pose:
    """Return the pose on a uniform Catmull-Rom spline, orientations by shorter arcs.

    Source: Catmull and Rom, "A class of local interpolating splines", 1974, with tension 1/2. An
    open track's ends are doubled.
    """
    leg, fraction = parameters.leg_at(time_s)
    points = _around(parameters.poses, leg, loop=parameters.loop)
    t = fraction
    weights = 0.5 * np.array(
        [
            -t + 2 * t**2 - t**3,
            2 - 5 * t**2 + 3 * t**3,
            t + 4 * t**2 - 3 * t**3,
            -(t**2) + t**3,
        ]
    )
    position = weights @ np.array([pose.position_m for pose in points])
    turned = interpolate(points[1], points[2], fraction)
    return Pose(position, turned.orientation_xyzw)


def _around(poses: Sequence[Pose], leg: int, *, loop: bool) -> list[Pose]:
    """Return the poses before, at the beginning of, at the end of and after a leg."""
    count = len(poses)
    places = range(leg - 1, leg + 3)
    if loop:
        return [poses[place % count] for place in places]
    return [poses[min(max(place, 0), count - 1)] for place in places]


@behaviour("linear_waypoints", Waypoints)
def linear_waypoints(
    parameters: Waypoints,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Run along straight lines from waypoint to waypoint."""
    return _led(parameters, time_s, body, linear_pose(parameters, time_s + STEP_S))


@behaviour("catmull_waypoints", Waypoints)
def catmull_waypoints(
    parameters: Waypoints,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Run along a smooth curve through the waypoints."""
    return _led(parameters, time_s, body, catmull_pose(parameters, time_s + STEP_S))


def _led(parameters: Waypoints, time_s: float, body: BodyState, goal: Pose) -> Action:
    """Return what brings a body to a pose; one that rests there is left alone."""
    if not parameters.rests_at(time_s) or not _is_at(body, goal):
        return towards(body, goal)
    if not (body.linear_velocity.any() or body.angular_velocity.any()):
        return Action()
    # What is not moved keeps its pose to the last bit, so that its flow is exactly 0.
    still = (0.0, 0.0, 0.0)
    return Action(linear_velocity=still, angular_velocity=still)


def _is_at(body: BodyState, goal: Pose) -> bool:
    way = np.asarray(goal.position_m) - np.asarray(body.pose.position_m)
    turn = turn_vector(body.pose, goal)
    return bool(np.abs(way).max() < ARRIVED and np.abs(turn).max() < ARRIVED)
