"""Sofas: boxy, rolled arms, on legs, tufted, corner; two to four seats."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.bedding import throw_over_arm
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.joinery import four_legs, leg
from sailenv_content.families.materials import FABRICS, LEATHERS, WOODS, metal
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import placed, turned
from sailenv_content.families.upholstery import loose_cushions, pad, seat, width_of

__all__ = ["FAMILY", "boxy", "rolled"]


def boxy(b: PieceBuilder, v: Values) -> None:
    """Make arms that are blocks."""
    width, d = width_of(v), v.depth
    base = v.legs
    seat(b, v, width, d, base)
    _block_arms(b, v, width, d, -1.0)
    four_legs(b, v.frame, v.leg, d - 0.1, width - 0.12, base + 0.005, 0.045)
    loose_cushions(b, v, width, d)
    throw_over_arm(b, v, width)


def rolled(b: PieceBuilder, v: Values) -> None:
    """Make arms that end in a roll; a skirt or turned feet below."""
    width, d = width_of(v), v.depth
    base = v.legs
    seat(b, v, width, d, base)
    r = v.arm * 0.56
    for sy in (-1.0, 1.0):
        y = sy * (width - v.arm) / 2
        pad(
            b,
            v.cover,
            (d - 0.04, v.arm * 0.8, v.arm_height - r - base),
            (0.0, y, (v.arm_height - r + base) / 2),
            puff=0.0,
            radius=0.02,
        )
        bead = [
            (0.0, 0.0),
            (0.88 * r, 0.0),
            (r, 0.02),
            (r, d - 0.05),
            (0.88 * r, d - 0.03),
            (0.0, d - 0.03),
        ]
        roll = placed(turned(bead, segments=24, tile_m=v.cover.tile_m), (0, 0, 0), (0.0, 90.0, 0.0))
        b.form(v.cover, roll, (-d / 2 + 0.015, y + sy * 0.02, v.arm_height - r))
        face = [(0.0, 0.0), (0.35 * r, 0.0), (0.3 * r, 0.006), (0.0, 0.008)]
        b.form(
            v.frame,
            turned(face, segments=16),
            (d / 2 - 0.016, y + sy * 0.02, v.arm_height - r),
            turn=(0.0, 90.0, 0.0),
            collides="none",
        )
    if v.skirt:
        for sy in (-1.0, 1.0):
            b.box(
                v.cover,
                (d - 0.03, 0.008, base - 0.012),
                (0.0, sy * (width / 2 - 0.035), base / 2 + 0.008),
                collides=False,
            )
        b.box(
            v.cover,
            (0.008, width - 0.06, base - 0.012),
            (d / 2 - 0.02, 0.0, base / 2 + 0.008),
            collides=False,
        )
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(
                b, v.frame, "turned", sx * (d / 2 - 0.09), sy * (width / 2 - 0.1), base + 0.01, 0.05
            )
    loose_cushions(b, v, width, d)


def _on_legs(b: PieceBuilder, v: Values) -> None:
    """Make a frame of wood or metal that one sees, thin cushions on it."""
    width, d, t = width_of(v), v.depth, 0.04
    h = v.height - 0.13
    inner = width - 2 * v.arm
    for sx, tall in ((1.0, v.arm_height), (-1.0, v.arm_height)):
        for sy in (-1.0, 1.0):
            leg(
                b,
                v.frame,
                "round",
                sx * (d / 2 - 0.08),
                sy * (width / 2 - 0.03),
                tall - 0.02,
                t,
                splay=0.02,
            )
    for sy in (-1.0, 1.0):
        b.box(
            v.frame,
            (d - 0.04, 0.06, 0.025),
            (0.0, sy * (width / 2 - 0.03), v.arm_height - 0.01),
            bevel=0.01,
        )
        b.box(v.frame, (d - 0.14, 0.025, 0.06), (0.0, sy * (width / 2 - 0.03), h - 0.04))
    for x in (d / 2 - 0.08, -d / 2 + 0.12):
        b.box(v.frame, (0.03, width - 0.08, 0.06), (x, 0.0, h - 0.03))
    tilt = -14.0
    for y in np.linspace(-0.5, 0.5, 2 + 4 * v.seats) * (inner - 0.05):
        b.box(
            v.frame,
            (0.02, 0.03, v.back - h),
            (-d / 2 + 0.05, y, (v.back + h) / 2 - 0.03),
            turn=(0.0, tilt, 0.0),
            collides=False,
        )
    b.box(v.frame, (0.025, inner, 0.06), (-d / 2 - 0.02, 0.0, v.back - 0.06), turn=(0.0, tilt, 0.0))
    b.collide(
        (0.03, inner, v.back - h), (-d / 2 + 0.05, 0.0, (v.back + h) / 2 - 0.03), (0.0, tilt, 0.0)
    )
    each = inner / v.seats
    with b.part("seat cushions", "pillow"):
        for number in range(v.seats):
            y = -inner / 2 + (number + 0.5) * each
            pad(b, v.cover, (d - 0.16, each - 0.006, 0.13), (0.04, y, h + 0.065), puff=0.018)
    with b.part("back cushions", "pillow"):
        tall = v.back - v.height - 0.02
        for number in range(v.seats):
            y = -inner / 2 + (number + 0.5) * each
            pad(
                b,
                v.cover,
                (0.12, each - 0.01, tall),
                (-d / 2 + 0.14, y, v.height + tall / 2),
                puff=0.025,
                turn=(0.0, tilt, 0.0),
            )
    loose_cushions(b, v, width, d)


def _tufted(b: PieceBuilder, v: Values) -> None:
    """Back and arms of one height, with buttons in rows."""
    width, d = width_of(v), v.depth
    base, top = v.legs, v.arm_height + 0.1
    inner = width - 2 * v.arm
    x = -d / 2 + 0.1
    rows, columns = 3, 4 * v.seats
    pad(b, v.cover, (0.2, width, top - base), (x, 0.0, (top + base) / 2), puff=0.03, radius=0.08)
    for row in range(rows):
        for column in range(columns - row % 2):
            y = inner * ((column + 0.5 + 0.5 * (row % 2)) / columns - 0.5)
            z = v.height + 0.08 + row * (top - v.height - 0.12) / rows
            button = [(0.0, 0.0), (0.014, 0.0), (0.01, 0.006), (0.0, 0.009)]
            b.form(
                v.cover,
                turned(button, segments=10, tile_m=v.cover.tile_m),
                (x + 0.118, y, z),
                turn=(0.0, 90.0, 0.0),
                collides="none",
            )
    for sy in (-1.0, 1.0):
        y = sy * (width - v.arm) / 2
        pad(
            b,
            v.cover,
            (d - 0.02, v.arm, top - base - 0.02),
            (0.01, y, (top + base) / 2 - 0.01),
            puff=0.02,
            radius=0.075,
        )
    pad(
        b,
        v.cover,
        (d - 0.05, inner, v.height - base - 0.12),
        (0.02, 0.0, (v.height - 0.12 + base) / 2),
        puff=0.0,
        radius=0.03,
    )
    with b.part("seat cushion", "pillow"):
        pad(b, v.cover, (d - 0.21, inner - 0.006, 0.13), (0.1, 0.0, v.height - 0.06), puff=0.02)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(
                b,
                v.frame,
                "turned",
                sx * (d / 2 - 0.08),
                sy * (width / 2 - 0.08),
                base + 0.02,
                0.055,
            )
    loose_cushions(b, v, width, d)


def _corner(b: PieceBuilder, v: Values) -> None:
    """Make a boxy sofa with a long seat at one end."""
    width, d = width_of(v), v.depth
    base, long = v.legs, v.chaise
    side = v.side
    _boxy_without_arm(b, v, width, d, side)
    each = v.seat
    y = side * (width / 2 - each / 2 - 0.002)
    x = d / 2 + (long - d) / 2
    pad(b, v.cover, (long - d, each - 0.004, 0.16), (x, y, base + 0.08), puff=0.0, radius=0.02)
    with b.part("seat cushions", "pillow"):
        at = (x - 0.012, y, base + 0.16 + (v.height - base - 0.16) / 2)
        pad(b, v.cover, (long - d - 0.01, each - 0.006, v.height - base - 0.16), at, puff=0.018)
    for sy in (-1.0, 1.0):
        leg(
            b,
            v.frame,
            v.leg,
            d / 2 + long - d - 0.08,
            y + sy * (each / 2 - 0.07),
            base + 0.005,
            0.045,
        )
    loose_cushions(b, v, width, d)


def _block_arms(b: PieceBuilder, v: Values, width: float, d: float, first: float) -> None:
    """Add arms that are blocks, the one at that side (1 or -1) first."""
    for side in (first, -first):
        y = side * (width - v.arm) / 2
        size = (d, v.arm - 0.004, v.arm_height - v.legs)
        middle = (0.0, y, (v.arm_height + v.legs) / 2)
        pad(b, v.cover, size, middle, puff=0.006, radius=v.edge)


def _boxy_without_arm(b: PieceBuilder, v: Values, width: float, d: float, side: float) -> None:
    base = v.legs
    seat(b, v, width, d, base)
    _block_arms(b, v, width, d, -side)
    four_legs(b, v.frame, v.leg, d - 0.1, width - 0.12, base + 0.005, 0.045)


_COVERS = Choice(*FABRICS, *FABRICS, *LEATHERS)
_FRAMES = Choice(*WOODS, metal("#232326"))
_SHARED = {
    "seats": Whole(2, 4),
    "seat": Span(0.58, 0.68),
    "depth": Span(0.82, 0.95),
    "height": Span(0.42, 0.47),
    "back": Span(0.74, 0.88),
    "arm_height": Span(0.54, 0.66),
    "loose": Span(0.0, 0.9),
    "soft": Choice(0.0, 0.5),
    "cover": _COVERS,
    "frame": _FRAMES,
}

FAMILY = Family(
    name="sofa",
    category="couch",
    least_m=(0.7, 1.2, 0.6),
    most_m=(1.9, 3.4, 1.05),
    styles={
        "boxy": Style(
            boxy,
            {
                **_SHARED,
                "arm": Span(0.12, 0.24),
                "legs": Span(0.05, 0.14),
                "edge": Span(0.03, 0.07),
                "leg": Choice("block", "round", "metal"),
                "throw": Choice(None, None, *FABRICS[:3]),
            },
        ),
        "rolled": Style(
            rolled,
            {
                **_SHARED,
                "arm": Span(0.18, 0.24),
                "legs": Span(0.08, 0.13),
                "skirt": Choice(True, False),
            },
        ),
        "framed": Style(
            _on_legs,
            {**_SHARED, "arm": Span(0.07, 0.09), "seats": Whole(2, 3), "frame": Choice(*WOODS)},
        ),
        "tufted": Style(
            _tufted,
            {**_SHARED, "arm": Span(0.17, 0.22), "legs": Span(0.08, 0.12), "seats": Whole(2, 3)},
        ),
        "corner": Style(
            _corner,
            {
                **_SHARED,
                "arm": Span(0.14, 0.22),
                "legs": Span(0.05, 0.12),
                "edge": Span(0.03, 0.07),
                "leg": Choice("block", "metal"),
                "chaise": Span(1.45, 1.65),
                "side": Choice(-1.0, 1.0),
            },
        ),
    },
)
