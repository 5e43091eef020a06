"""Recorded motion of a skeleton of joints, in the unit and the axes of its file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError

__all__ = ["MotionClip"]

Doubles = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class MotionClip:
    """Turns of joints in frames of equal length; arrays are read-only.

    Attributes
    ----------
    name : str
        Of its file.
    joint_names : (J,) tuple of str
        A joint comes after its parent; ends of bones are joints, too.
    parents : (J,) int64
        -1 for the first, which carries all.
    offsets : (J, 3) float64
        From the parent, at rest, in the unit of the file.
    turns : (F, J, 3, 3) float64
        From the axes of the joint to those of its parent; at rest all axes agree.
    roots : (F, 3) float64
        Where the first joint is, in the unit of the file.
    frame_s : float
        Time from a frame to the next [s].

    Raises
    ------
    AssetError
        If the arrays do not fit each other, or hold a number that is not finite.
    """

    name: str
    joint_names: tuple[str, ...]
    parents: NDArray[np.int64]
    offsets: Doubles
    turns: Doubles
    roots: Doubles
    frame_s: float

    def __post_init__(self) -> None:
        joints, frames = len(self.joint_names), len(self.roots)
        shapes = self.offsets.shape, self.turns.shape, self.roots.shape
        if shapes != ((joints, 3), (frames, joints, 3, 3), (frames, 3)) or not frames:
            raise AssetError(self.name, "its joints and its frames do not fit each other")
        if not ((self.parents >= -1) & (self.parents < np.arange(joints))).all():
            raise AssetError(self.name, "a joint comes before its parent")
        for array in (self.offsets, self.turns, self.roots):
            if not np.isfinite(array).all():
                raise AssetError(self.name, "a number is not finite")
            array.flags.writeable = False

    @property
    def duration_s(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self.roots) - 1) * self.frame_s

    @cached_property
    def rest(self) -> Doubles:
        """(J, 3): where joints are at rest, from the first one."""
        places = np.zeros((len(self.joint_names), 3))
        for number, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                places[number] = places[parent] + self.offsets[number]
        return places

    def in_world(self) -> tuple[Doubles, Doubles]:
        """Return (F, J, 3, 3) turns and (F, J, 3) places of the joints, in the file's axes."""
        turns, places = np.empty_like(self.turns), np.empty(self.turns.shape[:3])
        for number, parent in enumerate(self.parents.tolist()):
            if parent < 0:
                turns[:, number], places[:, number] = self.turns[:, number], self.roots
                continue
            turns[:, number] = turns[:, parent] @ self.turns[:, number]
            places[:, number] = places[:, parent] + turns[:, parent] @ self.offsets[number]
        return turns, places
