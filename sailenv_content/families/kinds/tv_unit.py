"""Units for a television: low with doors or drawers, hung on the wall, with a flap, of metal."""

from __future__ import annotations

from itertools import pairwise

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    CABINET_MATERIALS,
    cabinet_body,
    cabinet_drawer,
    divided,
    outer_doors,
)
from sailenv_content.families.contents import book_row
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, flap
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import shelf
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]


def _player(b: PieceBuilder, room: Box) -> None:
    """Stand a flat device into a room: a receiver or a console."""
    size = (min(0.26, float(room.size[0]) - 0.04), min(0.4, float(room.size[1]) - 0.04), 0.055)
    if room.size[2] < 0.09 or size[1] < 0.2:
        return
    at = (room.high[0] - 0.03 - size[0] / 2, float(room.middle[1]), room.low[2] + 0.035)
    black = paint("#1d1e20", 0.35, 900.0)
    b.box(black, size, at, bevel=0.004, collides=False)
    for sy in (-1.0, 1.0):
        foot = (at[0], at[1] + sy * 0.36 * size[1], room.low[2] + 0.004)
        b.box(black, (0.1, 0.03, 0.008), foot, collides=False)
    front = (at[0] + size[0] / 2 + 0.0005, at[1] - 0.2 * size[1], at[2])
    b.box(paint("#3d6f8f", 0.2), (0.002, 0.05, 0.012), front, bevel=0.0004, collides=False)


def _low(b: PieceBuilder, v: Values) -> None:
    """Make an open middle with a shelf, a door or a drawer at each side."""
    inside, fronts = cabinet_body(b, v)
    shares = [1.0, 1.2, 1.0]
    rooms = divided(b, v.scheme[0], inside, shares, setback=0.0)
    z = float(rooms[1].middle[2])
    shelf(b, v.scheme[0], rooms[1], z, setback=0.03)
    _player(b, Box((*rooms[1].low[:2], z), rooms[1].high))
    right, _, left = fronts.columns(shares, CLEARANCE_M)
    if v.drawers:
        for name, panel in (("right drawer", right), ("left drawer", left)):
            cabinet_drawer(b, v, name, panel, inside)
    else:
        outer_doors(b, v, right, left)


def _row(b: PieceBuilder, v: Values) -> None:
    """Make a row of drawers below an open slot for devices."""
    inside, fronts = cabinet_body(b, v)
    lower, upper = fronts.rows([1.0 - v.slot, v.slot], CLEARANCE_M)
    split = float(upper.low[2])
    shelf(b, v.scheme[0], inside, split, setback=0.0)
    above = Box((*inside.low[:2], split), inside.high)
    for room in divided(b, v.scheme[0], above, [1.0] * (v.count - 1), setback=0.0):
        if b.chance(0.6):
            _player(b, room)
    for number, panel in enumerate(lower.columns([1.0] * v.count, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {number + 1}", panel, inside)


def _flaps(b: PieceBuilder, v: Values) -> None:
    """Make flaps that fold down, side by side, before rooms of devices."""
    inside, fronts = cabinet_body(b, v)
    for room in divided(b, v.inner, inside, [1.0] * v.count):
        _player(b, room)
    names = ("right flap", "left flap") if v.count == 2 else ("right flap", "flap", "left flap")
    columns = fronts.columns([1.0] * v.count, CLEARANCE_M)
    for name, panel in zip(names, columns, strict=True):
        flap(b, name, v.scheme[1], v.front, panel, handle_kind=v.handle, metal_=v.metal)


def _wall(b: PieceBuilder, v: Values) -> None:
    """Hang a long box on the wall, with flaps that fold down."""
    with b.frame((v.depth / 2, 0.0, 0.0)):
        _flaps(b, v)


def _industrial(b: PieceBuilder, v: Values) -> None:
    """Make boards in a frame of metal, with books and devices below."""
    d, w, h = v.depth, v.width, v.height
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            at = (sx * (d / 2 - 0.0125), sy * (w / 2 - 0.0125), h / 2)
            b.box(v.frame, (0.025, 0.025, h), at)
    levels = (0.1, (h + 0.08) / 2, h - 0.014) if v.shelves == 3 else (0.16, h - 0.014)
    for z in levels:
        b.box(v.material, (d - 0.005, w - 0.052, 0.026), (0.0, 0.0, z))
        for sy in (-1.0, 1.0):
            b.box(v.frame, (d - 0.05, 0.02, 0.02), (0.0, sy * (w / 2 - 0.0125), z))
    for low, high in pairwise(levels):
        room = Box(
            (-d / 2 + 0.03, -w / 2 + 0.06, low + 0.013), (d / 2 - 0.02, w / 2 - 0.06, high - 0.013)
        )
        right, middle, left = room.columns([1.0, 1.0, 1.0], 0.02)
        _player(b, middle)
        book_row(b, b.pick(right, left), full=b.between(0.4, 0.9))


_SIZES = {
    "depth": Span(0.38, 0.45),
    "width": Span(1.3, 1.9),
    "height": Span(0.42, 0.55),
    "legs": Span(0.08, 0.16),
}

FAMILY = Family(
    name="tv_unit",
    category="cabinet",
    least_m=(0.3, 1.0, 0.2),
    most_m=(0.6, 2.4, 0.75),
    styles={
        "low": Style(
            _low,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "drawers": Choice(True, False),
                "front": Choice("flat", "grooved", "shaker"),
            },
        ),
        "row": Style(
            _row,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "height": Span(0.46, 0.6),
                "leg": Choice("plinth", "tapered", "square"),
                "slot": Span(0.36, 0.44),
                "count": Whole(2, 4),
                "front": Choice("flat", "shaker"),
            },
        ),
        "flaps": Style(
            _flaps,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "leg": Choice("plinth", "round", "hairpin"),
                "handle": Choice("edge", "bar", "knob"),
                "count": Whole(2, 3),
                "front": Choice("flat", "louvre", "glass"),
            },
        ),
        "wall": Style(
            _wall,
            {
                **CABINET_MATERIALS,
                "leg": "none",
                "legs": 0.0,
                "depth": Span(0.34, 0.4),
                "width": Span(1.4, 2.1),
                "height": Span(0.26, 0.38),
                "handle": Choice("edge", "none"),
                "count": Whole(2, 3),
                "front": Choice("flat", "grooved"),
            },
        ),
        "industrial": Style(
            _industrial,
            {
                **_SIZES,
                "shelves": Choice(2, 3),
                "height": Span(0.45, 0.58),
                "material": Choice(*WOODS),
                "frame": Choice(metal("#232326"), metal("brass"), metal("#e6e4de")),
            },
        ),
    },
)
