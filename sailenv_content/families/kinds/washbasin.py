"""Washbasins: on a pedestal, the wall, a cabinet or a metal frame, and a bowl on a board."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.cabinets import CABINET_MATERIALS, cabinet_drawer, outer_doors, unit
from sailenv_content.families.contents import stores
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M
from sailenv_content.families.hardware import DRAWER_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.hollows import tub_walls, vessel_walls
from sailenv_content.families.lathe import scaled, smooth_profile, vessel
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.plumbing import drain, tap, tub
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]

CERAMIC = paint("#f1efea", 0.12, 1600.0)


def _basin(b: PieceBuilder, v: Values, depth: float, width: float, low: float, high: float) -> None:
    """Add a tub that looks up between two heights, a ledge behind it and a tap; back at x = 0."""
    ledge = 0.1
    size = (depth - ledge + 0.02, width, high - low)
    mesh = tub(size, wall=0.03, floor=0.03, radius=v.corner, taper=v.taper, slope=0.05)
    x = ledge - 0.02 + size[0] / 2
    with b.part("basin", "sink"):
        b.form(CERAMIC, mesh, (x, 0.0, low), collides="none", volume=0.006)
        tub_walls(b, size, wall=0.03, floor=0.03, taper=v.taper, slope=0.05, at=(x, 0.0, low))
        flat = width - 1.9 * max(0.0, v.corner - 0.03)
        b.box(CERAMIC, (ledge, flat, 0.075), (ledge / 2, 0.0, high - 0.0375), bevel=0.012)
        drain(b, x, 0.0, low + 0.031)
    tap(b, v.metal, 0.055, 0.0, high - 0.001, kind=v.spout, reach=0.12, rise=v.rise)


def _pedestal(b: PieceBuilder, v: Values) -> None:
    """Set the basin on a foot of ceramic."""
    with b.frame((-v.depth / 2, 0.0, 0.0)):
        h = v.height
        _basin(b, v, v.depth, v.width, h - 0.17, h)
        rows = [
            (0, 0),
            (0.12, 0),
            (0.11, 0.03),
            (0.075, 0.14),
            (0.07, 0.45),
            (0.1, h - 0.16),
            (0, h - 0.16),
        ]
        foot = scaled(turned(rows, segments=30), (0.85, 1.0, 1.0))
        b.form(CERAMIC, foot, (0.22, 0.0, 0.0), volume=0.006)


def _hung(b: PieceBuilder, v: Values) -> None:
    """Hang the basin on the wall, with its trap below."""
    low = 0.3
    _basin(b, v, v.depth, v.width, low, low + 0.15)
    x = 0.08 + (v.depth - 0.08) / 2
    trap = curve(
        [
            (x, 0, low + 0.02),
            (x, 0, low - 0.14),
            (x - 0.04, 0, low - 0.2),
            (x - 0.09, 0, low - 0.15),
            (x - 0.12, 0, low - 0.1),
            (0.0, 0, low - 0.1),
        ],
        26,
    )
    b.form(v.metal, swept(trap, 0.016, sides=12), collides="none")
    cup = [(0, 0), (0.03, 0), (0.034, 0.01), (0.034, 0.07), (0, 0.07)]
    b.form(v.metal, turned(cup, segments=20), (x, 0.0, 0.0), collides="none")
    b.form(v.metal, swept([(x, 0, 0.06), (x, 0, low - 0.12)], 0.014, sides=12), collides="none")
    b.collide((0.08, 0.08, low), (x, 0.0, low / 2))


def _cabinet(b: PieceBuilder, v: Values) -> None:
    """Set the basin on a cabinet with doors or drawers."""
    h, d, w = v.height - 0.14, v.depth, v.width
    with b.frame((-d / 2, 0.0, 0.0)):
        outer = Box((0.0, -w / 2 + 0.01, v.legs), (d - 0.02, w / 2 - 0.01, h))
        inside, fronts = unit(b, v.scheme[0], outer, has_top=False)
        b.box(v.scheme[0], (d - 0.1, w - 0.06, v.legs), (d / 2 - 0.04, 0.0, v.legs / 2))
        if v.drawers:
            for number, panel in enumerate(fronts.rows([1.0, 1.0], CLEARANCE_M)):
                cabinet_drawer(
                    b,
                    v,
                    f"drawer {number + 1}",
                    panel,
                    inside,
                    fill=number == 0,
                    soft_close=DRAWER_CLOSE,
                )
        else:
            stores(b, inside.within((0.05, 0.03, 0.0), (0.06, 0.03, 0.2)))
            right, left = fronts.columns([1.0, 1.0], CLEARANCE_M)
            outer_doors(b, v, right, left)
        _basin(b, v, d, w, h + 0.001, v.height)


def _bowl(b: PieceBuilder, v: Values) -> None:
    """Set a bowl on a board on the wall, with a drawer below or none."""
    d, w, low = v.depth, v.wide, 0.24
    b.box(v.material, (d, w, 0.045), (d / 2, 0.0, low - 0.0225), bevel=0.004)
    outer = Box((0.0, -w / 2, 0.0), (d - 0.01, w / 2, low - 0.046))
    inside, fronts = unit(b, v.scheme[0], outer)
    cabinet_drawer(b, v, "drawer", fronts, inside, soft_close=DRAWER_CLOSE)
    r = min(0.17, 0.36 * d)
    rows = smooth_profile(
        np.array([(0.5, 0.0), (0.7, 0.08), (0.92, 0.45), (1.0, 1.0)]) * (r, v.bowl_m), 18
    )
    x = d - r - 0.012
    with b.part("basin", "sink"):
        mesh = vessel(rows, wall=0.012, floor=0.02, segments=44)
        place = (x, v.shift * w, low)
        b.form(v.bowl, scaled(mesh, (1.0, v.oval, 1.0)), place, collides="none", volume=0.002)
        vessel_walls(b, rows, wall=0.012, floor=0.02, at=place, oval=v.oval)
        drain(b, x, v.shift * w, low + 0.0205)
    reach = max(0.12, x - 0.06)
    tap(b, v.metal, 0.045, v.shift * w, low, kind="pillar", reach=reach, rise=v.bowl_m + 0.2)


def _frame(b: PieceBuilder, v: Values) -> None:
    """Set the basin on legs of metal, with a rail for towels and a board below."""
    h, d, w = v.height, v.depth, v.width
    with b.frame((-d / 2, 0.0, 0.0)):
        _basin(b, v, d, w, h - 0.14, h)
        for sy in (-1.0, 1.0):
            for x in (0.04, d - 0.04):
                b.form(
                    v.metal,
                    swept(
                        [(x, sy * (w / 2 - 0.04), 0), (x, sy * (w / 2 - 0.04), h - 0.12)],
                        0.011,
                        sides=10,
                    ),
                )
            side = [(0.04, sy * (w / 2 - 0.04), 0.2), (d - 0.04, sy * (w / 2 - 0.04), 0.2)]
            b.form(v.metal, swept(side, 0.009, sides=8), collides="none")
        b.box(v.material, (d - 0.06, w - 0.1, 0.018), (d / 2, 0.0, 0.215))
        rail = [(d + 0.02, -w / 2 + 0.04, h - 0.2), (d + 0.02, w / 2 - 0.04, h - 0.2)]
        b.form(v.metal, swept(rail, 0.007, sides=8))
        for sy in (-1.0, 1.0):
            arm = [
                (d - 0.04, sy * (w / 2 - 0.05), h - 0.2),
                (d + 0.02, sy * (w / 2 - 0.05), h - 0.2),
            ]
            b.form(v.metal, swept(arm, 0.006, sides=8), collides="none")


_SHARED = {
    **CABINET_MATERIALS,
    "depth": Span(0.42, 0.5),
    "width": Span(0.52, 0.66),
    "height": Span(0.83, 0.88),
    "corner": Choice(0.04, 0.12, 0.18),
    "taper": Span(0.04, 0.09),
    "spout": Choice("arc", "straight", "pillar"),
    "rise": Span(0.12, 0.2),
    "metal": Choice(metal("chrome"), metal("brass"), metal("#26272a")),
    "front": Choice("flat", "shaker", "grooved"),
}

FAMILY = Family(
    name="washbasin",
    category="sink",
    least_m=(0.35, 0.45, 0.3),
    most_m=(0.7, 1.4, 1.2),
    styles={
        "pedestal": Style(_pedestal, _SHARED),
        "wall": Style(_hung, _SHARED),
        "cabinet": Style(
            _cabinet,
            {
                **_SHARED,
                "legs": Span(0.08, 0.16),
                "width": Span(0.6, 0.9),
                "taper": 0.03,
                "corner": Choice(0.02, 0.04),
                "drawers": Choice(True, False),
            },
        ),
        "bowl": Style(
            _bowl,
            {
                **_SHARED,
                "wide": Span(0.8, 1.2),
                "material": Choice(*WOODS, paint("#33363a", 0.2)),
                "bowl": Choice(
                    CERAMIC,
                    paint("#2b2d30", 0.4, 1600.0),
                    metal("copper"),
                    paint("#7f9a93", 0.2, 1600.0),
                ),
                "bowl_m": Span(0.11, 0.15),
                "oval": Choice(1.0, 1.2),
                "shift": Choice(0.0, 0.0, 0.15),
                "front": "flat",
            },
        ),
        "frame": Style(
            _frame,
            {**_SHARED, "taper": 0.02, "corner": Choice(0.02, 0.05), "material": Choice(*WOODS)},
        ),
    },
)
