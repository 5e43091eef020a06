"""Objects that a scene has drawn upon its free floor: what was drawn in, places out.

A record holds the place, so a frame is made again without looking for it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidState
from sailenv_ros.scene.randomise.things.random_spawn import FLOOR
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.types.model import Asset

__all__ = ["placed_on_floor"]

GAP_M = 0.002
"""Between an object and the floor, so that physics does not push it out."""

STEP_M = 0.02
"""Rugs and thresholds that are no higher carry an object."""


def placed_on_floor(
    entry: Mapping[str, Any], asset: Asset, free_space: Callable[[BodySize], FreeSpace]
) -> dict[str, Any] | None:
    """Return a drawn object with its place; None if the floor has none for it.

    Parameters
    ----------
    entry : mapping
        Of an object, with a place already or with what was drawn for one; see `FLOOR`.
    asset : Asset
        What it is.
    free_space : callable
        Returns where a body can stand in the scene as it is now.
    """
    drawn = entry.get(FLOOR)
    if drawn is None:
        return dict(entry)
    low, high = asset.model.bounds() * float(entry.get("scale", 1.0))
    # Whatever its turn, it lies within this circle around its origin.
    radius = float(np.linalg.norm(np.maximum(np.abs(low[:2]), np.abs(high[:2]))))
    height = max(2.0 * STEP_M, float(high[2] - low[2]) + drawn["height"])
    try:
        space = free_space(BodySize(height_m=height, radius_m=radius, step_m=STEP_M))
        x, y, floor = space.random_pose(seed=drawn["seed"]).position_m
    except InvalidState:
        return None
    # What falls lands on what it was put above; what is static would hang there.
    above = GAP_M if entry.get("static") else STEP_M + GAP_M
    position = [x, y, floor + above - float(low[2]) + drawn["height"]]
    placed = {key: value for key, value in entry.items() if key != FLOOR}
    return {**placed, "position": position, "rotation": [0.0, 0.0, drawn["turn"]]}
