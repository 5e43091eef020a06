"""`CameraIntrinsics` to and from the fields that `AgentInfo` and `SetIntrinsics` have for them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics

__all__ = ["INTRINSICS_FIELDS", "intrinsics_fields", "intrinsics_from_fields"]

INTRINSICS_FIELDS = (*INTRINSICS_LIMITS, "distortion_model", "distortion")
"""Names of the fields, which are those of the attributes."""

_ANY_FOV_DEG = 60.0
"""Told where the rays are parallel: a reader looks at the focal length."""


def intrinsics_fields(intrinsics: CameraIntrinsics) -> dict[str, Any]:
    """Return the values of the fields."""
    fields: dict[str, Any] = {
        name: getattr(intrinsics, name) if limits.whole else float(getattr(intrinsics, name))
        for name, limits in INTRINSICS_LIMITS.items()
    }
    return {
        **fields,
        "vertical_fov_deg": fields["vertical_fov_deg"] or _ANY_FOV_DEG,
        "distortion_model": intrinsics.distortion_model,
        "distortion": [*intrinsics.distortion],
    }


def intrinsics_from_fields(values: Mapping[str, Any]) -> CameraIntrinsics:
    """Read intrinsics.

    Raises
    ------
    InvalidRequest
        If a number is out of its range, or does not fit the rest.
    """
    given = {name: values[name] for name in INTRINSICS_FIELDS}
    return CameraIntrinsics(**{**given, "distortion": tuple(given["distortion"])})
