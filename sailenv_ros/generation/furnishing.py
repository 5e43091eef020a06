"""Furniture by its rules: a piece and all that belongs to it is placed together, or not at all.

An `Area` of a `RoomPlan` and rules in, `Item`s out. A place is drawn and kept if nothing is in the
way, what must stay free stays free, and all doors can still be reached.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from sailenv_ros.assets.arranging import RESTING_GAP_M, WALL_GAP_M
from sailenv_ros.generation.items import Item, Namer, block_of, clear_blocks
from sailenv_ros.generation.plan import Area, Block, RoomPlan, WallGap, WallSide
from sailenv_ros.generation.randomness import Dice
from sailenv_ros.generation.rule_files import Rules
from sailenv_ros.generation.rule_models import CompanionRule, FurnitureRule, PieceRule
from sailenv_ros.generation.stock import Stock

__all__ = ["Furnisher"]

TRIES = 60
COMPANION_TRIES = 8
FROM_WINDOW_M = 0.05
BESIDE_CURTAIN_M = 0.16
FROM_WALL_M = 0.07
LEAST_GAP_M = 0.001
"""Between pieces that belong together."""

_CURTAIN_OUT_M, _CURTAIN_IN_M = 0.30, 0.12
_RUG_GAP_M = 0.03


@dataclass(slots=True)
class _Group:
    """A piece with what belongs to it, before it is accepted."""

    items: list[Item] = field(default_factory=list)
    clear: list[Block] = field(default_factory=list)
    ends: dict[tuple[int, str], Item] = field(default_factory=dict)
    names: list[tuple[Item, str]] = field(default_factory=list)


@dataclass(slots=True, kw_only=True)
class Furnisher:
    """Furnishes one area.

    Parameters
    ----------
    area : Area
    plan : RoomPlan
        What stands there is added to it.
    rules : Rules
    stock : Stock
    dice : Dice
    namer : Namer
    skirting_m : float
        How far the skirting keeps off what stands at a wall [m].
    """

    area: Area
    plan: RoomPlan
    rules: Rules
    stock: Stock
    dice: Dice
    namer: Namer
    skirting_m: float
    items: list[Item] = field(default_factory=list)

    def furnish(self, pieces: Sequence[PieceRule]) -> bool:
        """Place all pieces in their order; say if all that is needed has its place."""
        for piece in pieces:
            if not (piece.needed or self.dice.chance(piece.chance)):
                continue
            if piece.once and any(item.base == piece.put for item in self.items):
                continue
            count = self.dice.whole(piece.count)
            count += int(piece.per_metre * self.area.floor_m2)
            for number in range(count):
                placed = self.place(piece.put, needed=piece.needed and number == 0)
                if not placed and piece.needed and number == 0:
                    return False
        return True

    def place(self, name: str, *, needed: bool = False) -> bool:
        """Place a piece with what belongs to it; say if there was a place."""
        rule = self.rules.furniture[name]
        for _ in range(TRIES):
            group = _Group()
            item = self._proposed(name, rule, group)
            if item is None or not self._with_companions(item, rule, group):
                continue
            if self.plan.connects(each.block for each in group.items):
                item.needed = needed
                self._accept(group, name)
                return True
        return False

    # -- inside ----------------------------------------------------------------------------

    def _accept(self, group: _Group, heading: str) -> None:
        for item, base in group.names:
            prefix = f"{self.area.name} " if self.area.name else ""
            item.name = self.namer.name(prefix + base)
            item.base = base
            item.section = f"{self.area.name}:{heading}"
        self.plan.stand(
            [_thin(item.block) if item.is_flat else item.block for item in group.items],
            group.clear,
        )
        self.items.extend(group.items)

    def _proposed(self, name: str, rule: FurnitureRule, group: _Group) -> Item | None:
        """Draw a place for a piece; None if it cannot stand there."""
        asset, scale = self._fresh(rule), round(self.dice.between(rule.scale), 2)
        if rule.at in ("wall", "corner") or rule.height is not None:
            item = self._at_wall(rule, asset, scale, corner=rule.at == "corner")
        elif rule.at == "ceiling":
            x, y = self._middle()
            item = self._hung_up(rule, asset, scale, round(x, 2), round(y, 2))
        else:
            item = self._in_the_room(rule, asset, scale)
        return item if item is not None and self._fits(item, rule, name, group) else None

    def _fresh(self, rule: FurnitureRule) -> str:
        """Return an object of a piece, one that the room has not got yet where there is one."""
        present = {item.asset for item in self.items}
        return self.dice.one([a for a in rule.assets if a not in present] or rule.assets)

    def _at_wall(
        self, rule: FurnitureRule, asset: str, scale: float, *, corner: bool
    ) -> Item | None:
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
        return self._against(side, along, rule, asset, scale, turn=self.dice.between(rule.turn))

    def _against(
        self,
        side: WallSide,
        along: float,
        rule: FurnitureRule,
        asset: str,
        scale: float,
        *,
        turn: float = 0.0,
        digits: int = 2,
    ) -> Item | None:
        """Return a piece with its back to a wall, at a place along it; None if it cannot be."""
        low, high = self.stock.bounds(asset, scale)
        height = 0.0 if rule.height is None else round(self.dice.between(rule.height), 2)
        gap = round(self.dice.between(rule.gap), 2)
        turn = round(turn)
        along = _rounded_along(side, along, digits)
        half = (float(low[1]), float(high[1]))
        extent = (along + min(half[0], -half[1]), along + max(half[1], -half[0]))
        if turn:
            reach = float(np.hypot(*np.maximum(-low[:2], high[:2])))
            extent = (along - reach, along + reach)
        found = _beside_holes(side, extent, (height + low[2], height + high[2]), rule)
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

    def _in_the_room(self, rule: FurnitureRule, asset: str, scale: float) -> Item:
        low, high = self.area.low, self.area.high
        middle, size = self._middle(), self.area.size
        if rule.at == "middle":
            x = middle[0] + 0.32 * size[0] * self.dice.between((-1.0, 1.0))
            y = middle[1] + 0.32 * size[1] * self.dice.between((-1.0, 1.0))
            yaw = self.dice.one((0.0, 90.0))
        else:
            x, y = (self.dice.between((low[k] + 0.2, high[k] - 0.2)) for k in range(2))
            yaw = 0.0 if _turns(rule) else self.dice.one((0.0, 90.0, 180.0, -90.0))
        return self._standing(rule, asset, scale, x, y, yaw + self.dice.between(rule.turn))

    def _standing(
        self, rule: FurnitureRule, asset: str, scale: float, x: float, y: float, yaw: float
    ) -> Item:
        """Return a piece that stands free."""
        x, y, yaw = round(x, 2), round(y, 2), _angle(yaw)
        z = 0.0 if rule.flat else RESTING_GAP_M
        entry: dict[str, object] = {"position": [x, y, z], "rotation": [0, 0, yaw]}
        block = block_of(self.stock, asset, scale, x, y, yaw)
        return self._item(rule, asset, scale, entry, block, (x, y, yaw))

    def _hung_up(self, rule: FurnitureRule, asset: str, scale: float, x: float, y: float) -> Item:
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
            tall = float(self.stock.bounds(asset, scale)[1, 2])
            light = (rule.light_at * tall, round(self.dice.between(rule.light), 2))
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

    def _fits(self, item: Item, rule: FurnitureRule, name: str, group: _Group) -> bool:
        """Say if a piece can stand where it was drawn; it is in the group then."""
        # What stands free keeps off sill boards and curtains.
        stands_free = item.side is None and not rule.flat and rule.at != "ceiling"
        if not self.area.holds(item.block, FROM_WALL_M if stands_free else 0.0):
            return False
        if rule.flat:
            if not self._rug_fits(item, group):
                return False
        else:
            mates = [each.block for each in group.items if not each.is_flat]
            if any(item.block.meets(mate, LEAST_GAP_M) for mate in mates):
                return False
            rugs = [each for each in (*self.items, *group.items) if each.is_flat]
            if item.side is not None and any(_over(item.block, rug.block) for rug in rugs):
                return False
            if not self.plan.is_free(item.block):
                return False
            if not all(self.area.holds(c) and self.plan.is_empty(c) for c in item.clear):
                return False
            if any(c.meets(mate) for c in item.clear for mate in mates):
                return False
        group.items.append(item)
        group.clear.extend(item.clear)
        group.names.append((item, name))
        return True

    def _rug_fits(self, item: Item, group: _Group) -> bool:
        """Say if a rug lies on the floor alone, or under what stands free and never moves."""
        for other in (*self.items, *group.items):
            standing = other.side is not None or not other.entry.get("static", False)
            if (other.is_flat or standing) and _over(item.block, other.block):
                return False
        doors = [c for c in self.plan.clear if c.low == 0.0]
        return not any(_over(item.block, door) for door in doors)

    def _with_companions(self, item: Item, rule: FurnitureRule, group: _Group) -> bool:
        """Place what belongs to a piece, and what belongs to that; say if all needed is there."""
        for companion in rule.companions:
            if not companion.needed and not self.dice.chance(companion.chance):
                continue
            least = 1 if companion.needed else 0
            if self._companions(item, companion, group) < least:
                return False
        return True

    def _companions(self, item: Item, companion: CompanionRule, group: _Group) -> int:
        """Place the companions of one rule; return how many found a place."""
        rule = self.rules.furniture[companion.put]
        asset = self._fresh(rule)  # all of them alike
        placed, count = 0, self.dice.whole(companion.count)
        for spot in self._spots(item, companion, rule, asset, count, group):
            if placed == count:
                break
            for _ in range(COMPANION_TRIES):
                scale = round(self.dice.between(rule.scale), 2)
                proposed = spot(asset, scale)
                if proposed is None or not self._fits(proposed, rule, companion.put, group):
                    continue
                mark = len(group.items), len(group.clear), len(group.names)
                if self._with_companions(proposed, rule, group):
                    placed += 1
                    group.ends[id(item), companion.where] = proposed
                    if companion.where == "around":
                        item.around.append(proposed)
                    break
                del group.items[mark[0] - 1 :], group.names[mark[2] - 1 :]
                del group.clear[mark[1] - len(proposed.clear) :]
        return placed

    def _spots(
        self,
        item: Item,
        companion: CompanionRule,
        rule: FurnitureRule,
        asset: str,
        count: int,
        group: _Group,
    ) -> Iterator[Callable[[str, float], Item | None]]:
        """Yield ways to draw a place at each spot where a companion may be."""
        where = companion.where
        if where == "around":
            yield from self._around(item, companion, rule, asset, count)
        elif where == "over":
            yield lambda asset, scale: self._over(item, companion, rule, asset, scale)
        elif where == "under":
            yield lambda asset, scale: self._standing(
                rule,
                asset,
                scale,
                *_offset(item, companion.ahead, 0.0),
                item.yaw_deg + self._longways(item, asset),
            )
        elif where in ("left", "right"):
            # A row goes on where the last piece of this side ends.
            for _ in range(count):
                last = group.ends.get((id(item), where), item)
                sign = 1.0 if where == "left" else -1.0
                yield partial(self._beside, last, companion, rule, sign)
        elif where == "beside":
            for sign in self.dice.mixed([1.0, -1.0]):
                yield partial(self._beside, item, companion, rule, sign)
        else:
            turned = 0.0 if where == "front" else 180.0
            yield lambda asset, scale: self._facing(item, companion, rule, asset, scale, turned)

    def _facing(
        self,
        item: Item,
        companion: CompanionRule,
        rule: FurnitureRule,
        asset: str,
        scale: float,
        turned: float,
    ) -> Item:
        """Return a companion before or behind a piece that faces it."""
        turn = self.dice.between(companion.turn)
        reach = self._reach(asset, scale, turn)
        sign = 1.0 if not turned else -1.0
        ahead = _edge(item, sign) + sign * (self.dice.between(companion.gap) + reach)
        x, y = _offset(item, ahead, self.dice.between(companion.aside))
        return self._standing(rule, asset, scale, x, y, item.yaw_deg + 180.0 + turned + turn)

    def _beside(
        self,
        item: Item,
        companion: CompanionRule,
        rule: FurnitureRule,
        sign: float,
        asset: str,
        scale: float,
    ) -> Item | None:
        """Return a companion at the left (1) or right (-1) of a piece, at the same wall if any."""
        low, high = self.stock.bounds(asset, scale)
        gap = self.dice.between(companion.gap)
        if item.side is not None and not rule.flat and rule.at != "free":
            left = (-item.side.inward[1], item.side.inward[0])
            run = np.subtract(item.side.end, item.side.start) / item.side.length_m
            way = sign * float(np.sign(np.dot(left, run)))
            along = item.along_m + way * (item.block.half_y + gap + max(-low[1], high[1]))
            return self._against(item.side, along, rule, asset, scale, digits=3)
        turn = self.dice.between(companion.turn)
        aside = sign * (item.block.half_y + gap + (high[1] - low[1]) / 2.0)
        ahead = self.dice.between((-0.3, 0.3)) * item.block.half_x if rule.flat else 0.0
        if rule.flat:
            shorter = min(high[0] - low[0], high[1] - low[1])
            longer = max(high[0] - low[0], high[1] - low[1])
            turn = 90.0 if high[1] - low[1] > high[0] - low[0] else 0.0
            aside = sign * (item.block.half_y + gap + shorter / 2.0)
            ahead = self.dice.between((0.0, 0.4)) * max(0.0, item.block.half_x - longer / 4.0)
        x, y = _offset(item, ahead, aside)
        return self._standing(rule, asset, scale, x, y, item.yaw_deg + turn)

    def _over(
        self, item: Item, companion: CompanionRule, rule: FurnitureRule, asset: str, scale: float
    ) -> Item | None:
        """Return what hangs above a piece: on the wall behind it, or from the ceiling."""
        if rule.at == "ceiling":
            return self._hung_up(rule, asset, scale, round(item.block.x, 2), round(item.block.y, 2))
        if item.side is None:
            return None
        along = item.along_m + self.dice.between(companion.aside)
        return self._against(item.side, along, rule, asset, scale)

    def _around(
        self, item: Item, companion: CompanionRule, rule: FurnitureRule, asset: str, count: int
    ) -> Iterator[Callable[[str, float], Item | None]]:
        """Yield the places at a table, in pairs that face each other; the long sides first."""
        low, high = self.stock.bounds(asset)
        wide = float(high[1] - low[1]) + 0.06
        hx, hy = item.block.half_x, item.block.half_y
        long_axis = 0 if hx > hy + 0.05 else 1
        places: list[tuple[float, float, float]] = []
        for axis in (long_axis, 1 - long_axis):
            length = 2.0 * (hx if axis == 0 else hy)
            seats = max(1, int((length - 0.1) / wide))
            seats = seats if axis == long_axis else min(seats, 1)
            for seat in range(seats):
                at = ((seat + 0.5) / seats - 0.5) * (length - 0.05)
                for sign in (1.0, -1.0):
                    # Ahead, aside, and where the guest looks.
                    if axis == 0:
                        places.append((at, sign * hy, -90.0 * sign))
                    else:
                        places.append((sign * hx, at, 180.0 if sign > 0.0 else 0.0))
        for ahead, aside, looks in places:
            yield lambda asset, scale, p=(ahead, aside, looks): self._seat(  # type: ignore[misc]
                item, companion, rule, asset, scale, p
            )

    def _seat(
        self,
        item: Item,
        companion: CompanionRule,
        rule: FurnitureRule,
        asset: str,
        scale: float,
        place: tuple[float, float, float],
    ) -> Item:
        ahead, aside, looks = place
        turn = self.dice.between(companion.turn)
        off = self.dice.between(companion.gap) + self._reach(asset, scale, turn)
        angle = math.radians(looks)
        ahead, aside = ahead - off * math.cos(angle), aside - off * math.sin(angle)
        x, y = _offset(item, ahead, aside)
        return self._standing(rule, asset, scale, x, y, item.yaw_deg + looks + turn)

    def _reach(self, asset: str, scale: float, turn_deg: float) -> float:
        """Return how far a turned object reaches to its front from its origin [m]."""
        low, high = self.stock.bounds(asset, scale)
        c, s = abs(math.cos(math.radians(turn_deg))), abs(math.sin(math.radians(turn_deg)))
        return float(c * high[0] + s * max(-low[1], high[1]))

    def _longways(self, item: Item, asset: str) -> float:
        """Return the turn by which a rug lies along what stands on it [deg]."""
        low, high = self.stock.bounds(asset)
        rug_is_deep = high[0] - low[0] > high[1] - low[1]
        return 0.0 if rug_is_deep == (item.block.half_x > item.block.half_y) else 90.0

    def _middle(self) -> tuple[float, float]:
        """Return the middle of the area, or of the larger part beside the corner cut out."""
        area, cut = self.area, self.area.cut
        if cut is None:
            return area.middle
        x = (area.low[0] + cut.x - cut.half_x) / 2.0
        if cut.x < area.middle[0]:
            x = (area.high[0] + cut.x + cut.half_x) / 2.0
        return x, area.middle[1]


def _thin(block: Block) -> Block:
    """Return a rug as it is in the plan: nothing that anything could run into."""
    return Block(
        x=block.x, y=block.y, half_x=block.half_x, half_y=block.half_y,
        yaw_rad=block.yaw_rad, low=-0.02, high=-0.01,
    )  # fmt: skip


def _over(first: Block, second: Block) -> bool:
    """Say if two boxes that stand on the floor lie over one another, seen from above."""
    if second.low > 0.1:
        return False
    flat = [
        Block(x=b.x, y=b.y, half_x=b.half_x, half_y=b.half_y, yaw_rad=b.yaw_rad)
        for b in (first, second)
    ]
    return flat[0].meets(flat[1], _RUG_GAP_M)


def _windows(sides: Sequence[WallSide]) -> list[tuple[WallSide, WallGap]]:
    return [(side, hole) for side in sides for hole in side.holes if hole.kind == "window"]


def _turns(rule: FurnitureRule) -> bool:
    return rule.turn != (0.0, 0.0)


def _angle(degrees: float) -> float:
    """Return whole degrees from -179 to 180."""
    return -((-round(degrees) + 180) % 360 - 180)


def _offset(item: Item, ahead: float, aside: float) -> tuple[float, float]:
    """Return the place so far ahead of and to the left of a piece's middle."""
    c, s = math.cos(math.radians(item.yaw_deg)), math.sin(math.radians(item.yaw_deg))
    return item.block.x + c * ahead - s * aside, item.block.y + s * ahead + c * aside


def _edge(item: Item, sign: float) -> float:
    return sign * item.block.half_x


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
        margin = FROM_WINDOW_M + (_CURTAIN_OUT_M if hole.curtains else 0.0)
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
                    if rule.height is not None:
                        return None
                    gap = BESIDE_CURTAIN_M
    return gap
