"""Sideboards: doors and drawers, sliding doors, a hutch with glass, slats, on a metal frame."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    BOARD_M,
    CABINET_MATERIALS,
    cabinet_body,
    cabinet_drawer,
    divided,
    outer_doors,
    stocked,
)
from sailenv_content.families.contents import plates
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, sliding_doors
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import carcass, shelf
from sailenv_content.families.materials import metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]


def _doors(b: PieceBuilder, v: Values) -> None:
    """Make doors at the sides, drawers between them."""
    inside, fronts = cabinet_body(b, v)
    rooms = divided(b, v.inner, inside, [1.0, 1.0, 1.0])
    stocked(b, v.inner, rooms[0], setback=0.03)
    stocked(b, v.inner, rooms[2], setback=0.03)
    right, middle, left = fronts.columns([1.0, 1.0, 1.0], CLEARANCE_M)
    outer_doors(b, v, right, left)
    for number, panel in enumerate(middle.rows([1.0] * v.rows, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {number + 1}", panel, inside, front="flat")


def _sliding(b: PieceBuilder, v: Values) -> None:
    """Make two doors that slide past each other, of wood or of glass, before two rooms."""
    inside, fronts = cabinet_body(b, Values({**v.all, "depth": v.depth - 0.03}))
    for room in divided(b, v.inner, inside, [1.0, 1.0]):
        stocked(b, v.inner, room, setback=0.03)
    x = fronts.low[0] + 0.003
    opening = Box((x, *fronts.low[1:]), (x + 0.05, *fronts.high[1:]))
    z = float(opening.middle[2])
    sliding_doors(b, opening, v.scheme[1], v.front, v.metal, grip_z=z, grip_m=0.12)
    for edge in (opening.low[2] - 0.004, opening.high[2] + 0.004):
        at = (x + 0.022, 0.0, edge)
        b.box(v.metal, (0.056, v.width - 0.004, 0.004), at, bevel=0.001, collides=False)


def _drawers_and_doors(b: PieceBuilder, v: Values) -> None:
    """Make a row of drawers above two pairs of doors, or one."""
    inside, fronts = cabinet_body(b, v)
    lower, upper = fronts.rows([1.0 - v.upper, v.upper], CLEARANCE_M)
    split = float(upper.low[2])
    shelf(b, v.inner, inside, split, setback=0.0)
    below = Box(inside.low, (inside.high[0], inside.high[1], split - BOARD_M))
    for room in divided(b, v.inner, below, [1.0] * v.pairs):
        stocked(b, v.inner, room, setback=0.03)
    for number, panel in enumerate(upper.columns([1.0] * v.drawers, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {number + 1}", panel, inside, front="flat")
    columns = lower.columns([1.0] * (2 * v.pairs), CLEARANCE_M)
    for pair in range(v.pairs):
        prefix = ("right ", "left ")[pair] if v.pairs > 1 else ""
        outer_doors(b, v, columns[2 * pair], columns[2 * pair + 1], prefix=prefix)


def _hutch(b: PieceBuilder, v: Values) -> None:
    """Set a narrower case with glass doors and shelves of plates on top of it."""
    _drawers_and_doors(b, v)
    deep, rise = v.depth * 0.7, v.rise
    back = -v.depth / 2
    low = (back + 0.006, -v.width / 2 + 0.03, v.height + BOARD_M)
    inside = Box(low, (back + deep - 0.022, v.width / 2 - 0.03, v.height + rise - BOARD_M))
    carcass(b, v.scheme[0], inside, top=v.scheme[2], overhang=0.015)
    for number, row in enumerate(inside.rows([1.0] * 3, BOARD_M)):
        if number:
            shelf(b, v.inner, inside, float(row.low[2]), setback=0.03)
        plates(b, row)
    x = inside.high[0] + 0.001
    panels = Box(
        (x, inside.low[1] - BOARD_M, low[2]), (x + 0.019, inside.high[1] + BOARD_M, inside.high[2])
    )
    right, left = panels.inset(CLEARANCE_M).columns([1.0, 1.0], CLEARANCE_M)
    outer_doors(b, Values({**v.all, "front": "glass"}), right, left, prefix="upper ")


_SIZES = {
    "depth": Span(0.4, 0.48),
    "width": Span(1.4, 1.9),
    "height": Span(0.7, 0.9),
    "legs": Span(0.12, 0.2),
}

FAMILY = Family(
    name="sideboard",
    category="cabinet",
    least_m=(0.34, 0.9, 0.55),
    most_m=(0.62, 2.3, 2.2),
    styles={
        "doors": Style(
            _doors,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "rows": Whole(3, 4),
                "front": Choice("flat", "shaker", "grooved", "glass"),
            },
        ),
        "sliding": Style(
            _sliding,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "width": Span(1.4, 2.0),
                "height": Span(0.62, 0.78),
                "front": Choice("flat", "grooved", "glass", "louvre"),
            },
        ),
        "buffet": Style(
            _drawers_and_doors,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "height": Span(0.82, 0.95),
                "legs": Span(0.07, 0.12),
                "leg": Choice("plinth", "turned", "tapered"),
                "handle": Choice("knob", "cup", "bar"),
                "upper": Span(0.2, 0.26),
                "pairs": 2,
                "drawers": Choice(3, 4),
                "front": Choice("shaker", "grooved", "louvre"),
            },
        ),
        "hutch": Style(
            _hutch,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "width": Span(0.95, 1.3),
                "height": Span(0.8, 0.9),
                "rise": Span(0.95, 1.15),
                "legs": Span(0.07, 0.1),
                "leg": Choice("plinth", "turned"),
                "handle": Choice("knob", "bar"),
                "upper": Span(0.2, 0.25),
                "pairs": 1,
                "drawers": Choice(2, 3),
                "front": Choice("shaker", "grooved"),
            },
        ),
        "highboard": Style(
            _doors,
            {
                **CABINET_MATERIALS,
                **_SIZES,
                "width": Span(1.2, 1.5),
                "height": Span(1.05, 1.3),
                "legs": Span(0.14, 0.24),
                "leg": Choice("square", "hairpin"),
                "frame": Choice(metal("#232326"), metal("brass"), wood("black oak")),
                "handle": Choice("edge", "bar", "none"),
                "rows": Whole(4, 5),
                "front": Choice("flat", "grooved"),
                "inner": Choice(wood("birch"), paint("#e7e3da")),
            },
        ),
    },
)
