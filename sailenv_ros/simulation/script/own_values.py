"""A scene's own values, which others are drawn relative to, by the keys of its file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.types.agents import AgentSpec

__all__ = ["OwnCameraValues", "scene_values"]


def scene_values(spec: SceneSpec) -> Mapping[str, Mapping[str, Any]]:
    """Return the values of surroundings, lights and objects of a scene that was just built."""
    return {
        "environment": dict(spec.environment),
        "lights": {light.name: dict(light) for light in spec.lights},
        "objects": {entry.name: {"scale": entry.scale} for entry in spec.objects},
    }


class OwnCameraValues:
    """Values of cameras as programs set them, whatever was drawn since."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[Mapping[str, Any], Mapping[str, Any]]] = {}

    def of(self, spec: AgentSpec) -> Mapping[str, Any]:
        """Return a camera's own values; those that differ from what was drawn are its own."""
        present = _camera_values(spec)
        own, drawn = self._kept.get(spec.name, ({}, {}))
        return {
            key: own[key] if key in drawn and drawn[key] == value else value
            for key, value in present.items()
        }

    def keep(self, before: AgentSpec, after: AgentSpec) -> None:
        """Remember what drawn values stand instead of."""
        self._kept[before.name] = self.of(before), _camera_values(after)


def _camera_values(spec: AgentSpec) -> Mapping[str, Any]:
    return {
        "vertical_fov": spec.intrinsics.vertical_fov_deg,
        "exposure": spec.picture.exposure,
        "full_well": spec.picture.full_well,
    }
