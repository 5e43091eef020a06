"""Worlds of scenes that a test says as a dictionary, from the solids of the package."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from typing import Any

import numpy as np

from sailenv_ros.assets import AssetLibrary, load_categories
from sailenv_ros.scene import SceneSpec
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.world.build import build_world
from sailenv_ros.world.world import World

__all__ = ["built_snapshot", "built_world", "corners_of"]


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


def corners_of(world: World, *names: str) -> np.ndarray:
    """Return the corners of all triangles of some objects in the world [m]."""
    found = []
    for _, body in world.numbered_bodies:
        if body.placement.name in names:
            matrix = body.world_from_body()
            for part in body.placement.asset.model.parts:
                points = part.mesh.positions[part.mesh.triangles].reshape(-1, 3)
                found.append(points @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(found)
