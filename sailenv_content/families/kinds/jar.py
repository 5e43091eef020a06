"""Jars: with a clip, with a screwed lid, tins, of stoneware, for sweets; their lids open."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.crockery import GLAZES, band
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollows import vessel_walls
from sailenv_content.families.lathe import closed_ring, smooth_profile, vessel
from sailenv_content.families.materials import PieceMaterial, glass, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import Floats, swept, turned
from sailenv_content.procedural.forms import circle

__all__ = ["FAMILY"]

CLEAR = glass("#dfe8e6", 0.08)
RUBBER = paint("#c9562e", 0.6, 1100.0)


def _body(b: PieceBuilder, v: Values, material: PieceMaterial, rows: Floats) -> None:
    """Add a vessel and what is in it."""
    see_through = material.surface.alpha == "blend"
    wall = 0.0035
    b.form(
        material, vessel(rows, wall=wall, floor=0.005, segments=36), collides="none", volume=6e-5
    )
    vessel_walls(b, rows, wall=wall, floor=0.005, sectors=8, bands=1)
    if not see_through:
        return
    top = v.filled * rows[-1, 1]
    z = np.linspace(0.0065, max(top, 0.012), 8)
    inner = np.stack([np.interp(z, rows[:, 1], rows[:, 0]) - wall - 0.0008, z], -1)
    heap = [(0.55 * inner[-1, 0], top + 0.004), (0.0, top + 0.006)]
    mesh = turned(np.concatenate([[(0.0, 0.0065)], inner, heap]), segments=28)
    with b.part("contents", "jar"):
        b.form(v.store, mesh, collides="none", volume=2e-4)


def _clip(b: PieceBuilder, v: Values) -> None:
    """Close a glass with a lid on a wire."""
    r, h = v.radius, v.height
    rows = smooth_profile(
        [(0.9 * r, 0), (r, 0.012), (r, 0.8 * h), (0.84 * r, 0.93 * h), (0.84 * r, h)]
    )
    _body(b, v, CLEAR, rows)
    neck = 0.84 * r
    seal = closed_ring(circle(8) * (0.004, 0.0022) + (neck - 0.002, 0.0), segments=30)
    b.form(RUBBER, seal, (0.0, 0.0, h + 0.0038), collides="none", volume=2e-6)
    wire = metal("steel")
    loop = closed_ring(circle(6) * 0.0014 + (neck + 0.0015, 0.0), segments=30)
    b.form(wire, loop, (0.0, 0.0, h - 0.012), collides="none", volume=1e-6)
    at = (-neck - 0.004, 0.0, h + 0.006)
    with b.hinge(
        "lid", "lid", at=at, axis=(0, -1, 0), opens_deg=100.0, friction=0.02, damping=0.01
    ):
        lid = [
            (0, 0.0062),
            (neck + 0.003, 0.0062),
            (neck + 0.004, 0.012),
            (0.7 * neck, 0.018),
            (0, 0.02),
        ]
        b.form(CLEAR, turned(lid, segments=32), (0.0, 0.0, h), volume=2e-5)
        for sy in (-1.0, 1.0):
            path = [
                (-neck - 0.006, sy * 0.012, h - 0.004),
                (-neck * 0.6, sy * 0.012, h + 0.021),
                (neck * 0.6, sy * 0.012, h + 0.021),
            ]
            b.form(wire, swept(path, 0.0013, sides=6), collides="none", volume=1e-6)
    path = [
        (neck, 0.012, h - 0.012),
        (neck + 0.012, 0.012, h - 0.035),
        (neck + 0.012, -0.012, h - 0.035),
        (neck, -0.012, h - 0.012),
    ]
    b.form(wire, swept(path, 0.0013, sides=6), collides="none", volume=1e-6)


def _lifted(b: PieceBuilder, material: PieceMaterial, lid: Floats, z: float, by: float) -> None:
    """Add a lid that is lifted off."""
    with b.slide("lid", "lid", by=by, axis=(0.0, 0.0, 1.0), friction=3.0, damping=1.0):
        b.form(
            material, turned(lid, segments=32, tile_m=material.tile_m), (0.0, 0.0, z), volume=3e-5
        )


def _screw(b: PieceBuilder, v: Values) -> None:
    """Close a glass with a lid of tin or wood."""
    r, h = v.radius, v.height
    rows = smooth_profile(
        [(0.9 * r, 0), (r, 0.014), (r, 0.82 * h), (0.86 * r, 0.95 * h), (0.86 * r, h)]
    )
    _body(b, v, CLEAR, rows)
    lid = np.array(
        [
            (0, 0.0),
            (0.9 * r, 0.0),
            (0.92 * r, 0.002),
            (0.92 * r, 0.014),
            (0.88 * r, 0.016),
            (0, 0.016),
        ]
    )
    _lifted(b, v.lid, lid, h + 0.0015, 0.12)
    if v.label:
        paper = paint("#e8e0cc", 0.9)
        band(b, paper, rows, 0.25 * h, 0.6 * h)


def _tin(b: PieceBuilder, v: Values) -> None:
    """Close a tin, painted with bands, with a lid over its rim."""
    r, h = v.radius * 1.1, v.height
    rows = np.array([(r, 0.0), (r, 0.004), (r, h - 0.001), (r, h)])
    _body(b, v, v.tin, rows)
    for low, high in ((0.12, 0.2), (0.62, 0.7)):
        band(b, v.lid, rows, low * h, high * h)
    lid = np.array(
        [
            (0, 0.0),
            (1.03 * r, 0.0),
            (1.03 * r, 0.018),
            (0.96 * r, 0.022),
            (0.3 * r, 0.023),
            (0, 0.023),
        ]
    )
    _lifted(b, v.lid, lid, h + 0.0015, 0.12)


def _stone(b: PieceBuilder, v: Values) -> None:
    """Throw a pot with a shoulder, and a lid with a knob."""
    r, h = v.radius * 1.15, v.height
    outline = [(0.7 * r, 0), (0.92 * r, 0.2 * h), (r, 0.6 * h), (0.86 * r, 0.9 * h), (0.7 * r, h)]
    rows = smooth_profile(np.array(outline), 22)
    _body(b, v, v.glaze, rows)
    if v.label:
        band(b, v.second, rows, 0.58 * h, 0.68 * h)
    n = 0.7 * r
    lid = np.array(
        [
            (0, 0),
            (n + 0.003, 0),
            (n + 0.004, 0.005),
            (0.6 * n, 0.014),
            (0.16 * n, 0.018),
            (0.12 * n, 0.024),
            (0.26 * n, 0.034),
            (0.2 * n, 0.042),
            (0, 0.044),
        ]
    )
    _lifted(b, v.glaze if v.label else v.wood, lid, h + 0.0022, 0.1)


def _sweets(b: PieceBuilder, v: Values) -> None:
    """Blow a glass on a foot, and a lid with a ball."""
    r, h = v.radius * 1.1, v.height * 0.85
    foot = turned(
        [
            (0, 0),
            (0.7 * r, 0),
            (0.66 * r, 0.006),
            (0.16 * r, 0.012),
            (0.12 * r, 0.035),
            (0.3 * r, 0.042),
            (0, 0.044),
        ],
        segments=28,
    )
    b.form(CLEAR, foot, (0, 0, -0.042), volume=4e-5)
    rows = smooth_profile(
        [(0.35 * r, 0), (0.9 * r, 0.25 * h), (r, 0.6 * h), (0.84 * r, 0.92 * h), (0.8 * r, h)], 22
    )
    _body(b, v, CLEAR, rows)
    n = 0.8 * r
    lid = np.array(
        [
            (0, 0),
            (n + 0.002, 0),
            (n, 0.008),
            (0.5 * n, 0.026),
            (0.1 * n, 0.03),
            (0.2 * n, 0.042),
            (0.16 * n, 0.052),
            (0, 0.056),
        ]
    )
    _lifted(b, CLEAR, lid, h + 0.0015, 0.12)


_SHARED = {
    "radius": Span(0.038, 0.06),
    "height": Span(0.11, 0.22),
    "filled": Span(0.3, 0.85),
    "label": Choice(True, False),
    "store": Choice(
        *(
            paint(c, 0.9, 800.0)
            for c in ("#e8e0cc", "#b98a4a", "#6b3f24", "#c9a44a", "#8a3b32", "#f0ece2", "#5d6b3a")
        )
    ),
    "lid": Choice(metal("steel"), metal("brass"), metal("copper"), wood("beech"), metal("#26272a")),
    "wood": Choice(wood("beech"), wood("oak"), wood("walnut")),
    "tin": Choice(
        *(paint(c, 0.35, 900.0) for c in ("#8a3b32", "#2f4257", "#3f5a4a", "#d8c9a3", "#c9562e"))
    ),
    "glaze": Choice(*GLAZES),
    "second": Choice(*GLAZES),
}

FAMILY = Family(
    name="jar",
    category="jar",
    least_m=(0.06, 0.06, 0.08),
    most_m=(0.2, 0.2, 0.36),
    styles={
        "clip": Style(_clip, _SHARED),
        "screw": Style(_screw, _SHARED),
        "tin": Style(_tin, _SHARED),
        "stone": Style(_stone, _SHARED),
        "sweets": Style(_sweets, _SHARED),
    },
)
