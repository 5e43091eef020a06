"""Curtains: on rings, on eyelets, before a net, panels that slide, for cafés, tied at the sides."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder, Unfit
from sailenv_content.families.draping import hanging, hoop, rod, straight
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import (
    FABRICS,
    WOODS,
    PieceMaterial,
    fabric,
    metal,
    paint,
    veil,
)
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import swept

__all__ = ["FAMILY"]

OUT_M = 0.098
"""Of what hangs, from the wall [m]: sill boards are nearer to it."""

SIDES = (("right curtain", -1.0), ("left curtain", 1.0))


def _hang(b: PieceBuilder, v: Values, high: float, middle: float, width: float, folds: int) -> None:
    """Hang a sheet down to the floor."""
    mesh = hanging(
        straight(0.0, high, middle, width, 13), folds=folds, depth=v.deep, top_depth=0.014,
        phase=b.between(0.0, 6.0), wander=v.wander, tile_m=v.cloth.tile_m,
    )  # fmt: skip
    b.form(v.cloth, mesh, (OUT_M, 0.0, 0.0), collides="none")
    b.collide((2.0 * v.deep, width, high - 0.05), (OUT_M, middle, (high - 0.05) / 2))


def _halves(v: Values, width: float) -> list[tuple[float, float]]:
    """Return the middles and the width of both halves where they are drawn to."""
    wide = v.drawn * width / 2.0
    if wide < 0.18:
        raise Unfit("a curtain as narrow as a rope")
    return [(sign * (width - wide) / 2.0, wide) for _, sign in SIDES]


def _rings(b: PieceBuilder, v: Values) -> None:
    """Hang two halves by rings from a rod; both slide along it."""
    w, h = v.width, v.drop
    rod(b, v.rail, w + 0.12, OUT_M, h, radius=v.rod, ends=v.ends)
    high = h - v.rod - 0.035
    for (name, sign), (middle, wide) in zip(SIDES, _halves(v, w), strict=True):
        folds = max(3, round(wide / 0.075))
        with b.slide(name, "curtain", by=w / 2 - wide, axis=(0.0, -sign, 0.0), friction=3.0):
            _hang(b, v, high, middle, wide, folds)
            ring = hoop(v.rod + 0.009, 0.003)
            for number in range(folds):
                y = middle + wide * ((number + 0.5) / folds - 0.5)
                b.form(v.rail, ring, (OUT_M, y, h - 0.006), collides="none")
                clip = (0.004, 0.006, 0.024)
                b.box(v.rail, clip, (OUT_M, y, high + 0.008), bevel=0.001, collides=False)


def _eyelets(b: PieceBuilder, v: Values) -> None:
    """Thread two halves on a rod by eyelets, in even waves."""
    w, h = v.width, v.drop
    rod(b, v.rail, w + 0.12, OUT_M, h, radius=v.rod, ends=v.ends)
    for (name, sign), (middle, wide) in zip(SIDES, _halves(v, w), strict=True):
        folds = max(2, round(wide / 0.115))
        with b.slide(name, "curtain", by=w / 2 - wide, axis=(0.0, -sign, 0.0), friction=3.0):
            mesh = hanging(
                straight(0.0, h + 0.045, middle, wide, 13), folds=folds, depth=v.deep,
                top_depth=0.9 * v.deep, wander=0.12, tile_m=v.cloth.tile_m,
            )  # fmt: skip
            b.form(v.cloth, mesh, (OUT_M, 0.0, 0.0), collides="none")
            b.collide((2 * v.deep, wide, h - 0.06), (OUT_M, middle, (h - 0.06) / 2))
            ring = hoop(v.rod + 0.008, 0.0035)
            for number in range(2 * folds):
                y = middle + wide * ((number + 0.5) / (2 * folds) - 0.5)
                turn = (0.0, 0.0, 62.0 if number % 2 else -62.0)
                b.form(v.rail, ring, (OUT_M, y, h), turn=turn, collides="none")


def _net(b: PieceBuilder, v: Values) -> None:
    """Hang two heavy halves before a net that stays drawn, both from one rail."""
    w, h = v.width, v.drop
    b.box(v.rail, (0.075, w + 0.04, 0.028), (0.0825, 0.0, h - 0.014), bevel=0.004)
    for sign in (-1.0, 1.0):
        arm = (0.05, 0.02, 0.02)
        b.box(v.rail, arm, (0.025, sign * 0.42 * w, h - 0.012), bevel=0.003, collides=False)
    with b.part("net", "curtain"):
        folds = round(w / 0.085)
        net = hanging(
            straight(0.012, h - 0.03, 0.0, w - 0.03, 9), folds=folds, depth=0.012,
            top_depth=0.01, phase=b.between(0, 6), thick=0.001,
        )  # fmt: skip
        b.form(v.veil, net, (0.066, 0.0, 0.0), collides="none", volume=2e-5)
    for (name, sign), (middle, wide) in zip(SIDES, _halves(v, w), strict=True):
        folds = max(3, round(wide / 0.07))
        with b.slide(name, "curtain", by=w / 2 - wide, axis=(0.0, -sign, 0.0), friction=3.0):
            mesh = hanging(
                straight(0.0, h - 0.03, middle, wide, 13), folds=folds, depth=0.026,
                top_depth=0.014, phase=b.between(0, 6), wander=v.wander, tile_m=v.cloth.tile_m,
            )  # fmt: skip
            b.form(v.cloth, mesh, (0.112, 0.0, 0.0), collides="none")
            b.collide((0.052, wide, h - 0.05), (0.112, middle, (h - 0.05) / 2))


def _panels(b: PieceBuilder, v: Values) -> None:
    """Hang flat panels on tracks of their own, the outer ones of which stay."""
    w, h, count = v.width, v.drop, v.panels
    half = count // 2
    wide = w / count + 0.025
    deep = 0.02 * half + 0.012
    b.box(v.rail, (deep, w + 0.02, 0.026), (0.06 + deep / 2, 0.0, h - 0.013), bevel=0.003)
    for sign in (-1.0, 1.0):
        arm = (0.06, 0.02, 0.016)
        b.box(v.rail, arm, (0.03, sign * 0.42 * w, h - 0.01), bevel=0.003, collides=False)
        side = "left" if sign > 0 else "right"
        for number in range(half):
            x = 0.06 + 0.016 + 0.02 * number
            at = sign * (w / 2 - wide / 2)
            cloth = v.cloth if (number + v.second_first) % 2 else v.second
            by = number * (wide - 0.05) if number else 0.0
            if number == half - 1 and half > 1:
                by = min(by, w / 2 - wide)
            if not number:
                with b.part(f"{side} panel", "curtain"):
                    _panel(b, v, cloth, x, at, wide, h)
                continue
            axis = (0.0, -sign, 0.0)
            with b.slide(f"{side} panel {number + 1}", "curtain", by=by, axis=axis):
                _panel(b, v, cloth, x, at, wide, h)


def _panel(
    b: PieceBuilder, v: Values, cloth: PieceMaterial, x: float, y: float, wide: float, h: float
) -> None:
    size = (0.003, wide, h - 0.07)
    b.box(cloth, size, (x, y, (h - 0.07) / 2 + 0.02), bevel=0.001)
    for z in (0.022, h - 0.045):
        b.box(v.rail, (0.008, wide, 0.03), (x, y, z), bevel=0.002, collides=False)


def _cafe(b: PieceBuilder, v: Values) -> None:
    """Hang two short halves from a rod at half height, and a frill above."""
    w, h = v.width, v.drop
    middle_z = 0.52 * h
    for z in (middle_z, h - 0.03):
        rod(b, v.rail, w, OUT_M - 0.01, z, radius=0.007, ends="cap")
    for name, sign in SIDES:
        wide = (0.5 * v.drawn + 0.28) * w / 2
        at = sign * (w / 2 - 0.06 - wide / 2)
        by = max(0.03, w / 2 - 0.06 - wide)
        with b.slide(name, "curtain", by=by, axis=(0.0, -sign, 0.0), friction=2.0):
            folds = max(3, round(wide / 0.06))
            mesh = hanging(
                straight(0.0, middle_z + 0.022, at, wide), folds=folds, depth=0.02,
                top_depth=0.012, phase=b.between(0, 6), tile_m=v.cloth.tile_m,
            )  # fmt: skip
            b.form(v.cloth, mesh, (OUT_M - 0.01, 0.0, 0.0), collides="none")
            b.collide((0.036, wide, middle_z - 0.04), (OUT_M - 0.01, at, (middle_z - 0.04) / 2))
    with b.part("frill", "curtain"):
        frill = hanging(
            straight(0.8 * h, h, 0.0, w - 0.06), folds=round(w / 0.055), depth=0.019,
            top_depth=0.011, phase=1.0, tile_m=v.cloth.tile_m,
        )  # fmt: skip
        b.form(v.second, frill, (OUT_M - 0.01, 0.0, 0.0), collides="none")


def _tied(b: PieceBuilder, v: Values) -> None:
    """Tie two halves to the sides, below a pelmet."""
    w, h = v.width, v.drop
    tall, deep = v.pelmet, 0.142
    b.box(v.board, (0.016, w + 0.1, tall), (deep - 0.008, 0.0, h - tall / 2), bevel=0.004)
    b.box(v.board, (deep - 0.016, w + 0.1, 0.016), ((deep - 0.016) / 2, 0.0, h - 0.008))
    for sign in (-1.0, 1.0):
        at = (deep / 2 - 0.008, sign * (w / 2 + 0.042), h - tall / 2)
        b.box(v.board, (deep - 0.016, 0.016, tall), at, bevel=0.003)
    tie_z, top = 0.42 * h, h - 0.03
    full, waist, foot = 0.46 * w, 0.15, 0.3
    z = np.concatenate([np.linspace(0.0, tie_z, 7), np.linspace(tie_z, top, 14)[1:]])
    below = np.interp(z, [0.0, 0.75 * tie_z, tie_z], [foot, 0.8 * foot, waist])
    rise = np.clip((z - tie_z) / (top - tie_z), 0.0, 1.0)
    widths = np.where(z <= tie_z, below, waist + (full - waist) * rise**1.7)
    for name, sign in SIDES:
        with b.part(name, "curtain"):
            outer = w / 2 - 0.02
            middles = sign * (outer - widths / 2)
            rows = np.stack([z, middles, widths], axis=-1)
            cloth = hanging(
                rows, folds=7, depth=0.03, top_depth=0.024, phase=b.between(0, 6),
                wander=0.25, tile_m=v.cloth.tile_m,
            )  # fmt: skip
            b.form(v.cloth, cloth, (OUT_M - 0.004, 0.0, 0.0), collides="none")
            b.collide((0.06, foot, tie_z), (OUT_M - 0.004, sign * (outer - foot / 2), tie_z / 2))
        with b.part("tie", "curtain"):
            turns = np.linspace(0.0, 2.0 * np.pi, 15)
            at = sign * (outer - waist / 2)
            ring = np.stack(
                [
                    OUT_M - 0.004 + 0.037 * np.cos(turns),
                    at + (waist / 2 + 0.014) * np.sin(turns),
                    tie_z + 0.02 * np.sin(turns) * sign,
                ],
                axis=-1,
            )
            band = [ring + np.array([0.0, 0.0, up]) for up in (-0.012, 0.0, 0.012)]
            for one in band:
                b.form(v.second, swept(one, 0.008, sides=8), collides="none")


_RODS = (metal("#26272a"), metal("brass"), metal("steel"), metal("bronze"), *WOODS[:3])
_PALE = tuple(fabric(c) for c in ("#e4ded0", "#d5d8d6", "#cbbfa9", "#b9c3b4", "#d9c5b8"))
_SHARED = {
    "width": Span(1.9, 2.2),
    "drop": Span(2.15, 2.3),
    "drawn": Span(0.3, 0.42),
    "cloth": Choice(*FABRICS, *_PALE),
    "second": Choice(*FABRICS, *_PALE),
    "rail": Choice(*_RODS),
    "rod": Span(0.009, 0.015),
    "ends": Choice("ball", "cap", "spear", "disc"),
    "deep": Span(0.026, 0.034),
    "wander": Span(0.35, 0.6),
}

FAMILY = Family(
    name="curtain",
    category="curtain",
    least_m=(0.08, 1.0, 0.8),
    most_m=(0.2, 3.2, 2.8),
    styles={
        "rings": Style(_rings, _SHARED),
        "eyelets": Style(
            _eyelets, {**_SHARED, "deep": Span(0.036, 0.042), "rod": Span(0.012, 0.015)}
        ),
        "net": Style(
            _net,
            {
                **_SHARED,
                "rail": Choice(metal("#e6e4de"), metal("alu"), metal("#26272a")),
                "veil": Choice(veil("#f4f1ea", 0.45), veil("#e9e4d8", 0.5), veil("#f1efec", 0.4)),
            },
        ),
        "panels": Style(
            _panels,
            {
                **_SHARED,
                "panels": Choice(4, 6),
                "second_first": Whole(0, 1),
                "rail": Choice(metal("alu"), metal("#26272a"), metal("#e6e4de")),
            },
        ),
        "cafe": Style(
            _cafe,
            {
                **_SHARED,
                "width": Span(1.3, 1.5),
                "drop": Span(1.2, 1.35),
                "rail": Choice(metal("brass"), metal("#26272a"), metal("#e6e4de")),
            },
        ),
        "tied": Style(
            _tied,
            {
                **_SHARED,
                "pelmet": Span(0.14, 0.24),
                "board": Choice(*WOODS, paint("#e9e6df"), *FABRICS[:3]),
            },
        ),
    },
)
