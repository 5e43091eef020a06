"""Clocks: round and square ones on the wall, on a mantel, an alarm clock, one in a tall case."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import front_panel
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import closed_ring
from sailenv_content.families.materials import WOODS, PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import extruded, placed, swept, turned
from sailenv_content.procedural.forms import rectangle

__all__ = ["FAMILY"]


def _dial(b: PieceBuilder, v: Values, x: float, z: float, r: float) -> None:
    """Add a face that looks along x: marks, and hands that turn."""
    disc = [(0, -0.003), (r, -0.003), (r, 0.0), (0, 0.0)]
    b.form(v.face, turned(disc, segments=44), (x, 0.0, z), turn=(0, 90, 0), collides="none")
    for hour in range(12):
        a = np.pi * hour / 6
        long = 0.14 * r if hour % 3 == 0 else 0.08 * r
        at = (x + 0.0006, (0.93 * r - long / 2) * np.sin(a), z + (0.93 * r - long / 2) * np.cos(a))
        size = (0.0012, 0.022 * r if hour % 3 else 0.036 * r, long)
        b.box(v.ink, size, at, turn=(-float(np.degrees(a)), 0, 0), bevel=0.0003, collides=False)
    minute = b.between(0.0, 2 * np.pi)
    hour_angle = float(b.rng.integers(0, 12)) * np.pi / 6 + minute / 12
    hands = (
        ("hour hand", hour_angle, 0.5 * r, 0.055 * r),
        ("minute hand", minute, 0.78 * r, 0.036 * r),
    )
    for number, (name, a, long, wide) in enumerate(hands):
        off = x + 0.0045 + 0.0035 * number
        with b.hinge(
            name,
            "handle",
            at=(off, 0, z),
            axis=(-1, 0, 0),
            opens_deg=360.0,
            friction=0.01,  # a hand of 5 g must not fall
            damping=0.001,
        ):
            at = (off, 0.4 * long * np.sin(a), z + 0.4 * long * np.cos(a))
            b.box(
                v.ink,
                (0.0012, wide, 1.2 * long),
                at,
                turn=(-float(np.degrees(a)), 0, 0),
                bevel=0.0004,
            )
    hub = [(0, 0), (0.05 * r, 0), (0.04 * r, 0.0016), (0, 0.0016)]
    b.form(v.ink, turned(hub, segments=16), (x + 0.0095, 0, z), turn=(0, 90, 0), collides="none")


def _ring(
    b: PieceBuilder, material: PieceMaterial, x: float, z: float, r: float, wide: float, deep: float
) -> None:
    """Add a rim around a dial, from x forward."""
    rows = [
        (r - wide, 0.0),
        (r, 0.0),
        (r, 0.6 * deep),
        (r - 0.5 * wide, deep),
        (r - wide, 0.7 * deep),
    ]
    ring = closed_ring(rows, segments=48)
    b.form(material, placed(ring, (0, 0, 0), (0, 90, 0)), (x, 0, z), collides="none")


def _wall(b: PieceBuilder, v: Values) -> None:
    """Hang a round clock with a rim."""
    r, d = v.radius, v.depth
    back = [(0, 0), (r - 0.002, 0), (r - 0.002, 0.4 * d), (0, 0.4 * d)]
    b.form(v.case, turned(back, segments=44), (0, 0, r), turn=(0, 90, 0))
    _ring(b, v.case, 0.0, r, r, v.rim * r, d)
    _dial(b, v, 0.4 * d + 0.0035, r, (1 - 0.9 * v.rim) * r)


def _square(b: PieceBuilder, v: Values) -> None:
    """Hang a square clock with round corners."""
    r, d = v.radius, v.depth
    body = extruded(
        rectangle(2 * r, 2 * r, v.corner * r), 0.6 * d, bevel=0.004, tile_m=v.case.tile_m
    )
    b.form(v.case, placed(body, (0, 0, 0), (90, 0, 90)), (0.0, 0.0, r))
    _dial(b, v, 0.6 * d + 0.0035, r, 0.88 * r)


def _mantel(b: PieceBuilder, v: Values) -> None:
    """Stand a clock in a case with an arch on a shelf."""
    r, d = 0.55 * v.radius, 0.09
    wide, low = 2.9 * r, 0.03
    b.box(v.wood, (d + 0.03, wide, low), (0.0, 0.0, low / 2), bevel=0.006)
    turn = np.linspace(0.0, np.pi, 25)
    arch = np.stack([1.25 * r * np.cos(turn), 1.2 * r + 1.25 * r * np.sin(turn)], -1)
    outline = np.concatenate([[(-1.25 * r, 0.0), (1.25 * r, 0.0)], arch])
    middle = outline.mean(axis=0)
    body = extruded(outline - middle, d, bevel=0.006, tile_m=v.wood.tile_m)
    mesh = placed(body, (0, 0, 0), (90, 0, 90))
    b.form(v.wood, mesh, (-d / 2, float(middle[0]), low + float(middle[1])))
    z = low + 1.2 * r
    _ring(b, v.metal, d / 2 - 0.001, z, 1.02 * r, 0.1 * r, 0.014)
    _dial(b, v, d / 2 + 0.0035, z, 0.93 * r)


def _alarm(b: PieceBuilder, v: Values) -> None:
    """Stand an alarm clock with two bells on two feet."""
    r, d = 0.05, 0.045
    z = r + 0.016
    drum = [(0, 0), (r, 0), (r, d), (0.9 * r, d), (0.9 * r, d - 0.004), (0, d - 0.004)]
    b.form(v.coat, turned(drum, segments=36), (-d / 2, 0, z), turn=(0, 90, 0))
    _dial(b, v, d / 2 - 0.0005, z, 0.88 * r)
    for sy in (-1.0, 1.0):
        foot = [(0.0, sy * 0.6 * r, z - 0.75 * r), (0.0, sy * 0.85 * r, 0.004)]
        b.form(v.metal, swept(foot, (0.005, 0.004), sides=10))
        bell = [(0, 0), (0.022, 0), (0.02, 0.008), (0.012, 0.015), (0, 0.017)]
        at = (0.0, sy * 0.6 * r, z + 0.92 * r)
        b.form(v.metal, turned(bell, segments=20), at, turn=(-sy * 30, 0, 0))
        post = [(0.0, sy * 0.5 * r, z + 0.8 * r), at]
        b.form(v.metal, swept(post, 0.002, sides=6), collides="none")
    bow = [
        (0, 0.03 * np.cos(t), z + 1.15 * r + 0.022 * np.sin(t)) for t in np.linspace(0, np.pi, 12)
    ]
    b.form(v.metal, swept(bow, 0.0022, sides=8), collides="none")


def _tall(b: PieceBuilder, v: Values) -> None:
    """Make a case as high as a person, with a door and a pendulum behind it."""
    w, d, h, t = 0.44, 0.24, v.tall, 0.018
    b.box(v.wood, (d + 0.03, w + 0.04, 0.1), (0, 0, 0.05), bevel=0.008)
    b.box(v.wood, (d, w, 0.34), (0, 0, 0.27), bevel=0.005)
    low, high, slim = 0.44, h - 0.5, w - 0.1
    for sy in (-1.0, 1.0):
        b.box(v.wood, (d - 0.04, t, high - low), (-0.02, sy * (slim - t) / 2, (low + high) / 2))
    b.box(v.wood, (0.01, slim, high - low), (-d / 2 + 0.005, 0, (low + high) / 2))
    b.box(v.wood, (d, w, 0.46), (0, 0, high + 0.23), bevel=0.005)
    b.box(v.wood, (d + 0.05, w + 0.06, 0.04), (0, 0, h - 0.02), bevel=0.012)
    z = high + 0.23
    _ring(b, v.metal, d / 2 - 0.001, z, 0.165, 0.014, 0.012)
    _dial(b, v, d / 2 + 0.0035, z, 0.155)
    with b.hinge(
        "pendulum",
        "handle",
        at=(-0.03, 0, high - 0.02),
        axis=(1, 0, 0),
        opens_deg=5.0,
        friction=0.001,
        damping=0.001,
    ):
        b.box(v.metal, (0.004, 0.012, 0.6), (-0.03, 0.0, high - 0.33), bevel=0.001)
        bob = [(0, -0.008), (0.05, -0.004), (0.055, 0), (0.05, 0.004), (0, 0.008)]
        b.form(v.metal, turned(bob, segments=28), (-0.03, 0.0, high - 0.64), turn=(0, 90, 0))
    leaf = Box(
        (d / 2 - 0.06, -slim / 2 + 0.003, low + 0.003),
        (d / 2 - 0.041, slim / 2 - 0.003, high - 0.003),
    )
    leaf = Box(leaf.low + np.array([0.022, 0, 0]), leaf.high + np.array([0.022, 0, 0]))
    at = (float(leaf.high[0]), float(leaf.high[1]), float(leaf.middle[2]))
    with b.hinge("door", "door", at=at, axis=(0, 0, 1), opens_deg=100.0):
        front_panel(b, v.wood, "glass", leaf, pane=glass())


_CASES = (
    *WOODS,
    metal("#26272a"),
    metal("brass"),
    metal("chrome"),
    paint("#e9e6df"),
    paint("#8a3b32"),
    paint("#54616b"),
)
_SHARED = {
    "radius": Span(0.12, 0.22),
    "depth": Span(0.03, 0.045),
    "rim": Span(0.06, 0.18),
    "corner": Choice(0.1, 0.4),
    "tall": Span(1.85, 2.1),
    "case": Choice(*_CASES),
    "coat": Choice(*_CASES[7:], *(paint(c, 0.3) for c in ("#3f5a4a", "#c9a13a"))),
    "wood": Choice(*WOODS),
    "metal": Choice(metal("brass"), metal("chrome"), metal("copper")),
    "face": Choice(paint("#f3f0e8", 0.5), paint("#f3f0e8", 0.5), paint("#e2d6bb", 0.5)),
    "ink": paint("#1d1e20", 0.4),
}

FAMILY = Family(
    name="clock",
    category="clock",
    least_m=(0.03, 0.08, 0.1),
    most_m=(0.4, 0.6, 2.2),
    styles={
        "round": Style(_wall, _SHARED),
        "square": Style(_square, _SHARED),
        "mantel": Style(_mantel, _SHARED),
        "alarm": Style(_alarm, _SHARED),
        "tall_case": Style(_tall, _SHARED),
    },
)
