"""Rugs and what stands on them: wholly upon one, or beside and partly in its pile.

`Item`s in, their heights out. A thin rug gives way: what stands on its edge stands on the floor,
since it would be askew, or in the air on one side, at the rug's own height.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.items import Item
from sailenv_content.generation.plan import Block
from sailenv_ros.assets.arranging import RESTING_GAP_M
from sailenv_ros.world.physics_check import RUG_GIVES_M

__all__ = ["lies_under", "on_its_edge", "stand_on_rugs", "thin"]

GAP_M = 0.03
"""Least gap between a rug and what may not stand on it [m]."""

ON_FLOOR_M = 0.1
"""Up to which height of its lowest point something stands on the floor [m]."""


def stand_on_rugs(items: Sequence[Item], stock: AssetIndex) -> None:
    """Put what stands free, and wholly on a rug, upon it."""
    rugs = [item for item in items if item.is_flat]
    for item in items:
        if item.is_flat or "position" not in item.entry or item.block.low > ON_FLOOR_M:
            continue
        # What moves would be pushed out of a rug that it stands in.
        still = bool(item.entry.get("static", False))
        tops = [
            _top_m(rug, stock)
            for rug in rugs
            if lies_under(rug.block, item.block)
            and not (still and _gives(rug, stock) and on_its_edge(rug, item, stock))
        ]
        if tops:
            x, y, z = item.entry["position"]
            item.entry["position"] = [x, y, round(z + max(tops), 4)]


def lies_under(rug: Block, block: Block, gap_m: float = 0.0) -> bool:
    """Return whether a rug is below what stands on the floor, or nearer to it than a gap."""
    if block.low > ON_FLOOR_M:
        return False
    return _seen_from_above(rug).meets(_seen_from_above(block), gap_m)


def on_its_edge(rug: Item, item: Item, stock: AssetIndex) -> bool:
    """Return whether a rug is below some of an object and not below all its corners."""
    if not lies_under(rug.block, item.block):
        return False
    yaw = math.radians(rug.yaw_deg)
    turn = np.array([[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]])
    corners = (item.block.corners() - (rug.x, rug.y)) @ turn
    return not np.isfinite(stock.support_heights(rug.asset, rug.scale, corners)).all()


def thin(block: Block) -> Block:
    """Return a rug as it is in the plan: nothing that anything could run into."""
    return Block(
        x=block.x, y=block.y, half_x=block.half_x, half_y=block.half_y,
        yaw_rad=block.yaw_rad, low=-0.02, high=-0.01,
    )  # fmt: skip


def _top_m(rug: Item, stock: AssetIndex) -> float:
    return float(stock.bounds(rug.asset, rug.scale)[1, 2])


def _gives(rug: Item, stock: AssetIndex) -> bool:
    return _top_m(rug, stock) + RESTING_GAP_M < RUG_GIVES_M


def _seen_from_above(block: Block) -> Block:
    return Block(
        x=block.x, y=block.y, half_x=block.half_x, half_y=block.half_y, yaw_rad=block.yaw_rad
    )
