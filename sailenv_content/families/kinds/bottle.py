"""Bottles: for wine, water, beer, sauce, a carafe; with labels and caps."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import CLEAR, band, radius_at
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import turned

__all__ = ["FAMILY"]

LABELS = tuple(
    paint(c, 0.7)
    for c in ("#efe8d8", "#26282b", "#7c2a2a", "#d2a65a", "#2f5a6c", "#5f7a4a", "#e9e5dc")
)


def _bottle(b: PieceBuilder, v: Values) -> None:
    """Turn a bottle, what is in it, a label and a cap."""
    r, h = v.radius, v.height
    rows = smooth_profile(np.array(v.profile) * (r, h), 34)
    b.form(v.material, vessel(rows, wall=v.wall, floor=3 * v.wall, segments=32))
    if v.drink is not None:
        level = v.full * h
        heights = np.linspace(3 * v.wall + 0.0005, level, 14)
        inner = [
            (max(radius_at(rows, float(z)) - v.wall - 0.0004, 0.002), float(z)) for z in heights
        ]
        liquid = turned([(0, float(heights[0])), *inner, (0, level)], segments=28)
        b.form(v.drink, liquid, collides="none")
    if v.label is not None:
        low, high = v.label_at[0] * h, v.label_at[1] * h
        band(b, v.label, rows, low, high)
        strip = low + b.between(0.15, 0.6) * (high - low)
        wide = rows + np.array([0.0004, 0.0])
        band(b, b.pick(*LABELS), wide, strip, strip + 0.16 * (high - low))
    if v.cap is not None:
        neck, tall = float(rows[-1, 0]), v.cap_m
        inside = neck - v.wall
        with b.part("cap", "lid"):
            if v.cork:
                stopper = [(0, h - 0.01), (inside - 0.0004, h - 0.01), (inside, h + 0.002)]
                top = [(0.95 * neck, h + 0.003), (0.95 * neck, h + tall), (0, h + tall)]
                b.form(v.cap, turned([*stopper, *top], segments=20), collides="none")
            else:
                out, high = neck + 0.0015, h + 0.2 * tall
                disc = [(0, h + 0.0015), (out, h + 0.0015), (out, high), (0.9 * out, high + 0.002)]
                b.form(v.cap, turned([*disc, (0, high + 0.002)], segments=24), collides="none")
                around = rows + np.array([0.0012, 0.0])
                band(b, v.cap, around, h - 0.8 * tall, h + 0.0015, segments=24)


_BORDEAUX = (
    (0.96, 0.0),
    (1.0, 0.02),
    (1.0, 0.6),
    (0.9, 0.68),
    (0.42, 0.76),
    (0.36, 0.82),
    (0.36, 0.97),
    (0.4, 0.98),
    (0.38, 1.0),
)
_BURGUNDY = (
    (0.97, 0.0),
    (1.0, 0.03),
    (1.0, 0.42),
    (0.7, 0.6),
    (0.36, 0.78),
    (0.34, 0.97),
    (0.4, 0.98),
    (0.37, 1.0),
)
_LONGNECK = (
    (0.94, 0.0),
    (1.0, 0.03),
    (1.0, 0.5),
    (0.8, 0.62),
    (0.44, 0.8),
    (0.4, 0.96),
    (0.45, 0.97),
    (0.44, 1.0),
)
_WATER = (
    (0.9, 0.0),
    (1.0, 0.05),
    (1.0, 0.3),
    (0.92, 0.4),
    (1.0, 0.5),
    (1.0, 0.72),
    (0.7, 0.86),
    (0.4, 0.93),
    (0.4, 1.0),
)
_CARAFE = ((0.96, 0.0), (1.0, 0.1), (0.86, 0.35), (0.42, 0.62), (0.38, 0.78), (0.55, 1.0))
_SAUCE = ((0.95, 0.0), (1.0, 0.04), (1.0, 0.55), (0.85, 0.68), (0.5, 0.8), (0.42, 0.9), (0.42, 1.0))
_SHARED = {
    "wall": 0.0025,
    "full": Span(0.3, 0.72),
    "label": Choice(*LABELS),
    "label_at": (0.14, 0.46),
    "cap_m": 0.025,
    "cork": False,
}
_WATERS = paint("#c9dde2", 0.05, 1000.0)

FAMILY = Family(
    name="bottle",
    category="bottle",
    least_m=(0.045, 0.045, 0.14),
    most_m=(0.22, 0.22, 0.4),
    styles={
        "wine": Style(
            _bottle,
            {
                **_SHARED,
                "radius": Span(0.037, 0.04),
                "height": Span(0.29, 0.31),
                "profile": Choice(_BORDEAUX, _BURGUNDY),
                "material": Choice(
                    *(glass(c, 0.75) for c in ("#22381f", "#3a4a22", "#3b2412")),
                    glass("#dfe4d8", 0.1),
                ),
                "drink": Choice(None, paint("#2a0a12", 0.1, 1000.0)),
                "cap": Choice(paint("#b98f64", 0.9, 200.0), paint("#6e1a22", 0.4, 600.0)),
                "cork": True,
                "cap_m": Span(0.006, 0.02),
            },
        ),
        "water": Style(
            _bottle,
            {
                **_SHARED,
                "radius": Span(0.032, 0.042),
                "height": Span(0.2, 0.3),
                "wall": 0.001,
                "profile": _WATER,
                "material": Choice(
                    glass("#dceaf0", 0.1), glass("#b9d8e2", 0.35), glass("#c3dcc0", 0.35)
                ),
                "drink": Choice(None, _WATERS),
                "label_at": (0.5, 0.7),
                "cap": Choice(*(paint(c, 0.4) for c in ("#2f5a9c", "#e9e6df", "#3f8a4a"))),
                "cap_m": 0.018,
            },
        ),
        "beer": Style(
            _bottle,
            {
                **_SHARED,
                "radius": Span(0.03, 0.033),
                "height": Span(0.22, 0.26),
                "profile": _LONGNECK,
                "material": Choice(
                    glass("#4a2a0e", 0.75), glass("#26401e", 0.7), glass("#dfe4d8", 0.1)
                ),
                "drink": Choice(None, paint("#8a5a14", 0.1, 1000.0)),
                "cap": Choice(metal("steel"), metal("#8a3b32"), metal("brass")),
                "cap_m": 0.007,
            },
        ),
        "carafe": Style(
            _bottle,
            {
                **_SHARED,
                "radius": Span(0.055, 0.08),
                "height": Span(0.22, 0.28),
                "profile": _CARAFE,
                "material": Choice(*(glass(*c) for c in CLEAR)),
                "drink": Choice(None, _WATERS, paint("#4a0f1c", 0.05, 1000.0)),
                "full": Span(0.2, 0.5),
                "label": None,
                "cap": None,
            },
        ),
        "sauce": Style(
            _bottle,
            {
                **_SHARED,
                "radius": Span(0.027, 0.036),
                "height": Span(0.17, 0.22),
                "profile": _SAUCE,
                "material": Choice(
                    *(
                        paint(c, 0.25, 900.0)
                        for c in ("#a8231c", "#d9a520", "#3a2a1c", "#e9e4d2", "#5f7a3a")
                    )
                ),
                "drink": None,
                "label_at": (0.2, 0.52),
                "cap": Choice(
                    *(paint(c, 0.4) for c in ("#e9e6df", "#26282b", "#3f8a4a", "#a8231c"))
                ),
                "cap_m": 0.022,
            },
        ),
    },
)
