"""Furniture by its rules: a piece and all that belongs to it is placed together, or not at all.

An `Area` of a `RoomPlan` and rules in, `Item`s out. A place is drawn and kept if nothing is in the
way, what must stay free stays free, and all doors can still be reached.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from sailenv_content.families.names import has_form
from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.companion_spots import CompanionSpots
from sailenv_content.generation.items import Item, Namer
from sailenv_content.generation.pieces import PieceChooser, RoomStyle
from sailenv_content.generation.plan import Approach, Area, Block, RoomPlan
from sailenv_content.generation.positions import APART_M, Positioner, offset
from sailenv_content.generation.rugs import GAP_M, lies_under, on_its_edge, thin
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules
from sailenv_ros.authoring.room_rules.rule_models import CompanionRule, FurnitureRule, PieceRule

__all__ = ["Furnisher"]

TRIES = 60
TRIES_OF_ONE = 12
"""Places that are tried for a piece before another one is."""

COMPANION_TRIES = 8
FROM_WALL_M = 0.07
LEAST_APART_M = 0.01
"""Least gap between pieces that do not [m]."""

SEEN_M = 1.2
"""Up to which height there is nothing between what faces each other [m]."""

LEAST_GAP_M = 0.001
"""Least gap between pieces that belong together [m]."""


@dataclass(slots=True)
class _Group:
    """A piece with what belongs to it, before it is accepted."""

    items: list[Item] = field(default_factory=list)
    clear: list[Block] = field(default_factory=list)
    ends: dict[tuple[int, str], Item] = field(default_factory=dict)
    names: list[tuple[Item, str]] = field(default_factory=list)

    @property
    def approaches(self) -> list[Approach]:
        """Floor on which one comes to the pieces."""
        return [item.clear for item in self.items if item.clear]


@dataclass(slots=True, kw_only=True)
class Furnisher:
    """Furnishes one area.

    Parameters
    ----------
    area : Area
    plan : RoomPlan
        What stands there is added to it.
    rules : Rules
    stock : AssetIndex
    dice : RandomStream
    namer : Namer
    skirting_m : float
        How far the skirting keeps off what stands at a wall [m].
    """

    area: Area
    plan: RoomPlan
    rules: Rules
    stock: AssetIndex
    dice: RandomStream
    namer: Namer
    skirting_m: float
    items: list[Item] = field(default_factory=list)
    pieces: PieceChooser = field(init=False)
    positioner: Positioner = field(init=False)
    spots: CompanionSpots = field(init=False)

    def __post_init__(self) -> None:
        self.positioner = Positioner(
            area=self.area, stock=self.stock, dice=self.dice, skirting_m=self.skirting_m
        )
        self.pieces = PieceChooser(self.dice, RoomStyle.drawn(self.dice))
        self.spots = CompanionSpots(self.positioner)

    def furnish(self, pieces: Sequence[PieceRule]) -> bool:
        """Place all pieces in their order; say if all that is needed has its place."""
        for piece in pieces:
            if not (piece.needed or self.dice.chance(piece.chance)):
                continue
            if piece.once and any(item.base == piece.put for item in self.items):
                continue
            stand_ins = [item for item in self.items if item.base in piece.unless]
            stand_ins += self._having(piece.lacking, self.items)
            if stand_ins:
                stand_ins[0].needed |= piece.needed
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
        asset = ""
        for number in range(TRIES):
            group = _Group()
            if number % TRIES_OF_ONE == 0:
                asset = self._fresh(rule, name)
            item = self._proposed(name, rule, asset, group)
            if item is None or not self._with_companions(item, rule, group):
                continue
            if self.plan.connects([each.block for each in group.items], group.approaches):
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
            [thin(item.block) if item.is_flat else item.block for item in group.items],
            group.clear,
            group.approaches,
        )
        self.items.extend(group.items)

    def _proposed(self, name: str, rule: FurnitureRule, asset: str, group: _Group) -> Item | None:
        """Draw a place for a piece; None if it cannot stand there."""
        scale = round(self.dice.between(rule.scale), 2)
        if rule.at in ("wall", "corner") or rule.hangs:
            item = self.positioner.at_wall(rule, asset, scale, corner=rule.at == "corner")
        elif rule.at == "ceiling":
            x, y = self.positioner.middle()
            item = self.positioner.hung_up(rule, asset, scale, round(x, 2), round(y, 2))
        else:
            item = self.positioner.in_the_room(rule, asset, scale)
        return item if item is not None and self._fits(item, rule, name, group) else None

    def _fresh(self, rule: FurnitureRule, name: str) -> str:
        """Return an object of a piece, one that the room has not got yet where there is one.

        Pieces from seeds may be asked to be alike.
        """
        present = {item.asset: item.base for item in self.items}
        alike = [asset for asset, base in present.items() if base == name and has_form(asset)]
        if alike and self.dice.chance(rule.alike):
            return alike[-1]
        fresh = [asset for asset in rule.assets if asset not in present] or rule.assets
        return self.pieces.one_of(fresh)

    def _fits(self, item: Item, rule: FurnitureRule, name: str, group: _Group) -> bool:
        """Return whether a piece can stand where it was drawn; it is in the group then."""
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
            at_wall, moves = item.side is not None, not rule.static
            if any(at_wall and lies_under(rug.block, item.block, GAP_M) for rug in rugs):
                return False
            if any(moves and on_its_edge(rug, item, self.stock) for rug in rugs):
                return False
            apart = LEAST_APART_M if rule.eye_level is None else APART_M
            if not self.plan.is_free(item.block, apart):
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
        """Return whether a rug lies on bare floor, or under what stands free and never moves."""
        for other in (*self.items, *group.items):
            standing = other.side is not None or not other.entry.get("static", False)
            if (other.is_flat or standing) and lies_under(item.block, other.block, GAP_M):
                return False
        doors = [c for c in self.plan.clear if c.low == 0.0]
        return not any(lies_under(item.block, door, GAP_M) for door in doors)

    def _having(self, category: str | None, items: Iterable[Item]) -> list[Item]:
        """Return what is of a category or has a part of it; nothing for None."""
        return [
            item for item in items if category is not None and self.stock.has(item.asset, category)
        ]

    def _with_companions(self, item: Item, rule: FurnitureRule, group: _Group) -> bool:
        """Place what belongs to a piece, and what belongs to that; say if all needed is there."""
        for companion in rule.companions:
            if not companion.needed and not self.dice.chance(companion.chance):
                continue
            if self._having(companion.lacking, (*self.items, *group.items)):
                continue
            least = max(1, companion.count[0]) if companion.needed else 0
            if self._companions(item, companion, group) < least:
                return False
        return True

    def _companions(self, item: Item, companion: CompanionRule, group: _Group) -> int:
        """Place the companions of one rule; return how many found a place."""
        rule = self.rules.furniture[companion.put]
        asset = self._fresh(rule, companion.put)  # all of them alike
        placed, count = 0, self.dice.whole(companion.count)
        for spot in self.spots.spots(item, companion, rule, asset, count, group.ends):
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
                    if companion.in_view:
                        group.clear.append(_between(item, proposed))
                    break
                del group.items[mark[0] - 1 :], group.names[mark[2] - 1 :]
                del group.clear[mark[1] - len(proposed.clear) :]
        return placed


def _between(item: Item, other: Item) -> Block:
    """Return what lies between a piece and another before it, up to the eyes of who sits."""
    c, s = math.cos(item.block.yaw_rad), math.sin(item.block.yaw_rad)
    ahead = c * (other.block.x - item.block.x) + s * (other.block.y - item.block.y)
    x, y = offset(item, ahead / 2.0, 0.0)
    return Block(
        x=x, y=y, half_x=max(0.0, ahead / 2.0 - item.block.half_x),
        half_y=min(item.block.half_y, other.block.half_y), yaw_rad=item.block.yaw_rad,
        low=0.02, high=SEEN_M,
    )  # fmt: skip
