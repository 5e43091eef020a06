"""How rigid instances move between two pictures whose rows have instants of their own.

Row v of the one picture saw X, in its camera's frame, at the instant t(v). In axes that the
instance carries along it is at O = W(t)⁻¹ world_from_camera(t) X. Row v' of the other picture sees
it at camera'_from_world(t') W'(t') O, with t' = t'(v'): the row v' in which its place lies is found
by the kernel, by repeating. Instances that stand still throughout share one group, whose axes are
the world's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.motion.rigid_motion import MotionTable, ObservedPoses, matched
from sailenv_ros.native.motion_kernels import RowMotions
from sailenv_ros.types.geometry import invert

__all__ = ["rolling_table"]

_UNKNOWN, _SKY, _STILL, _FIRST = 0, 1, 2, 3


def rolling_table(begin: ObservedPoses, end: ObservedPoses) -> MotionTable:
    """Compute how what the one picture shows has moved in the other.

    Parameters
    ----------
    begin, end : ObservedPoses
        Of which one or both have poses by rows.
    """
    rows, others, deforming = matched(begin, end)
    ids = begin.ids[rows]
    first, last = begin.world_from_instance[rows], end.world_from_instance[others]
    moves = (first != last).any(axis=(1, 2))
    for poses in (begin, end):
        if poses.rows is not None:
            moves |= np.isin(ids, poses.rows.ids)
    moves |= np.isin(ids, deforming)
    moving = np.flatnonzero(moves)
    group_of_instance = np.zeros(65536, np.uint16)
    group_of_instance[ids] = _STILL
    group_of_instance[ids[moving]] = np.arange(len(moving)) + _FIRST
    group_of_instance[0] = _SKY
    seen, stands = _world_from_camera(begin), _world_from_camera(end)
    sees = invert(stands)
    groups = _FIRST + len(moving)
    own_from_rows = np.zeros((groups, len(seen), 4, 4))
    rows_from_own = np.zeros((groups, len(sees), 4, 4))
    own_from_rows[[_SKY, _STILL]] = np.swapaxes(seen, 1, 2)
    rows_from_own[[_SKY, _STILL]] = np.swapaxes(sees, 1, 2)
    for group, row in enumerate(moving.tolist(), start=_FIRST):
        then = _world_from_instance(begin, int(ids[row]), first[row])
        now = _world_from_instance(end, int(ids[row]), last[row])
        own_from_rows[group] = np.swapaxes(invert(then) @ seen, 1, 2)
        rows_from_own[group] = np.swapaxes(sees @ now, 1, 2)
    is_still = bool((seen == seen[0]).all() and (stands == stands[0]).all())
    is_still &= np.array_equal(begin.camera.world_from_camera, end.camera.world_from_camera)
    at_rest = np.zeros(groups, np.bool_)
    at_rest[[_SKY, _STILL]] = is_still
    if not is_still and end.camera.intrinsics.is_parallel:
        group_of_instance[0] = _UNKNOWN  # see `motion_table`
    return MotionTable(
        row_of_instance=group_of_instance,
        motions=np.zeros((groups, 3, 4)),
        by_rows=RowMotions(own_from_rows, rows_from_own, at_rest),
        deforming_ids=deforming,
        _camera=begin.camera,
        _first=first,
        _last=last,
    )


def _world_from_camera(poses: ObservedPoses) -> NDArray[np.float64]:
    """Return (H, 4, 4): where the camera of each row stood."""
    if poses.rows is not None:
        return poses.rows.world_from_camera
    height = poses.camera.intrinsics.height
    return np.broadcast_to(poses.camera.world_from_camera, (height, 4, 4))


def _world_from_instance(
    poses: ObservedPoses, instance_id: int, otherwise: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (H, 4, 4), or (4, 4) of what stood still."""
    return otherwise if poses.rows is None else poses.rows.of_instance(instance_id, otherwise)
