"""Postures between postures: joints turn from one to another by the shortest way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.skeleton import Posture, joint_frames
from sailenv_ros.types.rig import Rig

__all__ = ["JointTurns"]

Doubles = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class JointTurns:
    """A posture by the turns of joints from their parents.

    Attributes
    ----------
    root_m : (3,) float64
        Body frame [m].
    quaternions : (J, 4) float64
        w, x, y, z of each joint, from its parent; of the root from the body frame.
    """

    root_m: Doubles
    quaternions: Doubles

    @classmethod
    def of(cls, rig: Rig, posture: Posture) -> JointTurns:
        """Return a posture's turns."""
        turns, _ = joint_frames(rig, posture)
        own = turns.copy()
        own[1:] = np.einsum("jki,jkl->jil", turns[rig.parents[1:]], turns[1:])
        return cls(root_m=posture.root_m, quaternions=_quaternions(own))

    def towards(self, other: JointTurns, share: float) -> JointTurns:
        """Return what lies between this, 0, and another, 1."""
        one, two = self.quaternions, other.quaternions
        cosine = np.einsum("jk,jk->j", one, two)
        two = np.where(cosine[:, None] < 0.0, -two, two)
        angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
        sine = np.sin(angle)
        near = sine < 1e-6
        divided = np.where(near, 1.0, sine)
        first = np.where(near, 1.0 - share, np.sin((1.0 - share) * angle) / divided)
        second = np.where(near, share, np.sin(share * angle) / divided)
        found = first[:, None] * one + second[:, None] * two
        found /= np.linalg.norm(found, axis=1, keepdims=True)
        root = self.root_m + share * (other.root_m - self.root_m)
        return JointTurns(root_m=root, quaternions=found)

    def posture(self, rig: Rig) -> Posture:
        """Return the posture; all joints are turned in it."""
        own = _matrices(self.quaternions)
        turns = own.copy()
        for number, parent in enumerate(rig.parents.tolist()):
            if parent >= 0:
                turns[number] = turns[parent] @ own[number]
        return Posture(root_m=self.root_m, turns=dict(zip(rig.names, turns, strict=True)))


def _quaternions(turns: Doubles) -> Doubles:
    """Return (J, 4) w, x, y, z of (J, 3, 3) rotations."""
    # Each row's largest component first, so that nothing is divided by what is near 0.
    xx, yy, zz = turns[:, 0, 0], turns[:, 1, 1], turns[:, 2, 2]
    squares = np.stack([1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz], 1)
    a = turns[:, 2, 1], turns[:, 0, 2], turns[:, 1, 0]
    b = turns[:, 1, 2], turns[:, 2, 0], turns[:, 0, 1]
    (wx, wy, wz), (yz, xz, xy) = (
        [p - q for p, q in zip(a, b, strict=True)],
        [p + q for p, q in zip(a, b, strict=True)],
    )
    rows = np.stack([
        np.stack([squares[:, 0], wx, wy, wz], 1),
        np.stack([wx, squares[:, 1], xy, xz], 1),
        np.stack([wy, xy, squares[:, 2], yz], 1),
        np.stack([wz, xz, yz, squares[:, 3]], 1),
    ])  # fmt: skip
    found = rows[squares.argmax(axis=1), np.arange(len(turns))]
    norm: Doubles = found / np.linalg.norm(found, axis=1, keepdims=True)
    return norm


def _matrices(quaternions: Doubles) -> Doubles:
    """Return (J, 3, 3) rotations of (J, 4) w, x, y, z."""
    w, x, y, z = quaternions.T
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], 1),
        np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], 1),
        np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], 1),
    ], 1)  # fmt: skip
