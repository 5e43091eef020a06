"""Skeletons of models that bones deform: joints, the weights of their skin, named points.

All joints have the axes of the body frame at rest, so that a rotation of a joint is one about
these axes, and a skeleton needs the places of its joints alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError

__all__ = ["Rig", "RigPoint"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RigPoint:
    """A named point that a joint carries.

    Attributes
    ----------
    name : str
    joint : int
    position_m : (3,) tuple of float
        At rest, body frame [m].
    """

    name: str
    joint: int
    position_m: tuple[float, float, float]


@dataclass(frozen=True, eq=False, kw_only=True)
class Rig:
    """A skeleton and the skin on it; arrays are read-only.

    Attributes
    ----------
    names : (J,) tuple of str
        Of the joints; a joint comes after its parent.
    parents : (J,) int64
        Numbers of joints; -1 for the first, which carries all.
    heads : (J, 3) float64
        Where joints turn, at rest, body frame [m].
    bones : tuple of (V, 4) uint16
        For each part of the model: the joints that move its vertices.
    weights : tuple of (V, 4) float32
        Of these joints; sums are 1.
    points : tuple of RigPoint
        Keypoints.
    legs : {2, 4}
        Number of legs that it walks on: 2 as people do, 4 as animals do.
    arms_out : float
        Tangent of the angle from which straight arms hang down at least, off the clothes.

    Raises
    ------
    AssetError
        If a joint comes before its parent, or a bone or a point names no joint.
    """

    names: tuple[str, ...]
    parents: NDArray[np.int64]
    heads: NDArray[np.float64]
    bones: tuple[NDArray[np.uint16], ...]
    weights: tuple[NDArray[np.float32], ...]
    points: tuple[RigPoint, ...] = ()
    legs: Literal[2, 4] = 2
    arms_out: float = 0.0

    def __post_init__(self) -> None:
        count = len(self.names)
        before = np.asarray(self.parents) < np.arange(count)
        if len(self.parents) != count or self.heads.shape != (count, 3) or not before.all():
            raise AssetError("rig", "each joint needs a place and a parent that comes before it")
        if any(bones.size and int(bones.max()) >= count for bones in self.bones):
            raise AssetError("rig", "a bone is not among its joints")
        if any(not 0 <= point.joint < count for point in self.points):
            raise AssetError("rig", "a point is not on one of its joints")
        self.parents.flags.writeable = self.heads.flags.writeable = False
        for bones, weights in zip(self.bones, self.weights, strict=True):
            bones.flags.writeable = weights.flags.writeable = False

    @cached_property
    def skin(self) -> tuple[NDArray[np.uint16], NDArray[np.float32]]:
        """(V, 4) uint16 and float32: `bones` and `weights` of all parts, one after another."""
        bones = np.concatenate([np.zeros((0, 4), np.uint16), *self.bones])
        weights = np.concatenate([np.zeros((0, 4), np.float32), *self.weights])
        bones.flags.writeable = weights.flags.writeable = False
        return bones, weights

    @cached_property
    def joint_of(self) -> dict[str, int]:
        """Numbers of joints by their names."""
        return {name: number for number, name in enumerate(self.names)}

    def head(self, name: str) -> NDArray[np.float64]:
        """Return (3,): where a joint turns, at rest [m]."""
        found: NDArray[np.float64] = self.heads[self.joint_of[name]]
        return found
