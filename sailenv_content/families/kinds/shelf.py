"""Shelves: boards on the wall, boxes on the wall, a ladder, a round one, an open stand."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import BOARD_M, divided, unit
from sailenv_content.families.contents import book_row, plates, stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import closed_ring
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import placed, swept

__all__ = ["FAMILY"]


def _filled(b: PieceBuilder, room: Box) -> None:
    """Put books, dishes or nothing on the floor of a room."""
    kind = b.pick("books", "books", "dishes", "stores", "none")
    inner = room.within((0.0, 0.01, 0.0), (0.01, 0.01, 0.0))
    if kind == "books":
        book_row(b, inner, full=b.between(0.3, 0.9))
    elif kind == "dishes":
        plates(b, inner)
    elif kind == "stores":
        stores(b, inner)


def _boards(b: PieceBuilder, v: Values) -> None:
    """Hang boards on the wall, one above another, on brackets or none."""
    d, w = v.depth, v.width
    for number in range(v.rows):
        z = 0.112 + v.thick / 2 + number * v.step if v.bracket else v.thick / 2 + number * v.step
        b.box(v.material, (d, w, v.thick), (d / 2, 0.0, z), bevel=0.003)
        if v.bracket:
            for sy in (-1.0, 1.0):
                y, low = sy * (w / 2 - 0.12), z - v.thick / 2
                b.box(v.frame, (0.85 * d, 0.022, 0.004), (0.43 * d, y, low - 0.002))
                b.box(v.frame, (0.004, 0.022, 0.11), (0.002, y, low - 0.055))
                brace = [(0.004, y, low - 0.09), (0.7 * d, y, low - 0.004)]
                b.form(v.frame, swept(brace, 0.005, sides=8))
        top = z + v.thick / 2
        _filled(b, Box((0.01, -w / 2, top), (d, w / 2, top + min(v.step - v.thick, 0.32))))


def _cubes(b: PieceBuilder, v: Values) -> None:
    """Hang open boxes on the wall, in a staggered row."""
    each = v.cube
    for number in range(v.count):
        y = (number - v.count / 2) * (each - BOARD_M)
        z = 0.0 if number % 2 else v.stagger * each
        outer = Box((0.0, y, z), (v.depth, y + each, z + each))
        with b.frame((0.0, 0.0005 * number, 0.0)):
            inside, _ = unit(b, b.pick(v.material, v.material, v.accent), outer)
            _filled(b, inside)


def _ladder(b: PieceBuilder, v: Values) -> None:
    """Lean a ladder whose boards get narrower towards its top."""
    w, h = v.width, v.height
    lean = 0.36
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - 0.012)
        tilt = float(np.degrees(np.arctan2(lean, h)))
        size = (0.03, 0.024, float(np.hypot(h, lean)) - 0.02)
        b.box(v.frame, size, (0.02, y, h / 2), turn=(0.0, -tilt, 0.0))
    for number in range(v.rows):
        z = 0.14 + (h - 0.3) * number / (v.rows - 1)
        front = 0.02 + lean * (0.5 - z / h) + 0.02
        back = -0.02 - lean / 2
        size = (front - back, w - 0.05, 0.02)
        at = ((front + back) / 2, 0.0, z)
        b.box(v.material, size, at)
        b.box(v.material, (0.012, w - 0.05, 0.05), (back - 0.006, 0.0, z + 0.015))
        if number < v.rows - 1:
            room = Box((back, -w / 2 + 0.04, z + 0.01), (front - 0.03, w / 2 - 0.04, z + 0.26))
            _filled(b, room)


def _round(b: PieceBuilder, v: Values) -> None:
    """Hang a ring of metal on the wall, with boards across it."""
    r, d = v.across / 2, v.depth
    ring = closed_ring([(r, 0.0), (r, d), (r - 0.012, d), (r - 0.012, 0.0)], segments=48)
    b.form(
        v.frame,
        placed(ring, (0, 0, 0), (0.0, 90.0, 0.0)),
        (0.0, 0.0, r),
        collides="none",
        volume=2e-4,
    )
    for angle in np.arange(16) * np.pi / 8:
        at = (d / 2, (r - 0.006) * np.cos(angle), r + (r - 0.006) * np.sin(angle))
        b.collide((d, 0.39 * r, 0.012), at, (float(np.degrees(angle)) + 90.0, 0.0, 0.0))
    for share in v.levels:
        z = 2 * r * share
        half = float(np.sqrt(max(r**2 - (z - r) ** 2, 0.0))) - 0.014
        b.box(v.material, (d - 0.004, 2 * half, 0.018), (d / 2, 0.0, z))
        room = Box((0.01, -0.8 * half, z + 0.009), (d, 0.8 * half, z + 0.5 * r))
        _filled(b, room)


def _stand(b: PieceBuilder, v: Values) -> None:
    """Make open rooms between boards, some of them shifted, on the floor."""
    d, w, h = v.depth, v.width, v.height
    outer = Box((-d / 2, -w / 2, 0.0), (d / 2, w / 2, h))
    inside, _ = unit(b, v.material, outer, has_back=False)
    for number, row in enumerate(inside.rows([1.0] * v.rows, BOARD_M)):
        if number:
            at = (row.middle[0], row.middle[1], float(row.low[2]) - BOARD_M / 2)
            b.box(v.material, (row.size[0], row.size[1], BOARD_M), at)
        share = 0.62 if number % 2 else 0.38
        for room in divided(b, v.material, row, [share, 1 - share], setback=0.0):
            _filled(b, room)


_SHARED = {
    "depth": Span(0.2, 0.28),
    "width": Span(0.7, 1.1),
    "height": Span(1.5, 1.9),
    "rows": Whole(2, 3),
    "step": Span(0.3, 0.36),
    "thick": Span(0.02, 0.036),
    "material": Choice(*WOODS, paint("#e9e6df"), paint("#33373b")),
    "accent": Choice(paint("#8c9a86"), paint("#54616b"), paint("#b5694a"), *WOODS[:3]),
    "frame": Choice(metal("#232326"), metal("brass"), metal("#e6e4de")),
}

FAMILY = Family(
    name="shelf",
    category="shelf",
    least_m=(0.12, 0.4, 0.2),
    most_m=(0.6, 1.8, 2.1),
    styles={
        "boards": Style(_boards, {**_SHARED, "bracket": Choice(True, False), "rows": Whole(1, 3)}),
        "boxes": Style(
            _cubes,
            {
                **_SHARED,
                "cube": Span(0.3, 0.38),
                "count": Whole(2, 4),
                "stagger": Choice(0.0, 0.3, 0.5),
            },
        ),
        "ladder": Style(_ladder, {**_SHARED, "width": Span(0.5, 0.75), "rows": Whole(4, 5)}),
        "round": Style(
            _round,
            {
                **_SHARED,
                "across": Span(0.6, 0.85),
                "depth": Span(0.14, 0.2),
                "levels": Choice((0.3, 0.62), (0.22, 0.5, 0.76)),
            },
        ),
        "stand": Style(
            _stand,
            {**_SHARED, "depth": Span(0.28, 0.34), "rows": Whole(4, 5), "width": Span(0.7, 1.0)},
        ),
    },
)
