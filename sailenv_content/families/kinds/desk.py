"""Desks: with pedestals of drawers, on trestles, a bureau with a flap, a writing table."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    CABINET_MATERIALS,
    cabinet_body,
    cabinet_drawer,
    divided,
    unit,
)
from sailenv_content.families.contents import book_row
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, drawer, flap
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import four_legs, leg, shelf
from sailenv_content.families.materials import WOODS, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import extruded, swept
from sailenv_content.procedural.forms import rectangle

__all__ = ["FAMILY"]


def _top(b: PieceBuilder, v: Values) -> None:
    """Add the board that one works on."""
    outline = rectangle(v.width, v.depth, v.round)
    mesh = extruded(outline, v.top, bevel=0.004, tile_m=v.material.tile_m)
    b.form(v.material, mesh, (0.0, 0.0, v.height - v.top), collides="box")


def _pedestals(b: PieceBuilder, v: Values) -> None:
    """Set the board on stacks of drawers at one or both sides, legs at the other."""
    _top(b, v)
    high, deep = v.height - v.top, v.depth / 2 - 0.02
    sides = (1.0, -1.0) if v.both else (v.side,)
    wide = 0.38
    for sign in sides:
        y = sign * (v.width / 2 - 0.03 - wide / 2)
        outer = Box((-deep, y - wide / 2, v.legs), (deep, y + wide / 2, high))
        inside, fronts = unit(b, v.scheme[0], outer)
        name = {1.0: "left", -1.0: "right"}[sign]
        shares = [1.6, *[1.0] * (v.rows - 1)]
        for number, panel in enumerate(fronts.rows(shares, CLEARANCE_M)):
            cabinet_drawer(b, v, f"{name} drawer {v.rows - number}", panel, inside)
        with b.frame((0.0, y, 0.0)):
            if v.leg == "plinth":
                size = (2 * deep - 0.06, wide - 0.02, v.legs)
                b.box(v.scheme[0], size, (-0.02, 0.0, v.legs / 2))
            else:
                four_legs(b, v.frame, v.leg, 2 * deep - 0.03, wide - 0.03, v.legs, 0.04)
    if not v.both:
        y = -v.side * (v.width / 2 - 0.06)
        if v.panel:
            b.box(v.scheme[0], (2 * deep, 0.026, high), (0.0, y, high / 2))
        else:
            for sx in (-1.0, 1.0):
                leg(b, v.frame, "tapered", sx * (deep - 0.03), y, high, 0.05)
    if v.panel or v.both:  # a board behind the knees
        low, inner = high - 0.32, v.width - 0.06 - wide * len(sides) - 0.05 * (not v.both)
        y = 0.0 if v.both else -v.side * (wide / 2 - 0.02)
        b.box(v.scheme[0], (0.016, inner, 0.32), (-deep + 0.04, y, low + 0.16))


def _trestle(b: PieceBuilder, v: Values) -> None:
    """Lay the board on two trestles with splayed legs."""
    _top(b, v)
    high = v.height - v.top
    for sy in (-1.0, 1.0):
        y = sy * (v.width / 2 - 0.28)
        b.box(v.frame, (v.depth - 0.1, 0.07, 0.04), (0.0, y, high - 0.02))
        for sx in (-1.0, 1.0):
            for side in (-1.0, 1.0):
                foot = (sx * (v.depth / 2 - 0.07), y + side * 0.15, 0.0)
                head = (sx * (v.depth / 2 - 0.14), y + side * 0.02, high - 0.03)
                if v.metal_legs:
                    b.form(v.frame, swept([foot, head], 0.012, sides=10))
                else:
                    size, tilt = (0.04, 0.024, high - 0.03), side * 12.0
                    at = (sx * (v.depth / 2 - 0.1), y + side * 0.085, (high - 0.03) / 2)
                    b.box(v.frame, size, at, turn=(tilt, 0.0, 0.0), bevel=0.003)
        for side in (-1.0, 1.0):
            at = (0.0, y + side * 0.112, 0.24)
            b.box(v.frame, (v.depth - 0.2, 0.02, 0.045), at, turn=(side * 12.0, 0, 0))


def _bureau(b: PieceBuilder, v: Values) -> None:
    """Make drawers below a flap that folds down to write on, pigeonholes behind it."""
    inside, fronts = cabinet_body(b, v)
    desk = v.desk
    split = (desk - v.legs - 0.006) / float(fronts.size[2])
    lower, upper = fronts.rows([split, 1.0 - split], CLEARANCE_M)
    floor = float(upper.low[2]) + 0.02
    shelf(b, v.scheme[0], inside, floor, setback=0.0)
    for number, panel in enumerate(lower.rows([1.0] * v.rows, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {v.rows - number}", panel, inside)
    flap(b, "flap", v.scheme[1], v.front, upper, handle_kind=v.handle, metal_=v.metal)
    room = Box((*inside.low[:2], floor), (inside.low[0] + 0.2, *inside.high[1:]))
    for row in room.rows([1.0, 1.0], 0.012)[1:]:
        shelf(b, v.inner, room, float(row.low[2]), thick=0.012, setback=0.0)
    for column in divided(b, v.inner, room, [1.0, 1.4, 1.4, 1.0], setback=0.0):
        if b.chance(0.6):
            below = column.rows([1.0, 1.0], 0.012)[0]
            book_row(b, below, full=b.between(0.4, 0.9))


def _writing(b: PieceBuilder, v: Values) -> None:
    """Make a table with drawers in its apron."""
    _top(b, v)
    high, tall = v.height - v.top, 0.12
    d, w = v.depth - 0.06, v.width - 0.06
    four_legs(b, v.frame, v.leg, d, w, high, 0.05)
    low = high - tall
    for sy in (-1.0, 1.0):
        b.box(v.frame, (d - 0.1, 0.02, tall), (0.0, sy * (w / 2 - 0.026), low + tall / 2))
    b.box(v.frame, (0.02, w - 0.1, tall), (-d / 2 + 0.026, 0.0, low + tall / 2))
    b.box(v.frame, (d - 0.06, w - 0.1, 0.012), (0.0, 0.0, low + 0.006))
    fronts = Box((d / 2 - 0.025, -w / 2 + 0.055, low + 0.016), (d / 2 - 0.006, w / 2 - 0.055, high))
    panels = fronts.within(high=(0.0, 0.0, 0.003)).columns([1.0] * v.count, 0.02)
    for number, panel in enumerate(panels):
        drawer(
            b,
            f"drawer {number + 1}" if v.count > 1 else "drawer",
            v.scheme[1],
            "flat",
            panel,
            d - 0.16,
            inner=v.inner,
            handle_kind=v.handle,
            metal_=v.metal,
            fill=False,
        )
    for before in panels[1:]:
        y = float(before.low[1]) - 0.01
        b.box(v.frame, (0.02, 0.016, tall), (d / 2 - 0.016, y, low + tall / 2))


def _standing(b: PieceBuilder, v: Values) -> None:
    """Set the board on two columns with feet, whose height can be set."""
    _top(b, v)
    high = v.height - v.top
    for sy in (-1.0, 1.0):
        y = sy * (v.width / 2 - 0.25)
        b.box(v.frame, (v.depth - 0.06, 0.07, 0.022), (0.0, y, 0.018), bevel=0.006)
        for sx in (-1.0, 1.0):
            at = (sx * (v.depth / 2 - 0.07), y, 0.004)
            b.box(paint("#232326"), (0.04, 0.05, 0.008), at)
        lower = 0.55 * high
        b.box(v.frame, (0.08, 0.06, lower), (0.0, y, 0.029 + lower / 2), bevel=0.006)
        b.box(v.frame, (0.068, 0.048, high - lower - 0.03), (0.0, y, (high + lower) / 2))
        b.box(v.frame, (v.depth - 0.12, 0.05, 0.025), (0.0, y, high - 0.0125))
    b.box(v.frame, (0.05, v.width - 0.5, 0.03), (0.0, 0.0, high - 0.02))
    at = (v.depth / 2 - 0.05, v.width / 2 - 0.2, high - 0.012)
    b.box(paint("#1d1e20", 0.4), (0.06, 0.11, 0.022), at, collides=False)
    if v.screen:
        size, at = (0.03, v.width - 0.1, 0.38), (-v.depth / 2 + 0.015, 0.0, v.height + 0.13)
        b.box(v.cloth, size, at, bevel=0.008)
    turn = np.linspace(0.0, np.pi, 9)
    cable = [(-0.15, 0.06 * np.cos(t), high - 0.05 - 0.12 * np.sin(t)) for t in turn]
    b.form(paint("#1d1e20", 0.5), swept(cable, 0.004, sides=6), collides="none")


_SHARED = {
    "depth": Span(0.6, 0.75),
    "width": Span(1.1, 1.6),
    "height": Span(0.72, 0.76),
    "top": Span(0.02, 0.032),
    "round": Choice(0.004, 0.004, 0.04),
    "material": Choice(*WOODS, paint("#e9e6df", 0.3), paint("#2b2d30", 0.4)),
}

FAMILY = Family(
    name="desk",
    category="desk",
    least_m=(0.4, 0.7, 0.68),
    most_m=(0.9, 2.0, 1.4),
    styles={
        "pedestal": Style(
            _pedestals,
            {
                **CABINET_MATERIALS,
                **_SHARED,
                "leg": Choice("plinth", "tapered", "square"),
                "both": Choice(True, False),
                "side": Choice(1.0, -1.0),
                "panel": Choice(True, False),
                "width": Span(1.3, 1.7),
                "legs": Span(0.05, 0.14),
                "rows": Whole(3, 4),
                "front": Choice("flat", "shaker"),
            },
        ),
        "trestle": Style(
            _trestle,
            {
                **_SHARED,
                "width": Span(1.3, 1.8),
                "metal_legs": Choice(True, False),
                "frame": Choice(*WOODS[:5], metal("#232326"), metal("#b5402f"), paint("#e9e6df")),
            },
        ),
        "bureau": Style(
            _bureau,
            {
                **CABINET_MATERIALS,
                "leg": Choice("plinth", "turned", "tapered"),
                "handle": Choice("knob", "cup", "bar"),
                "depth": Span(0.42, 0.5),
                "width": Span(0.8, 1.05),
                "height": Span(1.05, 1.25),
                "legs": Span(0.08, 0.2),
                "desk": Span(0.7, 0.74),
                "rows": Whole(2, 3),
                "front": Choice("shaker", "flat", "grooved"),
            },
        ),
        "writing": Style(
            _writing,
            {
                **CABINET_MATERIALS,
                **_SHARED,
                "leg": Choice("tapered", "turned", "square"),
                "frame": Choice(*WOODS, paint("#e9e6df")),
                "handle": Choice("knob", "cup", "bar"),
                "count": Whole(1, 3),
            },
        ),
        "standing": Style(
            _standing,
            {
                **_SHARED,
                "depth": Span(0.7, 0.8),
                "width": Span(1.2, 1.7),
                "height": Span(0.72, 1.15),
                "frame": Choice(metal("#232326"), metal("#e6e4de"), metal("alu")),
                "screen": Choice(True, False, False),
                "cloth": Choice(paint("#6f7a83", 0.9), paint("#3d5a5c", 0.9), wood("birch")),
            },
        ),
    },
)
