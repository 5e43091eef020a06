"""`wander_plane`: an object flies about a room as a toy plane does, and banks into its curves."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.behaviours.base import (
    MAX_SPEED_M_S,
    STEP_S,
    Action,
    BehaviourParameters,
    BodyState,
    behaviour,
)
from sailenv_ros.behaviours.steering import MAX_TURN_RAD_S, limited, turn_vector, vector3
from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import Position
from sailenv_ros.types.geometry import Pose

__all__ = ["WanderPlane", "wander_plane"]

MAX_PITCH_DEG = 35.0
GRAVITY_M_S2 = 9.81
RESPONSE_S = 0.15
"""Time in which the engine's force makes up for most of a wrong speed."""
STUCK_S = 0.7
"""Time without headway after which another waypoint is tried."""


class WanderPlane(BehaviourParameters):
    """Parameters of `wander_plane`."""

    waypoints: tuple[Position, ...] = Field(
        min_length=2, max_length=1000, description="places that it flies to, in random order [m]"
    )
    speed: Annotated[float, Number(above=0.0, most=MAX_SPEED_M_S, unit="m/s")] = Field(
        default=1.2, description="[m/s]"
    )
    mean_interval: Annotated[float, Number(least=0.1, most=1e4, unit="s")] = Field(
        default=6.0, description="time after which it heads for another one, on average [s]"
    )
    turn_rate: Annotated[float, Number(above=0.0, most=720.0, unit="deg/s")] = Field(
        default=90.0, description="how fast it turns at most [deg/s]"
    )
    max_bank: Annotated[float, Number(least=0.0, most=80.0, unit="deg")] = Field(
        default=45.0, description="how far it leans into a curve at most [deg]"
    )
    arrival: Annotated[float, Number(above=0.0, most=100.0, unit="m")] = Field(
        default=0.4, description="how near a waypoint is reached [m]"
    )


@behaviour("wander_plane", WanderPlane)
def wander_plane(
    parameters: WanderPlane,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> Action:
    """Fly towards waypoints, switched at random instants, and bank like a plane."""
    way = _way(parameters, time_s, body, memory, rng)
    heading = _next_attitude(parameters, way, body.pose)
    forward = heading.matrix()[:3, 0]
    change = (forward * parameters.speed - body.linear_velocity) / RESPONSE_S
    turn = turn_vector(body.pose, heading) / STEP_S
    return Action(
        force_n=vector3(body.mass_kg * limited(change, MAX_SPEED_M_S / RESPONSE_S)),
        angular_velocity=vector3(limited(turn, MAX_TURN_RAD_S)),
    )


def _way(
    parameters: WanderPlane,
    time_s: float,
    body: BodyState,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return the way from the body to the waypoint that it heads for now [m]."""
    here = np.asarray(body.pose.position_m)
    targets = parameters.waypoints
    speed = float(np.linalg.norm(body.linear_velocity))
    if speed > 0.3 * parameters.speed or "headway" not in memory:
        memory["headway"] = time_s
    stuck = time_s - memory["headway"] > STUCK_S
    target = memory.get("target")
    reached = target is not None and math.dist(here, targets[target]) < parameters.arrival
    if target is None or reached or stuck or time_s >= memory["until"]:
        others = [place for place in range(len(targets)) if place != target]
        memory["target"] = others[int(rng.integers(len(others)))]
        memory["until"] = time_s + rng.exponential(parameters.mean_interval)
        memory["headway"] = time_s
    way: NDArray[np.float64] = np.asarray(targets[memory["target"]]) - here
    return way


def _next_attitude(parameters: WanderPlane, way: NDArray[np.float64], pose: Pose) -> Pose:
    """Return the attitude after one step of turning towards a way; the position stays."""
    roll, pitch, yaw = pose.rpy_deg
    most = parameters.turn_rate
    wanted_yaw = math.degrees(math.atan2(way[1], way[0]))
    off = (wanted_yaw - yaw + 180.0) % 360.0 - 180.0
    yaw_rate = _clipped(2.0 * off, most)
    # Body frames have z up: the nose rises with a negative pitch.
    climb = math.degrees(math.atan2(way[2], math.hypot(way[0], way[1])))
    pitch_rate = _clipped(2.0 * (-_clipped(climb, MAX_PITCH_DEG) - pitch), most)
    # In a level turn the lift's sideways part bends the path: tan(bank) = speed x rate / g.
    lean = math.degrees(math.atan(parameters.speed * math.radians(yaw_rate) / GRAVITY_M_S2))
    # The inner wing drops; toys do so more than the arithmetic of their speed asks for.
    bank = _clipped(-3.0 * lean, parameters.max_bank)
    roll_rate = _clipped(3.0 * (bank - roll), 2.0 * most)
    rates = (roll_rate, pitch_rate, yaw_rate)
    angles = [angle + rate * STEP_S for angle, rate in zip((roll, pitch, yaw), rates, strict=True)]
    return Pose.from_rpy_deg(pose.position_m, angles)


def _clipped(value: float, most: float) -> float:
    return max(-most, min(most, value))
