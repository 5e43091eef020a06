"""The kernel that turns a frame's views into the arrays of the SAILenv client's dict.

What the dict holds stands in `agent.frame_dict`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["convert_views"]

_KERNEL = Kernel(
    "client_views",
    *("integer", "integer", "array", "array", "number", "number"),
    *("array", "array", "array", "integer", "array", "array"),
)


def convert_views(
    views: Mapping[str, NDArray[Any]],
    *,
    near_m: float,
    range_m: float,
    colours: NDArray[np.uint32],
    threads: int,
) -> dict[str, NDArray[Any]]:
    """Convert those of three views that there are.

    Parameters
    ----------
    views : mapping of str to array
        ``depth`` (H, W) float32 [m], ``instance`` (H, W) uint16, ``flow``
        (H, W, 2) float32 [px/s]: what is NaN in it becomes 0, in its place. Others are left alone.
    near_m, range_m : float
        Depths that are shown as 255 and as 0 [m].
    colours : (N,) uint32
        Blue, green and red of each instance id, and a byte without meaning; larger ids have the
        last colour.
    threads : int

    Returns
    -------
    arrays : dict of str to array
        ``grey`` (H, W) uint8; ``object`` (H, W, 3) uint8 BGR; ``flow_valid`` (H, W) bool: fresh
        arrays.

    Raises
    ------
    InvalidRequest
        If an array has another type, shape or size than the others.
    NativeLibraryError
        If there is no library.
    """
    size = next((array.shape[:2] for array in views.values()), (0, 0))
    made: dict[str, NDArray[Any]] = {}
    pointers: list[NDArray[Any] | None] = []
    for name, dtype, channels, target, target_dtype, target_channels in (
        ("depth", np.float32, (), "grey", np.uint8, ()),
        ("instance", np.uint16, (), "object", np.uint8, (3,)),
        ("flow", np.float32, (2,), "flow_valid", np.bool_, ()),
    ):
        if name not in views:
            pointers += [None, None]
            continue
        pointers.append(checked(name, views[name], dtype, (*size, *channels)))
        made[target] = np.empty((*size, *target_channels), target_dtype)
        pointers.append(made[target])
    checked("colours", colours, np.uint32, (None,))
    depth, grey, ids, coloured, flow, valid = pointers
    _KERNEL(
        *(threads, size[0] * size[1], depth, grey),
        *(range_m, 255.0 / (range_m - near_m), ids, coloured, colours, len(colours), flow, valid),
    )
    return made
