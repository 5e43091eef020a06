"""Serialisation of poses, lights, waypoints and agents, as a scene file has them.

Data types in, entries of plain data out, with the keys that differ from the defaults. Poses are
rounded to a micrometre and to 0.00001 degrees, so that what people gave comes back as it was.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.scene.spec_cameras import AgentSpecModel
from sailenv_ros.scene.spec_lens import intrinsics_key
from sailenv_ros.scene.spec_surroundings import (
    AreaLightSpec,
    DirectionalLightSpec,
    LightSpec,
    PointLightSpec,
    SpotLightSpec,
)
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose, quat_xyzw_from_rpy_deg
from sailenv_ros.types.lights import Light
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.types.rigs import RigCamera

__all__ = [
    "MOTION_KEYS",
    "PLACE_KEYS",
    "VELOCITY_KEYS",
    "agent_entry",
    "body_entry",
    "camera_entries",
    "changed_light_entry",
    "lens_entry",
    "light_entry",
    "look_at_entry",
    "pose_entry",
    "rounded",
]

PLACE_KEYS = (
    "position",
    "rotation",
    "orientation",
    "look_at",
    "on",
    "level",
    "wall",
    "at",
    "height",
    "gap",
)
"""Keys that say where something is."""

VELOCITY_KEYS = ("velocity", "angular_velocity")
MOTION_KEYS = (*VELOCITY_KEYS, "behaviours")

LENGTH_DECIMALS = 6
ANGLE_DECIMALS = 5
UNIT_DECIMALS = 9

SAME_TURN = 2e-7
"""Quaternions whose components differ by no more mean the same."""

_LIGHTS: dict[str, type[SceneModel]] = {
    "directional": DirectionalLightSpec,
    "point": PointLightSpec,
    "spot": SpotLightSpec,
    "area": AreaLightSpec,
}


def pose_entry(pose: Pose) -> dict[str, Any]:
    """Return the keys of a pose: `position`, and `rotation` or `orientation` if it is turned.

    Angles are written where they give the very turn back; close to a pitch of 90° they do not,
    and the quaternion is written.
    """
    entry: dict[str, Any] = {"position": rounded(pose.position_m, LENGTH_DECIMALS)}
    angles = rounded(pose.rpy_deg, ANGLE_DECIMALS)
    given = np.asarray(pose.orientation_xyzw)
    again = np.asarray(quat_xyzw_from_rpy_deg(angles))
    if min(np.abs(given - again).max(), np.abs(given + again).max()) > SAME_TURN:
        entry["orientation"] = rounded(pose.orientation_xyzw, UNIT_DECIMALS)
    elif any(angles):
        entry["rotation"] = angles
    return entry


def light_entry(light: Light) -> dict[str, Any]:
    """Return the keys of a light; those that mean nothing to its type are left out."""
    values = _values(light)
    defaults = _LIGHTS[light.type].model_fields
    given = {key: values[key] for key in defaults if values[key] != defaults[key].default}
    return {"name": light.name, "type": light.type, **_plain(given)}


def changed_light_entry(spec: LightSpec, light: Light) -> dict[str, Any]:
    """Return the keys of a light that has an entry, whose unchanged keys stay as written."""
    before, now = _values(spec.to_light()), _values(light)
    if light.type != spec.type:
        return light_entry(light)
    entry: dict[str, Any] = spec.model_dump(mode="json", exclude_unset=True)
    changed = {key: now[key] for key in type(spec).model_fields if now[key] != before[key]}
    return {**entry, **_plain(changed)}


def agent_entry(spec: AgentSpec, pose: Pose | None) -> dict[str, Any]:
    """Return the keys of an agent.

    Parameters
    ----------
    spec : AgentSpec
    pose : Pose or None
        Where it stands; None for one that starts at its mover.
    """
    entry = _camera_entry(spec.name, spec, {"rate": spec.rate_hz, "following": spec.following})
    if spec.cameras is not None:
        entry["cameras"] = camera_entries(spec.cameras)
    if spec.mover:
        entry["mover"] = spec.mover
    if spec.carrier:
        del entry["following"]
        entry["carrier"] = spec.carrier
    if spec.look_at is not None:
        entry["keep_looking_at"] = look_at_entry(spec.look_at)
    return entry if pose is None else {**entry, **pose_entry(pose)}


def camera_entries(cameras: Mapping[str, RigCamera]) -> list[dict[str, Any]]:
    """Return the keys of a rig's cameras."""
    return [
        {**_camera_entry(name, camera, {}), **pose_entry(camera.extrinsics)}
        for name, camera in cameras.items()
    ]


def _camera_entry(
    name: str, camera: AgentSpec | RigCamera, more: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the keys that an agent and a camera of a rig have in common, and `more`."""
    values = {"depth_range": camera.depth_range_m, "views": camera.views, **more}
    defaults = AgentSpecModel.model_fields
    given = {key: value for key, value in values.items() if value != defaults[key].default}
    entry: dict[str, Any] = {"name": name, **lens_entry(camera.intrinsics), **_plain(given)}
    if camera.picture != PictureSettings():
        entry["picture"] = _picture(camera.picture)
    return entry


def lens_entry(lens: CameraIntrinsics) -> dict[str, Any]:
    """Return the keys of a camera's size, lens and clip distances that differ from the defaults."""
    defaults = AgentSpecModel.model_fields
    values = {intrinsics_key(name): value for name, value in lens.arguments().items()}
    return _plain({key: value for key, value in values.items() if value != defaults[key].default})


def look_at_entry(look_at: LookAt) -> dict[str, Any]:
    """Return the keys of what is faced; a point is not rounded, as it may be a moving object's."""
    if not look_at.obj:
        return {"point": list(look_at.point_m)}
    at_origin = not any(look_at.point_m)
    return {"object": look_at.obj, **({} if at_origin else {"point": list(look_at.point_m)})}


def body_entry(
    rigid: RigidBody, linear_m_s: Sequence[float], angular_rad_s: Sequence[float]
) -> dict[str, Any]:
    """Return the keys of a mover's body that differ from the defaults, and of its motion."""
    usual = RigidBody()
    names = [f.name for f in fields(RigidBody) if getattr(rigid, f.name) != getattr(usual, f.name)]
    entry = {
        name.removesuffix("_kg").removesuffix("_m").removesuffix("_per_s"): getattr(rigid, name)
        for name in names
    }
    motion = {
        "velocity": rounded(linear_m_s, LENGTH_DECIMALS),
        "angular_velocity": rounded(np.degrees(angular_rad_s).tolist(), LENGTH_DECIMALS),
    }
    return {**entry, **{key: values for key, values in motion.items() if any(values)}}


def rounded(numbers: Sequence[float], decimals: int) -> list[float]:
    """Round numbers, without a zero that has a sign."""
    return [round(float(number), decimals) + 0.0 for number in numbers]


def _values(light: Light) -> dict[str, Any]:
    """Return a light's attributes by their keys in a file, which have no units in their names."""
    values = {
        field.name.removesuffix("_m").removesuffix("_deg"): getattr(light, field.name)
        for field in fields(Light)
    }
    values["direction"] = tuple(rounded(light.direction, UNIT_DECIMALS))
    return values


def _picture(settings: PictureSettings) -> dict[str, Any]:
    """Return what differs from the defaults, by its keys in a file."""
    usual = PictureSettings()
    names = [f.name for f in fields(PictureSettings)]
    return {
        name.removesuffix("_m"): getattr(settings, name)
        for name in names
        if getattr(settings, name) != getattr(usual, name)
    }


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    return {k: list(v) if isinstance(v, tuple) else v for k, v in values.items()}
