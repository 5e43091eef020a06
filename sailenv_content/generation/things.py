"""Placement of small objects from lists: on furniture, and on a table before its chairs.

`Item`s that stand in, `Item`s that lie on them out. Heights are found when the scene is built.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_content.generation.asset_index import HOB, AssetIndex
from sailenv_content.generation.items import Item, Lamp, Namer, block_of
from sailenv_content.generation.pieces import PieceChooser
from sailenv_content.generation.plan import Block
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules
from sailenv_ros.authoring.room_rules.rule_models import ThingRule

__all__ = ["lay_things"]

TRIES = 12
EDGE_M = 0.012
"""Least distance of an object from the edge of its carrier [m]."""

APART_M = 0.012

BRIDGED_M = 0.06
"""Most that what is under a corner of a thing is above what is under its middle [m]."""

MOST = 0.7
"""Share of its size by which it has to be over its carrier."""


def lay_things(
    items: Sequence[Item], rules: Rules, stock: AssetIndex, dice: RandomStream, namer: Namer
) -> Iterator[Item]:
    """Yield what lies on furniture."""
    pieces = PieceChooser(dice)
    for item in items:
        if item.rule is None:
            continue
        taken: list[Block] = []
        prefix = _area_of(item)
        if item.rule.setting is not None:
            kinds: dict[int, str] = {}
            for guest in item.around:
                for index, thing in enumerate(rules.things[item.rule.setting]):
                    if not dice.chance(thing.chance):
                        continue
                    asset = kinds.get(index) or pieces.chosen(dice.one(thing.put))
                    kinds[index] = asset
                    laid = _laid_before(item, guest, thing, asset, stock, dice)
                    yield from _kept(laid, item, taken, stock, namer, prefix, thing)
        if item.rule.holds is not None:
            for thing in rules.things[item.rule.holds]:
                if not dice.chance(thing.chance):
                    continue
                for _ in range(dice.whole(thing.count)):
                    asset = pieces.chosen(dice.one(thing.put))
                    for _ in range(TRIES):
                        laid = _laid(item, thing, asset, stock, dice)
                        found = list(_kept(laid, item, taken, stock, namer, prefix, thing))
                        if found:
                            yield from found
                            break


def _area_of(item: Item) -> str:
    return item.section.rpartition(":")[0]


def _laid(item: Item, thing: ThingRule, asset: str, stock: AssetIndex, dice: RandomStream) -> Item:
    """Return a thing somewhere on a piece, in the piece's own axes."""
    scale = round(dice.between(thing.scale), 2)
    turn = float(round(dice.between(thing.turn)))
    hob = stock.let_in(item.asset, item.scale).get(HOB) if thing.hob else None
    low, high = stock.bounds(item.asset, item.scale) if hob is None else hob
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    block = block_of(stock, asset, scale, 0.0, 0.0, turn)
    reach = np.abs(block.corners() - (block.x, block.y)).max(axis=0)
    free = np.maximum(half[:2] - reach - EDGE_M, 0.0)
    x = float(middle[0] + dice.between(thing.x) * free[0] - block.x)
    y = float(middle[1] + dice.between(thing.y) * free[1] - block.y)
    return _thing(item, thing, asset, scale, x, y, turn, stock, dice)


def _laid_before(
    item: Item, guest: Item, thing: ThingRule, asset: str, stock: AssetIndex, dice: RandomStream
) -> Item:
    """Return a thing of a place that is laid before a guest, in the table's own axes."""
    yaw = math.radians(item.yaw_deg)
    c, s = math.cos(yaw), math.sin(yaw)
    dx, dy = guest.block.x - item.block.x, guest.block.y - item.block.y
    place = np.array([c * dx + s * dy, -s * dx + c * dy])
    half = np.array([item.block.half_x, item.block.half_y])
    # The guest sits at the side beyond which the chair stands.
    axis = int(np.argmax(np.abs(place) - half))
    inward = np.zeros(2)
    inward[axis] = -np.sign(place[axis])
    right = np.array([inward[1], -inward[0]])
    at = place.copy()
    at[axis] = -inward[axis] * half[axis]
    at += inward * thing.inset + right * thing.aside
    looks = math.degrees(math.atan2(inward[1], inward[0]))
    turn = float(round(looks + dice.between(thing.turn)))
    scale = round(dice.between(thing.scale), 2)
    low, high = stock.bounds(item.asset, item.scale)
    at += ((low + high) / 2.0)[:2]
    return _thing(item, thing, asset, scale, float(at[0]), float(at[1]), turn, stock, dice)


def _thing(
    item: Item,
    thing: ThingRule,
    asset: str,
    scale: float,
    x: float,
    y: float,
    turn: float,
    stock: AssetIndex,
    dice: RandomStream,
) -> Item:
    x, y, turn = round(x, 3), round(y, 3), (turn + 180.0) % 360.0 - 180.0
    entry: dict[str, object] = {"on": item.name, "position": [x, y, 0.0]}
    entry |= {"level": list(thing.level)} if thing.level is not None else {}
    entry |= {"rotation": [0, 0, turn]} if turn else {}
    entry |= {"scale": scale} if scale != 1.0 else {}
    entry |= {"static": True} if thing.static else {}
    yaw = math.radians(item.yaw_deg)
    c, s = math.cos(yaw), math.sin(yaw)
    light = None
    if thing.light is not None:
        light = Lamp(stock.light_m(asset, scale, up=True), round(dice.between(thing.light), 2))
    return Item(
        name="",
        asset=asset,
        entry=entry,
        block=block_of(stock, asset, scale, x, y, turn, 0.0),
        x=item.x + c * x - s * y,
        y=item.y + s * x + c * y,
        yaw_deg=item.yaw_deg + turn,
        scale=scale,
        section=item.section,
        light=light,
    )


def _kept(
    laid: Item,
    item: Item,
    taken: list[Block],
    stock: AssetIndex,
    namer: Namer,
    prefix: str,
    thing: ThingRule,
) -> Iterable[Item]:
    """Yield a thing if it lies within its carrier, where it may, and touches no other."""
    low, high = stock.bounds(item.asset, item.scale)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    offsets = np.abs(laid.block.corners() - middle[:2])
    if (offsets > half[:2] - EDGE_M + 1e-6).any():
        return
    if any(laid.block.meets(other, APART_M) for other in taken):
        return
    for category, corners in stock.let_in(item.asset, item.scale).items():
        allowed = thing.hob and category == HOB
        if not allowed and laid.block.meets(_seen_from_above(corners)):
            return
    # Tops are round or have a basin in them: it lies where most of it is over something.
    centre = np.array([laid.block.x, laid.block.y])
    corners = laid.block.corners() - centre
    spots = centre + np.vstack([np.zeros(2), MOST * corners, corners])
    heights = stock.support_heights(item.asset, item.scale, spots, thing.level)
    if not np.isfinite(heights[:5]).all():
        return
    # Across the arms of a chair or on the rim of a basin nothing is laid.
    if heights.max() - heights[0] > BRIDGED_M:
        return
    taken.append(laid.block)
    category = stock.asset(laid.asset).category
    laid.name = namer.name(f"{prefix} {category}" if prefix else category)
    yield laid


def _seen_from_above(bounds: NDArray[np.float64]) -> Block:
    """Return the box around corners (2, 3), at whatever height."""
    (x, y, _), (half_x, half_y, _) = bounds.mean(axis=0), np.ptp(bounds, axis=0) / 2.0
    return Block(
        x=float(x), y=float(y), half_x=float(half_x), half_y=float(half_y),
        low=-math.inf, high=math.inf,
    )  # fmt: skip
