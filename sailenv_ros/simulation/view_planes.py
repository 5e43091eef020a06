"""The planes between what a camera sees and what it does not.

A `Camera` in, planes out; knows no simulation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera

__all__ = ["view_planes"]


def view_planes(camera: Camera, distance_m: float) -> NDArray[np.float64]:
    """Return the six planes around what a camera sees.

    Parameters
    ----------
    camera : Camera
    distance_m : float
        Depth of the farthest plane [m].

    Returns
    -------
    planes : (6, 4) float64
        (a, b, c, d) each, in the world frame: a point (x, y, z) is seen where
        a x + b y + c z + d > 0 for all; (a, b, c) is a unit vector.
    """
    intrinsics = camera.intrinsics
    (left, top), (right, bottom) = intrinsics.border()
    optical = np.array(
        [
            (1.0, 0.0, -left),
            (-1.0, 0.0, right),
            (0.0, 1.0, -top),
            (0.0, -1.0, bottom),
            (0.0, 0.0, 1.0),
            (0.0, 0.0, -1.0),
        ]
    )
    sides_m = np.zeros(6)
    if intrinsics.is_parallel:
        sides_m[:4], optical[:4, 2] = optical[:4, 2], 0.0
    optical /= np.linalg.norm(optical, axis=1, keepdims=True)
    normals = optical @ camera.world_from_camera[:3, :3].T
    offsets = sides_m - normals @ np.asarray(camera.pose.position_m)
    offsets[4] -= intrinsics.near_m
    offsets[5] += distance_m
    return np.column_stack([normals, offsets])
