"""Lights and lenses by the few numbers that other programs know."""

from __future__ import annotations

import math

from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import QUAT_BODY_FROM_OPTICAL, Pose, facing
from sailenv_ros.types.lights import Light

__all__ = ["light_pose", "looking_back", "point_intensity", "view_angles"]

_UPSIDE_DOWN = (1.0, 0.0, 0.0, 0.0)


def point_intensity(light: Light) -> tuple[tuple[float, float, float], float]:
    """Return a light's colour, at most 1, and its intensity as a light without extent.

    Returns
    -------
    colour : (3,) tuple of float
    intensity : float
        Irradiance [W/m²] of a directional light, radiant intensity [W/sr] of others.
    """
    area = light.width_m * light.height_m if light.type == "area" else 1.0
    peak = max(light.colour)
    if peak <= 0.0:
        return (1.0, 1.0, 1.0), 0.0
    red, green, blue = (channel / peak for channel in light.colour)
    return (red, green, blue), light.intensity * peak * area


def view_angles(lens: CameraIntrinsics) -> tuple[float, float]:
    """Return the angles across and down [rad] of the pin-hole with a lens's focal length."""
    across = 2.0 * math.atan2(0.5 * lens.width, lens.fx)
    return across, 2.0 * math.atan2(0.5 * lens.height, lens.fy)


def light_pose(light: Light) -> Pose:
    """Return where a light is, with its x axis along its direction."""
    pose = Pose(light.position_m)
    if light.type == "point":
        return pose
    x, y, z = (a + b for a, b in zip(light.position_m, light.direction, strict=True))
    return facing(pose, (x, y, z))


def looking_back(pose: Pose) -> Pose:
    """Turn a pose that looks along its x into one that looks along its -z, with y up.

    So cameras and lights look in glTF, USD and MuJoCo.
    """
    return pose.turned(QUAT_BODY_FROM_OPTICAL).turned(_UPSIDE_DOWN)
