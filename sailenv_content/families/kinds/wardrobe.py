"""Wardrobes: hinged and sliding doors, clothes on a rail, folded ones on shelves and in drawers."""

from __future__ import annotations

from itertools import pairwise

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import folded, hung_clothes
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, door, drawer, sliding_doors
from sailenv_content.families.hardware import DRAWER_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import carcass, four_legs, shelf
from sailenv_content.families.materials import PieceMaterial, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values, Whole

__all__ = ["FAMILY"]

WHITES = ("#ece8e0", "#e4e2dc", "#d9d5cb")
PAINTS = (*WHITES, "#8c9a86", "#54616b", "#b8a48c")


def _inside(v: Values, base: float, board: float = 0.018) -> Box:
    """Return the hollow of a wardrobe of a depth, width and height over its doors."""
    front = v.depth / 2.0 - 0.02
    low = (-v.depth / 2.0 + 0.006, -v.width / 2.0 + board, base + board)
    return Box(low, (front, v.width / 2.0 - board, v.height - board))


def _furnished(b: PieceBuilder, inner: PieceMaterial, inside: Box, columns: int) -> None:
    """Divide the inside; one column has shelves, the others a rail."""
    rooms = inside.columns([1.0] * columns, 0.018)
    for before, after in pairwise(rooms):
        y = (before.high[1] + after.low[1]) / 2.0
        b.box(
            inner,
            (inside.size[0] - 0.02, 0.018, inside.size[2]),
            (inside.middle[0] - 0.01, y, inside.middle[2]),
        )
    for number, room in enumerate(rooms):
        if number == len(rooms) - 1 and len(rooms) > 1:
            for row in room.rows([1.0] * 5, 0.018):
                if row.low[2] > room.low[2] + 0.01:
                    shelf(b, inner, room, float(row.low[2]), setback=0.03)
                folded(b, row.within((0.02, 0.01, 0.0), (0.06, 0.01, 0.06)))
        else:
            shelf(b, inner, room, float(room.high[2] - 0.28), setback=0.03)
            folded(b, room.within((0.02, 0.01, room.size[2] - 0.28), (0.06, 0.01, 0.05)))
            hung_clothes(b, room.within((0.0, 0.01, 0.02), (0.03, 0.01, 0.30)))


def _doors(
    b: PieceBuilder,
    material: PieceMaterial,
    front: Box,
    v: Values,
    metal_: PieceMaterial,
    count: int,
) -> None:
    leaves = front.inset(CLEARANCE_M).columns([1.0] * count, CLEARANCE_M)
    for number, panel in enumerate(leaves):
        hinge = "right" if (number % 2 == 0 and number < count - 1) or count == 1 else "left"
        names = {1: ("door",), 2: ("right door", "left door")}
        name = names.get(count, tuple(f"door {k + 1}" for k in range(count)))[number]
        door(
            b,
            name,
            material,
            v.front,
            panel,
            hinge=hinge,
            handle_kind=v.handle,
            metal_=metal_,
            handle_z=min(1.05, float(panel.middle[2])),
            opens_deg=110.0 if count < 3 else 78.0,  # neighbours open towards each other
        )


def _front(inside: Box, v: Values, low: float, high: float) -> Box:
    x = inside.high[0] + 0.001
    return Box((x, -v.width / 2.0, low), (x + 0.019, v.width / 2.0, high))


def _hinged(b: PieceBuilder, v: Values) -> None:
    material, metal_ = v.material, v.metal
    inside = _inside(v, v.base)
    carcass(b, material, inside)
    b.box(material, (v.depth - 0.06, v.width - 0.03, v.base), (-0.02, 0.0, v.base / 2.0))
    count = max(2, round(v.width / 0.5))
    _furnished(b, v.inner, inside, max(1, count // 2))
    _doors(b, material, _front(inside, v, v.base, v.height), v, metal_, count)


def _sliding(b: PieceBuilder, v: Values) -> None:
    inside = _inside(v, 0.05)
    inside = inside.within(high=(0.04, 0.0, 0.0))
    carcass(b, v.material, inside)
    b.box(v.material, (v.depth - 0.06, v.width - 0.03, 0.05), (-0.02, 0.0, 0.025))
    rooms = 2 if v.width < 2.0 else 3
    _furnished(b, v.inner, inside, rooms)
    half, x = v.width / 2.0, inside.high[0] + 0.003
    opening = Box((x, -half, 0.055), (x + 0.05, half, v.height - 0.004))
    sliding_doors(b, opening, v.door, v.front, v.metal, grip_z=1.0)
    for z in (0.052, v.height - 0.002):
        b.box(
            v.metal,
            (0.062, v.width, 0.004),
            (inside.high[0] + 0.031, 0.0, z),
            bevel=0.001,
            collides=False,
        )


def _with_drawers(b: PieceBuilder, v: Values) -> None:
    """Make two doors above one or two drawers, on legs."""
    base = v.legs
    inside = _inside(v, base)
    carcass(b, v.material, inside, overhang=0.012)
    four_legs(b, v.material, "tapered", v.depth - 0.04, v.width - 0.02, base, 0.045)
    split = base + 0.018 + 0.24 * v.rows
    b.box(v.material, (inside.size[0], inside.size[1], 0.018), (inside.middle[0], 0.0, split))
    _furnished(b, v.inner, Box((*inside.low[:2], split + 0.009), inside.high), 1)
    lower = _front(inside, v, base, split).inset(CLEARANCE_M)
    for number, panel in enumerate(lower.rows([1.0] * v.rows, CLEARANCE_M)):
        drawer(
            b,
            f"drawer {number + 1}",
            v.material,
            "flat",
            panel,
            inside.size[0] - 0.03,
            inner=v.inner,
            handle_kind=v.handle,
            metal_=v.metal,
            side_gap=0.034,
            soft_close=DRAWER_CLOSE,
        )
    _doors(b, v.material, _front(inside, v, split, v.height - 0.018), v, v.metal, 2)


def _open(b: PieceBuilder, v: Values) -> None:
    """Make an open frame of metal and wood, with a rail, a shelf and a box of drawers."""
    w, d, h = v.width, v.depth, v.height
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(v.metal, (0.025, 0.025, h), (sx * (d / 2 - 0.013), sy * (w / 2 - 0.013), h / 2))
    for z in (0.14, h - 0.013):
        for sx in (-1.0, 1.0):
            b.box(v.metal, (0.025, w - 0.05, 0.025), (sx * (d / 2 - 0.013), 0.0, z))
        for sy in (-1.0, 1.0):
            b.box(v.metal, (d - 0.05, 0.025, 0.025), (0.0, sy * (w / 2 - 0.013), z))
    b.box(v.material, (d - 0.004, w - 0.054, 0.022), (0.0, 0.0, 0.164))
    b.box(v.material, (d - 0.06, w - 0.054, 0.022), (0.0, 0.0, h - 0.3))
    hung_clothes(
        b, Box((-d / 2 + 0.05, -w / 2 + 0.03, 0.5), (d / 2 - 0.05, w / 2 - 0.03, h - 0.32))
    )
    chest = Box((-d / 2 + 0.03, -w / 2 + 0.07, 0.193), (d / 2 - 0.045, w / 2 - 0.07, 0.46))
    carcass(b, v.material, chest)
    front = Box(
        (chest.high[0] + 0.001, chest.low[1] - 0.018, chest.low[2] - 0.018),
        (chest.high[0] + 0.02, chest.high[1] + 0.018, chest.high[2] + 0.018),
    )
    for number, panel in enumerate(front.inset(CLEARANCE_M).columns([1.0, 1.0], CLEARANCE_M)):
        drawer(
            b,
            ("right drawer", "left drawer")[number],
            v.material,
            "flat",
            panel,
            chest.size[0] - 0.03,
            inner=v.inner,
            handle_kind="knob",
            metal_=v.metal,
            side_gap=0.03,
            soft_close=DRAWER_CLOSE,
        )


_METALS = Choice(metal("steel"), metal("#26272a"), metal("brass"), metal("chrome"))
_INNER = Choice(wood("birch"), paint("#e7e3da"))
_BIG = {"depth": Span(0.56, 0.62), "height": Span(1.95, 2.25)}

FAMILY = Family(
    name="wardrobe",
    category="wardrobe",
    least_m=(0.4, 0.7, 1.5),
    most_m=(0.75, 2.8, 2.4),
    styles={
        "hinged": Style(
            _hinged,
            {
                **_BIG,
                "width": Choice(0.9, 1.0, 1.5, 2.0),
                "base": Span(0.06, 0.1),
                "front": Choice("flat", "shaker", "grooved"),
                "handle": Choice("bar", "knob", "cup"),
                "material": Choice(*(paint(c) for c in PAINTS), wood("oak"), wood("ash")),
                "inner": _INNER,
                "metal": _METALS,
            },
        ),
        "sliding": Style(
            _sliding,
            {
                "depth": Span(0.62, 0.68),
                "height": Span(2.0, 2.3),
                "width": Span(1.5, 2.4),
                "front": Choice("flat", "shaker"),
                "material": Choice(paint("#e4e2dc"), wood("light oak"), wood("walnut")),
                "door": Choice(paint("#ece8e0"), paint("#6b7178"), wood("oak"), wood("walnut")),
                "inner": _INNER,
                "metal": Choice(metal("alu"), metal("#26272a")),
            },
        ),
        "classic": Style(
            _with_drawers,
            {
                "depth": Span(0.54, 0.6),
                "height": Span(1.8, 2.05),
                "width": Span(0.9, 1.2),
                "legs": Span(0.1, 0.18),
                "rows": Whole(1, 2),
                "front": Choice("shaker", "louvre"),
                "handle": Choice("knob", "cup", "bar"),
                "material": Choice(
                    wood("cherry"),
                    wood("pine"),
                    wood("walnut"),
                    wood("mahogany"),
                    paint("#d9d5cb"),
                    paint("#54616b"),
                ),
                "inner": _INNER,
                "metal": Choice(metal("brass"), metal("bronze"), metal("#26272a")),
            },
        ),
        "open": Style(
            _open,
            {
                "depth": Span(0.45, 0.52),
                "height": Span(1.7, 1.95),
                "width": Span(0.9, 1.3),
                "material": Choice(wood("oak"), wood("pine"), wood("walnut")),
                "inner": _INNER,
                "metal": Choice(metal("#26272a"), metal("#e8e6e0"), metal("steel")),
            },
        ),
    },
)
