"""The planes between what a camera sees and what it does not.

A `Camera` in, planes out; knows no simulation.
"""

from __future__ import annotations

import math

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
    up = math.radians(intrinsics.vertical_fov_deg) / 2.0
    side = math.atan(math.tan(up) * intrinsics.width / intrinsics.height)
    body = np.array(
        [
            (math.sin(side), -math.cos(side), 0.0),
            (math.sin(side), math.cos(side), 0.0),
            (math.sin(up), 0.0, -math.cos(up)),
            (math.sin(up), 0.0, math.cos(up)),
            (1.0, 0.0, 0.0),
            (-1.0, 0.0, 0.0),
        ]
    )
    normals = body @ camera.pose.matrix()[:3, :3].T
    offsets = -normals @ np.asarray(camera.pose.position_m)
    offsets[4] -= intrinsics.near_m
    offsets[5] += distance_m
    return np.column_stack([normals, offsets])
