"""Arithmetic that behaviours share: turns between orientations, velocities towards a pose.

Poses and velocities in, velocities out; knows no engine and no particular behaviour.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours.base import MAX_SPEED_M_S, STEP_S, Action, BodyState
from sailenv_ros.types.geometry import Pose

__all__ = [
    "MAX_TURN_RAD_S",
    "dots",
    "lengths",
    "limited",
    "random_direction",
    "torques",
    "towards",
    "turn_vector",
    "vector3",
]

MAX_TURN_RAD_S = 30.0
"""No behaviour turns a body faster."""

Vector = NDArray[np.float64]


def vector3(values: Vector) -> tuple[float, float, float]:
    """Return three numbers as a tuple of Python's own."""
    return float(values[0]), float(values[1]), float(values[2])


def dots(first: Vector, second: Vector) -> Vector:
    """Return the (N,) scalar products of rows (N, 3); the same for a row, whatever the others."""
    product = first * second
    return np.asarray(product[:, 0] + product[:, 1] + product[:, 2])


def lengths(values: Vector) -> Vector:
    """Return the (N,) lengths of rows (N, 3)."""
    return np.sqrt(dots(values, values))


def torques(orientations: Vector, inertias_kg_m2: Vector, twists: Vector) -> Vector:
    """Return the torques that accelerate bodies at rest.

    Parameters
    ----------
    orientations : (N, 4) float64
        Unit quaternions x, y, z, w of the bodies.
    inertias_kg_m2 : (N, 3) float64
        About the bodies' own axes.
    twists : (N, 3) float64
        Angular accelerations, world frame [rad/s2].

    Returns
    -------
    torques_nm : (N, 3) float64
        World frame: R diag(I) Rᵀ a.
    """
    back = orientations * (-1.0, -1.0, -1.0, 1.0)
    return _rotated(orientations, inertias_kg_m2 * _rotated(back, twists))


def _rotated(orientations: Vector, values: Vector) -> Vector:
    """Turn rows (N, 3) by unit quaternions (N, 4): v + 2 w (u × v) + 2 u × (u × v)."""
    axis, w = orientations[:, :3], orientations[:, 3:]
    once = _crosses(axis, values)
    return np.asarray(values + 2.0 * (w * once + _crosses(axis, once)))


def _crosses(first: Vector, second: Vector) -> Vector:
    """Return the vector products of rows (N, 3): those of `np.cross`, which takes twice as long."""
    (a, b, c), (x, y, z) = first.T, second.T
    return np.stack((b * z - c * y, c * x - a * z, a * y - b * x), axis=1)


def limited(values: Vector, most: float) -> Vector:
    """Shorten a vector to a length of at most `most`, in its own direction."""
    length = float(np.linalg.norm(values))
    return values if length <= most else values * (most / length)


def random_direction(rng: np.random.Generator) -> Vector:
    """Draw a unit vector, every direction being equally likely."""
    height = rng.uniform(-1.0, 1.0)
    angle = rng.uniform(0.0, 2.0 * math.pi)
    radius = math.sqrt(1.0 - height * height)
    return np.array([radius * math.cos(angle), radius * math.sin(angle), height])


def turn_vector(start: Pose, end: Pose) -> Vector:
    """Return the shorter turn from one orientation to another.

    Returns
    -------
    turn : (3,) float64
        Axis in the world frame times angle [rad], the angle at most pi.
    """
    x, y, z, w = (float(part) for part in start.orientation_xyzw)
    p, q, r, s = (float(part) for part in end.orientation_xyzw)
    # end * conjugate(start), written out.
    axis = np.array(
        [
            -s * x + p * w - q * z + r * y,
            -s * y + p * z + q * w - r * x,
            -s * z - p * y + q * x + r * w,
        ]
    )
    cosine = s * w + p * x + q * y + r * z
    if cosine < 0.0:
        axis, cosine = -axis, -cosine
    sine = float(np.linalg.norm(axis))
    if sine < 1e-12:
        return 2.0 * axis
    return axis * (2.0 * math.atan2(sine, cosine) / sine)


def towards(body: BodyState, goal: Pose) -> Action:
    """Return the velocities that bring a body to a pose by the end of the step.

    What is too far for one step at the highest speed takes several.
    """
    way = np.asarray(goal.position_m) - np.asarray(body.pose.position_m)
    return Action(
        linear_velocity=vector3(limited(way / STEP_S, MAX_SPEED_M_S)),
        angular_velocity=vector3(limited(turn_vector(body.pose, goal) / STEP_S, MAX_TURN_RAD_S)),
    )
