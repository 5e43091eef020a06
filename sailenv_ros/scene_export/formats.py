"""The formats that scenes and assets are exported in, by the ends of files' names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TypeAlias

from sailenv_ros.scene_export.contents import ExportedScene, Written
from sailenv_ros.scene_export.glb import write_glb
from sailenv_ros.scene_export.mjcf import write_mjcf
from sailenv_ros.scene_export.sdf import write_sdf
from sailenv_ros.scene_export.urdf import write_urdf
from sailenv_ros.scene_export.usd import write_usda, write_usdz

__all__ = ["ASSET_FORMATS", "SCENE_FORMATS", "Writer"]

Writer: TypeAlias = Callable[[ExportedScene, str], Written]
"""``writer(scene, folder)``: what a file holds; ``folder`` is the name of the one beside it."""

SCENE_FORMATS: Mapping[str, Writer] = MappingProxyType(
    {
        ".glb": write_glb,
        ".usda": write_usda,
        ".usdz": write_usdz,
        ".xml": write_mjcf,
        ".sdf": write_sdf,
    }
)

ASSET_FORMATS: Mapping[str, Writer] = MappingProxyType({**SCENE_FORMATS, ".urdf": write_urdf})
