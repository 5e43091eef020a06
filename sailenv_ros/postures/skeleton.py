"""A `Rig` in a posture: where its joints are, and where its skin is taken.

A posture is a place of the root and rotations of some joints in the axes of the body frame; the
others turn with their parents.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.rig import Rig

__all__ = [
    "JointFrames",
    "Posture",
    "Pose3",
    "aligned",
    "joint_frames",
    "skin_matrices",
    "turn_about",
]

Doubles = NDArray[np.float64]

Pose3 = tuple[Doubles, Doubles]
"""A rotation (3, 3) and a place (3,)."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Posture:
    """Where a body's root is, and how joints are turned.

    Attributes
    ----------
    root_m : (3,) float64
        Of the first joint in the body frame [m].
    turns : mapping of str to (3, 3) float64
        From the axes of rest to those of the joint, both in the body frame.
    """

    root_m: Doubles
    turns: Mapping[str, Doubles] = field(default_factory=dict)


JointFrames: TypeAlias = tuple[Doubles, Doubles]
"""Rotations and places of joints; see `joint_frames`."""


def joint_frames(rig: Rig, posture: Posture) -> JointFrames:
    """Return (J, 3, 3) rotations and (J, 3) places of the joints, body frame [m]."""
    count = len(rig.names)
    turns, places = np.empty((count, 3, 3)), np.empty((count, 3))
    parents = rig.parents.tolist()
    for number, name in enumerate(rig.names):
        parent = parents[number]
        own = posture.turns.get(name)
        if parent < 0:
            turns[number] = np.eye(3) if own is None else own
            places[number] = posture.root_m
            continue
        turns[number] = turns[parent] if own is None else own
        places[number] = places[parent] + turns[parent] @ (rig.heads[number] - rig.heads[parent])
    return turns, places


def skin_matrices(rig: Rig, turns: Doubles, places: Doubles) -> Doubles:
    """Return (J, 3, 4): where each joint takes what is at rest; see `joint_frames`."""
    result = np.empty((len(rig.names), 3, 4))
    result[:, :, :3] = turns
    result[:, :, 3] = places - np.einsum("jik,jk->ji", turns, rig.heads)
    return result


def turn_about(axis: str, degrees: float) -> Doubles:
    """Return the rotation about x, y or z by an angle [deg]."""
    angle = np.radians(degrees)
    c, s = float(np.cos(angle)), float(np.sin(angle))
    if axis == "x":
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    if axis == "y":
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def aligned(rest: Doubles, rest_pole: Doubles, direction: Doubles, pole: Doubles) -> Doubles:
    """Return the rotation that takes one direction to another, and its pole next to a pole."""
    return _frame(direction, pole) @ _frame(rest, rest_pole).T


def _frame(direction: Doubles, pole: Doubles) -> Doubles:
    # Plain numbers: NumPy's cross takes longer than all else.
    x, y, z = _unit(*direction.tolist())
    a, b, c = pole.tolist()
    u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
    if u * u + v * v + w * w < 1e-18:
        u, v, w = -z, 0.0, x  # of a pole along y
    u, v, w = _unit(u, v, w)
    return np.array([
        [x, v * z - w * y, u],
        [y, w * x - u * z, v],
        [z, u * y - v * x, w],
    ])  # fmt: skip


def _unit(x: float, y: float, z: float) -> tuple[float, float, float]:
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length
