"""Chests of drawers: dressers, tallboys, commodes with doors below, many small drawers."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    BOARD_M,
    CABINET_MATERIALS,
    cabinet_body,
    cabinet_drawer,
    divided,
    outer_doors,
)
from sailenv_content.families.contents import folded
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import shelf
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]


def _drawers(b: PieceBuilder, v: Values) -> None:
    """Fill the front with rows of drawers."""
    inside, fronts = cabinet_body(b, v)
    number = 0
    for row in fronts.rows([1.15**k for k in range(v.rows)][::-1], CLEARANCE_M):
        for panel in row.columns([1.0] * v.columns, CLEARANCE_M):
            number += 1
            cabinet_drawer(b, v, f"drawer {number}", panel, inside)
    if v.columns == 2:
        divided(b, v.inner, inside, [1.0, 1.0])


def _apothecary(b: PieceBuilder, v: Values) -> None:
    """Fill the front with small drawers in equal rooms."""
    inside, fronts = cabinet_body(b, v)
    divided(b, v.inner, inside, [1.0] * v.columns)
    number = 0
    for row in fronts.rows([1.0] * v.rows, CLEARANCE_M):
        for panel in row.columns([1.0] * v.columns, CLEARANCE_M):
            number += 1
            cabinet_drawer(b, v, f"drawer {number}", panel, inside)


def _commode(b: PieceBuilder, v: Values) -> None:
    """Make two drawers above two doors, with clothes on a shelf behind."""
    inside, fronts = cabinet_body(b, v)
    lower, upper = fronts.rows([1.0 - v.upper, v.upper], CLEARANCE_M)
    split = float(upper.low[2])
    room = Box(inside.low, (inside.high[0], inside.high[1], split - BOARD_M))
    shelf(b, v.inner, inside, split, setback=0.0)
    shelf(b, v.inner, room, float(room.middle[2]), setback=0.04)
    for row in room.rows([1.0, 1.0], BOARD_M):
        folded(b, row.within((0.02, 0.02, 0.001), (0.06, 0.02, 0.04)))
    for side, panel in zip(("right", "left"), upper.columns([1.0, 1.0], CLEARANCE_M), strict=True):
        cabinet_drawer(b, v, f"{side} drawer", panel, inside, front="flat")
    right, left = lower.columns([1.0, 1.0], CLEARANCE_M)
    outer_doors(b, v, right, left)


FAMILY = Family(
    name="chest",
    category="cabinet",
    least_m=(0.32, 0.36, 0.35),
    most_m=(0.62, 2.0, 1.5),
    styles={
        "dresser": Style(
            _drawers,
            {
                **CABINET_MATERIALS,
                "depth": Span(0.44, 0.52),
                "width": Span(0.8, 1.3),
                "height": Span(0.75, 1.05),
                "legs": Span(0.08, 0.16),
                "rows": Whole(3, 5),
                "columns": Whole(1, 2),
                "front": Choice("flat", "shaker"),
            },
        ),
        "tallboy": Style(
            _drawers,
            {
                **CABINET_MATERIALS,
                "leg": Choice("plinth", "tapered", "turned"),
                "depth": Span(0.4, 0.46),
                "width": Span(0.45, 0.65),
                "height": Span(1.15, 1.4),
                "legs": Span(0.07, 0.12),
                "rows": Whole(5, 7),
                "columns": 1,
                "front": Choice("flat", "shaker"),
            },
        ),
        "apothecary": Style(
            _apothecary,
            {
                **CABINET_MATERIALS,
                "leg": Choice("plinth", "square", "turned"),
                "handle": Choice("cup", "knob"),
                "depth": Span(0.34, 0.4),
                "width": Span(0.9, 1.3),
                "height": Span(0.8, 1.05),
                "legs": Span(0.07, 0.14),
                "rows": Whole(4, 5),
                "columns": Whole(4, 6),
                "front": "flat",
            },
        ),
        "commode": Style(
            _commode,
            {
                **CABINET_MATERIALS,
                "leg": Choice("turned", "tapered", "plinth"),
                "handle": Choice("bar", "knob", "cup"),
                "depth": Span(0.42, 0.5),
                "width": Span(0.9, 1.2),
                "height": Span(0.8, 0.95),
                "legs": Span(0.08, 0.16),
                "upper": Span(0.24, 0.3),
                "front": Choice("shaker", "louvre", "grooved"),
            },
        ),
    },
)
