"""Kitchen units: cabinets below a worktop with sink and hob: in a row, a corner, an island."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.appliances import dishwasher, gas_hob, glass_hob, oven
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import (
    CABINET_MATERIALS,
    SCHEMES,
    cabinet_drawer,
    stocked,
    unit,
)
from sailenv_content.families.contents import stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, door
from sailenv_content.families.hardware import DOOR_CLOSE, DRAWER_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import WOODS, PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.plumbing import sink_basin, tap

__all__ = ["FAMILY"]

DEPTH_M, PLINTH_M, TOP_M = 0.6, 0.1, 0.036
SHEET = metal("steel", 700.0)


def _doors(b: PieceBuilder, v: Values, name: str, fronts: Box, hinge: str) -> None:
    """Add one door, or two before a wide room, with their grips near the upper or lower edge."""
    wide = fronts.size[1] > 0.65
    panels = fronts.columns([1.0, 1.0], CLEARANCE_M) if wide else [fronts]
    high = fronts.low[2] < 1.0
    grip = float(fronts.high[2]) - 0.12 if high else float(fronts.low[2]) + 0.12
    for number, panel in enumerate(panels):
        side = ("right", "left")[number] if wide else hinge
        whole = f"{name} {side} door" if wide else f"{name} door"
        door(
            b,
            whole,
            v.scheme[1],
            v.front,
            panel,
            hinge=side,
            handle_kind=v.handle,
            metal_=v.metal,
            handle_z=grip,
            opens_deg=88.0,
            pane=glass(),
            soft_close=DOOR_CLOSE,
        )


def _cabinet(
    b: PieceBuilder, v: Values, number: int, kind: str, low: float, high: float, hob: str
) -> None:
    """Add one base cabinet between two places along y; its back is at x = 0."""
    rise = v.height - TOP_M
    outer = Box((0.0, low, PLINTH_M), (DEPTH_M - 0.02, high, rise))
    y, wide = (low + high) / 2, high - low
    name, lead = f"cabinet {number}", f"cabinet {number} "
    if kind in ("oven", "dishwasher"):
        case = outer.within((0.03, 0.001, 0.001), (0.0, 0.001, 0.003))
        if kind == "oven":
            oven(
                b, case, body=SHEET, face=v.appliance, knobs=v.grip, grip=v.grip, prefix=lead,
                count=4,
            )  # fmt: skip
        else:
            dishwasher(
                b, case, body=SHEET, face=v.scheme[1], grip=v.metal, kind=v.front,
                handle_kind=v.handle, prefix=lead,
            )  # fmt: skip
    else:
        inside, fronts = unit(b, v.scheme[0], outer, has_top=False)
        if kind == "drawers":
            for row, panel in enumerate(fronts.rows([1.7, 1.7, 1.0], CLEARANCE_M)):
                cabinet_drawer(
                    b,
                    v,
                    f"{name} drawer {row + 1}",
                    panel,
                    inside,
                    front=v.front if row < 2 else "flat",
                    fill=False,
                    soft_close=DRAWER_CLOSE,
                )
        else:
            if kind == "cupboard":
                stocked(b, v.inner, inside, setback=0.05)
            else:
                stores(b, inside.within((0.1, 0.03, 0.0), (0.1, 0.03, 0.3)))
            _doors(b, v, name, fronts, v.hinge)
    top = v.height
    if kind == "oven" or (kind == "drawers" and hob == "drawers"):
        if v.gas:
            gas_hob(b, 0.31, y, top - 0.004, width=min(0.58, wide - 0.02))
        else:
            glass_hob(b, 0.31, y, top - 0.001, width=min(0.58, wide - 0.02))
    if kind == "sink":
        half = min(0.25, wide / 2 - 0.06)
        basin = Box((0.13, y - half, top - 0.18), (0.5, y + half, top))
        _worktop(b, v, low, high, hole=basin)
        with b.part("sink", "sink"):
            sink_basin(b, v.basin, basin)
        tap(b, v.tap, 0.075, y, top, kind=v.spout, reach=0.2, rise=v.rise)
    else:
        _worktop(b, v, low, high)


def _worktop(
    b: PieceBuilder, v: Values, low: float, high: float, *, hole: Box | None = None
) -> None:
    """Add the worktop over a cabinet, around a hole for a sink."""
    z, front = v.height - TOP_M / 2, DEPTH_M + 0.015
    if hole is None:
        b.box(v.top, (front, high - low, TOP_M), (front / 2, (low + high) / 2, z), bevel=0.0008)
        return
    x0, x1 = float(hole.low[0]) - 0.004, float(hole.high[0]) + 0.004
    y0, y1 = float(hole.low[1]) - 0.004, float(hole.high[1]) + 0.004
    for (a, c), (d, e) in (
        ((0.0, x0), (low, high)),
        ((x1, front), (low, high)),
        ((x0, x1), (low, y0)),
        ((x0, x1), (y1, high)),
    ):
        b.box(v.top, (c - a, e - d, TOP_M), ((a + c) / 2, (d + e) / 2, z), bevel=0.0008)


def _widths(v: Values, kinds: list[str]) -> list[float]:
    wide = {"cupboard": v.cell, "drawers": v.cell, "sink": 0.8 if v.cell > 0.5 else 0.6}
    return [wide.get(kind, 0.6) for kind in kinds]


def _hob(kinds: list[str]) -> str:
    """Return the kind of cabinet, the first of which carries the hob of a row."""
    return "oven" if "oven" in kinds else "drawers"


def _row(b: PieceBuilder, v: Values, kinds: list[str], *, first: int = 1) -> float:
    """Add cabinets side by side, the middle of their backs at the origin; return their width."""
    each, hob = _widths(v, kinds), _hob(kinds)
    y = -sum(each) / 2
    size = (DEPTH_M - 0.09, sum(each) - 0.004, PLINTH_M)
    b.box(v.plinth, size, (size[0] / 2, 0.0, PLINTH_M / 2))
    for number, (kind, wide) in enumerate(zip(kinds, each, strict=True)):
        _cabinet(
            b, v, first + number, kind, y, y + wide, hob if kinds.index(kind) == number else ""
        )
        y += wide
    return float(sum(each))


def _kinds(b: PieceBuilder, count: int) -> list[str]:
    """Return which cabinets stand side by side: never a hob right beside a sink."""
    kinds = [
        "drawers",
        b.pick("oven", "drawers"),
        "cupboard",
        "sink",
        b.pick("dishwasher", "cupboard"),
    ]
    kinds = kinds[5 - count :] if b.chance(0.5) else kinds[1 : count + 1]
    return kinds if b.chance(0.5) else kinds[::-1]


def _straight(b: PieceBuilder, v: Values) -> None:
    """Make a row of base cabinets."""
    with b.frame((-DEPTH_M / 2, 0.0, 0.0)):
        width = _row(b, v, _kinds(b, v.count))
        if v.splash:
            at = (0.006, 0.0, v.height + v.splash / 2)
            b.box(v.top, (0.012, width, v.splash), at, bevel=0.001)


def _upper(b: PieceBuilder, v: Values, width: float, kinds: list[str]) -> None:
    """Hang cabinets above a row, and a hood above its hob, if it has one."""
    low, high, deep = v.height + 0.5, v.height + 0.5 + v.upper, 0.34
    cells = max(2, round(width / 0.6))
    each = width / cells
    hood_at = -1
    if _hob(kinds) in kinds:
        place, widths = kinds.index(_hob(kinds)), _widths(v, kinds)
        hood_at = int((sum(widths[:place]) + widths[place] / 2) / each)
    for number in range(cells):
        y = -width / 2 + number * each
        if number == hood_at:
            with b.part("hood", "hood"):
                rows = (
                    (0.5, 0.06, low + 0.03),
                    (0.28, v.upper - 0.06, low + 0.06 + (v.upper - 0.06) / 2),
                )
                for depth, tall, z in rows:
                    wide = each - 0.01 if tall < 0.1 else 0.3
                    b.box(v.hood, (depth, wide, tall), (depth / 2, y + each / 2, z), bevel=0.004)
            continue
        outer = Box((0.0, y, low), (deep, y + each, high))
        inside, fronts = unit(b, v.scheme[0], outer)
        stocked(b, v.inner, inside, setback=0.05)
        _doors(b, Values({**v.all, "front": v.above}), f"upper {number + 1}", fronts, v.hinge)


def _wall(b: PieceBuilder, v: Values) -> None:
    """Make a row with tiles, cabinets and a hood above it."""
    with b.frame((-DEPTH_M / 2, 0.0, 0.0)):
        kinds = _kinds(b, v.count)
        width = _row(b, v, kinds)
        at = (0.005, 0.0, v.height + 0.25)
        b.box(v.tiles, (0.01, width, 0.5), at, bevel=0.0005)
        joint = paint("#b9b6ae", 0.7)
        for z in np.arange(0.1, 0.5, 0.1):
            line = (0.0104, 0.0, v.height + float(z))
            b.box(joint, (0.001, width, 0.003), line, bevel=0.0002, collides=False)
        count = round(width / 0.2)
        for number in range(1, count):
            line = (0.0104, -width / 2 + number * width / count, v.height + 0.25)
            b.box(joint, (0.001, 0.003, 0.5), line, bevel=0.0002, collides=False)
        _upper(b, v, width, kinds)


def _corner(b: PieceBuilder, v: Values) -> None:
    """Make two rows that meet in a corner."""
    kinds = _kinds(b, v.count)
    split = 3 if len(kinds) > 3 else 2
    long = sum(_widths(v, kinds[:split]))
    blind = DEPTH_M + 0.1
    with b.frame((-(long + blind) / 2, 0.0, 0.0)), b.frame((0.0, -blind / 2, 0.0)):
        width = _row(b, v, kinds[:split])
    half = width / 2
    x, y = -(long + blind) / 2, -blind / 2 + half
    # The corner itself: a blind cabinet below one more piece of the worktop.
    middle = (x + blind / 2, y + blind / 2)
    unit(
        b,
        v.scheme[0],
        Box((x, y, PLINTH_M), (x + blind, y + blind, v.height - TOP_M)),
        has_top=False,
    )
    b.box(v.plinth, (blind - 0.02, blind - 0.02, PLINTH_M), (*middle, PLINTH_M / 2))
    b.box(v.top, (blind, blind, TOP_M), (*middle, v.height - TOP_M / 2), bevel=0.0008)
    rest = kinds[split:] or ["cupboard"]
    other = sum(_widths(v, rest))
    with b.frame((x + blind + other / 2, y + blind, 0.0), -90.0):
        _row(b, v, rest, first=split + 1)


def _island(b: PieceBuilder, v: Values) -> None:
    """Make a block with cabinets at its front and room for stools at its back."""
    deep = DEPTH_M + v.over
    with b.frame(((v.over - DEPTH_M) / 2, 0.0, 0.0)):
        kinds = [b.pick("drawers", "cupboard"), b.pick("sink", "oven", "drawers"), "drawers"]
        width = _row(b, v, kinds)
        rise = v.height - TOP_M
        b.box(v.scheme[1], (0.018, width, rise), (-0.009, 0.0, rise / 2), bevel=0.001)
        b.box(v.top, (v.over, width, TOP_M), (-v.over / 2, 0.0, v.height - TOP_M / 2), bevel=0.0008)
        for sy in (-1.0, 1.0):
            at = ((DEPTH_M + 0.015 - v.over) / 2, sy * (width / 2 + 0.015), v.height / 2)
            b.box(v.ends, (deep + 0.015, 0.03, v.height), at, bevel=0.002)


_TOPS: tuple[PieceMaterial, ...] = (
    *WOODS[:4],
    paint("#33363a", 0.22, 1800.0),
    paint("#dedbd4", 0.22, 1800.0),
    paint("#8d8a84", 0.35, 1800.0),
)
_STEEL, _CHROME, _BLACK = metal("steel"), metal("chrome"), metal("#232326")
_SHARED = {
    **CABINET_MATERIALS,
    "scheme": Choice(*SCHEMES),
    "height": Span(0.88, 0.94),
    "cell": Choice(0.45, 0.5, 0.6, 0.8),
    "count": Choice(3, 4),
    "front": "flat",
    "hinge": Choice("left", "right"),
    "top": Choice(*_TOPS),
    "plinth": Choice(paint("#2b2d30"), paint("#d9d5cb")),
    "appliance": Choice(metal("steel", 700.0), paint("#17181a", 0.3, 900.0)),
    "grip": Choice(_STEEL, _BLACK),
    "gas": Choice(True, False),
    "basin": Choice(
        metal("steel", 1500.0), paint("#e9e7e2", 0.15, 1500.0), paint("#2b2d30", 0.5, 1500.0)
    ),
    "tap": Choice(_CHROME, _STEEL, _BLACK, metal("brass")),
    "spout": Choice("arc", "straight"),
    "rise": Span(0.24, 0.36),
    "splash": Choice(0.0, 0.1),
}

FAMILY = Family(
    name="kitchen_unit",
    category="cabinet",
    least_m=(0.55, 1.2, 0.85),
    most_m=(2.6, 3.6, 2.4),
    styles={
        "modern": Style(_straight, {**_SHARED, "handle": Choice("edge", "none", "bar")}),
        "classic": Style(
            _straight,
            {
                **_SHARED,
                "front": Choice("shaker", "grooved"),
                "handle": Choice("knob", "cup", "bar"),
                "top": Choice(*WOODS, _TOPS[-2]),
                "spout": Choice("pillar", "arc"),
                "splash": Choice(0.1, 0.15),
            },
        ),
        "wall": Style(
            _wall,
            {
                **_SHARED,
                "front": Choice("flat", "shaker"),
                "above": Choice("flat", "shaker", "glass"),
                "upper": Span(0.6, 0.75),
                "hood": Choice(metal("steel", 500.0), paint("#1d1e20", 0.3, 500.0)),
                "tiles": Choice(
                    *(paint(c, 0.15) for c in ("#e9e7e2", "#7f9a93", "#33475a", "#b98f74"))
                ),
            },
        ),
        "corner": Style(
            _corner, {**_SHARED, "cell": Choice(0.45, 0.5, 0.6), "front": Choice("flat", "shaker")}
        ),
        "island": Style(
            _island,
            {
                **_SHARED,
                "front": Choice("flat", "shaker", "grooved"),
                "cell": Choice(0.6, 0.8),
                "over": Span(0.28, 0.4),
                "ends": Choice(*_TOPS),
            },
        ),
    },
)
