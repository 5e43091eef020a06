"""Curtains and blinds before the windows of a room: each made as wide and as long as its window.

An `Area` and rules in, `Item`s out; the plan is told what they take.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.items import Item, Namer
from sailenv_content.generation.pieces import PieceChooser
from sailenv_content.generation.plan import Area, Block, RoomPlan, WallGap, WallSide
from sailenv_ros.assets.arranging import WALL_GAP_M
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules
from sailenv_ros.authoring.room_rules.rule_models import FurnitureRule

__all__ = ["WindowDresser"]

FOOT_M, ABOVE_SILL_M, BELOW_CEILING_M = 0.012, 0.035, 0.02
"""Of what hangs, above the floor, above a sill, and of its upper end below the ceiling [m]."""

LEAST_ASIDE_M = 0.02
FROM_CORNER_M = 0.012
SCALES = (0.55, 1.75)
"""Least and greatest scale by which a piece is made to fit."""

SIDES_M = 0.45
"""Width of what curtains that are drawn aside take at each side of a window [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WindowDresser:
    """Hangs something before the windows of one area.

    Parameters
    ----------
    area : Area
    plan : RoomPlan
        What hangs there is added to it.
    rules : Rules
    stock : AssetIndex
    dice : RandomStream
    pieces : PieceChooser
    namer : Namer
    """

    area: Area
    plan: RoomPlan
    rules: Rules
    stock: AssetIndex
    dice: RandomStream
    pieces: PieceChooser
    namer: Namer

    def items(self) -> Iterator[Item]:
        """Yield what hangs before the windows, of one kind before all of them."""
        rule = self.rules.kind(self.area.kind).windows
        blinds = self.dice.chance(rule.blinds)
        chosen: dict[str, str] = {}
        for side in self.area.walls:
            for hole in side.holes:
                name = rule.hung if hole.curtains else rule.bare if blinds else None
                if hole.kind != "window" or name is None:
                    continue
                piece = self.rules.furniture[name]
                asset = chosen.setdefault(name, self.pieces.one_of(piece.assets))
                item = self._before(side, hole, piece, asset)
                if item is None or not self.plan.connects(self._taken(side, item)):
                    continue
                prefix = f"{self.area.name} " if self.area.name else ""
                item.name, item.base = self.namer.name(prefix + name), name
                item.section = f"{self.area.name}:windows"
                self.plan.stand(self._taken(side, item))
                yield item

    def _before(
        self, side: WallSide, hole: WallGap, rule: FurnitureRule, asset: str
    ) -> Item | None:
        """Return a piece that is made to fit a window; None if there is too little room for it."""
        assert rule.window is not None  # as rules are checked
        low, high = self.stock.bounds(asset)
        middle, width = sum(hole.along) / 2.0, hole.along[1] - hole.along[0]
        others = [other for other in side.holes if other is not hole]
        free = [hole.along[0] - FROM_CORNER_M, side.length_m - hole.along[1] - FROM_CORNER_M]
        free += [(hole.along[0] - o.along[1]) / 2.0 for o in others if o.along[1] <= hole.along[0]]
        free += [(o.along[0] - hole.along[1]) / 2.0 for o in others if o.along[0] >= hole.along[1]]
        aside = min(rule.window.aside, *free)
        foot = FOOT_M if rule.window.floor else hole.up[0] + ABOVE_SILL_M
        top = min(hole.up[1] + rule.window.above, self.area.height - BELOW_CEILING_M)
        across = round((width + 2.0 * aside) / float(high[1] - low[1]), 3)
        up = round((top - foot) / float(high[2] - low[2]), 3)
        if aside < LEAST_ASIDE_M or not all(SCALES[0] <= s <= SCALES[1] for s in (across, up)):
            return None
        off = WALL_GAP_M + max(0.0, -float(low[0]))
        along = middle - across * float(low[1] + high[1]) / 2.0
        x, y = side.point(along, off)
        at = round(x if side.wall in ("north", "south") else y, 3)
        height = round(foot - up * float(low[2]), 3)
        block = Block(
            x=side.point(middle, off + float(low[0] + high[0]) / 2.0)[0],
            y=side.point(middle, off + float(low[0] + high[0]) / 2.0)[1],
            half_x=float(high[0] - low[0]) / 2.0,
            half_y=width / 2.0 + aside,
            yaw_rad=0.0 if abs(side.inward[0]) > 0.5 else math.pi / 2.0,
            low=foot,
            high=top,
        )
        return Item(
            name="",
            asset=asset,
            entry={
                "wall": side.wall, "at": at, "height": height, "scale": [1.0, across, up],
                "static": True,
            },
            block=block,
            x=x,
            y=y,
            yaw_deg=side.yaw_deg,
            rule=rule,
            side=side,
            along_m=middle,
        )  # fmt: skip

    def _taken(self, side: WallSide, item: Item) -> list[Block]:
        """Return what a piece takes: of curtains that are drawn aside, both sides alone."""
        assert item.rule is not None
        assert item.rule.window is not None
        block = item.block
        if not item.rule.window.floor:
            return [block]
        reach = min(SIDES_M, block.half_y) / 2.0
        taken = []
        for sign in (-1.0, 1.0):
            x, y = side.point(item.along_m + sign * (block.half_y - reach), block.half_x)
            taken.append(
                Block(
                    x=x, y=y, half_x=block.half_x, half_y=reach, yaw_rad=block.yaw_rad,
                    low=block.low, high=block.high,
                )
            )  # fmt: skip
        return taken
