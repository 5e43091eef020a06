"""Ovens: a cooker with a hob, a range, built into a tall cabinet, on feet, a microwave."""

from __future__ import annotations

from sailenv_content.families.appliances import gas_hob, glass_hob, hollow_case, knob_row, oven
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    BOARD_M,
    CABINET_MATERIALS,
    cabinet_door,
    cabinet_drawer,
    unit,
)
from sailenv_content.families.contents import plates
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, door
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import leg, shelf
from sailenv_content.families.materials import glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import turned

__all__ = ["FAMILY"]

BLACK = paint("#17181a", 0.3, 900.0)
_SHEET = metal("steel", 700.0)


def _feet(b: PieceBuilder, v: Values, high: float) -> None:
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            at = (sx * (v.depth / 2 - 0.08), sy * (v.width / 2 - 0.06))
            leg(b, v.grip, "metal", *at, high, 0.035)


def _cooker(b: PieceBuilder, v: Values) -> None:
    """Make a hob above an oven above a drawer, on a plinth."""
    d, w, h = v.depth, v.width, v.height
    plinth, low = 0.06, 0.24
    b.box(BLACK, (d - 0.08, w - 0.03, plinth), (-0.02, 0.0, plinth / 2))
    outer = Box((-d / 2, -w / 2, low), (d / 2, w / 2, h - 0.02))
    oven(b, outer, body=v.body, face=v.face, knobs=v.knobs, grip=v.grip, count=5)
    below = Box((-d / 2, -w / 2, plinth), (d / 2, w / 2, low))
    inside, fronts = unit(b, v.body, below, has_top=False)
    deep = Values({**v.all, "scheme": (v.body, v.face, v.body), "front": "flat"})
    cabinet_drawer(b, deep, "drawer", fronts, inside, fill=False)
    b.box(v.body, (d, w, 0.02), (0.0, 0.0, h - 0.01), bevel=0.004)
    if v.gas:
        gas_hob(b, 0.0, 0.0, h - 0.006, width=w - 0.04, plate=v.body)
        b.box(v.body, (0.02, w, 0.06), (-d / 2 + 0.01, 0.0, h + 0.03), bevel=0.004)
    else:
        glass_hob(b, 0.0, 0.0, h, width=w - 0.02)


def _range(b: PieceBuilder, v: Values) -> None:
    """Make a wide cooker with two ovens side by side and six burners."""
    d, w, h, low = v.depth, v.wide, v.height, 0.14
    wide = Values({**v.all, "width": w})
    _feet(b, wide, low + 0.02)
    for sign, name in ((1.0, "left "), (-1.0, "right ")):
        edge = -w / 2 + (1.0 - v.share) * w
        y = (edge, w / 2) if sign > 0 else (-w / 2, edge)
        outer = Box((-d / 2, y[0], low), (d / 2, y[1], h - 0.13))
        oven(
            b,
            outer,
            body=v.body,
            face=v.body,
            knobs=v.grip,
            grip=v.grip,
            prefix=name,
            control_m=0.0,
            count=0,
        )
    control = Box((-d / 2, -w / 2, h - 0.13), (d / 2, w / 2, h - 0.02))
    b.box(v.body, control.size, control.middle, bevel=0.006)
    places = [-0.42 * w + 0.84 * w * k / 7 for k in range(8)]
    knob_row(b, v.grip, d / 2, float(control.middle[2]), places, radius=0.022)
    rail = [(0, 0), (0.009, 0), (0.009, 0.9 * w), (0, 0.9 * w)]
    at = (d / 2 + 0.05, 0.45 * w, h - 0.03)
    b.form(v.grip, turned(rail, segments=12), at, turn=(90.0, 0.0, 0.0), collides="none")
    for sy in (-1.0, 1.0):
        b.box(v.grip, (0.05, 0.012, 0.012), (d / 2 + 0.025, sy * 0.42 * w, h - 0.03))
    b.box(v.body, (d, w, 0.02), (0.0, 0.0, h - 0.01), bevel=0.004)
    gas_hob(b, 0.0, 0.0, h - 0.006, width=w - 0.06, count=6, plate=BLACK)
    b.box(v.body, (0.02, w, 0.08), (-d / 2 + 0.01, 0.0, h + 0.04), bevel=0.004)


def _column(b: PieceBuilder, v: Values) -> None:
    """Build an oven into a tall cabinet: a drawer below it, a door above."""
    d, w, h, low = v.depth, 0.6, v.tall, 0.1
    b.box(v.scheme[0], (d - 0.08, w - 0.02, low), (-0.02, 0.0, low / 2))
    outer = Box((-d / 2, -w / 2, low), (d / 2, w / 2, h))
    inside, fronts = unit(b, v.scheme[0], outer)
    z = (low + v.sill, low + v.sill + 0.595)
    for level in (z[0], z[1] + BOARD_M):
        shelf(b, v.scheme[0], inside, level, setback=0.0)
    body = Box(
        (-d / 2 + 0.04, inside.low[1] + 0.001, z[0] + 0.001),
        (fronts.high[0], inside.high[1] - 0.001, z[1] - 0.001),
    )
    oven(b, body, body=_SHEET, face=v.face, knobs=v.knobs, grip=v.grip)
    lower = Box(fronts.low, (fronts.high[0], fronts.high[1], z[0] - 0.01))
    for number, panel in enumerate(lower.rows([1.0] * v.rows, CLEARANCE_M)):
        cabinet_drawer(b, v, f"drawer {number + 1}", panel, inside, fill=False)
    above = Box((fronts.low[0], fronts.low[1], z[1] + 0.01), fronts.high)
    upper = Box((*inside.low[:2], z[1] + BOARD_M), inside.high)
    shelf(b, v.inner, upper, float(upper.middle[2]), setback=0.03)
    plates(b, Box(upper.low, (*upper.high[:2], upper.middle[2] - 0.02)))
    cabinet_door(b, v, "upper door", above, v.hinge)


def _retro(b: PieceBuilder, v: Values) -> None:
    """Make an old stove of coloured enamel on tall feet, with a gas hob."""
    d, w, h, low = v.depth, v.width, v.height, 0.22
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(
                b,
                v.body,
                "tapered",
                sx * (d / 2 - 0.05),
                sy * (w / 2 - 0.05),
                low,
                0.05,
                splay=0.02,
            )
    outer = Box((-d / 2, -w / 2, low), (d / 2, w / 2, h - 0.02))
    oven(b, outer, body=v.body, face=v.enamel, knobs=v.grip, grip=v.grip, control_m=0.12)
    b.box(v.body, (d, w, 0.02), (0.0, 0.0, h - 0.01), bevel=0.008)
    gas_hob(b, 0.0, 0.0, h - 0.006, width=w - 0.06, plate=v.body)
    b.box(v.enamel, (0.02, w, v.splash), (-d / 2 + 0.01, 0.0, h + v.splash / 2), bevel=0.008)


def _microwave(b: PieceBuilder, v: Values) -> None:
    """Make a microwave oven: a door at its left, a panel with a knob at its right."""
    d, w, h = v.small_depth, v.small_width, v.small_height
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(BLACK, (0.03, 0.03, 0.012), (sx * (d / 2 - 0.05), sy * (w / 2 - 0.05), 0.006))
    thick, panel = 0.03, 0.24 * w
    case = Box((-d / 2, -w / 2, 0.01), (d / 2 - thick, w / 2, h))
    wide = Box(case.low, case.high).within((0.0, panel, 0.0))
    room = hollow_case(b, v.body, wide, 0.016, liner=paint("#d6d8d8", 0.3))
    b.box(
        v.body,
        (float(case.size[0]), panel - 0.001, h - 0.01),
        (case.middle[0], -w / 2 + panel / 2, 0.01 + (h - 0.01) / 2),
        bevel=0.004,
    )
    plate = [(0, 0), (0.11, 0), (0.125, 0.008), (0.125, 0.012), (0.11, 0.006), (0, 0.006)]
    b.form(
        glass(opacity=0.5),
        turned(plate, segments=28),
        (room.middle[0], room.middle[1], room.low[2] + 0.006),
        collides="none",
        volume=1e-4,
    )
    front = Box((d / 2 - thick, -w / 2, 0.01), (d / 2, -w / 2 + panel - 0.002, h))
    b.box(v.face, front.size, front.middle, bevel=0.003)
    y = float(front.middle[1])
    b.box(
        paint("#101214", 0.1),
        (0.002, 0.7 * panel, 0.035),
        (d / 2 + 0.0006, y, h - 0.05),
        bevel=0.0005,
        collides=False,
    )
    b.box(
        paint("#5fb7c9", 0.4),
        (0.002, 0.036, 0.012),
        (d / 2 + 0.0012, y, h - 0.05),
        bevel=0.0003,
        collides=False,
    )
    knob_row(b, v.grip, d / 2, 0.32 * h, [y], radius=0.025)
    leaf = Box((d / 2 - thick + 0.002, -w / 2 + panel, 0.012), (d / 2, w / 2, h - 0.002))
    door(
        b,
        "door",
        v.face,
        "glass",
        leaf,
        hinge="left",
        handle_kind="bar",
        metal_=v.grip,
        opens_deg=100.0,
        pane=glass("#101214", 0.75),
    )


_STEEL, _BLACK, _BRASS = metal("steel", 700.0), metal("#1d1e20"), metal("brass")
_ENAMELS = tuple(
    paint(c, 0.25, 900.0)
    for c in ("#e9e6df", "#1d1f22", "#7c2a2a", "#3f5a4a", "#2f4257", "#d8c9a3")
)
_SHARED = {
    "depth": Span(0.58, 0.62),
    "width": Choice(0.5, 0.6, 0.6),
    "height": Span(0.85, 0.92),
    "body": Choice(_STEEL, _ENAMELS[0], _ENAMELS[1]),
    "face": Choice(_STEEL, BLACK, _ENAMELS[0]),
    "knobs": Choice(BLACK, _STEEL),
    "grip": Choice(_STEEL, metal("chrome"), _BLACK),
}

FAMILY = Family(
    name="oven",
    category="oven",
    least_m=(0.3, 0.42, 0.24),
    most_m=(0.8, 1.25, 2.3),
    styles={
        "cooker": Style(
            _cooker,
            {
                **_SHARED,
                "gas": Choice(True, False),
                "inner": _STEEL,
                "handle": "edge",
                "metal": Choice(_STEEL, _BLACK),
            },
        ),
        "range": Style(
            _range,
            {
                **_SHARED,
                "wide": Choice(0.9, 1.0, 1.1),
                "share": Choice(0.5, 0.6),
                "body": Choice(*_ENAMELS, _STEEL),
                "grip": Choice(_BRASS, metal("chrome"), _STEEL),
            },
        ),
        "column": Style(
            _column,
            {
                **CABINET_MATERIALS,
                **_SHARED,
                "tall": Span(1.95, 2.2),
                "sill": Span(0.45, 0.75),
                "rows": Choice(1, 2),
                "hinge": Choice("left", "right"),
                "handle": Choice("bar", "edge", "knob"),
                "front": Choice("flat", "shaker", "grooved"),
            },
        ),
        "retro": Style(
            _retro,
            {
                **_SHARED,
                "body": Choice(*_ENAMELS),
                "enamel": Choice(*_ENAMELS),
                "grip": Choice(_BRASS, metal("chrome")),
                "splash": Span(0.08, 0.2),
            },
        ),
        "microwave": Style(
            _microwave,
            {
                **_SHARED,
                "body": Choice(_STEEL, *_ENAMELS),
                "face": Choice(_STEEL, BLACK, _ENAMELS[0]),
                "small_depth": Span(0.34, 0.42),
                "small_width": Span(0.46, 0.54),
                "small_height": Span(0.27, 0.31),
            },
            "microwave",
        ),
    },
)
