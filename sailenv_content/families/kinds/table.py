"""Tables: dining, round, coffee, side, trestle."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.joinery import four_legs, leg
from sailenv_content.families.materials import WOODS, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import extruded, swept, turned
from sailenv_content.procedural.forms import circle, rectangle

__all__ = ["FAMILY"]


def _four(b: PieceBuilder, v: Values) -> None:
    """Make a rectangular top on four legs, with an apron below it."""
    d, w, h, t = v.depth, v.width, v.height, v.top
    if v.round:
        outline = rectangle(w, d, v.round)
        top = extruded(outline, t, bevel=0.006, tile_m=v.material.tile_m)
        b.form(v.material, top, (0.0, 0.0, h - t))
    else:
        boards = max(3, round(d / 0.16))
        each = d / boards
        for number in range(boards):
            x = -d / 2 + (number + 0.5) * each
            b.box(
                v.material, (each - 0.0006, w, t), (x, 0.0, h - t / 2), bevel=0.0015, collides=False
            )
        b.collide((d, w, t), (0.0, 0.0, h - t / 2))
    inset = 0.05
    four_legs(b, v.frame, v.leg, d - 2 * inset, w - 2 * inset, h - t, v.thick)
    if v.leg not in ("hairpin", "metal"):
        apron = 0.09 if h > 0.6 else 0.05
        for sx in (-1.0, 1.0):
            at = (sx * (d / 2 - inset - v.thick / 2), 0.0, h - t - apron / 2)
            b.box(v.frame, (0.02, w - 2 * inset - 2 * v.thick, apron), at)
        for sy in (-1.0, 1.0):
            at = (0.0, sy * (w / 2 - inset - v.thick / 2), h - t - apron / 2)
            b.box(v.frame, (d - 2 * inset - 2 * v.thick, 0.02, apron), at)


def _pedestal(b: PieceBuilder, v: Values) -> None:
    """Make a round or oval top on one foot."""
    h, t = v.height, v.top
    outline = circle(48) * (v.across / 2, v.across / 2 * v.oval)
    b.form(
        v.material, extruded(outline, t, bevel=0.008, tile_m=v.material.tile_m), (0.0, 0.0, h - t)
    )
    r = v.across * 0.26
    if v.trumpet:
        rows = [(0.0, 0.0), (r, 0.0), (r, 0.006)]
        rows += [
            (0.035 + (r - 0.035) * (1 - s) ** 3.2, 0.008 + s * (h - t - 0.1))
            for s in np.linspace(0.06, 1, 10)
        ]
        rows += [(0.09, h - t), (0.0, h - t)]
        b.form(v.foot, turned(rows, segments=32))
    else:
        b.form(
            v.foot,
            turned(
                [
                    (0, 0.05),
                    (0.05, 0.05),
                    (0.04, 0.12),
                    (0.05, h - t - 0.05),
                    (0.1, h - t),
                    (0, h - t),
                ],
                segments=24,
            ),
        )
        for angle in np.arange(4) * np.pi / 2 + np.pi / 4:
            tip = (r * 1.25 * np.cos(angle), r * 1.25 * np.sin(angle), 0.022)
            b.form(v.foot, swept([(0.0, 0.0, 0.1), tip], (0.034, 0.02), sides=12))


def _trestle(b: PieceBuilder, v: Values) -> None:
    """Make a thick top on two crossed or closed frames."""
    d, w, h, t = v.depth, v.width, v.height, v.top * 1.4
    b.box(v.material, (d, w, t), (0.0, 0.0, h - t / 2), bevel=0.005)
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - 0.22)
        rise, run = h - t, d - 0.16
        if v.crossed:
            tilt = float(np.degrees(np.arctan2(run, rise)))
            length = float(np.hypot(run, rise)) - 0.06
            for sign in (-1.0, 1.0):
                b.box(
                    v.frame,
                    (0.06, 0.05, length),
                    (0.0, y + sign * 0.026, rise / 2),
                    turn=(0.0, sign * tilt, 0.0),
                )
        else:
            for sx in (-1.0, 1.0):
                b.box(v.frame, (0.05, 0.08, rise), (sx * (run / 2), y, rise / 2))
            for z in (0.025, rise - 0.025):
                b.box(v.frame, (run - 0.05, 0.08, 0.05), (0.0, y, z))
    b.box(v.frame, (0.05, w - 0.5, 0.07), (0.0, 0.0, (h - t) / 2))


def _nested(b: PieceBuilder, v: Values) -> None:
    """Make a low table with a second one below it, or a shelf."""
    d, w, h = v.depth, v.width, v.height
    b.box(v.material, (d, w, v.top), (0.0, 0.0, h - v.top / 2), bevel=0.004)
    four_legs(b, v.frame, "square", d - 0.01, w - 0.01, h - v.top, 0.035)
    z = h * 0.3
    for number in range(7):
        x = (d - 0.1) * ((number + 0.5) / 7 - 0.5)
        b.box(v.material, ((d - 0.1) / 7 - 0.012, w - 0.03, 0.014), (x, 0.0, z))
    for sy in (-1.0, 1.0):
        b.box(v.frame, (d - 0.07, 0.02, 0.03), (0.0, sy * (w / 2 - 0.022), z - 0.022))


def _side(b: PieceBuilder, v: Values) -> None:
    """Make a small round table on three legs."""
    h, r = v.height, v.across / 2
    outline = circle(36) * r
    b.form(
        v.material,
        extruded(outline, v.top, bevel=0.005, tile_m=v.material.tile_m),
        (0.0, 0.0, h - v.top),
    )
    for angle in np.arange(3) * 2 * np.pi / 3 + 0.5:
        leg(
            b,
            v.frame,
            v.leg,
            r * 0.5 * np.cos(angle),
            r * 0.5 * np.sin(angle),
            h - v.top,
            0.034,
            splay=0.07,
        )


_TOPS = Choice(*WOODS, paint("#e9e6df", 0.3), paint("#2b2d30", 0.4))
_FRAMES = Choice(*WOODS, metal("#232326"), paint("#e9e6df"))
_DINING = {
    "depth": Span(0.8, 0.95),
    "width": Span(1.4, 2.2),
    "height": Span(0.73, 0.76),
    "top": Span(0.024, 0.036),
}

FAMILY = Family(
    name="table",
    category="dining table",
    least_m=(0.38, 0.38, 0.34),
    most_m=(1.4, 2.4, 0.8),
    styles={
        "dining": Style(
            _four,
            {
                **_DINING,
                "round": Choice(0.0, 0.0, 0.05, 0.3),
                "leg": Choice("square", "tapered", "turned", "hairpin"),
                "thick": Span(0.055, 0.075),
                "material": _TOPS,
                "frame": _FRAMES,
            },
        ),
        "pedestal": Style(
            _pedestal,
            {
                **_DINING,
                "across": Span(0.95, 1.35),
                "oval": Choice(1.0, 1.0, 1.4),
                "trumpet": Choice(True, False),
                "material": _TOPS,
                "foot": Choice(*WOODS, metal("#232326"), paint("#ece9e2")),
            },
        ),
        "trestle": Style(
            _trestle,
            {
                **_DINING,
                "crossed": Choice(True, False),
                "material": Choice(*WOODS),
                "frame": _FRAMES,
            },
        ),
        "coffee": Style(
            _four,
            {
                "depth": Span(0.5, 0.65),
                "width": Span(0.9, 1.25),
                "height": Span(0.38, 0.45),
                "top": Span(0.02, 0.032),
                "round": Choice(0.0, 0.04, 0.22),
                "leg": Choice("square", "tapered", "hairpin"),
                "thick": Span(0.035, 0.05),
                "material": _TOPS,
                "frame": _FRAMES,
            },
            "coffee table",
        ),
        "slatted": Style(
            _nested,
            {
                "depth": Span(0.5, 0.62),
                "width": Span(0.9, 1.2),
                "height": Span(0.38, 0.46),
                "top": Span(0.02, 0.03),
                "material": Choice(*WOODS),
                "frame": _FRAMES,
            },
            "coffee table",
        ),
        "side": Style(
            _side,
            {
                "across": Span(0.4, 0.55),
                "height": Span(0.45, 0.58),
                "top": Span(0.018, 0.028),
                "leg": Choice("splayed", "metal"),
                "material": _TOPS,
                "frame": _FRAMES,
            },
            "coffee table",
        ),
    },
)
