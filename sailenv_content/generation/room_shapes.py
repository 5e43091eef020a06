"""The shell of a room: its size and shape, windows and doors. A kind's rules in, a `Shell` out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from sailenv_content.generation.plan import Area, Block, WallGap, WallSide
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_models import KindFile, MaterialsRule

__all__ = ["PARTITION_M", "Shell", "single_room", "surface_entry"]

PARTITION_M = 0.12
DOOR_M = (0.9, 2.05)
DOOR_CLEAR_M = 0.95
_CORNER_M = 0.3
"""Least distance between an opening and a corner [m]."""

_APART_M = 0.25
_TRIES = 40

OUTER = {
    "north": ((-1.0, 1.0), (1.0, 1.0), (0.0, -1.0)),
    "east": ((1.0, -1.0), (1.0, 1.0), (-1.0, 0.0)),
    "south": ((-1.0, -1.0), (1.0, -1.0), (0.0, 1.0)),
    "west": ((-1.0, -1.0), (-1.0, 1.0), (1.0, 0.0)),
}
"""Signs of both ends, from -x or -y on, and the normal into the room of each wall."""


@dataclass(slots=True, kw_only=True)
class Shell:
    """A room before it is furnished.

    Attributes
    ----------
    entry : dict
        `room` of the scene file, but for the materials.
    areas : list of Area
    walls : list of Block
        Walls between rooms, and corners that are cut out.
    doors : list of (2,) tuple of float
        Places that must be reached [m].
    clear : list of Block
        Floor before doors, which stays free.
    leaves : list of Block
        Leaves of open doors.
    windows : list of WallSide and WallGap
    """

    entry: dict[str, Any]
    areas: list[Area] = field(default_factory=list)
    walls: list[Block] = field(default_factory=list)
    doors: list[tuple[float, float]] = field(default_factory=list)
    clear: list[Block] = field(default_factory=list)
    leaves: list[Block] = field(default_factory=list)
    windows: list[tuple[WallSide, WallGap]] = field(default_factory=list)


def single_room(kind: str, rules: KindFile, materials: MaterialsRule, dice: RandomStream) -> Shell:
    """Return the shell of one room, a rectangle or an L."""
    shape = rules.shape
    x, y = (round(dice.between(span), 1) for span in (shape.width, shape.depth))
    height = round(dice.between(shape.height), 2)
    shell = Shell(entry={"size": [x, y, height]})
    cut: Block | None = None
    partitions: list[tuple[dict[str, Any], WallSide]] = []
    if dice.chance(shape.l_chance):
        cut, partitions = _cut_corner((x, y), height, rules, dice)
        shell.entry["partitions"] = [entry for entry, _ in partitions]
        shell.walls.append(cut)
    sides = [_trimmed(side, cut) for side in outer_sides((-x / 2, -y / 2), (x / 2, y / 2))]
    openings, sides = add_openings(sides, rules, materials, dice, height)
    shell.entry["openings"] = openings
    sides += [side for _, side in partitions]
    low, high = (-x / 2, -y / 2), (x / 2, y / 2)
    area = Area(name="", kind=kind, low=low, high=high, height=height, walls=tuple(sides), cut=cut)
    shell.areas.append(area)
    note_openings(shell, openings, sides)
    return shell


def outer_sides(low: Sequence[float], high: Sequence[float]) -> list[WallSide]:
    """Return the four walls of a rectangle around the origin, as sides of outer walls."""
    corner = {-1.0: low, 1.0: high}
    return [
        WallSide(
            wall=wall,
            start=(corner[start[0]][0], corner[start[1]][1]),
            end=(corner[end[0]][0], corner[end[1]][1]),
            inward=inward,
        )
        for wall, (start, end, inward) in OUTER.items()
    ]


def _cut_corner(
    size: tuple[float, float], height: float, rules: KindFile, dice: RandomStream
) -> tuple[Block, list[tuple[dict[str, Any], WallSide]]]:
    """Return a corner that is cut out of a rectangle, and the two walls that close it off."""
    sx, sy = dice.one([-1.0, 1.0]), dice.one([-1.0, 1.0])
    dx, dy = (round(dice.between(rules.shape.l_share) * side, 1) for side in size)
    x0, y0 = sx * size[0] / 2.0, sy * size[1] / 2.0
    x1, y1 = round(x0 - sx * dx, 2), round(y0 - sy * dy, 2)
    half = PARTITION_M / 2.0
    block = Block(
        x=(x0 + x1) / 2.0, y=(y0 + y1) / 2.0, half_x=dx / 2.0, half_y=dy / 2.0,
        low=0.0, high=height,
    )  # fmt: skip
    # Each wall's face lies at the cut; its middle is half its thickness behind.
    across, up = round(x1 + sx * half, 3), round(y1 + sy * half, 3)
    along_y = {"name": "corner wall 1", "start": [across, y1], "end": [across, y0]}
    along_x = {"name": "corner wall 2", "start": [x1, up], "end": [x0, up]}
    ends_y = tuple(sorted((y1, y0)))
    ends_x = tuple(sorted((x1, x0)))
    sides = [
        WallSide(wall="", start=(x1, ends_y[0]), end=(x1, ends_y[1]), inward=(-sx, 0.0)),
        WallSide(wall="", start=(ends_x[0], y1), end=(ends_x[1], y1), inward=(0.0, -sy)),
    ]
    return block, list(zip([along_y, along_x], sides, strict=True))


def _trimmed(side: WallSide, cut: Block | None) -> WallSide:
    """Return what is left of a wall beside a corner that is cut out."""
    if cut is None:
        return side
    axis = 0 if side.wall in ("north", "south") else 1
    low = (cut.x - cut.half_x, cut.y - cut.half_y)
    high = (cut.x + cut.half_x, cut.y + cut.half_y)
    other = 1 - axis
    if not low[other] - 1e-6 <= side.start[other] <= high[other] + 1e-6:
        return side
    start, end = list(side.start), list(side.end)
    if abs(low[axis] - start[axis]) < 1e-6:
        start[axis] = high[axis]
    else:
        end[axis] = low[axis]
    return WallSide(
        wall=side.wall, start=(start[0], start[1]), end=(end[0], end[1]), inward=side.inward
    )


def add_openings(
    sides: Sequence[WallSide],
    rules: KindFile,
    materials: MaterialsRule,
    dice: RandomStream,
    height: float,
    *,
    doors: bool = True,
) -> tuple[list[dict[str, Any]], list[WallSide]]:
    """Draw doors and windows; return their entries, and the walls with their holes."""
    holes: dict[int, list[WallGap]] = {number: [] for number in range(len(sides))}
    openings: list[dict[str, Any]] = []
    asked = [("door", dice.whole(rules.doors.count) if doors else 0)]
    asked += [("window", dice.whole(rules.windows.count))]
    cloth = dice.one(materials.curtains) if materials.curtains else None
    curtained = cloth is not None and dice.chance(rules.windows.curtains)
    size = [round(dice.between(span), 2) for span in (rules.windows.height, rules.windows.sill)]
    size[0] = min(size[0], round(height - size[1] - 0.15, 2))
    door_walls: set[int] = set()
    for type_, count in asked:
        for _ in range(count):
            for _ in range(_TRIES):
                width = (
                    DOOR_M[0] if type_ == "door" else round(dice.between(rules.windows.width), 1)
                )
                number = dice.whole((0, len(sides) - 1))
                side = sides[number]
                if type_ == "window" and number in door_walls and len(sides) > 1:
                    continue
                margin = width / 2.0 + _CORNER_M
                if side.length_m < 2.0 * margin:
                    continue
                along = dice.between((margin, side.length_m - margin))
                at, along = _at(side, along)
                room = width / 2.0 + _APART_M + (0.3 if curtained else 0.0)
                if any(
                    along - room < h.along[1] and along + room > h.along[0] for h in holes[number]
                ):
                    continue
                entry: dict[str, Any] = {"type": type_, "wall": side.wall, "at": at, "width": width}
                if type_ == "door":
                    door_walls.add(number)
                    entry["hinged"] = True
                    up = (0.0, DOOR_M[1])
                    if dice.chance(rules.doors.open_chance):
                        entry["open"] = round(dice.between((75.0, 95.0)))
                        entry["hinge"] = dice.one(["left", "right"])
                else:
                    up = (size[1], round(size[1] + size[0], 2))
                    entry |= {"height": size[0], "sill": size[1]}
                    if curtained and rules.windows.hung is None:
                        entry["curtains"] = {"colour": list(cloth or ())}
                span = (along - width / 2.0, along + width / 2.0)
                holes[number].append(
                    WallGap(along=span, up=up, kind=type_, curtains=type_ == "window" and curtained)
                )
                openings.append(entry)
                break
    with_holes = [
        WallSide(
            wall=side.wall, start=side.start, end=side.end, inward=side.inward,
            holes=tuple(holes[number]),
        )
        for number, side in enumerate(sides)
    ]  # fmt: skip
    return openings, with_holes


def _at(side: WallSide, along: float) -> tuple[float, float]:
    """Return a rounded coordinate on a wall, and how far along the wall it is."""
    axis = 0 if side.wall in ("north", "south") else 1
    at = round(side.start[axis] + along, 2)
    return at, at - side.start[axis]


def note_openings(
    shell: Shell, openings: Sequence[dict[str, Any]], sides: Sequence[WallSide]
) -> None:
    """Note where doors are entered, what they keep free, and where windows are."""
    for side in sides:
        for hole in side.holes:
            middle = (hole.along[0] + hole.along[1]) / 2.0
            if hole.kind == "window":
                shell.windows.append((side, hole))
                continue
            shell.doors.append(side.point(middle, DOOR_CLEAR_M / 2.0))
            shell.clear.append(_before(side, hole, DOOR_CLEAR_M))
    for entry in openings:
        if entry["type"] == "door" and entry.get("open"):
            shell.leaves.append(_leaf(entry, sides))


def _before(side: WallSide, hole: WallGap, depth: float) -> Block:
    x, y = side.point((hole.along[0] + hole.along[1]) / 2.0, depth / 2.0)
    half = (hole.along[1] - hole.along[0]) / 2.0 + 0.1
    along_x = abs(side.inward[1]) > 0.5
    return Block(
        x=x, y=y, half_x=half if along_x else depth / 2.0,
        half_y=depth / 2.0 if along_x else half, low=0.0, high=2.1,
    )  # fmt: skip


def _leaf(entry: dict[str, Any], sides: Sequence[WallSide]) -> Block:
    """Return the leaf of an open door."""
    side = next(
        each
        for each in sides
        if each.wall == entry["wall"]
        and any(h.kind == "door" for h in each.holes)
        and any(abs(_at(each, sum(h.along) / 2.0)[0] - entry["at"]) < 0.02 for h in each.holes)
    )
    axis = 0 if side.wall in ("north", "south") else 1
    along = entry["at"] - side.start[axis]
    # As seen from inside, the right is outward x up: the inward normal turned to the left.
    right = (-side.inward[1], side.inward[0])
    run = ((side.end[0] - side.start[0]), (side.end[1] - side.start[1]))
    way = math.copysign(1.0, right[0] * run[0] + right[1] * run[1])
    way = way if entry["hinge"] == "right" else -way
    width = entry["width"]
    hx, hy = side.point(along + way * width / 2.0)
    closed = math.atan2(-way * run[1], -way * run[0])
    inward = math.atan2(side.inward[1], side.inward[0])
    turn = math.radians(entry["open"])
    sense = math.copysign(1.0, math.sin(inward - closed))
    angle = closed + sense * turn
    return Block(
        x=hx + math.cos(angle) * width / 2.0, y=hy + math.sin(angle) * width / 2.0,
        half_x=width / 2.0, half_y=0.05, yaw_rad=angle, low=0.0, high=2.05,
    )  # fmt: skip


def surface_entry(surface: Any, seed: int) -> dict[str, Any] | str:
    """Return a material as a scene file has it, with a grain of its own."""
    entry = surface.model_dump(mode="json", exclude_unset=True)
    entry = {"material": entry} if isinstance(entry, str) else dict(entry)
    entry["seed"] = seed
    return entry


def materials_of(
    shell: Shell, materials: MaterialsRule, dice: RandomStream
) -> Iterator[tuple[str, Any]]:
    """Yield the keys of a room that say what it is made of."""
    yield "walls", surface_entry(dice.one(materials.walls), dice.whole((0, 99)))
    sides = [side.wall for side in shell.areas[0].walls if side.wall]
    if materials.accent and dice.chance(materials.accent_chance) and sides:
        accent = surface_entry(dice.one(materials.accent), dice.whole((0, 99)))
        yield "wall_materials", {dice.one(sides): accent}
    yield "floor", surface_entry(dice.one(materials.floor), dice.whole((0, 99)))
    yield "skirting", {"colour": list(materials.skirting)} if materials.skirting else False
