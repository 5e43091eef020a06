"""The view `measured_depth`: what an agent's depth sensor makes of the surfaces that it sees."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.picture.sensor import sensor_seed
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.depth_sensor_names import IDEAL
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["MEASURED_FROM", "measured_depth"]

MEASURED_FROM = frozenset({"normals", "albedo", "metallic_roughness"})
"""Views that a measurement needs besides the depth."""


def measured_depth(
    views: Mapping[str, NDArray[Any]], snapshot: WorldSnapshot, camera: Camera
) -> NDArray[np.float32]:
    """Measure depth.

    Parameters
    ----------
    views : mapping of str to array
        With ``depth`` and `MEASURED_FROM`.
    snapshot, camera
        As `RenderBackend.render` takes them. The camera's name and the instant are the seed.

    Returns
    -------
    depth : (H, W) float32
        See `VIEWS`. A new array.
    """
    name, depth = camera.picture.depth_sensor, views["depth"]
    if name == IDEAL:
        return np.where(np.isfinite(depth), depth, np.float32(np.nan))
    # Files of sensors are read by a library whose import takes longer than many frames.
    from sailenv_ros.render.depth_sensors import Surfaces, depth_sensor

    surfaces = Surfaces(
        lens=camera.intrinsics,
        depth=depth,
        normals=views["normals"],
        albedo=views["albedo"],
        metallic_roughness=views["metallic_roughness"],
    )
    seed = sensor_seed(f"{camera.name}/depth", snapshot.sim_time_ns)
    return depth_sensor(name).measure(surfaces, seed)
