"""Refrigerators: above a freezer, with one door, two tall doors, drawers below, small, retro."""

from __future__ import annotations

from sailenv_content.families.appliances import hollow_case
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import FRUIT, stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import handle
from sailenv_content.families.hardware import SEAL
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import turned

__all__ = ["FAMILY"]

LINER = paint("#eef0f0", 0.3, 300.0)
WALL_M, DOOR_M = 0.045, 0.055


def _fruit(b: PieceBuilder, room: Box) -> None:
    """Lay fruit on the floor of a drawer."""
    kind = b.pick(*FRUIT)
    with b.part(kind, kind):
        y = float(room.low[1]) + 0.06
        while y < room.high[1] - 0.05:
            for x in (0.35, 0.7):
                if b.chance(0.75):
                    r = min(b.between(0.028, 0.038), 0.45 * float(room.size[2]))
                    ball = [(0, 0), (0.6 * r, 0.2 * r), (r, r), (0.6 * r, 1.8 * r), (0, 2 * r)]
                    at = (room.low[0] + x * room.size[0], y, room.low[2] + 0.001)
                    skin = paint(b.pick(*FRUIT[kind]), 0.4, 900.0)
                    b.form(skin, turned(ball, segments=14), at, collides="none")
            y += 0.085


def _cold_drawer(b: PieceBuilder, name: str, room: Box, *, frozen: bool) -> None:
    """Add a clear drawer behind a door."""
    clear = glass("#dfe9ee", 0.15)
    size, middle, t = room.size, room.middle, 0.005
    with b.slide(name, "drawer", by=round(0.55 * float(size[0]), 3)):
        b.box(clear, (size[0], size[1], t), (middle[0], middle[1], room.low[2] + t / 2))
        for sign in (-1.0, 1.0):
            at = (middle[0], middle[1] + sign * (size[1] - t) / 2, middle[2])
            b.box(clear, (size[0], t, size[2]), at, bevel=0.001)
            at = (middle[0] + sign * (size[0] - t) / 2, middle[1], middle[2])
            b.box(clear, (t, size[1] - 2 * t, size[2]), at, bevel=0.001)
        lip = (room.high[0] + 0.004, middle[1], room.high[2] - 0.015)
        b.box(paint("#cfd8dc", 0.3), (0.012, 0.5 * size[1], 0.02), lip, bevel=0.003)
        inner = room.within((t, t, t), (t, t, 0.0))
        if frozen:
            _boxes(b, inner)
        else:
            _fruit(b, inner)


def _boxes(b: PieceBuilder, room: Box) -> None:
    """Stand packets into a drawer."""
    with b.part("packets", "carton"):
        y = float(room.low[1]) + 0.04
        while y < room.high[1] - 0.05:
            deep, high = b.between(0.12, 0.2), b.between(0.6, 0.95) * float(room.size[2])
            colour = paint(b.pick("#3a6ea5", "#e6dccb", "#5a8a4a", "#c9543a"), 0.6, 500.0)
            at = (room.middle[0] + b.between(-0.04, 0.04), y, room.low[2] + high / 2 + 0.001)
            b.box(colour, (min(deep, room.size[0] - 0.1), 0.045, high), at, collides=False)
            y += b.between(0.055, 0.09)


def _furnished(b: PieceBuilder, room: Box, *, shelves: int, drawers: int, prefix: str) -> None:
    """Divide a cold room by shelves of glass with groceries, drawers at its floor."""
    inner = room.within((0.01, 0.003, 0.002), (0.12, 0.003, 0.0))
    low = float(inner.low[2])
    for number in range(drawers):
        high = 0.17 if shelves else float(room.size[2]) / drawers
        name = f"{prefix}compartment {number + 1}"
        cell = Box((*inner.low[:2], low + 0.006), (*inner.high[:2], low + high - 0.01))
        _cold_drawer(b, name, cell.within((0.0, 0.025, 0.0), (0.0, 0.025, 0.0)), frozen=not shelves)
        low += high
        if number < drawers - 1 or shelves:
            size = (inner.size[0], inner.size[1], 0.006)
            b.box(glass("#cfdde2", 0.12), size, (inner.middle[0], inner.middle[1], low - 0.003))
    if not shelves:
        return
    rows = Box((*inner.low[:2], low), inner.high).rows([1.0] * shelves, 0.008)
    for number, row in enumerate(rows):
        if number:
            at = (row.middle[0], row.middle[1], row.low[2] - 0.004)
            b.box(glass("#cfdde2", 0.12), (row.size[0], row.size[1], 0.006), at)
        stores(b, row.within((0.04, 0.02, 0.001), (0.04, 0.02, 0.01)), cold=True)


def _door(
    b: PieceBuilder, v: Values, name: str, face: Box, room: Box, hinge: str, *, racks: int
) -> None:
    """Add an insulated door with a seal, a grip, and racks of bottles inside."""
    left = hinge == "left"
    at = (face.high[0], face.high[1] if left else face.low[1], face.middle[2])
    axis = (0.0, 0.0, 1.0 if left else -1.0)
    with b.hinge(name, "door", at=at, axis=axis, opens_deg=130.0, friction=0.6, detents=SEAL):
        b.box(v.face, face.size, face.middle, bevel=v.edge, collides=False)
        # The corner behind its free edge swings out by so much, past the door beside it.
        clear = DOOR_M**2 / (2.0 * float(face.size[1]))
        low, high = (clear, 0.0) if left else (0.0, clear)
        solid = face.within((0.0, low, 0.0), (0.0, high, 0.0))
        b.collide(solid.size, solid.middle)
        liner = Box(
            (face.low[0] - 0.012, room.low[1] + 0.02, room.low[2] + 0.02),
            (face.low[0] + 0.004, room.high[1] - 0.02, room.high[2] - 0.02),
        )
        b.box(LINER, liner.size, liner.middle, bevel=0.004)
        inset = 0.06
        for row in liner.within((0, 0, 0.03), (0, 0, 0.06)).rows([1.0] * max(racks, 1), 0.02):
            if not racks:
                break
            deep = 0.085
            size = (deep, float(liner.size[1]) - 2 * inset + 0.03, 0.006)
            mid = (liner.low[0] - deep / 2, float(liner.middle[1]), row.low[2] + 0.003)
            b.box(LINER, size, mid, bevel=0.001)
            front = (liner.low[0] - deep + 0.003, mid[1], row.low[2] + 0.031)
            b.box(glass("#dfe9ee", 0.15), (0.005, size[1], 0.06), front, bevel=0.001)
            shelf = Box(
                (liner.low[0] - deep, mid[1] - size[1] / 2 + 0.03, row.low[2] + 0.006),
                (liner.low[0], mid[1] + size[1] / 2 - 0.03, row.high[2]),
            )
            _bottles(b, shelf)
        y = face.low[1] + 0.035 if left else face.high[1] - 0.035
        long = min(v.grip_m, 0.7 * float(face.size[2]))
        reach = long / 2 + 0.06
        z = min(max(v.grip_z, face.low[2] + reach), face.high[2] - reach)
        if v.badge:
            at = (face.high[0] + 0.002, float(face.middle[1]), face.high[2] - 0.12)
            b.box(v.grip, (0.003, 0.09, 0.018), at, collides=False)
        handle(b, v.grip, "bar", face.high[0], y, z, length=long, upright=True)


def _bottles(b: PieceBuilder, room: Box) -> None:
    """Stand bottles and cartons in a row."""
    y = float(room.low[1]) + 0.03
    while y < room.high[1] - 0.02:
        tall = min(float(room.size[2]) - 0.02, b.between(0.12, 0.28))
        if b.chance(0.7) and tall > 0.08:
            r = 0.03
            rows = [
                (0, 0),
                (r, 0),
                (r, 0.62 * tall),
                (0.4 * r, 0.8 * tall),
                (0.4 * r, tall),
                (0, tall),
            ]
            shade = b.pick("#2f5a34", "#d8d0a0", "#f2f0ea", "#b5533c", "#5a3a1e")
            with b.part("bottle", "bottle"):
                at = (room.middle[0], y, room.low[2] + 0.001)
                b.form(paint(shade, 0.15, 900.0), turned(rows, segments=14), at, collides="none")
        y += b.between(0.068, 0.085)


def _cell(
    b: PieceBuilder,
    v: Values,
    outer: Box,
    name: str,
    hinge: str,
    *,
    shelves: int,
    drawers: int,
    racks: int,
    prefix: str = "",
) -> None:
    """Add a case that is open at its front, what is in it, and its door."""
    case = outer.within(high=(DOOR_M + 0.003, 0.0, 0.0))
    room = hollow_case(b, v.body, case, WALL_M, liner=LINER)
    _furnished(b, room, shelves=shelves, drawers=drawers, prefix=prefix)
    face = Box(
        (outer.high[0] - DOOR_M, outer.low[1] + 0.001, outer.low[2] + 0.003),
        (outer.high[0], outer.high[1] - 0.001, outer.high[2] - 0.003),
    )
    _door(b, v, name, face, room, hinge, racks=racks)


def _plinth(b: PieceBuilder, v: Values, width: float) -> float:
    high = 0.05
    size = (v.depth - 0.1, width - 0.03, high)
    b.box(paint("#232326", 0.5), size, (-0.03, 0.0, high / 2))
    return high


def _combi(b: PieceBuilder, v: Values) -> None:
    """Make a cold room above a freezer, or a freezer above it."""
    d, w, h = v.depth, v.width, v.height
    low = _plinth(b, v, w)
    split = low + (h - low) * (v.share if not v.top_freezer else 1.0 - 0.75 * v.share)
    lower = Box((-d / 2, -w / 2, low), (d / 2, w / 2, split))
    upper = Box((-d / 2, -w / 2, split), (d / 2, w / 2, h))
    cold, frozen = (lower, upper) if v.top_freezer else (upper, lower)
    _cell(b, v, cold, "door", v.hinge, shelves=v.shelves, drawers=1, racks=3)
    count = 1 if v.top_freezer else 3
    _cell(
        b, v, frozen, "freezer door", v.hinge, shelves=0, drawers=count, racks=0, prefix="freezer "
    )


def _single(b: PieceBuilder, v: Values) -> None:
    """Make one cold room behind one door."""
    d, w, h = v.depth, v.width, v.height
    low = _plinth(b, v, w)
    outer = Box((-d / 2, -w / 2, low), (d / 2, w / 2, h))
    racks = 4 if h > 1.2 else 2
    _cell(b, v, outer, "door", v.hinge, shelves=v.shelves, drawers=v.drawers, racks=racks)


def _retro(b: PieceBuilder, v: Values) -> None:
    """Make one of one colour, with round edges and a badge."""
    _single(b, Values({**v.all, "body": v.face}))


def _beside(b: PieceBuilder, v: Values) -> None:
    """Make a cold room and a freezer side by side."""
    d, w, h = v.depth, v.wide, v.height
    low = _plinth(b, v, w)
    edge = 0.08 * w
    left = Box((-d / 2, edge, low), (d / 2, w / 2, h))
    right = Box((-d / 2, -w / 2, low), (d / 2, edge, h))
    _cell(b, v, right, "door", "right", shelves=v.shelves, drawers=2, racks=4)
    _cell(b, v, left, "freezer door", "left", shelves=0, drawers=5, racks=0, prefix="freezer ")
    if v.dispenser:
        at = (d / 2 + 0.0008, float(left.middle[1]), 1.1)
        b.box(paint("#141518", 0.15), (0.002, 0.2, 0.32), at, bevel=0.0006, collides=False)


def _french(b: PieceBuilder, v: Values) -> None:
    """Make two doors above drawers that are pulled out with their fronts."""
    d, w, h = v.depth, v.wide, v.height
    low = _plinth(b, v, w)
    split = low + 0.36 * (h - low)
    outer = Box((-d / 2, -w / 2, split), (d / 2, w / 2, h))
    case = outer.within(high=(DOOR_M + 0.003, 0.0, 0.0))
    room = hollow_case(b, v.body, case, WALL_M, liner=LINER)
    _furnished(b, room, shelves=v.shelves, drawers=0, prefix="")
    right, left = outer.within((d - DOOR_M, 0.001, 0.003), (0, 0.001, 0.003)).columns([1, 1], 0.004)
    halves = room.columns([1.0, 1.0], 0.0)
    for name, face, half in (("right", right, halves[0]), ("left", left, halves[1])):
        _door(b, v, f"{name} door", face, half, name, racks=3)
    lower = Box((-d / 2, -w / 2, low), (d / 2, w / 2, split))
    for number, part in enumerate(lower.rows([1.0] * v.pulls, 0.003)):
        room = hollow_case(
            b, v.body, part.within(high=(DOOR_M + 0.003, 0.0, 0.0)), WALL_M, liner=LINER
        )
        deep = float(room.size[0]) - 0.03
        with b.slide(f"freezer drawer {number + 1}", "drawer", by=round(0.75 * deep, 3)):
            face = part.within((d - DOOR_M, 0.001, 0.002), (0.0, 0.001, 0.002))
            b.box(v.face, face.size, face.middle, bevel=v.edge)
            bin_ = room.within((0.02, 0.012, 0.012), (0.0, 0.012, 0.05))
            size, middle, t = bin_.size, bin_.middle, 0.005
            b.box(LINER, (size[0], size[1], t), (middle[0], middle[1], bin_.low[2] + t / 2))
            for sign in (-1.0, 1.0):
                at = (middle[0], middle[1] + sign * (size[1] - t) / 2, middle[2])
                b.box(LINER, (size[0], t, size[2]), at, bevel=0.001)
            b.box(LINER, (t, size[1], size[2]), (bin_.low[0] + t / 2, middle[1], middle[2]))
            _boxes(b, bin_.within((0.01, 0.01, t), (0.01, 0.01, 0.0)))
            z = float(face.high[2]) - 0.05
            handle(b, v.grip, "bar", d / 2, 0.0, z, length=0.55 * w)


_STEEL = metal("steel", 500.0)
_COATS: tuple[PieceMaterial, ...] = tuple(
    paint(c, 0.25, 300.0)
    for c in ("#7ea6a0", "#b5382f", "#e6d8b0", "#2f4257", "#e39a8f", "#1d1f22", "#a9b98f")
)
_WHITE = paint("#eeede9", 0.3, 300.0)
_SHARED = {
    "depth": Span(0.6, 0.68),
    "width": Choice(0.55, 0.6, 0.6),
    "height": Span(1.7, 2.0),
    "wide": Span(0.86, 0.94),
    "body": Choice(_WHITE, paint("#8d9194", 0.35, 300.0)),
    "face": Choice(_WHITE, _STEEL, paint("#26282b", 0.25, 300.0), paint("#b9bdbf", 0.3, 300.0)),
    "edge": Choice(0.004, 0.01),
    "grip": Choice(_STEEL, metal("chrome"), metal("#26272a")),
    "grip_z": 1.0,
    "grip_m": Choice(0.25, 0.4, 0.6),
    "hinge": Choice("left", "right"),
    "shelves": Whole(3, 4),
    "badge": False,
}

FAMILY = Family(
    name="fridge",
    category="refrigerator",
    least_m=(0.45, 0.42, 0.6),
    most_m=(0.9, 1.05, 2.1),
    styles={
        "combi": Style(
            _combi,
            {**_SHARED, "share": Span(0.33, 0.42), "top_freezer": Choice(False, False, True)},
        ),
        "tall": Style(_single, {**_SHARED, "shelves": Whole(4, 5), "drawers": Choice(1, 2)}),
        "double": Style(
            _beside, {**_SHARED, "depth": Span(0.66, 0.74), "dispenser": Choice(True, False)}
        ),
        "french": Style(
            _french, {**_SHARED, "depth": Span(0.66, 0.74), "pulls": Whole(1, 2), "shelves": 3}
        ),
        "small": Style(
            _single,
            {
                **_SHARED,
                "depth": Span(0.5, 0.58),
                "width": Choice(0.48, 0.55),
                "height": Span(0.7, 0.86),
                "grip_m": Choice(0.12, 0.2),
                "shelves": 2,
                "drawers": 1,
            },
        ),
        "retro": Style(
            _retro,
            {
                **_SHARED,
                "height": Span(1.4, 1.6),
                "face": Choice(*_COATS),
                "edge": Span(0.02, 0.024),
                "grip": metal("chrome"),
                "grip_m": Choice(0.2, 0.3),
                "drawers": 1,
                "badge": True,
            },
        ),
    },
)
