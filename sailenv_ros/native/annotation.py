"""The kernel of ground truth: from depth and instance ids to the annotated views.

What the views are and where the motions come from stands in `render.annotate`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["annotate_pixels"]

_KERNEL = Kernel(
    "annotate",
    *("integer", "integer", "integer", "array", "array", "array", "array", "integer", "array"),
    *("number", "number", "array", "integer", "integer"),
    *("array", "array", "array", "array", "array", "array"),
)
_OUTPUTS: dict[str, tuple[Any, tuple[int, ...]]] = {
    "depth": (np.float32, ()),
    "category": (np.uint8, ()),
    "instance": (np.uint16, ()),
    "flow": (np.float32, (2,)),
    "flow_valid": (np.bool_, ()),
    "occlusion": (np.bool_, ()),
}


def annotate_pixels(
    surface: NDArray[np.float32],
    category_of_instance: NDArray[np.uint8],
    row_of_instance: NDArray[np.uint16],
    motions: NDArray[np.float64],
    lens: NDArray[np.float64],
    dt_s: float,
    tolerance: float,
    past_depth: NDArray[np.float32] | None,
    views: Mapping[str, NDArray[Any]],
    *,
    threads: int,
) -> None:
    """Fill in the views.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id;
        what is no id from 0 to 65535 counts as 0.
    category_of_instance : (65536,) uint8
    row_of_instance : (65536,) uint16
        Row in `motions` of each instance; 0 for what has no past, or beyond the rows.
    motions : (R, 3, 4) float64
        T - 1 of each: where a point of the camera's frame was in the previous one, less the point.
    lens : (5,) float64
        Focal length and principal point x, y [px]; near and far [m].
    dt_s : float
        From the previous frame to this one [s], more than 0.
    tolerance : float
        Share of its depth by which a hidden point lies behind what was seen.
    past_depth : (H', W') float32 or None
        The previous frame's; None: everything counts as hidden.
    views : mapping of str to array
        What to fill in: ``depth`` (H, W) float32, and any of ``category`` uint8, ``instance``
        uint16, ``flow`` (H, W, 2) float32, ``flow_valid`` and ``occlusion`` bool.
    threads : int

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library.
    """
    height, width = surface.shape[:2]
    checked("surface", surface, np.float32, (height, width, 2))
    checked("category_of_instance", category_of_instance, np.uint8, (65536,))
    checked("row_of_instance", row_of_instance, np.uint16, (65536,))
    checked("motions", motions, np.float64, (None, 3, 4))
    checked("lens", lens, np.float64, (5,))
    past_height = past_width = 0
    if past_depth is not None:
        checked("past_depth", past_depth, np.float32, (None, None))
        past_height, past_width = past_depth.shape
    for name, array in views.items():
        dtype, channels = _OUTPUTS[name]
        checked(name, array, dtype, (height, width, *channels))
    _KERNEL(
        *(threads, height, width, surface, category_of_instance, row_of_instance),
        *(motions, len(motions), lens, float(lens[0]) / dt_s, tolerance),
        *(past_depth, past_height, past_width),
        *(views.get(name) for name in _OUTPUTS),
    )
