"""Worlds of scenes that a test says as a dictionary, from the solids of the package."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from typing import Any

from sailenv_ros.assets import AssetLibrary, load_categories
from sailenv_ros.scene import SceneSpec
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.world.build import build_world
from sailenv_ros.world.world import World

__all__ = ["built_snapshot", "built_world"]


def built_world(scene: Mapping[str, Any], assets: AssetLibrary | None = None) -> World:
    """Build a scene's world; `assets` are others than the solids."""
    return build_world(
        SceneSpec.model_validate({"version": 1, **scene}),
        assets=AssetLibrary() if assets is None else assets,
        categories=load_categories(),
        seed=0,
        epoch=1,
    )


def built_snapshot(scene: Mapping[str, Any]) -> WorldSnapshot:
    """Return how a scene's world begins."""
    with closing(built_world(scene)) as world:
        return world.snapshot()
