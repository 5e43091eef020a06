"""Table lamps: a turned or ceramic base with a shade, a globe, a desk lamp, a mushroom."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lamps import PAPERS, bulb, foot, globe, shade
from sailenv_content.families.lathe import smooth_profile
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept, turned

__all__ = ["FAMILY"]

BODIES: dict[str, tuple[tuple[float, float], ...]] = {
    "gourd": ((0.7, 0.0), (1.0, 0.25), (0.8, 0.5), (0.42, 0.66), (0.52, 0.8), (0.2, 1.0)),
    "urn": ((0.55, 0.0), (0.5, 0.06), (0.95, 0.55), (1.0, 0.7), (0.5, 0.92), (0.22, 1.0)),
    "ball": ((0.5, 0.0), (0.86, 0.2), (1.0, 0.48), (0.84, 0.76), (0.3, 0.95), (0.2, 1.0)),
    "jug": ((0.8, 0.0), (1.0, 0.05), (0.94, 0.5), (0.6, 0.85), (0.24, 1.0)),
    "candlestick": (
        (1.0, 0.0),
        (0.95, 0.05),
        (0.4, 0.1),
        (0.3, 0.3),
        (0.5, 0.36),
        (0.28, 0.42),
        (0.34, 0.75),
        (0.5, 0.82),
        (0.3, 0.88),
        (0.26, 1.0),
    ),
}


def _based(b: PieceBuilder, v: Values) -> None:
    """Make a turned body below a shade."""
    rows = smooth_profile(np.array(BODIES[v.form]) * (v.body_r, v.body_h), 26)
    mesh = turned([(0, 0), *rows, (0, v.body_h)], segments=30, tile_m=v.body.tile_m)
    b.form(v.body, mesh, volume=v.body_r**2 * v.body_h * 0.5)
    neck = v.body_h + 0.05
    b.form(v.metal, swept([(0, 0, v.body_h - 0.005), (0, 0, neck)], 0.008, sides=12))
    bulb(b, (0.0, 0.0, neck - 0.01))
    low = v.body_h + 0.02
    shade(b, v.kind, v.paper, v.radius, v.shade_m, (0.0, 0.0, low), ribs=v.ribs)
    for angle in (0.0, np.pi):
        end = (0.9 * v.radius * np.cos(angle), 0.0, low + 0.012)
        b.form(v.metal, swept([(0, 0, neck - 0.004), end], 0.002, sides=6), collides="none")


def _globe(b: PieceBuilder, v: Values) -> None:
    """Make a ball of opal glass on a ring or a low foot."""
    foot(b, v.metal, 0.6 * v.ball, height=v.foot_h)
    globe(b, v.ball, (0.0, 0.0, v.foot_h + 0.97 * v.ball))


def _desk(b: PieceBuilder, v: Values) -> None:
    """Make two arms with joints, and a shade that is turned down."""
    foot(b, v.metal, 0.085, height=0.022)
    low = np.array([0.0, 0.0, 0.03])
    lean = np.radians(v.lean)
    elbow = low + v.arm * np.array([-np.sin(lean), 0.0, np.cos(lean)])
    tip = elbow + v.arm * 0.9 * np.array([np.cos(lean * 0.9), 0.0, np.sin(lean * 0.9)])
    knuckle = [(0, -0.014), (0.014, -0.014), (0.014, 0.014), (0, 0.014)]
    for start, end in ((low, elbow), (elbow, tip)):
        for sy in (-1.0, 1.0):
            ends = np.array([start, end]) + np.array([0.0, sy * 0.008, 0.0])
            b.form(v.metal, swept(ends, 0.0045, sides=8))
    for place in (low, elbow, tip):
        b.form(v.joint, turned(knuckle, segments=14), place, turn=(90, 0, 0), collides="none")
    b.form(v.metal, swept([low - (0, 0, 0.012), low], 0.012, sides=10), collides="none")
    bulb(b, (float(tip[0]), 0.0, float(tip[2])), hanging=True, size=0.024)
    at = (float(tip[0]) + 0.015, 0.0, float(tip[2]) - 0.105)
    shade(b, "bell", v.dome, 0.08, 0.12, at, tilt_deg=-10.0)


def _mushroom(b: PieceBuilder, v: Values) -> None:
    """Make a dome on a thick stem."""
    stem = [(1.25, 0.0), (1.0, 0.08), (0.8, 0.5), (0.9, 0.9), (1.0, 1.0)]
    rows = smooth_profile(np.array(stem) * (v.stem_r, v.body_h), 14)
    b.form(v.solid, turned([(0, 0), *rows, (0, v.body_h)], segments=28), volume=4e-4)
    bulb(b, (0.0, 0.0, v.body_h - 0.07), size=0.02)
    shade(b, "dome", v.cap, v.radius, 0.7 * v.radius, (0.0, 0.0, v.body_h - 0.015))
    r, top = 0.17 * v.radius, v.body_h - 0.016 + 0.7 * v.radius
    cap = [(0, 0), (r, 0), (0.6 * r, 0.006), (0.3 * r, 0.02), (0, 0.022)]
    b.form(v.metal, turned(cap, segments=20), (0.0, 0.0, top), collides="none")


def _lantern(b: PieceBuilder, v: Values) -> None:
    """Make a block of paper or wood that glows between thin bars."""
    w, h = v.wide, v.tall
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(v.wood, (0.014, 0.014, h), (sx * w / 2, sy * w / 2, h / 2))
    for z in (0.02, h / 2, h - 0.01):
        for sign in (-1.0, 1.0):
            b.box(v.wood, (w, 0.01, 0.012), (0.0, sign * w / 2, z))
            b.box(v.wood, (0.01, w, 0.012), (sign * w / 2, 0.0, z))
    b.box(v.paper, (w - 0.012, w - 0.012, h - 0.03), (0.0, 0.0, h / 2 + 0.004), bevel=0.001)


_GLAZES = tuple(
    paint(c, 0.18, 1500.0)
    for c in ("#e9e5dc", "#2f4a5c", "#7d8f78", "#b5694a", "#26282b", "#c9a45c")
)
_SHARED = {
    "body_r": Span(0.06, 0.1),
    "body_h": Span(0.2, 0.32),
    "radius": Span(0.12, 0.17),
    "shade_m": Span(0.15, 0.22),
    "kind": Choice("drum", "cone", "empire"),
    "ribs": Choice(0, 0, 20),
    "paper": Choice(*PAPERS),
    "metal": Choice(metal("brass"), metal("#232326"), metal("chrome")),
    "wood": Choice(*WOODS),
}

FAMILY = Family(
    name="table_lamp",
    category="lamp",
    least_m=(0.1, 0.1, 0.15),
    most_m=(0.7, 0.5, 0.8),
    styles={
        "ceramic": Style(
            _based,
            {**_SHARED, "form": Choice("gourd", "urn", "ball", "jug"), "body": Choice(*_GLAZES)},
        ),
        "turned": Style(
            _based,
            {
                **_SHARED,
                "form": "candlestick",
                "body_r": Span(0.055, 0.075),
                "body": Choice(*WOODS, metal("brass"), paint("#e9e6df")),
            },
        ),
        "globe": Style(_globe, {**_SHARED, "ball": Span(0.09, 0.15), "foot_h": Span(0.02, 0.07)}),
        "desk": Style(
            _desk,
            {
                **_SHARED,
                "arm": Span(0.24, 0.34),
                "lean": Span(16.0, 32.0),
                "metal": Choice(
                    metal("#232326"), metal("#e6e4de"), metal("brass"), metal("#8a3b32")
                ),
                "joint": Choice(metal("brass"), metal("chrome")),
                "dome": Choice(
                    *(paint(c, 0.3) for c in ("#232326", "#e9e6df", "#3f5a4a", "#b5402f"))
                ),
            },
        ),
        "mushroom": Style(
            _mushroom,
            {
                **_SHARED,
                "stem_r": Span(0.03, 0.05),
                "solid": Choice(*_GLAZES, metal("chrome")),
                "cap": Choice(*PAPERS, *_GLAZES[:2]),
            },
        ),
        "lantern": Style(
            _lantern,
            {
                **_SHARED,
                "wide": Span(0.14, 0.2),
                "tall": Span(0.24, 0.4),
                "paper": Choice(*PAPERS[:3]),
            },
        ),
    },
)
