"""Facts of our own beside the words of a format, as plain JSON values."""

from __future__ import annotations

from typing import Any

from sailenv_ros.scene_export.contents import ExportedBody
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.labels import Instance

__all__ = ["body_extras", "camera_extras", "instance_extras"]


def instance_extras(instance: Instance) -> dict[str, Any]:
    """Return the labels of an instance."""
    return {
        "category": instance.category,
        "category_id": instance.category_id,
        "instance_id": instance.id,
        "asset": instance.asset,
    }


def body_extras(body: ExportedBody) -> dict[str, Any]:
    """Return how a body moves: whether physics moves it, its mass and its joint."""
    extras: dict[str, Any] = {"static": body.static}
    if not body.static:
        extras["mass_kg"] = body.mass_kg
    if body.joint is not None:
        joint = body.joint
        extras["joint"] = {"type": joint.type, "parent": joint.parent}
        if joint.type != "fixed":
            extras["joint"] |= {
                "axis": list(joint.axis),
                "origin_m": list(joint.origin_m),
                "limits": None if joint.limits is None else list(joint.limits),
                "position": joint.position,
            }
    return extras


def camera_extras(lens: CameraIntrinsics) -> dict[str, Any]:
    """Return a lens by all its numbers, of which formats know a few."""
    return {
        "width": lens.width,
        "height": lens.height,
        "fx": lens.fx,
        "fy": lens.fy,
        "cx": lens.cx,
        "cy": lens.cy,
        "distortion_model": lens.distortion_model,
        "distortion": list(lens.distortion),
    }
