"""Toilets: on the floor with a cistern, hung on the wall, with a high cistern, square."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hardware import DRAWER_CLOSE, LID_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import closed_ring, scaled, smooth_profile, vessel
from sailenv_content.families.materials import PieceMaterial, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.plumbing import tub
from sailenv_content.families.shaping import extruded, swept, turned
from sailenv_content.procedural.forms import circle, curve, rectangle

__all__ = ["FAMILY"]

CERAMIC = paint("#f1efea", 0.12, 1600.0)
WIDE_M = 0.185
"""Half the width of a bowl [m]; it is longer by a quarter."""


def _seat(b: PieceBuilder, v: Values, x: float, z: float, *, square: bool = False) -> None:
    """Add a seat and a lid above it, both on hinges at the back; x is the middle of the bowl."""
    half, long = WIDE_M, 1.22 * WIDE_M
    back, t = x - long, 0.018
    parts = (("seat", z), ("lid", z + t + 0.003))
    material = v.seat
    for name, low in parts:
        at = (back, 0.0, z + t / 2)
        with b.hinge(
            name,
            "lid",
            at=at,
            axis=(0.0, -1.0, 0.0),
            opens_deg=93.0,
            friction=0.4,
            damping=0.6,
            soft_close=LID_CLOSE,
        ):
            if square:
                outline = rectangle(2 * half, 2 * long, 0.05)
                board = extruded(outline, t, bevel=0.006, tile_m=material.tile_m)
                b.form(material, board, (x, 0.0, low))
            elif name == "lid":
                outline = circle(44) * (long, half)
                board = extruded(outline, t, bevel=0.006, tile_m=material.tile_m)
                b.form(material, board, (x, 0.0, low))
            else:
                rows = [
                    (half - 0.062, 0.0),
                    (half, 0.0),
                    (half + 0.001, 0.6 * t),
                    (half - 0.008, t),
                ]
                ring = closed_ring([*rows, (half - 0.054, t), (half - 0.064, 0.6 * t)], segments=44)
                b.form(material, scaled(ring, (long / half, 1.0, 1.0)), (x, 0.0, low))
    for sy in (-1.0, 1.0):
        hub = [(0, -0.02), (0.011, -0.02), (0.011, 0.02), (0, 0.02)]
        b.form(
            v.metal,
            turned(hub, segments=14),
            (back - 0.005, sy * 0.075, z + 0.008),
            turn=(90, 0, 0),
            collides="none",
        )


def _bowl(b: PieceBuilder, v: Values, x: float, low: float, high: float) -> None:
    """Add an oval bowl with a foot that is narrower, water at its ground."""
    tall = high - low
    foot = 0.62 if low == 0.0 else 0.5
    rows = smooth_profile(
        np.array([(foot, 0.0), (foot - 0.04, 0.1), (0.68, 0.5), (0.94, 0.85), (1.0, 1.0)])
        * (WIDE_M, tall),
        18,
    )
    mesh = scaled(vessel(rows, wall=0.045, floor=0.42 * tall, segments=40), (1.22, 1.0, 1.0))
    b.form(CERAMIC, mesh, (x, 0.0, low), volume=0.012)
    water = [(0, 0), (0.055, 0), (0.055, 0.002), (0, 0.002)]
    b.form(
        paint("#b7cdd2", 0.05),
        turned(water, segments=24),
        (x, 0.0, low + 0.45 * tall),
        collides="none",
        volume=1e-5,
    )


def _cistern(b: PieceBuilder, v: Values, box: Box) -> None:
    size, middle = box.size, box.middle
    tank = extruded(rectangle(size[1], size[0], v.corner), size[2], bevel=0.012)
    b.form(CERAMIC, tank, (middle[0], middle[1], box.low[2]), volume=0.006)
    lid = extruded(rectangle(size[1] + 0.012, size[0] + 0.012, v.corner), 0.03, bevel=0.01)
    b.form(CERAMIC, lid, (middle[0], middle[1], box.high[2]), volume=0.001)
    button = [(0, 0), (0.024, 0), (0.024, 0.004), (0.02, 0.007), (0, 0.007)]
    at = (float(middle[0]), float(middle[1]), float(box.high[2]) + 0.031)
    with b.slide("button", "handle", by=0.004, axis=(0.0, 0.0, -1.0), friction=0.5):
        b.form(v.metal, turned(button, segments=24), (at[0], at[1], at[2] + 0.0055))


def _floor(b: PieceBuilder, v: Values) -> None:
    """Make a bowl on the floor, with a cistern on its back."""
    x = 0.125
    _bowl(b, v, x, 0.0, v.height)
    b.box(CERAMIC, (0.22, 0.2, v.height - 0.03), (-0.22, 0.0, (v.height - 0.03) / 2), bevel=0.02)
    back = Box((-0.345, -0.19, v.height - 0.02), (-0.345 + v.deep, 0.19, v.height + v.tank))
    _cistern(b, v, back)
    _seat(b, v, x, v.height + 0.017)


def _wall(b: PieceBuilder, v: Values) -> None:
    """Hang a bowl on a panel, which hides the cistern."""
    wide = v.panel_w
    b.box(v.panel, (0.16, wide, v.panel_m), (-0.28, 0.0, v.panel_m / 2), bevel=0.002)
    b.box(v.top, (0.18, wide + 0.01, 0.02), (-0.275, 0.0, v.panel_m + 0.01))
    x, low = 0.1, 0.12
    _bowl(b, v, x, low, v.height)
    b.box(CERAMIC, (0.16, 0.3, 0.24), (-0.12, 0.0, v.height - 0.135), bevel=0.03)
    _seat(b, v, x, v.height + 0.017)
    at = (-0.197, 0.0, v.panel_m - 0.16)
    b.box(v.metal, (0.006, 0.22, 0.14), at, bevel=0.002, collides=False)
    for name, y, w in (("large button", 0.03, 0.11), ("small button", -0.062, 0.06)):
        with b.slide(name, "handle", by=0.003, axis=(-1.0, 0.0, 0.0), friction=0.5):
            b.box(v.metal, (0.004, w, 0.09), (at[0] + 0.0095, y, at[2]), bevel=0.001)


def _high(b: PieceBuilder, v: Values) -> None:
    """Make a bowl with a wooden seat, and a cistern high above it with a chain."""
    x = 0.1
    _bowl(b, v, x, 0.0, v.height)
    tank = Box((-0.36, -0.24, 1.75), (-0.16, 0.24, 2.02))
    b.box(v.seat if v.wooden else CERAMIC, tank.size, tank.middle, bevel=0.012)
    b.box(v.seat if v.wooden else CERAMIC, (0.22, 0.5, 0.025), (-0.26, 0.0, 2.0325), bevel=0.006)
    pipe = curve(
        [(-0.26, 0, 1.76), (-0.28, 0, 1.2), (-0.27, 0, 0.5), (-0.2, 0, 0.33), (-0.1, 0, 0.3)], 24
    )
    b.form(v.metal, swept(pipe, 0.02, sides=14), collides="none")
    b.collide((0.05, 0.05, 1.3), (-0.275, 0.0, 1.1))
    arm = [(-0.26, 0.0, 2.05), (-0.26, 0.3, 2.06)]
    b.form(v.metal, swept(arm, 0.006, sides=8), collides="none")
    with b.slide(
        "pull",
        "handle",
        by=0.06,
        axis=(0.0, 0.0, -1.0),
        friction=0.5,
        soft_close=DRAWER_CLOSE,
    ):
        chain = [(-0.26, 0.29, 2.05), (-0.26, 0.29, 1.2)]
        b.form(v.metal, swept(chain, 0.0025, sides=6), collides="none")
        grip = [(0, 0), (0.012, 0.004), (0.016, 0.03), (0.01, 0.09), (0, 0.1)]
        b.form(v.seat, turned(grip, segments=16), (-0.26, 0.29, 1.1))
    for sy in (-1.0, 1.0):
        b.box(v.metal, (0.16, 0.02, 0.1), (-0.28, sy * 0.18, 1.7), bevel=0.004)
    _seat(b, v, x, v.height + 0.017)


def _square(b: PieceBuilder, v: Values) -> None:
    """Make a bowl with straight sides and a wide cistern."""
    x, long = 0.125, 1.22 * WIDE_M
    mesh = tub(
        (2 * long, 2 * WIDE_M, v.height), wall=0.04, floor=0.17, radius=0.05, taper=0.03, slope=0.06
    )
    b.form(CERAMIC, mesh, (x, 0.0, 0.0), volume=0.014)
    b.box(CERAMIC, (0.2, 0.3, v.height - 0.02), (-0.24, 0.0, (v.height - 0.02) / 2), bevel=0.015)
    _cistern(
        b, v, Box((-0.345, -0.19, v.height - 0.02), (-0.345 + v.deep, 0.19, v.height + v.tank))
    )
    _seat(b, v, x, v.height + 0.004, square=True)


def _wood_or_white() -> tuple[PieceMaterial, ...]:
    return (
        paint("#f3f2ee", 0.2),
        paint("#f3f2ee", 0.2),
        wood("oak"),
        wood("walnut"),
        paint("#2b2d30", 0.3),
    )


_SHARED = {
    "height": Span(0.385, 0.415),
    "deep": Span(0.15, 0.165),
    "tank": Span(0.34, 0.4),
    "corner": Choice(0.02, 0.05),
    "seat": Choice(*_wood_or_white()),
    "metal": Choice(metal("chrome"), metal("steel"), metal("#26272a")),
}

FAMILY = Family(
    name="toilet",
    category="toilet",
    least_m=(0.5, 0.34, 0.4),
    most_m=(0.9, 1.1, 2.2),
    styles={
        "floor": Style(_floor, _SHARED),
        "wall": Style(
            _wall,
            {
                **_SHARED,
                "panel": Choice(
                    *(paint(c, 0.3) for c in ("#e9e7e2", "#7f9a93", "#5c6166")), wood("oak")
                ),
                "panel_m": Span(1.05, 1.2),
                "panel_w": Span(0.6, 1.0),
                "top": Choice(wood("oak"), paint("#e9e7e2", 0.2), paint("#33363a", 0.2)),
            },
        ),
        "high": Style(
            _high,
            {
                **_SHARED,
                "seat": Choice(
                    wood("oak"), wood("walnut"), wood("mahogany"), paint("#2b2d30", 0.3)
                ),
                "wooden": Choice(True, False),
                "metal": Choice(metal("brass"), metal("chrome"), metal("copper")),
            },
        ),
        "square": Style(_square, _SHARED),
    },
)
