"""Radiators: of columns, flat panels, a ladder for towels, upright tubes, low along a wall."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hardware import clicks
from sailenv_content.families.lathe import smooth_profile
from sailenv_content.families.materials import fabric, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import cushion, swept, turned
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _valve(b: PieceBuilder, v: Values, x: float, y: float, z: float) -> None:
    """Add a valve with a knob that turns, and the pipe to it."""
    side = float(np.sign(y))
    pipe = [(x, y + side * 0.05, 0.0), (x, y + side * 0.05, z)]
    b.form(metal("chrome"), swept(pipe, 0.008, sides=10), collides="none")
    body = [(x, y - side * 0.01, z), (x, y + side * 0.055, z)]
    b.form(metal("chrome"), swept(body, 0.013, sides=12), collides="none")
    if not v.valve:
        return
    at = (x, y + side * 0.058, z)
    turn = (-90.0 * side, 0.0, 0.0)
    rows = [(0, 0), (0.02, 0), (0.024, 0.01), (0.023, 0.055), (0.018, 0.062), (0, 0.062)]
    with b.hinge(
        "valve",
        "handle",
        at=at,
        axis=(0.0, side, 0.0),
        opens_deg=270.0,
        friction=0.1,
        detents=clicks(0.15, 45.0),
    ):
        b.form(paint("#eceae5", 0.4), turned(rows, segments=18), at, turn=turn)


def _columns(b: PieceBuilder, v: Values) -> None:
    """Make cast sections side by side, each of two or three columns."""
    h, each, d = v.height, v.section, v.deep
    w = v.count * each
    rows = smooth_profile(
        np.array([(0.6, 0.0), (1.0, 0.06), (0.72, 0.14), (0.68, 0.86), (1.0, 0.94), (0.6, 1.0)])
        * (0.42 * each, h - 0.1),
        18,
    )
    column = turned([(0, 0), *rows, (0, h - 0.1)], segments=12)
    places = np.linspace(-d / 2 + 0.4 * each, d / 2 - 0.4 * each, v.columns)
    for number in range(v.count):
        y = (number + 0.5) * each - w / 2
        for x in places:
            b.form(v.coat, column, (float(x), y, 0.08), collides="none")
        for z in (0.13, h - 0.07):
            b.box(
                v.coat, (d - 0.4 * each, 0.5 * each, 0.06), (0.0, y, z), bevel=0.012, collides=False
            )
        if number in (0, v.count - 1):
            for x in (places[0], places[-1]):
                b.box(v.coat, (0.03, 0.03, 0.1), (float(x), y, 0.05), bevel=0.008)
    for z in (0.13, h - 0.07):
        b.form(v.coat, swept([(0, -w / 2, z), (0, w / 2, z)], 0.016, sides=12), collides="none")
    b.collide((d, w, h - 0.06), (0.0, 0.0, (h + 0.06) / 2))
    _valve(b, v, 0.0, v.side * w / 2, 0.13)


def _panel(b: PieceBuilder, v: Values) -> None:
    """Make one or two plates with upright ridges, a grille on top."""
    h, w, low = v.height, v.width, 0.1
    tall = h - low
    for sx in (-1.0, 1.0):
        b.box(
            v.coat,
            (0.012, w, tall - 0.02),
            (sx * (v.thick / 2 - 0.008), 0.0, low + tall / 2),
            bevel=0.004,
        )
        if v.ridged:
            count = round(w / 0.034)
            for number in range(count):
                y = (number + 0.5) / count * (w - 0.05) - (w - 0.05) / 2
                at = (sx * (v.thick / 2 - 0.002), y, low + tall / 2)
                b.box(v.coat, (0.01, 0.018, tall - 0.09), at, bevel=0.005, collides=False)
    for sy in (-1.0, 1.0):
        b.box(
            v.coat, (v.thick, 0.006, tall), (0.0, sy * (w / 2 + 0.003), low + tall / 2), bevel=0.001
        )
        b.box(
            v.coat, (0.03, 0.02, low + 0.05), (-v.thick / 2 - 0.015, sy * 0.3 * w, (low + 0.05) / 2)
        )
    for number in range(round(w / 0.03)):
        y = (number + 0.5) * 0.03 - w / 2
        b.box(
            v.coat, (v.thick - 0.02, 0.014, 0.006), (0.0, y, h - 0.004), bevel=0.001, collides=False
        )
    for sx in (-1.0, 1.0):
        b.box(v.coat, (0.01, w, 0.012), (sx * (v.thick / 2 - 0.005), 0.0, h - 0.006), bevel=0.002)
    _valve(b, v, 0.0, v.side * (w / 2 + 0.006), low + 0.06)


def _ladder(b: PieceBuilder, v: Values) -> None:
    """Make rungs in groups between two uprights, with a towel over one for some."""
    h, w = v.tall, v.narrow
    for sy in (-1.0, 1.0):
        y = sy * w / 2
        b.form(v.coat, swept([(0, y, 0.06), (0, y, h)], 0.017, sides=14))
        for z in (0.3, h - 0.12):
            arm = [(-0.07, y, z), (0, y, z)]
            b.form(v.coat, swept(arm, 0.009, sides=8), collides="none")
    z, free = 0.1, []
    for _group in range(v.groups):
        for number in range(v.rungs):
            bend = v.bow * np.sin(np.linspace(0, np.pi, 11))
            path = np.stack([bend, np.linspace(-w / 2, w / 2, 11), np.full(11, z)], -1)
            b.form(v.coat, swept(path, 0.011, sides=10), collides="none")
            if number == v.rungs - 1:
                free.append(z)
            z += (h - 0.25 - 0.08 * v.groups) / (v.groups * v.rungs)
        z += 0.08
    b.collide((0.03, w, h - 0.1), (v.bow / 2, 0.0, h / 2))
    if v.towel is not None:
        top = float(free[v.groups // 2])
        with b.part("towel", "towel"):
            long = min(0.4, top - 0.08)
            for sx, share in ((1.0, 1.0), (-1.0, 0.7)):
                mesh = cushion((0.012, 0.62 * w, long * share), radius=0.005, puff=0.002, steps=5)
                at = (v.bow + sx * 0.019, 0.0, top - long * share / 2 + 0.012)
                b.form(v.towel, mesh, at, collides="none")
            over = cushion((0.05, 0.62 * w, 0.014), radius=0.006, puff=0.002, steps=5)
            b.form(v.towel, over, (v.bow, 0.0, top + 0.017), collides="none")
    _valve(b, v, 0.0, v.side * w / 2, 0.08)


def _tubes(b: PieceBuilder, v: Values) -> None:
    """Make upright flat or round tubes side by side, as high as a door."""
    h, each = v.tall, v.pitch
    w = v.count * each
    for number in range(v.count):
        y = (number + 0.5) * each - w / 2
        if v.flat:
            b.box(
                v.coat,
                (0.016, each - 0.008, h - 0.04),
                (0.024, y, h / 2 + 0.02),
                bevel=0.005,
                collides=False,
            )
        else:
            tube = [(0.024, y, 0.04), (0.024, y, h)]
            b.form(v.coat, swept(tube, 0.38 * each, sides=12), collides="none")
    for z in (0.14, h - 0.1):
        b.box(v.coat, (0.026, w, 0.035), (0.0, 0.0, z), bevel=0.006)
        for sy in (-1.0, 1.0):
            b.box(v.coat, (0.04, 0.02, 0.02), (-0.03, sy * 0.3 * w, z))
    b.collide((0.03, w, h - 0.04), (0.024, 0.0, h / 2 + 0.02))
    _valve(b, v, 0.0, v.side * w / 2, 0.14)


def _low(b: PieceBuilder, v: Values) -> None:
    """Make long tubes one above the other between short feet."""
    w = v.width * 1.3
    for level in range(v.levels):
        z = 0.09 + 0.075 * level
        for x in (-0.045, 0.045):
            path = curve([(x, -w / 2, z), (x, 0, z), (x, w / 2, z)], 3)
            b.form(v.coat, swept(path, 0.028, sides=16))
    top = 0.09 + 0.075 * (v.levels - 1)
    for sy in (-1.0, 0.0, 1.0):
        y = sy * (w / 2 - 0.04)
        b.box(v.coat, (0.15, 0.05, top), (0.0, y, top / 2 + 0.03), bevel=0.012)
        b.box(v.coat, (0.1, 0.03, 0.05), (0.0, y, 0.025), bevel=0.006)
    _valve(b, v, 0.0, v.side * w / 2, 0.09)


_WHITE = paint("#eeece7", 0.35, 2500.0)
_COATS = Choice(
    _WHITE, _WHITE, *(paint(c, 0.4, 2500.0) for c in ("#2b2d30", "#8c9a86", "#7c2a2a", "#5c6166"))
)
_SHARED = {
    "height": Span(0.5, 0.8),
    "width": Span(0.6, 1.2),
    "side": Choice(-1.0, 1.0),
    "valve": Choice(True, True, False),
    "coat": _COATS,
}

FAMILY = Family(
    name="radiator",
    category="radiator",
    least_m=(0.05, 0.25, 0.2),
    most_m=(0.3, 1.9, 2.1),
    styles={
        "columns": Style(
            _columns,
            {
                **_SHARED,
                "section": Span(0.045, 0.06),
                "deep": Span(0.12, 0.2),
                "count": Whole(8, 18),
                "columns": Whole(2, 3),
            },
        ),
        "panel": Style(
            _panel,
            {**_SHARED, "thick": Span(0.07, 0.12), "ridged": Choice(True, False), "coat": _WHITE},
        ),
        "ladder": Style(
            _ladder,
            {
                **_SHARED,
                "tall": Span(1.1, 1.7),
                "narrow": Span(0.45, 0.6),
                "groups": Whole(3, 4),
                "rungs": Whole(4, 6),
                "bow": Choice(0.0, 0.04),
                "coat": Choice(_WHITE, metal("chrome"), metal("#26272a")),
                "towel": Choice(None, fabric("#c9d2d6"), fabric("#a8715c"), fabric("#e9e5dc")),
            },
        ),
        "tubes": Style(
            _tubes,
            {
                **_SHARED,
                "tall": Span(1.6, 1.9),
                "pitch": Span(0.045, 0.075),
                "count": Whole(6, 10),
                "flat": Choice(True, False),
            },
        ),
        "low": Style(_low, {**_SHARED, "levels": Whole(3, 4)}),
    },
)
