"""Bookcases filled with books: closed, ladder, cubes, industrial, with doors below."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import book_row, stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, door
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import carcass
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]

BOARD_M = 0.02


def _hollow(v: Values, base: float) -> Box:
    low = (-v.depth / 2 + 0.006, -v.width / 2 + BOARD_M, base + BOARD_M)
    return Box(low, (v.depth / 2, v.width / 2 - BOARD_M, v.height - BOARD_M))


def _shelved(b: PieceBuilder, v: Values, room: Box, rows: int) -> None:
    """Divide a hollow by shelves, and stand books on each."""
    for row in room.rows([1.0] * rows, BOARD_M):
        if row.low[2] > room.low[2] + 0.01:
            z = float(row.low[2]) - BOARD_M / 2
            b.box(
                v.material,
                (room.size[0] - 0.004, room.size[1] - 0.001, BOARD_M),
                (room.middle[0] - 0.002, room.middle[1], z),
            )
        if b.chance(0.92):
            book_row(b, row, full=b.between(0.45, 1.0))


def _on_plinth(b: PieceBuilder, v: Values) -> Box:
    """Make a carcass on a plinth; return its hollow."""
    inside = _hollow(v, 0.06)
    carcass(b, v.material, inside, board=BOARD_M)
    b.box(v.material, (v.depth - 0.04, v.width - 0.01, 0.06), (-0.015, 0.0, 0.03))
    return inside


def _closed(b: PieceBuilder, v: Values) -> None:
    """Make a carcass on a plinth, full of shelves."""
    inside = _on_plinth(b, v)
    _shelved(b, v, inside, v.rows)


def _cubes(b: PieceBuilder, v: Values) -> None:
    """Make a grid of square rooms."""
    inside = _hollow(v, 0.0)
    carcass(b, v.material, inside, board=BOARD_M, has_back=False)
    rooms = inside.columns([1.0] * v.columns, BOARD_M)
    for room in rooms[1:]:
        y = float(room.low[1]) - BOARD_M / 2
        b.box(
            v.material,
            (inside.size[0], BOARD_M, inside.size[2]),
            (inside.middle[0], y, inside.middle[2]),
        )
    for room in rooms:
        _shelved(b, v, room, v.rows)


def _industrial(b: PieceBuilder, v: Values) -> None:
    """Make shelves of wood in a frame of metal, open at all sides."""
    d, w, h = v.depth, v.width, v.height
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(v.frame, (0.025, 0.025, h), (sx * (d / 2 - 0.0125), sy * (w / 2 - 0.0125), h / 2))
    step = (h - 0.12) / (v.rows - 1)
    for number in range(v.rows):
        z = 0.1 + number * step
        b.box(v.material, (d - 0.005, w - 0.052, 0.024), (0.0, 0.0, z))
        for sy in (-1.0, 1.0):
            b.box(v.frame, (d - 0.05, 0.02, 0.02), (0.0, sy * (w / 2 - 0.0125), z))
        if number < v.rows - 1:
            row = Box(
                (-d / 2 + 0.03, -w / 2 + 0.05, z + 0.012),
                (d / 2 - 0.02, w / 2 - 0.05, z + step - 0.012),
            )
            book_row(b, row, full=b.between(0.3, 0.85))


def _with_doors(b: PieceBuilder, v: Values) -> None:
    """Make shelves above, and two doors in front of stores below."""
    inside = _on_plinth(b, v)
    split = 0.06 + BOARD_M + v.low
    front = float(inside.high[0]) - 0.022
    b.box(v.material, (inside.size[0], inside.size[1], BOARD_M), (inside.middle[0], 0.0, split))
    below = Box(inside.low, (front, inside.high[1], split - BOARD_M / 2))
    stores(b, below.within((0.05, 0.02, 0.0), (0.05, 0.02, 0.1)))
    _shelved(
        b, v, Box((inside.low[0], inside.low[1], split + BOARD_M / 2), inside.high), v.rows - 1
    )
    panels = Box(
        (front + 0.001, below.low[1], below.low[2]), (front + 0.02, below.high[1], below.high[2])
    )
    right, left = panels.inset(CLEARANCE_M).columns([1.0, 1.0], CLEARANCE_M)
    door(
        b, "right door", v.door, v.front, right, hinge="right", handle_kind=v.handle, metal_=v.metal
    )
    door(b, "left door", v.door, v.front, left, hinge="left", handle_kind=v.handle, metal_=v.metal)


_SHARED = {
    "depth": Span(0.26, 0.34),
    "width": Span(0.7, 1.1),
    "height": Span(1.5, 2.1),
    "rows": Whole(4, 6),
    "material": Choice(*WOODS, paint("#e9e6df"), paint("#33373b"), paint("#8c9a86")),
}

FAMILY = Family(
    name="bookcase",
    category="bookcase",
    least_m=(0.2, 0.5, 0.7),
    most_m=(0.5, 2.0, 2.3),
    styles={
        "tall": Style(_closed, _SHARED),
        "cubes": Style(
            _cubes,
            {
                **_SHARED,
                "width": Span(1.1, 1.5),
                "height": Span(1.1, 1.5),
                "rows": Whole(3, 4),
                "columns": Whole(3, 4),
            },
        ),
        "industrial": Style(
            _industrial,
            {
                **_SHARED,
                "frame": Choice(metal("#232326"), metal("brass"), metal("#e6e4de")),
                "rows": Whole(4, 5),
            },
        ),
        "cabinet": Style(
            _with_doors,
            {
                **_SHARED,
                "low": Span(0.45, 0.6),
                "height": Span(1.7, 2.1),
                "rows": Whole(4, 5),
                "front": Choice("flat", "shaker", "glass"),
                "door": Choice(*WOODS, paint("#e9e6df"), paint("#54616b")),
                "handle": Choice("bar", "knob"),
                "metal": Choice(metal("steel"), metal("brass")),
            },
        ),
    },
)
