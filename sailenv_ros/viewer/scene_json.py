"""Scene as the page gets it, in plain values for JSON.

`SceneInfo` and `ObjectState` in, dictionaries out. Knows no socket and no simulation.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, fields, is_dataclass
from functools import cache
from typing import Any

from sailenv_ros.assets.skies import sky_files
from sailenv_ros.assets.sources import installed_packs
from sailenv_ros.assets.surfaces import surface_names
from sailenv_ros.behaviours import BehaviourKind, behaviour_kinds
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import UNLABELLED_CATEGORY
from sailenv_ros.types.lights import Light
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.types.picture_settings import LIMITS, NAMES, PictureSettings, picture_choices
from sailenv_ros.types.scene_info import MoverInfo, SceneInfo
from sailenv_ros.types.validation import Bounds
from sailenv_ros.viewer.messages import (
    BehaviourInfo,
    BehaviourParameter,
    ObjectValues,
    PictureSetting,
)
from sailenv_ros.viewer.scene_messages import (
    LensValues,
    LightNews,
    LookAtNews,
    MoverNews,
    PoseValues,
    SceneMessage,
)

__all__ = [
    "behaviours_to_json",
    "lens_to_json",
    "materials_to_json",
    "object_to_json",
    "picture_settings_to_json",
    "pose_to_json",
    "scene_to_json",
    "skies_to_json",
    "to_json",
]


def scene_to_json(info: SceneInfo) -> SceneMessage:
    """Return what the scene is now."""
    surroundings = info.environment
    return {
        "type": "scene",
        "scene": info.scene,
        "scenes": list(info.scenes),
        "epoch": info.epoch,
        "revision": info.revision,
        "mode": info.mode,
        "paused": info.paused,
        "real_time_factor": info.real_time_factor,
        "seed": info.seed,
        "renderer": info.renderer,
        "categories": [
            {"id": category.id, "name": category.name, "colour": category.colour}
            for category in info.categories.values()
            if category.id not in (0, UNLABELLED_CATEGORY)
        ],
        "instances": [
            {
                "id": instance.id,
                "name": instance.name,
                "asset": instance.asset,
                "category_id": instance.category_id,
                "category": instance.category,
                "static": instance.static,
                "moves": instance.id in info.moving,
                "materials": list(instance.materials),
                "painted": json.loads(instance.painted or "[]"),
                "parent": instance.parent,
                "is_part": instance.is_part,
            }
            for instance in info.instances
        ],
        "spawnables": list(info.spawnables),
        "lights": [_light(light) for light in info.lights],
        "environment": {
            "ambient": surroundings.ambient,
            "background": surroundings.background,
            "background_colour": surroundings.background_colour,
            "sky_map": surroundings.sky_map,
            "sky_rotation": surroundings.sky_rotation,
            "sky_blend": surroundings.sky_blend,
            "outside_factor": surroundings.outside_factor,
            "sky_share": surroundings.sky_share,
            "exposure": surroundings.exposure,
        },
        "agents": [
            {
                "name": agent.name,
                "width": agent.intrinsics.width,
                "height": agent.intrinsics.height,
                "fov_deg": agent.intrinsics.vertical_fov_deg,
                "rate_hz": agent.rate_hz,
                "following": agent.following,
                "mover": agent.mover,
                "picture": asdict(agent.picture),
                "look_at": _look_at(agent.look_at),
            }
            for agent in info.agents
        ],
        "movers": [_mover(mover) for mover in info.movers],
    }


def lens_to_json(intrinsics: CameraIntrinsics) -> LensValues:
    """Return what a lens is."""
    law = intrinsics.law
    return {
        "model": intrinsics.distortion_model,
        "fx": intrinsics.fx,
        "fy": intrinsics.fy,
        "cx": intrinsics.cx,
        "cy": intrinsics.cy,
        "coefficients": list(zip(law.model.coefficients, law.coefficients, strict=False)),
        "max_angle_deg": None if law.model.parallel else math.degrees(law.limit_rad),
    }


def object_to_json(state: ObjectState) -> ObjectValues:
    """Return what and where an object is."""
    return {
        "id": state.id,
        "name": state.name,
        "asset": state.asset,
        "category": state.category,
        **pose_to_json(state.pose),
        "scale": state.scale,
        "size": state.size_m,
        "static": state.static,
        "mass_kg": state.mass_kg,
        "behaviours": to_json(state.behaviours),
    }


def pose_to_json(pose: Pose) -> PoseValues:
    """Return a pose: position [m] and roll, pitch, yaw [deg]."""
    return {"position": pose.position_m, "rpy_deg": pose.rpy_deg}


@cache
def behaviours_to_json() -> list[BehaviourInfo]:
    """Return which behaviours there are, with their parameters."""
    return [_behaviour(kind) for kind in behaviour_kinds().values()]


def picture_settings_to_json() -> list[PictureSetting]:
    """Return which settings a picture has: defaults, choices, limits and units."""
    usual, choices, unbounded = PictureSettings(), picture_choices(), Bounds()
    return [
        {
            "name": name,
            "default": getattr(usual, name),
            "choices": list(choices.get(name, ())),
            "whole": bounds.whole,
            "least": bounds.least,
            "most": bounds.most,
            "unit": bounds.unit,
        }
        for name in NAMES
        for bounds in [LIMITS.get(name, unbounded)]
    ]


def materials_to_json() -> list[str]:
    """Return the names of the materials that are made for rooms."""
    return list(surface_names())


def skies_to_json() -> list[str]:
    """Return the names of the pictures of skies on this machine; reads folders."""
    return sorted(sky_files(pack.folder for pack in installed_packs()))


def _behaviour(kind: BehaviourKind) -> BehaviourInfo:
    parameters: list[BehaviourParameter] = [
        {
            "name": name,
            "about": field.description or "",
            "needed": field.is_required(),
            "default": None if field.is_required() else to_json(field.default),
        }
        for name, field in kind.parameters.model_fields.items()
    ]
    return {"type": kind.type, "summary": kind.summary, "parameters": parameters}


def _light(light: Light) -> LightNews:
    return {
        "name": light.name,
        "type": light.type,
        "intensity": light.intensity,
        "indirect_multiplier": light.indirect_multiplier,
        "range_m": light.range_m,
        "colour": light.colour,
        "position_m": light.position_m,
        "direction": light.direction,
    }


def _mover(mover: MoverInfo) -> MoverNews:
    return {
        "name": mover.name,
        "controller": mover.controller,
        "waypoints": [pose_to_json(pose) for pose in mover.waypoints],
        "total_time_s": mover.total_time_s,
        "loop": mover.loop,
        "is_body": mover.body is not None,
    }


def _look_at(faced: LookAt | None) -> LookAtNews | None:
    return None if faced is None else {"object": faced.obj, "point": faced.point_m}


def to_json(value: Any) -> Any:
    """Return the result of an operation: data classes and mappings as objects, poses by angles."""
    if isinstance(value, ObjectState):
        return object_to_json(value)
    if isinstance(value, Pose):
        return pose_to_json(value)
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: to_json(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): to_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_json(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
