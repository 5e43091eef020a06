"""Bounds of the numbers that describe a camera's intrinsics."""

from __future__ import annotations

from collections.abc import Mapping

from sailenv_ros.types.picture_settings import MAX_SIZE_PX
from sailenv_ros.types.validation import Bounds

__all__ = ["INTRINSICS_LIMITS", "MIN_SIZE_PX", "PINHOLE_FOV"]

MIN_SIZE_PX = 8

_SIZE = Bounds(least=MIN_SIZE_PX, most=MAX_SIZE_PX, unit="px", whole=True)
_CLIP = Bounds(least=1e-3, most=1e4, unit="m")
_OFFSET = Bounds(least=-MAX_SIZE_PX / 2, most=MAX_SIZE_PX / 2, unit="px")
_FOCAL = Bounds(least=0.0, most=1e6, unit="px")

INTRINSICS_LIMITS: Mapping[str, Bounds] = {
    "width": _SIZE,
    "height": _SIZE,
    "vertical_fov_deg": Bounds(least=1.0, most=360.0, unit="deg"),
    "near_m": _CLIP,
    "far_m": _CLIP,
    "cx_offset_px": _OFFSET,
    "cy_offset_px": _OFFSET,
    "fx_px": _FOCAL,
    "fy_px": _FOCAL,
    "max_angle_deg": Bounds(least=0.0, most=180.0, unit="deg"),
}
"""Bounds of each number of `CameraIntrinsics`; what a model shows may have closer ones."""

PINHOLE_FOV = Bounds(least=1.0, most=170.0, unit="deg")
"""Bounds of the vertical angle of view without distortion."""
