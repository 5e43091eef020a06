"""Places for the companions of a piece: before, beside, behind, around, under or on it.

A piece that has its place and a rule in, ways to draw a place for a companion out. Knows nothing of
what else is in the room.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from sailenv_content.generation.items import Item
from sailenv_content.generation.positions import Positioner, offset
from sailenv_ros.authoring.room_rules.rule_models import CompanionRule, FurnitureRule

__all__ = ["CompanionSpots"]


@dataclass(frozen=True, slots=True)
class CompanionSpots:
    """Draws places for what belongs to pieces.

    Parameters
    ----------
    positioner : Positioner
    """

    positioner: Positioner

    def spots(
        self,
        item: Item,
        companion: CompanionRule,
        rule: FurnitureRule,
        asset: str,
        count: int,
        ends: Mapping[tuple[int, str], Item],
    ) -> Iterator[Callable[[str, float], Item | None]]:
        """Yield ways to draw a place at each spot where a companion may be.

        Parameters
        ----------
        item : Item
            What it belongs to.
        companion : CompanionRule
        rule : FurnitureRule
            Of the companion itself.
        asset : str
        count : int
            How many are wanted.
        ends : mapping
            The last pieces of rows that continue to a side of a piece, by its identity and the
            side.

        Yields
        ------
        draw : callable
            ``draw(asset, scale)`` returns an `Item` that stands somewhere there, or None.
        """
        where = companion.where
        if where == "around":
            yield from self._around(item, companion, rule, asset, count)
        elif where == "over":
            yield lambda asset, scale: self._over(item, companion, rule, asset, scale)
        elif where == "under":
            yield lambda asset, scale: self.positioner.standing(
                rule,
                asset,
                scale,
                *offset(item, companion.ahead, 0.0),
                item.yaw_deg + self._longways(item, asset),
            )
        elif where in ("left", "right"):
            # A row goes on where the last piece of this side ends.
            for _ in range(count):
                last = ends.get((id(item), where), item)
                sign = 1.0 if where == "left" else -1.0
                yield partial(self._beside, last, companion, rule, sign)
        elif where == "beside":
            for sign in self.positioner.dice.mixed([1.0, -1.0]):
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
        turn = self.positioner.dice.between(companion.turn)
        reach = self._reach(asset, scale, turn)
        sign = 1.0 if not turned else -1.0
        ahead = _edge(item, sign) + sign * (self.positioner.dice.between(companion.gap) + reach)
        x, y = offset(item, ahead, self.positioner.dice.between(companion.aside))
        return self.positioner.standing(
            rule, asset, scale, x, y, item.yaw_deg + 180.0 + turned + turn
        )

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
        low, high = self.positioner.stock.bounds(asset, scale)
        gap = self.positioner.dice.between(companion.gap)
        if item.side is not None and not rule.flat and rule.at != "free":
            left = (-item.side.inward[1], item.side.inward[0])
            run = np.subtract(item.side.end, item.side.start) / item.side.length_m
            way = sign * float(np.sign(np.dot(left, run)))
            along = item.along_m + way * (item.block.half_y + gap + max(-low[1], high[1]))
            return self.positioner.against(item.side, along, rule, asset, scale, digits=3)
        turn = self.positioner.dice.between(companion.turn)
        aside = sign * (item.block.half_y + gap + (high[1] - low[1]) / 2.0)
        ahead = self.positioner.dice.between((-0.3, 0.3)) * item.block.half_x if rule.flat else 0.0
        if rule.flat:
            shorter = min(high[0] - low[0], high[1] - low[1])
            longer = max(high[0] - low[0], high[1] - low[1])
            turn = 90.0 if high[1] - low[1] > high[0] - low[0] else 0.0
            aside = sign * (item.block.half_y + gap + shorter / 2.0)
            ahead = self.positioner.dice.between((0.0, 0.4)) * max(
                0.0, item.block.half_x - longer / 4.0
            )
        x, y = offset(item, ahead, aside)
        return self.positioner.standing(rule, asset, scale, x, y, item.yaw_deg + turn)

    def _over(
        self, item: Item, companion: CompanionRule, rule: FurnitureRule, asset: str, scale: float
    ) -> Item | None:
        """Return what hangs above a piece: on the wall behind it, or from the ceiling."""
        if rule.at == "ceiling":
            return self.positioner.hung_up(
                rule, asset, scale, round(item.block.x, 2), round(item.block.y, 2)
            )
        if item.side is None:
            return None
        along = item.along_m + self.positioner.dice.between(companion.aside)
        top = item.block.high
        return self.positioner.against(item.side, along, rule, asset, scale, above_m=top)

    def _around(
        self, item: Item, companion: CompanionRule, rule: FurnitureRule, asset: str, count: int
    ) -> Iterator[Callable[[str, float], Item | None]]:
        """Yield the places at a table, in pairs that face each other; the long sides first."""
        low, high = self.positioner.stock.bounds(asset)
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
        turn = self.positioner.dice.between(companion.turn)
        off = self.positioner.dice.between(companion.gap) + self._reach(asset, scale, turn)
        angle = math.radians(looks)
        ahead, aside = ahead - off * math.cos(angle), aside - off * math.sin(angle)
        x, y = offset(item, ahead, aside)
        return self.positioner.standing(rule, asset, scale, x, y, item.yaw_deg + looks + turn)

    def _reach(self, asset: str, scale: float, turn_deg: float) -> float:
        """Return how far a turned object reaches to its front from its origin [m]."""
        low, high = self.positioner.stock.bounds(asset, scale)
        c, s = abs(math.cos(math.radians(turn_deg))), abs(math.sin(math.radians(turn_deg)))
        return float(c * high[0] + s * max(-low[1], high[1]))

    def _longways(self, item: Item, asset: str) -> float:
        """Return the turn by which a rug lies along what stands on it [deg]."""
        low, high = self.positioner.stock.bounds(asset)
        rug_is_deep = high[0] - low[0] > high[1] - low[1]
        return 0.0 if rug_is_deep == (item.block.half_x > item.block.half_y) else 90.0


def _edge(item: Item, sign: float) -> float:
    return sign * item.block.half_x
