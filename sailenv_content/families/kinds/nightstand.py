"""Nightstands: of drawers, with an open shelf, with a door, round, hung on the wall."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    BOARD_M,
    CABINET_MATERIALS,
    cabinet_body,
    cabinet_door,
    cabinet_drawer,
)
from sailenv_content.families.contents import book_row, folded
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import leg, shelf
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import extruded, swept
from sailenv_content.procedural.forms import circle

__all__ = ["FAMILY"]


def _drawers(b: PieceBuilder, v: Values) -> None:
    """Fill the front with one or two drawers."""
    inside, fronts = cabinet_body(b, v)
    for number, panel in enumerate(fronts.rows([1.0] * v.rows, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {number + 1}", panel, inside)


def _below_drawer(b: PieceBuilder, v: Values) -> tuple[Box, Box]:
    """Add a body with a drawer at its top; return the hollow and the front below it."""
    inside, fronts = cabinet_body(b, v)
    lower, upper = fronts.rows([1.0 - v.upper, v.upper], CLEARANCE_M)
    cabinet_drawer(b, v, "drawer", upper, inside, front="flat")
    split = float(upper.low[2])
    shelf(b, v.scheme[0], inside, split, setback=0.0)
    return Box(inside.low, (inside.high[0], inside.high[1], split - BOARD_M)), lower


def _open(b: PieceBuilder, v: Values) -> None:
    """Make a drawer above an open room for books."""
    room, _ = _below_drawer(b, v)
    if b.chance(0.7):
        book_row(b, room, full=b.between(0.4, 0.9))


def _door(b: PieceBuilder, v: Values) -> None:
    """Make a door below a drawer."""
    room, front = _below_drawer(b, v)
    shelf(b, v.inner, room, float(room.middle[2]), setback=0.04)
    for row in room.rows([1.0, 1.0], BOARD_M):
        folded(b, row.within((0.02, 0.02, 0.001), (0.06, 0.02, 0.03)))
    cabinet_door(b, v, "door", front, v.hinge)


def _wall(b: PieceBuilder, v: Values) -> None:
    """Hang a drawer on the wall, with an open room above it for some."""
    with b.frame((v.depth / 2, 0.0, 0.0)):
        inside, fronts = cabinet_body(b, v)
        if not v.niche:
            cabinet_drawer(b, v, "drawer", fronts, inside)
            return
        lower, upper = fronts.rows([1.0, 1.0], CLEARANCE_M)
        cabinet_drawer(b, v, "drawer", lower, inside)
        shelf(b, v.scheme[0], inside, float(upper.low[2]), setback=0.0)


def _round(b: PieceBuilder, v: Values) -> None:
    """Make two round boards between posts, the upper one with a rim."""
    r, h = v.across / 2, v.height
    for z, t in ((h - 0.05, 0.022), (v.low, 0.02)):
        board = extruded(circle(40) * r, t, bevel=0.004, tile_m=v.material.tile_m)
        b.form(v.material, board, (0.0, 0.0, z))
    turn = np.linspace(0.0, 2 * np.pi, 41)
    ring = np.stack([r * np.cos(turn), r * np.sin(turn), np.full(41, h - 0.008)], -1)
    b.form(v.rail, swept(ring, 0.006, sides=8), collides="none")
    for angle in np.arange(v.count) * 2 * np.pi / v.count + np.pi / v.count:
        x, y = 0.94 * r * np.cos(angle), 0.94 * r * np.sin(angle)
        if v.rail is v.frame:
            b.form(v.frame, swept([(x, y, 0.0), (x, y, h - 0.008)], 0.009, sides=10))
        else:
            leg(b, v.frame, "round", x, y, h - 0.03, 0.03)


_SIZES = {
    "depth": Span(0.36, 0.42),
    "width": Span(0.4, 0.52),
    "height": Span(0.48, 0.6),
    "legs": Span(0.1, 0.2),
}
_BRASS, _BLACK = metal("brass"), metal("#232326")

FAMILY = Family(
    name="nightstand",
    category="nightstand",
    least_m=(0.3, 0.32, 0.15),
    most_m=(0.6, 0.62, 0.7),
    styles={
        "drawers": Style(
            _drawers,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "rows": Whole(1, 3),
                "legs": Span(0.06, 0.2),
                "leg": Choice("tapered", "round", "square", "plinth"),
                "front": Choice("flat", "shaker"),
            },
        ),
        "open": Style(
            _open, {**CABINET_MATERIALS, **_SIZES, "upper": Span(0.34, 0.42), "front": "flat"}
        ),
        "door": Style(
            _door,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "height": Span(0.55, 0.66),
                "legs": Span(0.06, 0.12),
                "leg": Choice("turned", "tapered", "plinth"),
                "upper": Span(0.3, 0.36),
                "hinge": Choice("left", "right"),
                "handle": Choice("knob", "bar", "cup"),
                "front": Choice("shaker", "louvre", "grooved"),
            },
        ),
        "wall": Style(
            _wall,
            {
                **CABINET_MATERIALS,
                "leg": "none",
                "legs": 0.0,
                "depth": Span(0.32, 0.38),
                "width": Span(0.4, 0.55),
                "height": Span(0.2, 0.32),
                "niche": Choice(True, False),
                "handle": Choice("edge", "none", "knob"),
                "front": "flat",
            },
        ),
        "round": Style(
            _round,
            {
                "across": Span(0.38, 0.48),
                "height": Span(0.5, 0.6),
                "low": Span(0.12, 0.2),
                "count": Choice(3, 4),
                "material": Choice(*WOODS, paint("#e9e6df")),
                "frame": Choice(_BRASS, _BLACK, *WOODS[:4]),
                "rail": Choice(_BRASS, _BLACK),
            },
        ),
    },
)
