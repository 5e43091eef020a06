"""Places for a piece of furniture by itself: at a wall, in a corner, on the floor, hung up.

A rule, an object and random numbers in, an `Item` with its place out. Knows nothing of what else is
in the room.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.items import Item, Lamp, block_of, clear_blocks
from sailenv_content.generation.plan import Area, Block, WallGap, WallSide
from sailenv_ros.assets.arranging import RESTING_GAP_M, WALL_GAP_M
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_models import FurnitureRule

__all__ = ["APART_M", "Positioner", "offset"]

FROM_WINDOW_M = 0.05
BESIDE_CURTAIN_M = 0.16
BELOW_CEILING_M = 0.01
OVER_M = 0.12
"""Between a piece and what hangs above it [m]."""

APART_M = 0.15
"""Between what hangs at eye level and what is beside it [m]."""

_CURTAIN_OUT_M, _CURTAIN_IN_M = 0.30, 0.12


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioner:
    """Draws places for pieces in one area.

    Parameters
    ----------
    area : Area
    stock : AssetIndex
    dice : RandomStream
    skirting_m : float
        How far the skirting keeps off what stands at a wall [m].
    """

    area: Area
    stock: AssetIndex
    dice: RandomStream
    skirting_m: float

    def at_wall(
        self, rule: FurnitureRule, asset: str, scale: float, *, corner: bool
    ) -> Item | None:
        """Return a piece at a wall or in a corner; None if it cannot be there."""
        sides = self.area.walls
        side = self.dice.one(sides)
        low, high = self.stock.bounds(asset, scale)
        half = float(max(-low[1], high[1]))
        if corner:
            half = float(np.hypot(*np.maximum(-low[:2], high[:2]))) if _turns(rule) else half
            space = self.dice.between(rule.gap) + half + 0.02
            along = self.dice.one((space, side.length_m - space))
        elif rule.at_window and (windows := _windows(sides)) and self.dice.chance(0.85):
            side, hole = self.dice.one(windows)
            along = (hole.along[0] + hole.along[1]) / 2.0 + self.dice.between((-0.15, 0.15))
        else:
            along = self.dice.between((half, side.length_m - half))
        return self.against(side, along, rule, asset, scale, turn=self.dice.between(rule.turn))

    def against(
        self,
        side: WallSide,
        along: float,
        rule: FurnitureRule,
        asset: str,
        scale: float,
        *,
        turn: float = 0.0,
        digits: int = 2,
        above_m: float = 0.0,
    ) -> Item | None:
        """Return a piece with its back to a wall, at a place along it; None if it cannot be.

        What hangs at eye level hangs higher if there is something below it, `above_m` high.
        """
        low, high = self.stock.bounds(asset, scale)
        height = 0.0 if rule.height is None else round(self.dice.between(rule.height), 2)
        if rule.eye_level is not None:
            middle = self.dice.between(rule.eye_level)
            foot = max(middle - float(high[2] - low[2]) / 2.0, above_m + OVER_M)
            height = round(foot - float(low[2]), 2)
        gap = round(self.dice.between(rule.gap), 2)
        turn = round(turn)
        along = _rounded_along(side, along, digits)
        half = (float(low[1]), float(high[1]))
        extent = (along + min(half[0], -half[1]), along + max(half[1], -half[0]))
        if turn:
            reach = float(np.hypot(*np.maximum(-low[:2], high[:2])))
            extent = (along - reach, along + reach)
        found = _beside_holes(side, extent, (height + low[2], height + high[2]), rule)
        if height + high[2] > self.area.height - BELOW_CEILING_M:
            return None
        if found is None or extent[0] < 0.005 or extent[1] > side.length_m - 0.005:
            return None
        gap = max(gap, found)
        off = WALL_GAP_M + gap + (self.skirting_m if height == 0.0 else 0.0)
        yaw = side.yaw_deg + turn
        entry: dict[str, object]
        if side.wall and not turn:
            # What is drawn keeps the distance; what collides may reach further behind it.
            off += max(0.0, round(self.stock.back_m(asset, scale) - float(low[0]), 2))
            gap = round(off - WALL_GAP_M - (self.skirting_m if height == 0.0 else 0.0), 3)
            x, y = side.point(along, off - self.stock.back_m(asset, scale))
            entry = {"wall": side.wall, "at": _wall_coordinate(side, x, y)}
            entry |= {"height": height} if height else {}
            entry |= {"gap": gap} if gap else {}
        else:
            reach = float(-low[0]) if not turn else float(np.hypot(*np.maximum(-low[:2], high[:2])))
            x, y = (round(value, 3) for value in side.point(along, off + reach))
            entry = {"position": [x, y, height or RESTING_GAP_M], "rotation": [0, 0, _angle(yaw)]}
        block = block_of(self.stock, asset, scale, x, y, yaw, height)
        return self._item(rule, asset, scale, entry, block, (x, y, yaw), side=side, along_m=along)

    def in_the_room(self, rule: FurnitureRule, asset: str, scale: float) -> Item:
        """Return a piece somewhere on the floor, or near the middle."""
        low, high = self.area.low, self.area.high
        middle, size = self.middle(), self.area.size
        if rule.at == "middle":
            x = middle[0] + 0.32 * size[0] * self.dice.between((-1.0, 1.0))
            y = middle[1] + 0.32 * size[1] * self.dice.between((-1.0, 1.0))
            yaw = self.dice.one((0.0, 90.0))
        else:
            x, y = (self.dice.between((low[k] + 0.2, high[k] - 0.2)) for k in range(2))
            yaw = 0.0 if _turns(rule) else self.dice.one((0.0, 90.0, 180.0, -90.0))
        return self.standing(rule, asset, scale, x, y, yaw + self.dice.between(rule.turn))

    def standing(
        self, rule: FurnitureRule, asset: str, scale: float, x: float, y: float, yaw: float
    ) -> Item:
        """Return a piece that stands free."""
        x, y, yaw = round(x, 2), round(y, 2), _angle(yaw)
        low_z = float(self.stock.bounds(asset, scale)[0, 2])
        z = 0.0 if rule.flat else round(RESTING_GAP_M - low_z, 4)
        entry: dict[str, object] = {"position": [x, y, z], "rotation": [0, 0, yaw]}
        block = block_of(self.stock, asset, scale, x, y, yaw)
        return self._item(rule, asset, scale, entry, block, (x, y, yaw))

    def hung_up(self, rule: FurnitureRule, asset: str, scale: float, x: float, y: float) -> Item:
        """Return a lamp below the ceiling."""
        z = round(self.area.height - float(self.stock.bounds(asset, scale)[1, 2]) - 0.005, 3)
        block = block_of(self.stock, asset, scale, x, y, 0.0, z)
        entry: dict[str, object] = {"position": [x, y, z]}
        return self._item(rule, asset, scale, entry, block, (x, y, 0.0))

    def _item(
        self,
        rule: FurnitureRule,
        asset: str,
        scale: float,
        entry: dict[str, object],
        block: Block,
        pose: tuple[float, float, float],
        *,
        side: WallSide | None = None,
        along_m: float = 0.0,
    ) -> Item:
        entry |= {"scale": scale} if scale != 1.0 else {}
        entry |= {"static": True} if rule.static else {}
        light = None
        if rule.light is not None:
            at = self.stock.light_m(asset, scale, up=rule.shines == "up")
            light = Lamp(at, round(self.dice.between(rule.light), 2))
        x, y, yaw = pose
        return Item(
            name="",
            asset=asset,
            entry=entry,
            block=block,
            x=x,
            y=y,
            yaw_deg=yaw,
            scale=scale,
            rule=rule,
            side=side,
            along_m=along_m,
            clear=clear_blocks(rule, block),
            light=light,
        )

    def middle(self) -> tuple[float, float]:
        """Return the middle of the area, or of the larger part beside the corner cut out."""
        area, cut = self.area, self.area.cut
        if cut is None:
            return area.middle
        x = (area.low[0] + cut.x - cut.half_x) / 2.0
        if cut.x < area.middle[0]:
            x = (area.high[0] + cut.x + cut.half_x) / 2.0
        return x, area.middle[1]


def _windows(sides: Sequence[WallSide]) -> list[tuple[WallSide, WallGap]]:
    return [(side, hole) for side in sides for hole in side.holes if hole.kind == "window"]


def _turns(rule: FurnitureRule) -> bool:
    return rule.turn != (0.0, 0.0)


def _angle(degrees: float) -> float:
    """Return whole degrees from -179 to 180."""
    return -((-round(degrees) + 180) % 360 - 180)


def offset(item: Item, ahead: float, aside: float) -> tuple[float, float]:
    """Return the place so far ahead of and to the left of a piece's middle."""
    c, s = math.cos(math.radians(item.yaw_deg)), math.sin(math.radians(item.yaw_deg))
    return item.block.x + c * ahead - s * aside, item.block.y + s * ahead + c * aside


def _rounded_along(side: WallSide, along: float, digits: int) -> float:
    """Return a place along a wall whose coordinate in the room is rounded."""
    x, y = side.point(along)
    axis = 0 if abs(side.end[0] - side.start[0]) > abs(side.end[1] - side.start[1]) else 1
    at = round((x, y)[axis], digits)
    return abs(at - side.start[axis])


def _wall_coordinate(side: WallSide, x: float, y: float) -> float:
    return round(x if side.wall in ("north", "south") else y, 3)


def _beside_holes(
    side: WallSide, extent: tuple[float, float], up: tuple[float, float], rule: FurnitureRule
) -> float | None:
    """Return the gap to the wall that curtains ask for; None if something is in the way."""
    gap = 0.0
    for hole in side.holes:
        margin = FROM_WINDOW_M if rule.eye_level is None else APART_M
        margin += _CURTAIN_OUT_M if hole.curtains else 0.0
        beside = extent[1] <= hole.along[0] - margin or extent[0] >= hole.along[1] + margin
        if beside:
            continue
        if up[1] > hole.up[0] - 0.06 and up[0] < hole.up[1] + 0.06:
            return None
        if hole.curtains and up[0] < hole.up[1]:
            for low, high in (
                (hole.along[0] - _CURTAIN_OUT_M, hole.along[0] + _CURTAIN_IN_M),
                (hole.along[1] - _CURTAIN_IN_M, hole.along[1] + _CURTAIN_OUT_M),
            ):
                if extent[0] < high and extent[1] > low:
                    if rule.hangs:
                        return None
                    gap = BESIDE_CURTAIN_M
    return gap
