"""Stools: for a bar, three-legged, upholstered, on a column, a pouf."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.joinery import leg
from sailenv_content.families.materials import FABRICS, LEATHERS, WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import cushion, extruded, swept, turned
from sailenv_content.families.upholstery import pad
from sailenv_content.procedural.forms import circle, rectangle

__all__ = ["FAMILY"]


def _bar(b: PieceBuilder, v: Values) -> None:
    """Make a tall stool with a ring for the feet, a low back for some."""
    r, h = v.seat / 2, v.height
    seat = rectangle(v.seat, v.seat, 0.06) if v.square else circle(32) * r
    b.form(
        v.material, extruded(seat, 0.032, bevel=0.01, tile_m=v.material.tile_m), (0, 0, h - 0.032)
    )
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(b, v.frame, v.leg, sx * r * 0.62, sy * r * 0.62, h - 0.03, 0.032, splay=0.07)
    reach = r * 0.62 + 0.07 * (1 - 0.28 / h)
    corners = [
        (reach, reach, 0.28),
        (reach, -reach, 0.28),
        (-reach, -reach, 0.28),
        (-reach, reach, 0.28),
    ]
    for first, last in zip(corners, [*corners[1:], corners[0]], strict=True):
        b.form(v.frame, swept([first, last], 0.009, sides=8))
    if v.pad is not None:
        pad(
            b,
            v.pad,
            (v.seat - 0.03, v.seat - 0.03, 0.04),
            (0.0, 0.0, h + 0.012),
            puff=0.012,
            radius=0.019,
        )
    if v.back:
        for sy in (-1.0, 1.0):
            b.form(
                v.frame,
                swept(
                    [(-r * 0.8, sy * r * 0.6, h - 0.02), (-r * 1.05, sy * r * 0.6, h + v.back)],
                    0.009,
                    sides=8,
                ),
            )
        b.box(
            v.material,
            (0.018, v.seat * 0.86, 0.09),
            (-r * 1.02, 0.0, h + v.back - 0.04),
            turn=(0, -12, 0),
            bevel=0.007,
        )


def _milking(b: PieceBuilder, v: Values) -> None:
    """Make a low round stool with three splayed legs."""
    r, h = v.seat / 2, v.low
    profile = [
        (0, 0),
        (r * 0.9, 0),
        (r, 0.012),
        (r, 0.026),
        (r * 0.94, 0.034),
        (r * 0.5, 0.029),
        (0, 0.027),
    ]
    b.form(v.material, turned(profile, segments=28, tile_m=v.material.tile_m), (0, 0, h - 0.034))
    for angle in np.arange(v.count) * 2 * np.pi / v.count + 0.4:
        leg(
            b,
            v.frame,
            "splayed",
            r * 0.55 * np.cos(angle),
            r * 0.55 * np.sin(angle),
            h - 0.02,
            0.036,
            splay=0.06,
        )


def _column(b: PieceBuilder, v: Values) -> None:
    """Make a round seat on a column and a plate, as at a counter."""
    r, h = v.seat / 2, v.height
    steel = v.metal
    b.form(
        steel,
        turned(
            [
                (0, 0),
                (0.2, 0),
                (0.2, 0.006),
                (0.05, 0.02),
                (0.03, 0.04),
                (0.028, h * 0.5),
                (0.02, h * 0.5),
                (0.02, h - 0.06),
                (0.09, h - 0.055),
                (0.09, h - 0.045),
                (0, h - 0.045),
            ],
            segments=28,
        ),
    )
    turns = np.linspace(-0.9, 0.9, 14)
    ring = np.stack([0.19 * np.cos(turns), 0.19 * np.sin(turns), np.full(14, 0.27)], -1)
    b.form(
        steel,
        swept(np.concatenate([[(0.02, -0.02, 0.27)], ring, [(0.02, 0.02, 0.27)]]), 0.008, sides=8),
        collides="none",
    )
    profile = [
        (0, 0),
        (r * 0.92, 0),
        (r, 0.02),
        (r, 0.05),
        (r * 0.93, 0.07),
        (r * 0.4, 0.076),
        (0, 0.076),
    ]
    b.form(v.cover, turned(profile, segments=30, tile_m=v.cover.tile_m), (0, 0, h - 0.05))


def _pouf(b: PieceBuilder, v: Values) -> None:
    """Make a soft drum or cube without legs."""
    r, h = v.seat * 0.62, v.low
    if v.square:
        pad(b, v.cover, (2 * r, 2 * r, h), (0, 0, h / 2), puff=0.0, radius=0.035)
        return
    rows = [(0, 0), (r * 0.9, 0), (r * 0.99, 0.03)]
    rows += [(r * (1 + 0.07 * np.sin(np.pi * t)), h * t) for t in np.linspace(0.12, 0.88, 8)]
    rows += [(r * 0.97, h - 0.025), (r * 0.85, h - 0.004), (0, h)]
    b.form(v.cover, turned(rows, segments=36, tile_m=v.cover.tile_m, crease_deg=60))
    for angle in np.arange(12) * np.pi / 6:
        line = [
            (
                r * (1.005 + 0.07 * np.sin(np.pi * t)) * np.cos(angle),
                r * (1.005 + 0.07 * np.sin(np.pi * t)) * np.sin(angle),
                h * t,
            )
            for t in np.linspace(0.06, 0.94, 8)
        ]
        b.form(v.cover, swept(line, 0.004, sides=6, tile_m=0.06), collides="none")


def _bench_stool(b: PieceBuilder, v: Values) -> None:
    """Make a rectangular footstool with a cushion on four legs."""
    w, d, h = v.seat * 1.5, v.seat * 1.1, v.low
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(b, v.frame, v.leg, sx * (d / 2 - 0.04), sy * (w / 2 - 0.04), h - 0.08, 0.036)
    b.box(v.frame, (d - 0.02, w - 0.02, 0.03), (0, 0, h - 0.085))
    b.form(
        v.cover,
        cushion((d, w, 0.08), radius=0.035, puff=0.018, tile_m=v.cover.tile_m),
        (0, 0, h - 0.035),
    )


_SHARED = {
    "seat": Span(0.32, 0.38),
    "height": Span(0.63, 0.78),
    "low": Span(0.4, 0.47),
    "material": Choice(*WOODS, paint("#2d3033")),
    "frame": Choice(*WOODS[:4], metal("#232326"), metal("brass"), metal("chrome")),
    "leg": Choice("round", "metal"),
    "square": Choice(True, False),
    "cover": Choice(*FABRICS, *LEATHERS),
    "count": Choice(3, 4),
    "pad": Choice(None, *FABRICS[:3], *LEATHERS[:2]),
    "back": Choice(0.0, 0.0, 0.16, 0.24),
    "metal": Choice(metal("chrome"), metal("#232326"), metal("brass")),
}

FAMILY = Family(
    name="stool",
    category="stool",
    least_m=(0.28, 0.28, 0.36),
    most_m=(0.7, 0.75, 1.1),
    styles={
        "bar": Style(_bar, _SHARED),
        "round": Style(_milking, _SHARED),
        "counter": Style(_column, _SHARED),
        "pouf": Style(_pouf, _SHARED),
        "foot": Style(_bench_stool, {**_SHARED, "leg": Choice("tapered", "turned", "metal")}),
    },
)
