"""Bowls: for breakfast, salad, noodles, on a foot, oval; some with fruit."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import FRUIT
from sailenv_content.families.crockery import CLEAR, GLAZES, band, grained
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollows import vessel_walls
from sailenv_content.families.lathe import scaled, smooth_profile, vessel
from sailenv_content.families.materials import WOODS, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept, turned

__all__ = ["FAMILY"]


def _fruit(b: PieceBuilder, v: Values, floor: float) -> None:
    """Lay fruit into it, in one layer or two."""
    inner = 0.68 * v.radius
    kind = b.pick(*FRUIT)
    places = [(0.0, 0.0)] if inner < 0.09 else []
    count = max(3, int(2 * np.pi * 0.6 * inner / 0.075))
    ring = np.arange(count) * 2 * np.pi / count
    places += [(0.6 * inner * np.cos(a), 0.6 * inner * np.sin(a)) for a in ring]
    for number, (x, y) in enumerate(places):
        if b.chance(0.15):
            continue
        r = b.between(0.03, 0.036)
        long = 1.25 if kind == "lemon" else 0.95
        t = np.linspace(-np.pi / 2, np.pi / 2, 11)
        rows = np.stack([r * np.cos(t), long * r * (1 + np.sin(t))], -1)
        rows[[0, -1], 0] = 0.0
        if kind == "apple":
            rows[-1, 1] -= 0.25 * r
        out = np.hypot(x, y) / max(v.radius, 1e-6)
        at = (x, y, floor + 0.5 * v.height * out**2)
        with b.part(kind, kind):
            skin = paint(b.pick(*FRUIT[kind]), 0.45, 850.0)
            tilt = (b.between(-25, 25), b.between(-25, 25), 0.0)
            b.form(skin, turned(rows, segments=16), at, turn=tilt, collides="none")
            if kind == "apple":
                stem = [(at[0], at[1], at[2] + 1.6 * r), (at[0] + 0.004, at[1], at[2] + 2.2 * r)]
                b.form(paint("#5a4630", 0.8), swept(stem, 0.0012, sides=5), collides="none")
        if number > 6:
            break


def _bowl(b: PieceBuilder, v: Values) -> None:
    """Turn a bowl from its profile."""
    rows = smooth_profile(np.array(v.profile) * (v.radius, v.height), 22)
    floor = float(np.array(v.profile)[v.bottom, 1]) * v.height + 1.5 * v.wall
    mesh = vessel(rows, wall=v.wall, floor=floor, segments=44)
    whole = scaled(grained(mesh, v.material), (1.0, v.oval, 1.0))
    b.form(v.material, whole, collides="none")
    vessel_walls(b, rows, wall=v.wall, floor=floor, oval=v.oval, sectors=8)
    if v.banded and v.oval == 1.0:
        band(b, v.second, rows, 0.9 * v.height, 0.985 * v.height, segments=44)
    if v.fruit and v.radius > 0.1:
        _fruit(b, v, floor)


_ROUND = ((0.45, 0.0), (0.48, 0.06), (0.8, 0.35), (0.95, 0.68), (1.0, 1.0))
_SHARED = {
    "radius": Span(0.07, 0.085),
    "height": Span(0.055, 0.075),
    "wall": Span(0.003, 0.005),
    "oval": 1.0,
    "bottom": 1,
    "material": Choice(*GLAZES),
    "second": Choice(*GLAZES),
    "banded": Choice(True, False),
    "fruit": False,
    "profile": _ROUND,
}

FAMILY = Family(
    name="bowl",
    category="bowl",
    least_m=(0.08, 0.08, 0.03),
    most_m=(0.5, 0.6, 0.3),
    styles={
        "breakfast": Style(_bowl, _SHARED),
        "salad": Style(
            _bowl,
            {
                **_SHARED,
                "radius": Span(0.12, 0.16),
                "height": Span(0.08, 0.12),
                "wall": Span(0.007, 0.011),
                "material": Choice(*WOODS, *(glass(*c) for c in CLEAR[:2]), *GLAZES[:3]),
                "banded": False,
                "fruit": Choice(True, False),
            },
        ),
        "noodle": Style(
            _bowl,
            {
                **_SHARED,
                "radius": Span(0.085, 0.1),
                "height": Span(0.07, 0.085),
                "profile": ((0.4, 0.0), (0.38, 0.1), (0.42, 0.14), (0.75, 0.55), (1.0, 1.0)),
                "bottom": 1,
            },
        ),
        "footed": Style(
            _bowl,
            {
                **_SHARED,
                "radius": Span(0.12, 0.15),
                "height": Span(0.12, 0.18),
                "profile": (
                    (0.55, 0.0),
                    (0.5, 0.03),
                    (0.16, 0.2),
                    (0.18, 0.48),
                    (0.7, 0.66),
                    (1.0, 1.0),
                ),
                "bottom": 3,
                "material": Choice(*GLAZES, metal("brass"), *(glass(*c) for c in CLEAR)),
                "fruit": Choice(True, True, False),
            },
        ),
        "oval": Style(
            _bowl,
            {
                **_SHARED,
                "radius": Span(0.11, 0.14),
                "height": Span(0.06, 0.09),
                "oval": Span(1.3, 1.6),
                "wall": Span(0.006, 0.009),
                "material": Choice(*WOODS, *GLAZES[:6]),
                "fruit": Choice(True, False),
            },
        ),
    },
)
