"""Ceiling lamps: a pendant, a chandelier, a flat dish, spots on a rail, a ball of paper."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lamps import BULB, PAPERS, bulb, globe, shade
from sailenv_content.families.lathe import sleeve
from sailenv_content.families.materials import glow, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import swept, turned

__all__ = ["FAMILY"]


def _hung(b: PieceBuilder, v: Values, low: float, *, x: float = 0.0, y: float = 0.0) -> None:
    """Add a cord from a height to the ceiling, and a cup at its upper end."""
    cord = [(x, y, low), (x, y, v.drop)]
    b.form(v.cord, swept(cord, 0.003, sides=8), collides="none")
    cup = [
        (0, v.drop),
        (0.045, v.drop),
        (0.05, v.drop - 0.005),
        (0.03, v.drop - 0.03),
        (0, v.drop - 0.032),
    ]
    b.form(v.metal, turned(cup[::-1], segments=22), (x, y, 0.0))


def _pendant(b: PieceBuilder, v: Values) -> None:
    """Hang one shade on a cord."""
    _hung(b, v, v.shade_m - 0.01)
    bulb(b, (0.0, 0.0, v.shade_m), hanging=True, size=0.034)
    shade(b, v.kind, v.paper, v.radius, v.shade_m, (0.0, 0.0, 0.0), ribs=v.ribs)


def _group(b: PieceBuilder, v: Values) -> None:
    """Hang small shades or globes side by side from a bar."""
    reach = 0.32 * (v.count - 1)
    b.box(v.metal, (0.06, reach + 0.14, 0.025), (0.0, 0.0, v.drop - 0.0125))
    for number in range(v.count):
        y = number * 0.32 - reach / 2
        low = 0.0 if v.level else 0.12 * (number % 2)
        top = low + (2 * v.ball if v.round else 0.16)
        cord = [(0.0, y, top - 0.005), (0.0, y, v.drop - 0.02)]
        b.form(v.cord, swept(cord, 0.003, sides=8), collides="none")
        if v.round:
            globe(b, v.ball, (0.0, y, low + v.ball))
        else:
            bulb(b, (0.0, y, top), hanging=True, size=0.028)
            shade(b, "bell", v.dome, 0.11, 0.16, (0.0, y, low))


def _chandelier(b: PieceBuilder, v: Values) -> None:
    """Make curved arms with candles around a turned stem."""
    stem = [
        (0, 0),
        (0.02, 0.01),
        (0.04, 0.05),
        (0.015, 0.09),
        (0.03, 0.14),
        (0.045, 0.18),
        (0.012, 0.24),
        (0.012, 0.4),
        (0, 0.4),
    ]
    b.form(v.metal, turned(stem, segments=20))
    _hung(b, v, 0.39)
    for angle in np.arange(v.arms) * 2 * np.pi / v.arms:
        c, s = np.cos(angle), np.sin(angle)
        t = np.linspace(0.0, 1.0, 10)
        r = 0.03 + (v.radius - 0.03) * t
        z = 0.14 - 0.1 * np.sin(np.pi * t) + 0.08 * t**2
        path = np.stack([r * c, r * s, z], -1)
        b.form(v.metal, swept(path, 0.007, sides=8), collides="none")
        x, y, top = float(path[-1, 0]), float(path[-1, 1]), float(path[-1, 2])
        cup = [(0, 0), (0.03, 0.006), (0.034, 0.014), (0.012, 0.012), (0.011, 0.09), (0, 0.09)]
        b.form(v.candle, turned(cup, segments=16), (x, y, top), collides="none")
        flame = [(0, 0.088), (0.009, 0.094), (0.013, 0.112), (0.006, 0.14), (0, 0.15)]
        b.form(BULB, turned(flame, segments=12), (x, y, top), collides="none", volume=1e-6)
        if v.shaded:
            shade(b, "empire", v.paper, 0.06, 0.09, (x, y, top + 0.07))
    ring = [(0, 0), (v.radius, 0), (v.radius, 0.24), (0, 0.24)]
    b.hull(turned(ring, segments=12), (0.0, 0.0, 0.04))


def _dish(b: PieceBuilder, v: Values) -> None:
    """Make a flat dish of opal glass right below the ceiling."""
    r, h = v.radius, v.flat
    turn = np.linspace(0.0, np.pi / 2, 10)
    rows = np.stack([r * np.sin(turn), h * 0.75 * (1 - np.cos(turn))], -1)
    b.form(v.opal, turned([*rows, (r, h), (0, h)], segments=40), volume=r * r * 0.01)
    rim = [(r + 0.012, h * 0.72), (r + 0.014, h * 0.85), (r + 0.012, h)]
    b.form(v.metal, sleeve(rim, wall=0.01, segments=40), collides="none", volume=1e-4)
    if v.second:  # a button of metal in its middle
        button = [(0, 0), (0.1 * r, 0), (0.12 * r, 0.012), (0, 0.012)]
        b.form(v.metal, turned(button, segments=20), collides="none")


def _spots(b: PieceBuilder, v: Values) -> None:
    """Make a rail with spots that are turned to different sides."""
    long = 0.28 * v.count
    b.box(v.metal, (0.04, long, 0.022), (0.0, 0.0, 0.169))
    for number in range(v.count):
        y = (number + 0.5) * 0.28 - long / 2
        tilt, yaw = b.between(-35.0, 35.0), b.between(-40.0, 40.0)
        b.form(v.metal, swept([(0, y, 0.1), (0, y, 0.16)], 0.006, sides=8), collides="none")
        can = [
            (0, 0.035),
            (0.03, 0.035),
            (0.036, 0.02),
            (0.036, -0.07),
            (0.031, -0.07),
            (0.031, -0.045),
            (0, -0.045),
        ]
        at = (0.0, y, 0.09)
        b.form(v.metal, turned(can[::-1], segments=20), at, turn=(yaw, tilt, 0), volume=8e-5)
        lens = [(0, -0.052), (0.03, -0.052), (0.03, -0.048), (0, -0.048)]
        b.form(
            BULB, turned(lens, segments=18), at, turn=(yaw, tilt, 0), collides="none", volume=1e-6
        )


def _paper(b: PieceBuilder, v: Values) -> None:
    """Hang a ball of paper with rings of wire."""
    r, flat = v.radius, v.squash
    turn = np.linspace(-1.35, 1.35, 21)
    ridge = 1.0 + 0.012 * np.cos(np.arange(21) * np.pi)
    rows = np.stack([r * np.cos(turn) * ridge, r * flat * (1.0 + np.sin(turn))], -1)
    rows[:, 1] -= rows[0, 1]
    top = float(rows[-1, 1])
    b.form(v.paper, sleeve(rows, wall=0.0015, segments=36), collides="none", volume=3e-4)
    b.hull(turned([(0, 0), *rows[::4], (0, top)], segments=12), (0.0, 0.0, 0.0))
    _hung(b, v, top - 0.02)
    bulb(b, (0.0, 0.0, top - 0.01), hanging=True, size=0.034)


_DOMES = tuple(paint(c, 0.35) for c in ("#232326", "#e9e6df", "#3f5a4a", "#8a3b32", "#c9a13a"))
_SHARED = {
    "drop": Span(0.7, 1.1),
    "radius": Span(0.18, 0.28),
    "shade_m": Span(0.2, 0.3),
    "kind": Choice("drum", "cone", "empire", "dome"),
    "ribs": Choice(0, 0, 24),
    "paper": Choice(*PAPERS),
    "dome": Choice(*_DOMES, metal("brass"), metal("copper")),
    "cord": Choice(paint("#1d1e20", 0.8), paint("#e2ddd0", 0.8), paint("#8a3b32", 0.8)),
    "metal": Choice(metal("#232326"), metal("brass"), metal("chrome"), metal("#e6e4de")),
}

FAMILY = Family(
    name="ceiling_lamp",
    category="lamp",
    least_m=(0.04, 0.18, 0.05),
    most_m=(1.2, 1.5, 1.3),
    styles={
        "pendant": Style(_pendant, {**_SHARED, "paper": Choice(*PAPERS, *_DOMES, metal("copper"))}),
        "group": Style(
            _group,
            {
                **_SHARED,
                "count": Whole(2, 4),
                "ball": Span(0.08, 0.12),
                "round": Choice(True, False),
                "level": Choice(True, False),
            },
        ),
        "chandelier": Style(
            _chandelier,
            {
                **_SHARED,
                "radius": Span(0.28, 0.4),
                "arms": Whole(5, 8),
                "shaded": Choice(True, False),
                "candle": Choice(paint("#efe7d3", 0.5), metal("brass")),
                "metal": Choice(metal("brass"), metal("#232326"), metal("bronze")),
            },
        ),
        "dish": Style(
            _dish,
            {
                **_SHARED,
                "radius": Span(0.15, 0.24),
                "flat": Span(0.08, 0.13),
                "second": Choice(False, True),
                "opal": Choice(glow("#f6f2e8", 3.0), glow("#f1e3c4", 3.0)),
            },
        ),
        "spots": Style(_spots, {**_SHARED, "count": Whole(2, 4)}),
        "paper": Style(
            _paper,
            {
                **_SHARED,
                "radius": Span(0.2, 0.3),
                "squash": Choice(1.0, 0.8, 1.2),
                "paper": Choice(*PAPERS[:3]),
            },
        ),
    },
)
