"""The kernels of motion: where surface points are in another picture, and in other axes.

Where the transforms come from stands in `motion.motion_tables`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked

__all__ = ["MovedPoints", "move_points", "transform_points"]

_MOVE = Kernel(
    "motion",
    *("integer", "integer", "integer", "array", "array", "array", "array", "array", "integer"),
    *("array", "array", "array", "array", "integer", "integer", "number"),
    *("array", "array", "array", "array", "array"),
)
_TRANSFORM = Kernel(
    "transform_points",
    *("integer", "integer", "integer", "array", "array", "array", "array", "integer"),
    *("array", "array"),
)


class MovedPoints(NamedTuple):
    """What `move_points` finds for each pixel.

    Attributes
    ----------
    flow : (H, W, 2) float32
        From the pixel to the point's place in the other picture [px]; nan where it has none.
    scene_flow : (H, W, 3) float32
        What the displacements say [m]; nan where there is no surface or no motion.
    valid : (H, W) bool
        Where the point is in front of the other camera.
    occluded : (H, W) bool
        Where it is within the other picture, which shows something else there.
    out_of_view : (H, W) bool
        Where it is not within the other picture.
    """

    flow: NDArray[np.float32]
    scene_flow: NDArray[np.float32]
    valid: NDArray[np.bool_]
    occluded: NDArray[np.bool_]
    out_of_view: NDArray[np.bool_]


def move_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    motions: NDArray[np.float64],
    displacements: NDArray[np.float64],
    from_lens: NDArray[np.float64],
    to_lens: NDArray[np.float64],
    to_depth: NDArray[np.float32],
    to_instance: NDArray[np.uint16],
    tolerance: float,
    *,
    threads: int,
) -> MovedPoints:
    """Find where the surface points of one picture are in another one.

    Parameters
    ----------
    depth, instance : (H, W) float32, uint16
        Views of the one picture: depth along the optical axis [m], ``inf`` where nothing was hit,
        ``nan`` where it is not known; instance ids.
    row_of_instance : (65536,) uint16
        Row of each instance in `motions` and `displacements`; 0 for what has no motion, or beyond.
    motions : (R, 3, 4) float64
        T - 1: where a point of the one camera's frame is in the other's, less the point.
    displacements : (R, 3, 4) float64
        The same for the displacement that `scene_flow` tells of.
    from_lens, to_lens : (5,) float64
        Focal length and principal point x, y [px]; near and far [m].
    to_depth, to_instance : (H', W') float32, uint16
        The other picture's views.
    tolerance : float
        Share of its depth by which a hidden point lies behind what is seen.
    threads : int

    Returns
    -------
    points : MovedPoints
        Fresh arrays.

    Raises
    ------
    InvalidRequest
        If an array has another type or shape.
    NativeLibraryError
        If there is no library.
    """
    height, width = depth.shape
    checked("depth", depth, np.float32, (height, width))
    checked("instance", instance, np.uint16, (height, width))
    checked("row_of_instance", row_of_instance, np.uint16, (65536,))
    checked("motions", motions, np.float64, (None, 3, 4))
    checked("displacements", displacements, np.float64, (len(motions), 3, 4))
    checked("from_lens", from_lens, np.float64, (5,))
    checked("to_lens", to_lens, np.float64, (5,))
    checked("to_depth", to_depth, np.float32, (None, None))
    checked("to_instance", to_instance, np.uint16, to_depth.shape)
    result = MovedPoints(
        flow=np.empty((height, width, 2), np.float32),
        scene_flow=np.empty((height, width, 3), np.float32),
        valid=np.empty((height, width), np.bool_),
        occluded=np.empty((height, width), np.bool_),
        out_of_view=np.empty((height, width), np.bool_),
    )
    _MOVE(
        *(threads, height, width, depth, instance, row_of_instance),
        *(motions, displacements, len(motions), from_lens, to_lens),
        *(to_depth, to_instance, *to_depth.shape, tolerance, *result),
    )
    return result


def transform_points(
    depth: NDArray[np.float32],
    instance: NDArray[np.uint16],
    row_of_instance: NDArray[np.uint16],
    transforms: NDArray[np.float64],
    lens: NDArray[np.float64],
    *,
    threads: int,
) -> NDArray[np.float32]:
    """Return each pixel's surface point in other axes.

    Parameters
    ----------
    depth, instance, row_of_instance, lens
        As `move_points` takes them.
    transforms : (R, 3, 4) float64
        Other axes from the camera's optical frame, for each instance.
    threads : int

    Returns
    -------
    points : (H, W, 3) float32
        A fresh array; nan where there is no surface, or no row for it.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `move_points`.
    """
    height, width = depth.shape
    checked("depth", depth, np.float32, (height, width))
    checked("instance", instance, np.uint16, (height, width))
    checked("row_of_instance", row_of_instance, np.uint16, (65536,))
    checked("transforms", transforms, np.float64, (None, 3, 4))
    checked("lens", lens, np.float64, (5,))
    points = np.empty((height, width, 3), np.float32)
    _TRANSFORM(
        *(threads, height, width, depth, instance, row_of_instance),
        *(transforms, len(transforms), lens, points),
    )
    return points
