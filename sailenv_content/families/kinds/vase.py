"""Vases: amphoras, balls, cylinders, trumpets, bottles, with facets; some with twigs."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import CLEAR, GLAZES, band, loop
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import smooth_profile, vessel
from sailenv_content.families.materials import glass, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import Floats, swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _twigs(b: PieceBuilder, rows: Floats, v: Values) -> None:
    """Stand dry twigs with round seeds into the neck."""
    h, neck = float(rows[-1, 1]), float(rows[:, 0].min())
    bark = paint(b.pick("#6b5237", "#8c7650", "#4d4a3a"), 0.9)
    seed = paint(b.pick("#c9b896", "#e6ded0", "#9a4a3a", "#7d8a5a"), 0.8)
    bead = turned([(0, 0), (0.006, 0.004), (0.007, 0.009), (0, 0.016)], segments=8)
    for number in range(v.twigs):
        angle, lean = 2.4 * number + b.between(0.0, 1.0), b.between(0.1, 0.35)
        c, s = np.cos(angle), np.sin(angle)
        tall = h * b.between(0.7, 1.3)
        points = [
            (0.2 * neck * c, 0.2 * neck * s, 0.3 * h),
            (0.4 * neck * c, 0.4 * neck * s, h),
            (
                0.4 * neck * c + lean * tall * 0.6 * c,
                0.4 * neck * s + lean * tall * 0.6 * s,
                h + 0.6 * tall,
            ),
            (
                0.4 * neck * c + lean * tall * 1.3 * c,
                0.4 * neck * s + lean * tall * 1.3 * s,
                h + tall,
            ),
        ]
        path = curve(points, 12)
        b.form(bark, swept(path, np.linspace(0.0025, 0.001, 12), sides=5), collides="none")
        for place in path[6::1]:
            away = np.array([*b.rng.uniform(-0.02, 0.02, 2), b.between(0.0, 0.02)])
            turn = (b.between(-40, 40), b.between(-40, 40), 0.0)
            b.form(seed, bead, place + away, turn=turn, collides="none", volume=2e-7)


def _turned(b: PieceBuilder, v: Values) -> None:
    """Turn a vase from its profile."""
    rows = smooth_profile(np.array(v.profile) * (v.radius, v.height), 30)
    crease = 40.0 if v.sides > 16 else 5.0
    mesh = vessel(rows, wall=v.wall, floor=2 * v.wall, segments=v.sides, crease_deg=crease)
    b.form(v.material, mesh)
    if v.banded:
        low = v.height * b.between(0.3, 0.5)
        band(b, v.second, rows, low, low + v.height * b.between(0.05, 0.2))
    if v.handles:
        neck = np.abs(rows[:, 1] - 0.94 * v.height).argmin()
        shoulder = np.abs(rows[:, 1] - 0.68 * v.height).argmin()
        for yaw in (90.0, 270.0):
            loop(
                b,
                v.material,
                float(rows[neck, 0]),
                0.68 * v.height,
                0.94 * v.height,
                out=0.35 * v.radius,
                thick=0.07 * v.radius,
                yaw_deg=yaw,
                foot_x=float(rows[shoulder, 0]),
            )
    if v.twigs:
        _twigs(b, rows, v)


_SHARED = {
    "height": Span(0.18, 0.36),
    "radius": Span(0.06, 0.1),
    "wall": Span(0.004, 0.007),
    "sides": 40,
    "material": Choice(*GLAZES, paint("#b98f74", 0.8, 1900.0)),
    "second": Choice(*GLAZES),
    "banded": Choice(False, True),
    "handles": False,
    "twigs": Choice(0, 0, 5, 8),
}

FAMILY = Family(
    name="vase",
    category="vase",
    least_m=(0.06, 0.06, 0.1),
    most_m=(0.9, 0.9, 1.2),
    styles={
        "amphora": Style(
            _turned,
            {
                **_SHARED,
                "profile": Choice(
                    ((0.5, 0), (0.8, 0.25), (1, 0.58), (0.75, 0.78), (0.36, 0.88), (0.5, 1)),
                    ((0.4, 0), (0.45, 0.03), (0.95, 0.5), (0.9, 0.68), (0.4, 0.84), (0.45, 1)),
                ),
                "handles": Choice(True, False),
            },
        ),
        "ball": Style(
            _turned,
            {
                **_SHARED,
                "height": Span(0.14, 0.24),
                "radius": Span(0.08, 0.13),
                "profile": Choice(
                    ((0.45, 0), (0.9, 0.22), (1, 0.48), (0.8, 0.76), (0.3, 0.92), (0.34, 1)),
                    ((0.6, 0), (1, 0.3), (0.9, 0.6), (0.5, 0.85), (0.46, 1)),
                ),
            },
        ),
        "cylinder": Style(
            _turned,
            {
                **_SHARED,
                "radius": Span(0.045, 0.08),
                "profile": Choice(
                    ((0.97, 0), (1, 0.04), (1, 1)),
                    ((0.8, 0), (0.84, 0.1), (1, 1)),
                ),
                "material": Choice(*GLAZES[:6], *(glass(*c) for c in CLEAR)),
            },
        ),
        "trumpet": Style(
            _turned,
            {
                **_SHARED,
                "profile": Choice(
                    ((0.55, 0), (0.5, 0.03), (0.28, 0.2), (0.4, 0.6), (1, 1)),
                    ((0.6, 0), (0.35, 0.1), (0.55, 0.7), (1, 1)),
                ),
                "material": Choice(*(glass(*c) for c in CLEAR), *GLAZES[:3]),
                "banded": False,
            },
        ),
        "bottle": Style(
            _turned,
            {
                **_SHARED,
                "profile": Choice(
                    ((0.8, 0), (1, 0.15), (0.95, 0.38), (0.3, 0.6), (0.2, 0.9), (0.26, 1)),
                    ((0.9, 0), (0.95, 0.3), (0.5, 0.5), (0.6, 0.66), (0.24, 0.8), (0.28, 1)),
                ),
                "height": Span(0.24, 0.42),
            },
        ),
        "faceted": Style(
            _turned,
            {
                **_SHARED,
                "sides": Choice(6, 8, 10),
                "profile": Choice(
                    ((0.6, 0), (1, 0.5), (0.55, 1)),
                    ((0.7, 0), (0.85, 0.3), (1, 0.7), (0.8, 1)),
                ),
                "material": Choice(*GLAZES, wood("walnut"), wood("oak")),
                "banded": False,
            },
        ),
    },
)
