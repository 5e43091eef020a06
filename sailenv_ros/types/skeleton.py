"""Joints and keypoints of a person or an animal at one instant, in the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = ["COCO_KEYPOINTS", "COCO_SKELETON", "Skeleton"]

_SIDED = ("eye", "ear", "shoulder", "elbow", "wrist", "hip", "knee", "ankle")

COCO_KEYPOINTS: tuple[str, ...] = (
    "nose",
    *(f"{side} {name}" for name in _SIDED for side in ("left", "right")),
)
"""The 17 keypoints of COCO, in its order, as `Skeleton.point_names` has them."""

COCO_SKELETON: tuple[tuple[int, int], ...] = (
    (16, 14), (14, 12), (17, 15), (15, 13), (12, 13), (6, 12), (7, 13), (6, 7), (6, 8), (7, 9),
    (8, 10), (9, 11), (2, 3), (1, 2), (1, 3), (2, 4), (3, 5), (4, 6), (5, 7),
)  # fmt: skip
"""Pairs of keypoints that lines join, counted from 1, as COCO's files have them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Skeleton:
    """Joints and keypoints of one instance.

    Attributes
    ----------
    joint_names : (J,) tuple of str
    parents : (J,) int64
        Of joints; -1 for the root.
    world_from_joint : (J, 3, 4) float64
        Pose of each joint, whose axes at rest are those of the body frame [-, m].
    point_names : (P,) tuple of str
        `COCO_KEYPOINTS` of a person, none of an animal.
    points : (P, 3) float64
        World frame [m].

    Raises
    ------
    InvalidRequest
        If the arrays do not fit each other, a number is not finite, or a joint comes before its
        parent.
    """

    joint_names: tuple[str, ...]
    parents: NDArray[np.int64]
    world_from_joint: NDArray[np.float64]
    point_names: tuple[str, ...]
    points: NDArray[np.float64]

    def __post_init__(self) -> None:
        joints, points = len(self.joint_names), len(self.point_names)
        shapes = self.parents.shape, self.world_from_joint.shape, self.points.shape
        wanted = (joints,), (joints, 3, 4), (points, 3)
        if shapes != wanted:
            raise InvalidRequest("arrays of a skeleton", shapes, f"of the shapes {wanted}")
        if not (np.isfinite(self.world_from_joint).all() and np.isfinite(self.points).all()):
            raise InvalidRequest("skeleton", "a number that is not finite", "finite numbers")
        if not ((self.parents >= -1) & (self.parents < np.arange(joints))).all():
            raise InvalidRequest("parents of joints", self.parents, "joints that come before")

    @property
    def joints(self) -> NDArray[np.float64]:
        """(J, 3) float64: places of the joints, world frame [m]."""
        return self.world_from_joint[:, :, 3]
