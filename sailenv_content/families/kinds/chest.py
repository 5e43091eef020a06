"""Chests: dressers and nightstands of drawers, sideboards and TV units with doors and drawers."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import plates, stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, FrontKind, door, drawer
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import carcass, four_legs, shelf
from sailenv_content.families.materials import WOODS, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]

BOARD_M = 0.018


def _body(b: PieceBuilder, v: Values) -> tuple[Box, Box]:
    """Add legs and a carcass; return its hollow and the room of its fronts."""
    front = v.depth / 2 - 0.022
    low = (-v.depth / 2 + 0.006, -v.width / 2 + BOARD_M, v.legs + BOARD_M)
    inside = Box(low, (front, v.width / 2 - BOARD_M, v.height - BOARD_M))
    carcass(b, v.scheme[0], inside, top=v.scheme[2], overhang=0.0)
    four_legs(b, v.frame, v.leg, v.depth - 0.06, v.width - 0.06, v.legs, 0.04)
    x = front + 0.001
    fronts = Box((x, -v.width / 2, v.legs), (x + 0.019, v.width / 2, v.height - BOARD_M))
    return inside, fronts.inset(CLEARANCE_M)


def _drawer(
    b: PieceBuilder,
    v: Values,
    name: str,
    panel: Box,
    inside: Box,
    *,
    front: FrontKind | None = None,
) -> None:
    """Add a drawer of the chest's materials; its front is the chest's unless told otherwise."""
    drawer(
        b,
        name,
        v.scheme[1],
        front or v.front,
        panel,
        inside.size[0] - 0.03,
        inner=v.inner,
        handle_kind=v.handle,
        metal_=v.metal,
        side_gap=0.03,
    )


def _outer_doors(b: PieceBuilder, v: Values, right: Box, left: Box) -> None:
    """Add two doors with their hinges at the outer sides."""
    for side, panel in (("right", right), ("left", left)):
        door(
            b,
            f"{side} door",
            v.scheme[1],
            v.front,
            panel,
            hinge=side,
            handle_kind=v.handle,
            metal_=v.metal,
        )


def _drawers(b: PieceBuilder, v: Values) -> None:
    """Fill the front with rows of drawers."""
    inside, fronts = _body(b, v)
    number = 0
    for row in fronts.rows([1.15**k for k in range(v.rows)][::-1], CLEARANCE_M):
        for panel in row.columns([1.0] * v.columns, CLEARANCE_M):
            number += 1
            _drawer(b, v, f"drawer {number}", panel, inside)
    if v.columns == 2:
        b.box(
            v.inner,
            (inside.size[0] - 0.02, 0.016, inside.size[2]),
            (inside.middle[0] - 0.01, 0.0, inside.middle[2]),
        )


def _doors(b: PieceBuilder, v: Values) -> None:
    """Make doors at the sides, drawers between them, plates and stores inside."""
    inside, fronts = _body(b, v)
    rooms = inside.columns([1.0, 1.0, 1.0], BOARD_M)
    for room, other in ((rooms[0], rooms[1]), (rooms[1], rooms[2])):
        y = float(room.high[1] + other.low[1]) / 2
        b.box(
            v.inner,
            (inside.size[0] - 0.02, BOARD_M, inside.size[2]),
            (inside.middle[0] - 0.01, y, inside.middle[2]),
        )
    for room in (rooms[0], rooms[2]):
        z = float(room.middle[2])
        shelf(b, v.inner, room, z)
        plates(b, Box((room.low[0], room.low[1], z), room.high))
        stores(b, Box(room.low, (room.high[0], room.high[1], z - 0.02)))
    right, middle, left = fronts.columns([1.0, 1.0, 1.0], CLEARANCE_M)
    _outer_doors(b, v, right, left)
    for number, panel in enumerate(middle.rows([1.0] * v.rows, CLEARANCE_M)):
        _drawer(b, v, f"drawer {number + 1}", panel, inside, front="flat")


def _tv(b: PieceBuilder, v: Values) -> None:
    """Make a long low unit: an open middle with a shelf, a door or a drawer at each side."""
    inside, fronts = _body(b, v)
    rooms = inside.columns([1.0, 1.2, 1.0], BOARD_M)
    for room, other in ((rooms[0], rooms[1]), (rooms[1], rooms[2])):
        y = float(room.high[1] + other.low[1]) / 2
        b.box(
            v.scheme[0],
            (inside.size[0], BOARD_M, inside.size[2]),
            (inside.middle[0], y, inside.middle[2]),
        )
    shelf(b, v.scheme[0], rooms[1], float(rooms[1].middle[2]), setback=0.03)
    right, _, left = fronts.columns([1.0, 1.2, 1.0], CLEARANCE_M)
    if v.drawers:
        for name, panel in (("right drawer", right), ("left drawer", left)):
            _drawer(b, v, name, panel, inside)
    else:
        _outer_doors(b, v, right, left)


_WHITE, _DARK, _SAGE, _BLUE = (paint(c) for c in ("#e9e6df", "#33373b", "#8c9a86", "#54616b"))
_SCHEMES = (
    *((one, one, one) for one in WOODS),
    (_WHITE, _WHITE, _WHITE),
    (_WHITE, _WHITE, wood("oak")),
    (_BLUE, _BLUE, wood("oak")),
    (_SAGE, _SAGE, wood("ash")),
    (_DARK, _DARK, wood("walnut")),
    (wood("walnut"), _WHITE, wood("walnut")),
    (wood("oak"), _SAGE, wood("oak")),
    (wood("black oak"), wood("walnut"), wood("black oak")),
)
"""Materials of sides, fronts and top that go together."""

_MATERIALS = {
    "scheme": Choice(*_SCHEMES),
    "inner": wood("birch"),
    "frame": Choice(*WOODS, metal("#232326")),
    "leg": Choice("tapered", "round", "square"),
    "handle": Choice("bar", "knob", "cup", "edge"),
    "metal": Choice(metal("steel"), metal("brass"), metal("#26272a")),
}

FAMILY = Family(
    name="chest",
    category="cabinet",
    least_m=(0.32, 0.36, 0.35),
    most_m=(0.62, 2.0, 1.3),
    styles={
        "dresser": Style(
            _drawers,
            {
                **_MATERIALS,
                "depth": Span(0.44, 0.52),
                "width": Span(0.8, 1.3),
                "height": Span(0.75, 1.05),
                "legs": Span(0.08, 0.16),
                "rows": Whole(3, 5),
                "columns": Whole(1, 2),
                "front": Choice("flat", "shaker"),
            },
        ),
        "nightstand": Style(
            _drawers,
            {
                **_MATERIALS,
                "depth": Span(0.36, 0.42),
                "width": Span(0.4, 0.52),
                "height": Span(0.48, 0.6),
                "legs": Span(0.1, 0.2),
                "rows": Whole(1, 2),
                "columns": 1,
                "front": Choice("flat", "shaker"),
            },
            "nightstand",
        ),
        "sideboard": Style(
            _doors,
            {
                **_MATERIALS,
                "depth": Span(0.4, 0.48),
                "width": Span(1.4, 1.9),
                "height": Span(0.7, 0.9),
                "legs": Span(0.12, 0.2),
                "rows": Whole(3, 4),
                "front": Choice("flat", "shaker", "grooved", "glass"),
            },
        ),
        "tv": Style(
            _tv,
            {
                **_MATERIALS,
                "depth": Span(0.38, 0.45),
                "width": Span(1.3, 1.9),
                "height": Span(0.42, 0.55),
                "legs": Span(0.08, 0.16),
                "drawers": Choice(True, False),
                "front": Choice("flat", "grooved", "shaker"),
            },
        ),
    },
)
