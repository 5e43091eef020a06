"""Floor lamps: a shade on a pole, an arc, a tripod, three globes, a reading lamp."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lamps import PAPERS, bulb, foot, globe, shade
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _pole(b: PieceBuilder, v: Values) -> None:
    """Make a shade on an upright pole."""
    h, low = v.height, v.height - v.shade_m
    foot(b, v.metal, v.foot, height=0.024)
    b.form(v.metal, swept([(0, 0, 0.02), (0, 0, low + 0.06)], v.pole, sides=14))
    bulb(b, (0.0, 0.0, low + 0.05))
    shade(b, v.kind, v.paper, v.radius, v.shade_m, (0.0, 0.0, h - v.shade_m), ribs=v.ribs)
    for angle in np.arange(3) * 2 * np.pi / 3:
        end = (0.9 * v.radius * np.cos(angle), 0.9 * v.radius * np.sin(angle), low + 0.03)
        b.form(v.metal, swept([(0, 0, low + 0.045), end], 0.002, sides=6), collides="none")


def _tripod(b: PieceBuilder, v: Values) -> None:
    """Make a shade on three splayed legs."""
    low = v.height - v.shade_m
    hub = low - 0.06
    for angle in np.arange(3) * 2 * np.pi / 3 + np.pi:
        c, s = np.cos(angle), np.sin(angle)
        ends = [(0.3 * c, 0.3 * s, 0.0), (0.03 * c, 0.03 * s, hub)]
        b.form(v.wood, swept(ends, (0.011, 0.016), sides=12, tile_m=v.wood.tile_m))
        ring = [(0.19 * c, 0.19 * s, 0.4 * hub), (0.0, 0.0, 0.42 * hub)]
        b.form(v.metal, swept(ring, 0.004, sides=8), collides="none")
    cap = [
        (0, hub - 0.03),
        (0.05, hub - 0.03),
        (0.05, hub + 0.01),
        (0.012, hub + 0.02),
        (0.012, low + 0.05),
        (0, low + 0.05),
    ]
    b.form(v.metal, turned(cap, segments=20))
    bulb(b, (0.0, 0.0, low + 0.04))
    shade(b, v.kind, v.paper, v.radius, v.shade_m, (0.0, 0.0, low))


def _arc(b: PieceBuilder, v: Values) -> None:
    """Make a dome that hangs from a long arc, over a heavy foot."""
    reach, h = v.reach, v.height
    x = -0.4 * reach
    base = [(0, 0), (0.17, 0), (0.17, 0.05), (0.16, 0.06), (0, 0.06)]
    b.form(v.stone, turned(base, segments=36), (x, 0.0, 0.0))
    path = curve(
        [
            (x, 0, 0.05),
            (x, 0, 0.55 * h),
            (x + 0.25 * reach, 0, 0.93 * h),
            (x + 0.65 * reach, 0, h),
            (x + reach, 0, 0.9 * h),
        ],
        24,
    )
    for first in range(0, 23, 4):
        piece = path[first : first + 5]
        b.form(v.metal, swept(piece, 0.011, sides=10))
    end = path[-1]
    top = (float(end[0]), 0.0, float(end[2]))
    bulb(b, (top[0], 0.0, top[2] - 0.02), hanging=True, size=0.035)
    shade(b, "dome", v.dome, v.radius, 0.75 * v.radius, (top[0], 0.0, top[2] - 0.75 * v.radius))


def _globes(b: PieceBuilder, v: Values) -> None:
    """Make globes of opal glass on arms of a pole."""
    h = v.height
    foot(b, v.metal, v.foot, height=0.02)
    b.form(v.metal, swept([(0, 0, 0.02), (0, 0, h - v.ball)], 0.009, sides=12))
    globe(b, v.ball, (0.0, 0.0, h - v.ball))
    for number in range(v.count):
        angle = 2.4 * number + 0.6
        z = h - 0.22 - 0.2 * number
        out = (0.2 * np.cos(angle), 0.2 * np.sin(angle))
        b.form(v.metal, swept([(0, 0, z - 0.05), (*out, z - 0.02)], 0.006, sides=8))
        globe(b, v.ball * 0.85, (*out, z + 0.5 * v.ball))


def _reading(b: PieceBuilder, v: Values) -> None:
    """Make a small shade on an arm with two joints, that lights downwards."""
    h = v.height
    foot(b, v.metal, v.foot, height=0.02)
    neck = np.array([0.0, 0.0, h - 0.1])
    b.form(v.metal, swept(np.array([(0, 0, 0.02), neck]), 0.009, sides=12))
    tip = neck + np.array([0.26, 0.0, 0.1])
    b.form(v.metal, swept([neck - (0.07, 0, 0.027), tip], 0.007, sides=10))
    knuckle = [(0, -0.012), (0.016, -0.012), (0.016, 0.012), (0, 0.012)]
    for place in (neck, tip):
        b.form(v.metal, turned(knuckle, segments=16), place, turn=(90, 0, 0), collides="none")
    at = (float(tip[0]) + 0.02, 0.0, float(tip[2]) - 0.13)
    bulb(b, (float(tip[0]), 0.0, float(tip[2]) - 0.01), hanging=True, size=0.024)
    shade(b, "bell", v.dome, 0.085, 0.14, at, tilt_deg=-12.0)


_SHARED = {
    "height": Span(1.45, 1.7),
    "foot": Span(0.13, 0.17),
    "pole": Span(0.008, 0.014),
    "radius": Span(0.18, 0.26),
    "shade_m": Span(0.22, 0.32),
    "kind": Choice("drum", "cone", "empire"),
    "ribs": Choice(0, 0, 24),
    "paper": Choice(*PAPERS),
    "metal": Choice(metal("#232326"), metal("brass"), metal("chrome"), metal("bronze")),
    "wood": Choice(*WOODS),
    "dome": Choice(
        *(paint(c, 0.35) for c in ("#232326", "#e9e6df", "#3f5a4a", "#8a3b32")), metal("brass")
    ),
}

FAMILY = Family(
    name="floor_lamp",
    category="lamp",
    least_m=(0.2, 0.2, 1.1),
    most_m=(1.7, 0.8, 2.3),
    styles={
        "pole": Style(_pole, _SHARED),
        "tripod": Style(_tripod, {**_SHARED, "radius": Span(0.2, 0.27)}),
        "arc": Style(
            _arc,
            {
                **_SHARED,
                "height": Span(1.8, 2.1),
                "reach": Span(0.85, 1.15),
                "radius": Span(0.15, 0.2),
                "stone": Choice(
                    *(paint(c, 0.2, 2600.0) for c in ("#e7e4de", "#2b2d30", "#5c6b5f"))
                ),
            },
        ),
        "globes": Style(_globes, {**_SHARED, "ball": Span(0.08, 0.12), "count": Choice(1, 2, 3)}),
        "reading": Style(_reading, {**_SHARED, "height": Span(1.25, 1.5)}),
    },
)
