"""Lights as UsdLux and cameras as UsdGeomCamera.

UsdLux counts in nits; here one nit is one W/(m² sr), for emission too, so that all is right but for
one factor. Pixar, "UsdLux: USD Lighting Schema", and "UsdGeomCamera".
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from sailenv_ros.scene_export.contents import ExportedCamera
from sailenv_ros.scene_export.extras import camera_extras
from sailenv_ros.scene_export.optics import light_pose, looking_back, point_intensity
from sailenv_ros.scene_export.usd_geometry import write_place
from sailenv_ros.scene_export.usd_text import UsdText, number, quoted, vector
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.light_shapes import LAMP_RADIUS_M
from sailenv_ros.types.lights import Environment, Light

__all__ = ["write_camera", "write_light", "write_sky"]

APERTURE = 0.20955
"""Width of a sensor in tenths of a metre, UsdGeomCamera's own default in millimetres."""


def write_light(text: UsdText, light: Light, name: str) -> None:
    """Write a light."""
    colour, intensity = point_intensity(light)
    metadata = {"displayName": quoted(light.name)}
    kinds = {"directional": "DistantLight", "area": "RectLight"}
    schemas = ["ShapingAPI"] if light.type == "spot" else []
    with text.prim(kinds.get(light.type, "SphereLight"), name, schemas=schemas, metadata=metadata):
        text.attribute("color3f", "inputs:color", vector(colour))
        if light.type == "directional":
            text.attribute("float", "inputs:angle", "0.53")
            # Normalised, its intensity is the irradiance.
            text.attribute("bool", "inputs:normalize", "1")
        elif light.type == "area":
            intensity /= light.width_m * light.height_m
            text.attribute("float", "inputs:width", number(light.width_m))
            text.attribute("float", "inputs:height", number(light.height_m))
            half = (0.5 * light.width_m, 0.5 * light.height_m)
            corners = (vector((-half[0], -half[1], 0.0)), vector((*half, 0.0)))
            text.attribute("float3[]", "extent", f"[{', '.join(corners)}]")
        else:
            intensity /= math.pi * LAMP_RADIUS_M**2
            text.attribute("float", "inputs:radius", number(LAMP_RADIUS_M))
            ball = (vector([-LAMP_RADIUS_M] * 3), vector([LAMP_RADIUS_M] * 3))
            text.attribute("float3[]", "extent", f"[{', '.join(ball)}]")
        if light.type == "spot":
            soft = 1.0 - light.inner_cone_deg / max(light.outer_cone_deg, 1e-6)
            text.attribute("float", "inputs:shaping:cone:angle", number(light.outer_cone_deg))
            text.attribute("float", "inputs:shaping:cone:softness", number(soft))
        text.attribute("float", "inputs:intensity", number(intensity))
        write_place(text, looking_back(light_pose(light)))


def write_sky(text: UsdText, environment: Environment, name: str) -> None:
    """Write sky and ambient light as a dome of one colour."""
    with text.prim("DomeLight", name):
        zenith, horizon, ground = (
            environment.sky_zenith,
            environment.sky_horizon,
            environment.sky_ground,
        )
        colour = [
            own + environment.sky_share * 0.5 * (low + 0.45 * middle + 0.55 * high)
            for own, low, middle, high in zip(
                environment.ambient, ground, horizon, zenith, strict=True
            )
        ]
        text.attribute("color3f", "inputs:color", vector(colour))
        text.attribute("float", "inputs:intensity", "1")


def write_camera(
    text: UsdText, camera: ExportedCamera, name: str, samples: Mapping[float, Pose]
) -> None:
    """Write a camera of a lens's focal length and principal point, and its poses by time codes."""
    lens = camera.intrinsics
    # An orthographic aperture is the width that is seen.
    width = 10.0 * lens.width / lens.fx if lens.is_parallel else APERTURE
    height = width * (lens.height / lens.fy) / (lens.width / lens.fx)
    entries = camera_extras(lens)
    distortion = ", ".join(number(value) for value in entries.pop("distortion"))
    model = entries.pop("distortion_model")
    told = [f"{kind(value)} {key} = {number(value)}" for key, value in entries.items()]
    told.append(f"string distortion_model = {quoted(model)}")
    if distortion:
        told.append(f"double[] distortion = [{distortion}]")
    metadata = {
        "customData": "{ dictionary sailenv = { " + "; ".join(told) + " } }",
        "displayName": quoted(camera.name),
    }
    with text.prim("Camera", name, metadata=metadata):
        text.attribute("float2", "clippingRange", vector((lens.near_m, lens.far_m)))
        if lens.is_parallel:
            text.attribute("token", "projection", quoted("orthographic"))
        else:
            text.attribute("float", "focalLength", number(width * lens.fx / lens.width))
            text.attribute("token", "projection", quoted("perspective"))
        text.attribute("float", "horizontalAperture", number(width))
        text.attribute("float", "verticalAperture", number(height))
        # The window moves away from where the axis is seen.
        across = -lens.cx_offset_px / lens.width * width
        down = lens.cy_offset_px / lens.height * height
        text.attribute("float", "horizontalApertureOffset", number(across))
        text.attribute("float", "verticalApertureOffset", number(down))
        write_place(text, looking_back(camera.pose), samples=samples)


def kind(value: object) -> str:
    """Return USD's type of a number."""
    return "int" if isinstance(value, int) else "double"
