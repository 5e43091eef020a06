"""Plates: with a rim, without, deep, oval, square."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import GLAZES, grained
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import closed_ring, scaled
from sailenv_content.families.materials import WOODS, glass
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import turned

__all__ = ["FAMILY"]


def _profile(v: Values) -> list[tuple[float, float]]:
    r, h, t = v.radius, v.height, v.wall
    well = v.well * r
    return [
        (0, 0),
        (0.55 * well, 0),
        (0.6 * well, 0.0015),
        (well, v.step * h),
        (0.99 * r, h - t),
        (r, h - 0.5 * t),
        (0.985 * r, h),
        (0.94 * well + 0.05 * r, v.step * h + t),
        (0.88 * well, t + 0.002),
        (0, t + 0.0015),
    ]


def _plate(b: PieceBuilder, v: Values) -> None:
    """Turn one plate, or a pile of them; with a band on its rim if it has one."""
    mesh = turned(_profile(v), segments=48 if v.sides == 0 else v.sides, tile_m=v.material.tile_m)
    mesh = grained(mesh, v.material)
    oval = (1.0, v.oval, 1.0)
    turn = (0.0, 0.0, 45.0) if v.sides == 4 else (0.0, 0.0, 0.0)
    for number in range(v.count):
        z = number * 1.8 * v.wall
        b.form(v.material, scaled(mesh, oval), (0.0, 0.0, z), turn=turn)
    if v.banded and v.sides == 0:
        r, h, t = v.radius, v.height, v.wall
        well = v.well * r
        inner, low = 0.94 * well + 0.05 * r, v.step * h + t
        rise = (h - low) / (0.985 * r - inner)
        edge = np.linspace(0.985 * r - v.wide, 0.975 * r, 3)
        top = [(float(x), low + (float(x) - inner) * rise + 0.0003) for x in edge]
        below = [(x, z - 0.0002) for x, z in top]
        z = (v.count - 1) * 1.8 * t
        mesh = closed_ring([*below, *top[::-1]], segments=48)
        b.form(v.second, scaled(mesh, oval), (0.0, 0.0, z), collides="none", volume=1e-7)


_SHARED = {
    "radius": Span(0.125, 0.145),
    "height": Span(0.018, 0.026),
    "wall": Span(0.004, 0.005),
    "well": Span(0.64, 0.72),
    "step": Span(0.4, 0.6),
    "oval": 1.0,
    "sides": 0,
    "count": Choice(1, 1, 1, 4),
    "wide": Span(0.006, 0.02),
    "banded": Choice(True, False),
    "material": Choice(*GLAZES),
    "second": Choice(*GLAZES),
}

FAMILY = Family(
    name="plate",
    category="dish",
    least_m=(0.14, 0.14, 0.012),
    most_m=(0.4, 0.5, 0.2),
    styles={
        "dinner": Style(_plate, _SHARED),
        "dessert": Style(_plate, {**_SHARED, "radius": Span(0.09, 0.105)}),
        "deep": Style(
            _plate,
            {
                **_SHARED,
                "radius": Span(0.1, 0.12),
                "height": Span(0.038, 0.046),
                "step": Span(0.7, 0.8),
            },
        ),
        "coupe": Style(
            _plate,
            {
                **_SHARED,
                "well": Span(0.9, 0.93),
                "step": Span(0.3, 0.4),
                "height": Span(0.022, 0.03),
                "banded": False,
                "material": Choice(*GLAZES, *WOODS[:3]),
            },
        ),
        "oval": Style(
            _plate, {**_SHARED, "radius": Span(0.11, 0.14), "oval": Span(1.35, 1.5), "count": 1}
        ),
        "faceted": Style(
            _plate,
            {
                **_SHARED,
                "sides": Choice(4, 8, 12),
                "banded": False,
                "material": Choice(*GLAZES, glass("#9fc3b6", 0.4)),
            },
        ),
    },
)
