"""How each instance has moved between two moments, as seen by a camera: tables for the kernels.

A surface point at X in the optical frame of the camera c at one moment belongs to an instance of
pose W (world_from_instance). At another moment, with camera c' and pose W', it is at

    T X,    T = camera'_from_world  W'  W⁻¹  world_from_camera

in that camera's optical frame, and has been displaced in the world by W' W⁻¹ - 1. Tables hold
D = T - 1 and the displacement in the axes of c, so that both are exactly 0 where nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.motion.moments import Moment
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.instance_states import InstanceStates

__all__ = ["MotionTables", "common_rows", "lens_numbers", "motion_tables"]

_SKY_ROW = 1
_FIRST_ROW = 2


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class MotionTables:
    """What the kernels take.

    Attributes
    ----------
    row_of_instance : (65536,) uint16
        Row of each instance id; 0 for what has no motion. Id 0 is the background's.
    motions, displacements : (R, 3, 4) float64
    """

    row_of_instance: NDArray[np.uint16]
    motions: NDArray[np.float64]
    displacements: NDArray[np.float64]


def common_rows(
    one: InstanceStates, other: InstanceStates
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the rows of instances that there are in both, with one history."""
    _, rows, others = np.intersect1d(one.ids, other.ids, assume_unique=True, return_indices=True)
    same = one.histories[rows] == other.histories[others]
    return rows[same], others[same]


def motion_tables(begin: Moment, end: Moment) -> MotionTables:
    """Compute how what one moment's camera sees has moved at the other."""
    rows, others = common_rows(begin.states, end.states)
    row_of_instance = np.zeros(65536, np.uint16)
    row_of_instance[0] = _SKY_ROW
    row_of_instance[begin.states.ids[rows]] = np.arange(len(rows)) + _FIRST_ROW
    motions = np.zeros((_FIRST_ROW + len(rows), 3, 4))
    displacements = np.zeros_like(motions)
    world_from_camera = begin.camera.world_from_camera
    to_camera = end.camera.camera_from_world
    same_camera = np.array_equal(begin.camera.camera_from_world, to_camera)
    if not same_camera:
        turn = to_camera[:3, :3] @ world_from_camera[:3, :3]
        motions[_SKY_ROW, :, :3] = turn - np.eye(3)
        # Of what stands still, which is most, the camera's motion is all.
        motions[_FIRST_ROW:] = (to_camera @ world_from_camera)[:3] - np.eye(4)[:3]
    first, last = begin.states.matrices[rows], end.states.matrices[others]
    moves = np.flatnonzero((first != last).any(axis=(1, 2)))
    if len(moves):
        carried = last[moves] @ invert(first[moves])
        chain = (to_camera @ carried @ world_from_camera)[:, :3]
        motions[_FIRST_ROW + moves] = chain - np.eye(4)[:3]
        moved = (carried - np.eye(4)) @ world_from_camera
        axes = begin.camera.camera_from_world[:3, :3]
        displacements[_FIRST_ROW + moves] = axes @ moved[:, :3]
    return MotionTables(
        row_of_instance=row_of_instance, motions=motions, displacements=displacements
    )


def lens_numbers(camera: Camera) -> NDArray[np.float64]:
    """Return (5,) focal length and principal point [px], near and far [m]."""
    lens = camera.intrinsics
    return np.array([lens.fx, lens.cx, lens.cy, lens.near_m, lens.far_m])
