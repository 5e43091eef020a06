"""Cups: mugs, tea cups on saucers, espresso, tumblers, glasses for wine."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import CLEAR, GLAZES, band, loop, radius_at
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import glass, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import turned

__all__ = ["FAMILY"]


def _cup(b: PieceBuilder, v: Values) -> None:
    """Turn a cup, with a handle, a saucer and a drink if it has them."""
    base = 0.0
    if v.saucer:
        r = 1.75 * v.radius
        dish = [(0, 0), (0.55 * r, 0), (r, 0.016), (r, 0.019), (0.55 * r, 0.006), (0, 0.005)]
        with b.part("saucer", "dish"):
            b.form(v.material, turned(dish, segments=36))
        base = 0.006
    rows = smooth_profile(np.array(v.profile) * (v.radius, v.height), 22)
    floor = v.bottom * v.height + 1.6 * v.wall
    with b.frame((0.0, 0.0, base)):
        sides = 40 if v.sides == 0 else v.sides
        crease = 40.0 if v.sides == 0 else 5.0
        mesh = vessel(rows, wall=v.wall, floor=floor, segments=sides, crease_deg=crease)
        b.form(v.material, mesh)
        if v.handle:
            low, high = v.grip[0] * v.height, v.grip[1] * v.height
            loop(
                b,
                v.material,
                radius_at(rows, high),
                low,
                high,
                out=v.out * v.radius,
                thick=0.09 * v.radius,
                yaw_deg=90.0,
                foot_x=radius_at(rows, low),
            )
        if v.banded:
            band(b, v.second, rows, v.at * v.height, (v.at + v.wide) * v.height, segments=sides)
        if v.drink is not None:
            level = floor + 0.72 * (v.height - floor)
            heights = np.linspace(floor + 0.0005, level, 8)
            inner = [
                (max(radius_at(rows, float(z)) - v.wall - 0.0004, 0.001), float(z)) for z in heights
            ]
            liquid = turned([(0, floor + 0.0005), *inner, (0, level)], segments=32)
            b.form(v.drink, liquid, collides="none")


_MUG = ((0.92, 0.0), (1.0, 0.06), (1.0, 1.0))
_DRINKS = (
    None,
    paint("#3a2415", 0.1, 1000.0),
    paint("#8a4a1e", 0.1, 1000.0),
    paint("#b98a62", 0.2, 1000.0),
)
_SHARED = {
    "radius": Span(0.037, 0.044),
    "height": Span(0.085, 0.105),
    "wall": Span(0.003, 0.004),
    "bottom": 0.0,
    "sides": 0,
    "profile": Choice(
        _MUG,
        ((0.85, 0.0), (1.0, 0.2), (1.05, 0.5), (0.95, 1.0)),
        ((0.75, 0.0), (0.8, 0.08), (1.0, 1.0)),
    ),
    "handle": True,
    "grip": (0.2, 0.8),
    "out": Span(0.6, 0.75),
    "saucer": False,
    "banded": Choice(True, False),
    "at": Span(0.1, 0.6),
    "wide": Span(0.08, 0.3),
    "material": Choice(*GLAZES),
    "second": Choice(*GLAZES),
    "drink": Choice(*_DRINKS),
}

FAMILY = Family(
    name="cup",
    category="cup",
    least_m=(0.045, 0.045, 0.04),
    most_m=(0.2, 0.2, 0.3),
    styles={
        "mug": Style(_cup, _SHARED),
        "tea": Style(
            _cup,
            {
                **_SHARED,
                "radius": Span(0.044, 0.05),
                "height": Span(0.055, 0.066),
                "wall": 0.0025,
                "profile": ((0.45, 0.0), (0.5, 0.06), (0.8, 0.4), (0.92, 0.75), (1.0, 1.0)),
                "grip": (0.35, 0.9),
                "saucer": True,
                "at": 0.84,
                "wide": 0.12,
            },
        ),
        "espresso": Style(
            _cup,
            {
                **_SHARED,
                "radius": Span(0.029, 0.033),
                "height": Span(0.05, 0.06),
                "profile": ((0.7, 0.0), (0.82, 0.2), (1.0, 1.0)),
                "saucer": Choice(True, False),
                "grip": (0.3, 0.85),
                "drink": Choice(*_DRINKS[:2]),
            },
        ),
        "tumbler": Style(
            _cup,
            {
                **_SHARED,
                "handle": False,
                "wall": 0.0025,
                "sides": Choice(0, 0, 10),
                "bottom": 0.06,
                "profile": Choice(
                    ((0.82, 0.0), (0.86, 0.03), (1.0, 1.0)), ((0.98, 0.0), (1.0, 0.04), (1.0, 1.0))
                ),
                "material": Choice(*(glass(*c) for c in CLEAR)),
                "banded": False,
                "drink": Choice(None, None, paint("#c96a1e", 0.1, 1000.0)),
            },
            "glass",
        ),
        "wine": Style(
            _cup,
            {
                **_SHARED,
                "handle": False,
                "radius": Span(0.036, 0.046),
                "height": Span(0.18, 0.23),
                "wall": 0.0018,
                "bottom": 0.52,
                "profile": (
                    (0.85, 0.0),
                    (0.8, 0.012),
                    (0.14, 0.06),
                    (0.1, 0.45),
                    (0.2, 0.5),
                    (0.82, 0.62),
                    (1.0, 0.74),
                    (0.8, 1.0),
                ),
                "material": glass(*CLEAR[0]),
                "banded": False,
                "drink": Choice(
                    None, paint("#4a0f1c", 0.05, 1000.0), paint("#d8c98a", 0.05, 1000.0)
                ),
            },
            "wine glass",
        ),
    },
)
