"""Lights and cameras in glTF's words.

KHR_lights_punctual counts in candela and lux, of which 683 are one watt, as the importer does.
"""

from __future__ import annotations

import math
from typing import Any

from sailenv_ros.scene_export.optics import point_intensity, view_angles
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.lights import LAMP_TYPES, LUMENS_PER_WATT, Light

__all__ = ["LIGHTS", "gltf_camera", "gltf_light"]

LIGHTS = "KHR_lights_punctual"

_NARROWEST_EDGE = 1e-3
"""Least difference between the two cones of a spot [rad]."""


def gltf_light(light: Light) -> dict[str, Any]:
    """Return a light of KHR_lights_punctual; an area is a spot of the same power in front of it."""
    colour, intensity = point_intensity(light)
    kind = "spot" if light.type == "area" else light.type
    entry: dict[str, Any] = {
        "name": light.name,
        "type": kind,
        "color": list(colour),
        "intensity": intensity * LUMENS_PER_WATT,
    }
    if light.type in LAMP_TYPES:
        entry["range"] = light.range_m
    if light.type == "area":
        entry["spot"] = {"innerConeAngle": 0.0, "outerConeAngle": 0.5 * math.pi}
    if light.type == "spot":
        outer = max(math.radians(light.outer_cone_deg), 2.0 * _NARROWEST_EDGE)
        inner = min(math.radians(light.inner_cone_deg), outer - _NARROWEST_EDGE)
        entry["spot"] = {"innerConeAngle": inner, "outerConeAngle": outer}
    return entry


def gltf_camera(lens: CameraIntrinsics) -> dict[str, Any]:
    """Return a camera of the same focal length, or of the same size where rays are parallel."""
    near, far = lens.near_m, lens.far_m
    if lens.is_parallel:
        size = {"xmag": 0.5 * lens.width / lens.fx, "ymag": 0.5 * lens.height / lens.fy}
        return {"type": "orthographic", "orthographic": {**size, "znear": near, "zfar": far}}
    across, down = view_angles(lens)
    shape = {"aspectRatio": math.tan(0.5 * across) / math.tan(0.5 * down), "yfov": down}
    return {"type": "perspective", "perspective": {**shape, "znear": near, "zfar": far}}
