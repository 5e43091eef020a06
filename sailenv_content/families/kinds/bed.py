"""Beds: slatted, upholstered, panelled, of iron, on a platform, with drawers, two above another."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.bedding import LINENS, bedding
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import CLEARANCE_M, drawer, front_panel
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import leg
from sailenv_content.families.materials import FABRICS, LEATHERS, WOODS, metal, paint, wood
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept, turned
from sailenv_content.families.upholstery import pad

__all__ = ["FAMILY"]

LENGTH_M = 2.0
POST_M = 0.06


def _made_up(b: PieceBuilder, v: Values, low: float, *, hang: float, width: float = 0.0) -> None:
    """Lay the bedding on what is at a height."""
    half = (width or v.width) / 2.0
    on = Box((-LENGTH_M / 2, -half, low), (LENGTH_M / 2, half, low))
    bedding(b, on, thick=v.mattress, cover=v.cover, pillow=v.pillow, throw=v.throw, hang=hang)


def _slats(b: PieceBuilder, v: Values, z: float) -> None:
    """Add the boards below the mattress, whose upper side is at a height."""
    for number in range(13):
        x = (number + 0.5) / 13 * LENGTH_M - LENGTH_M / 2
        b.box(wood("birch"), (0.07, v.width, 0.018), (x, 0.0, z - 0.009), collides=False)
    b.collide((LENGTH_M, v.width, 0.018), (0.0, 0.0, z - 0.009))


def _rails(b: PieceBuilder, v: Values, low: float, high: float, thick: float = 0.025) -> None:
    """Add the boards at both sides, from one height to another."""
    for sy in (-1.0, 1.0):
        at = (0.0, sy * (v.width + thick) / 2, (low + high) / 2)
        b.box(v.frame, (LENGTH_M, thick, high - low), at, bevel=0.004)


def _end(b: PieceBuilder, v: Values, sign: float, top: float, *, slatted: bool) -> None:
    """Add posts and what is between them at the head or the foot."""
    x = sign * (LENGTH_M + POST_M) / 2
    wide = v.width + 0.05
    for sy in (-1.0, 1.0):
        leg(b, v.frame, v.post, x, sy * (wide - POST_M) / 2, top, POST_M)
    inner, low = wide - 2 * POST_M, v.base - 0.06
    if top - low < 0.25:  # no more than a board
        b.box(
            v.frame, (0.026, inner, top - low - 0.02), (x, 0.0, (top + low) / 2 - 0.01), bevel=0.004
        )
        return
    if not slatted:
        panel = Box((x - 0.014, -inner / 2, low), (x + 0.014, inner / 2, top - 0.03))
        for column in panel.columns([1.0] * v.fields, 0.03):
            front_panel(b, v.frame, v.front, column)
        for before in panel.columns([1.0] * v.fields, 0.03)[1:]:
            y = float(before.low[1]) - 0.015
            b.box(v.frame, (0.034, 0.03, panel.size[2]), (x, y, panel.middle[2]))
        b.box(v.frame, (POST_M + 0.02, wide + 0.04, 0.03), (x, 0.0, top + 0.012), bevel=0.008)
        return
    for z in (top - 0.05, low + 0.04):
        b.box(v.frame, (0.026, inner, 0.07), (x, 0.0, z), bevel=0.004)
    count = max(3, round(inner / v.spacing))
    for number in range(count):
        y = (number + 0.5) / count * inner - inner / 2
        tall = top - low - 0.16
        b.box(v.frame, (0.018, v.slat, tall), (x, y, (top + low) / 2 - 0.005), collides=False)
    b.collide((0.02, inner, top - low), (x, 0.0, (top + low) / 2))


def _slatted(b: PieceBuilder, v: Values) -> None:
    """Make posts with upright slats between them."""
    _end(b, v, -1.0, v.head, slatted=True)
    _end(b, v, 1.0, v.base + v.foot, slatted=True)
    _rails(b, v, v.base - 0.1, v.base + 0.05)
    _slats(b, v, v.base)
    _made_up(b, v, v.base, hang=0.0 if v.foot > 0.2 else 0.05)


def _panelled(b: PieceBuilder, v: Values) -> None:
    """Make a head and a foot of frames and panels."""
    _end(b, v, -1.0, v.head, slatted=False)
    _end(b, v, 1.0, v.base + v.foot, slatted=False)
    _rails(b, v, v.base - 0.12, v.base + 0.06)
    _slats(b, v, v.base)
    _made_up(b, v, v.base, hang=0.0)


def _upholstered(b: PieceBuilder, v: Values) -> None:
    """Make a padded head and padded sides on short legs."""
    rim, low = 0.07, 0.09
    side = v.base + 0.06 - low
    for sy in (-1.0, 1.0):
        at = (0.0, sy * (v.width + rim) / 2, low + side / 2)
        pad(b, v.cloth, (LENGTH_M + rim, rim, side), at, puff=0.006, radius=0.025)
    at = (LENGTH_M / 2 + rim / 2, 0.0, low + side / 2)
    pad(b, v.cloth, (rim, v.width + 2 * rim, side), at, puff=0.006, radius=0.025)
    _slats(b, v, v.base)
    whole, x = v.width + 2 * rim + v.wing, -LENGTH_M / 2 - 0.05
    tall = v.head - low
    if v.tufts == 0:
        pad(b, v.cloth, (0.1, whole, tall), (x, 0.0, low + tall / 2), puff=0.025, radius=0.045)
    else:
        b.box(v.cloth, (0.05, whole, tall), (x - 0.02, 0.0, low + tall / 2), bevel=0.012)
        upper = Box((x, -whole / 2, v.base), (x + 0.05, whole / 2, v.head - 0.01))
        rows = upper.rows([1.0] * v.rows, 0.0)
        for row in rows:
            for field in row.columns([1.0] * v.tufts, 0.0):
                size = (0.07, float(field.size[1]) - 0.002, float(field.size[2]) - 0.002)
                at = (x + 0.02, float(field.middle[1]), float(field.middle[2]))
                pad(b, v.cloth, size, at, puff=0.014, radius=0.025, collides=False)
        b.collide((0.06, whole, upper.size[2]), (x + 0.025, 0.0, upper.middle[2]))
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            leg(
                b,
                v.feet,
                "tapered",
                sx * (LENGTH_M / 2 - 0.1),
                sy * (v.width / 2 - 0.08),
                low + 0.02,
                0.05,
            )
    _made_up(b, v, v.base, hang=0.06)


def _iron(b: PieceBuilder, v: Values) -> None:
    """Make a bed of tubes: bows at head and foot, with rods between."""
    w = v.width + 0.04
    for sign, top in ((-1.0, v.head), (1.0, v.base + v.foot + 0.1)):
        x = sign * (LENGTH_M / 2 + 0.02)
        turn = np.linspace(0.0, np.pi, 15)
        rise = v.arch * (0.22 if sign < 0 else 0.12)
        bow = [(x, -w / 2 * np.cos(t), top - rise + rise * np.sin(t)) for t in turn]
        path = [(x, -w / 2, 0.02), *bow, (x, w / 2, 0.02)]
        b.form(v.iron, swept(path, 0.014, sides=10), collides="none")
        b.collide((0.03, w, top - 0.2), (x, 0.0, 0.2 + (top - 0.2) / 2))
        lower = v.base + 0.02
        b.form(v.iron, swept([(x, -w / 2, lower), (x, w / 2, lower)], 0.011), collides="none")
        count = max(4, round(w / v.spacing))
        for number in range(1, count):
            y = number / count * w - w / 2
            high = top - rise + rise * float(np.sqrt(max(0.0, 1.0 - (2 * y / w) ** 2)))
            b.form(v.iron, swept([(x, y, lower), (x, y, high)], 0.006, sides=8), collides="none")
        knob = [(0, 0), (0.016, 0.004), (0.026, 0.022), (0.016, 0.042), (0, 0.046)]
        for sy in (-1.0, 1.0):
            at = (x, sy * w / 2, top - rise - 0.01 if rise else top)
            b.form(v.knob, turned(knob, segments=16), at, collides="none")
            foot = [(0, 0), (0.02, 0), (0.02, 0.025), (0, 0.025)]
            b.form(metal("#232326"), turned(foot, segments=14), (x, sy * w / 2, 0.0))
    for sy in (-1.0, 1.0):
        b.box(
            v.iron, (LENGTH_M + 0.03, 0.03, 0.05), (0.0, sy * (v.width / 2 + 0.01), v.base - 0.02)
        )
    _slats(b, v, v.base)
    _made_up(b, v, v.base, hang=0.14)


def _platform(b: PieceBuilder, v: Values) -> None:
    """Make a low platform that stands out all around, with a leaning head of boards."""
    out, t = v.out, 0.04
    size = (LENGTH_M + out, v.width + 2 * out, t)
    low = v.base - 0.08
    boards = Box(
        (-LENGTH_M / 2, -size[1] / 2, low - t), (-LENGTH_M / 2 + size[0], size[1] / 2, low)
    )
    for board in boards.columns([1.0] * max(6, round(size[1] / 0.19)), 0.0006):
        b.box(v.frame, board.size, board.middle, bevel=0.002, collides=False)
    b.collide(boards.size, boards.middle)
    for sign in (-1.0, 1.0):
        at = (sign * (LENGTH_M / 2 - 0.16), 0.0, (low - t) / 2)
        b.box(v.frame, (0.03, v.width - 0.2, low - t), at)
        at = (0.0, sign * (v.width / 2 - 0.115), (low - t) / 2)
        b.box(v.frame, (LENGTH_M - 0.35, 0.03, low - t), at)
    tall, x = v.head - low, -LENGTH_M / 2 - 0.06
    for number in range(v.planks):
        each = tall / v.planks
        at = (x - 0.12 * (number + 0.5) / v.planks, 0.0, low + (number + 0.5) * each)
        b.box(v.frame, (0.032, size[1], each - 0.012), at, turn=(0.0, -8.0, 0.0), bevel=0.006)
    for sy in (-1.0, 1.0):
        at = (x - 0.07, sy * v.width * 0.35, v.head / 2 - 0.04)
        b.box(v.frame, (0.03, 0.08, v.head - 0.08), at, turn=(0.0, -6.5, 0.0))
    _made_up(b, v, low, hang=0.1)


def _storage(b: PieceBuilder, v: Values) -> None:
    """Make a box with drawers at both sides, and a head with a shelf for some."""
    with b.frame((0.11 if v.shelf else 0.0, 0.0, 0.0)):
        _box(b, v)


def _box(b: PieceBuilder, v: Values) -> None:
    t, w = 0.022, v.width + 0.04
    high = v.base + 0.04
    foot, head = LENGTH_M / 2 + t / 2, -LENGTH_M / 2 - t / 2
    b.box(v.frame, (t, w, high), (foot, 0.0, high / 2), bevel=0.003)
    b.box(v.frame, (t, w, v.head), (head, 0.0, v.head / 2), bevel=0.003)
    b.box(v.frame, (LENGTH_M, t, v.base - 0.016), (0.0, 0.0, (v.base - 0.016) / 2), bevel=0.001)
    b.box(v.inner, (LENGTH_M, w - 2 * t, 0.016), (0.0, 0.0, v.base - 0.008))
    for sy in (-1.0, 1.0):
        at = (0.0, sy * (w - t) / 2, (v.base + high) / 2)
        b.box(v.frame, (LENGTH_M, t, high - v.base + 0.04), at, bevel=0.003)
        b.box(v.frame, (LENGTH_M, 0.02, 0.05), (0.0, sy * (w / 2 - 0.05), 0.025))
    fronts = Box((w / 2 - 0.019, -LENGTH_M / 2, 0.055), (w / 2, LENGTH_M / 2, v.base - 0.02))
    deep = min(0.65, w / 2 - 0.06)
    for yaw, side in ((90.0, "left"), (-90.0, "right")):
        with b.frame(yaw_deg=yaw):
            for number, panel in enumerate(
                fronts.inset(CLEARANCE_M).columns([1.0] * v.drawers, CLEARANCE_M)
            ):
                drawer(
                    b,
                    f"{side} drawer {number + 1}",
                    v.frame,
                    v.front,
                    panel,
                    deep,
                    inner=v.inner,
                    handle_kind=v.handle,
                    metal_=v.knob,
                )
    if v.shelf:
        x, deep = head - 0.12, 0.22
        for z in (v.head - 0.011, v.head - 0.32):
            b.box(v.frame, (deep, w, t), (x, 0.0, z))
        for sy in (-1.0, 0.0, 1.0):
            at = (x, sy * (w - t) / 2, v.head / 2 - 0.011)
            b.box(v.frame, (deep, t, v.head - 0.022), at)
        b.box(v.frame, (t, w, v.head), (x - deep / 2 - t / 2, 0.0, v.head / 2))
    _made_up(b, v, v.base, hang=0.03)


def _bunk(b: PieceBuilder, v: Values) -> None:
    """Make two beds one above the other, with a ladder and a guard rail."""
    w, upper, top = 0.9 + 0.05, 1.35, 1.68
    v = Values({**v.all, "width": 0.9, "base": 0.32, "throw": None})
    for sx in (-1.0, 1.0):
        x = sx * (LENGTH_M + POST_M) / 2
        for sy in (-1.0, 1.0):
            b.box(v.frame, (POST_M, POST_M, top), (x, sy * (w - POST_M) / 2, top / 2), bevel=0.004)
        for z in (0.30, 0.62, upper - 0.03, upper + 0.13, top - 0.05):
            b.box(v.frame, (0.024, w - 2 * POST_M, 0.09), (x, 0.0, z), bevel=0.004)
    for z in (v.base, upper):
        _rails(b, v, z - 0.08, z + 0.06)
        _slats(b, v, z)
        _made_up(b, v, z, hang=0.0)
    ladder = LENGTH_M / 2 - 0.45
    for z in (upper + 0.16, top - 0.05):
        b.box(v.frame, (LENGTH_M, 0.024, 0.07), (0.0, -w / 2 + 0.012, z), bevel=0.004)
        at = (-0.25, w / 2 - 0.012, z)
        b.box(v.frame, (LENGTH_M - 0.5, 0.024, 0.07), at, bevel=0.004)
    for sx in (-1.0, 1.0):
        at = (ladder + sx * 0.2, w / 2 + 0.035, (top - 0.02) / 2)
        b.box(v.frame, (0.032, 0.055, top - 0.02), at, bevel=0.004)
    for z in np.arange(0.28, upper + 0.1, 0.26):
        b.box(v.frame, (0.37, 0.05, 0.028), (ladder, w / 2 + 0.035, float(z)), bevel=0.006)


_COLOURS = tuple(paint(c) for c in ("#e9e6df", "#33373b", "#8c9a86", "#54616b"))
_SHARED = {
    "width": Choice(0.9, 1.4, 1.6, 1.6, 1.8),
    "base": Span(0.27, 0.34),
    "mattress": Span(0.17, 0.23),
    "head": Span(0.85, 1.1),
    "foot": Choice(0.04, 0.06, 0.3),
    "frame": Choice(*WOODS, *_COLOURS),
    "cover": Choice(*LINENS),
    "pillow": Choice(*LINENS[:4]),
    "throw": Choice(None, None, *FABRICS[:6]),
    "post": Choice("block", "square", "turned"),
    "knob": Choice(metal("brass"), metal("#232326"), metal("steel")),
}

FAMILY = Family(
    name="bed",
    category="bed",
    least_m=(1.95, 0.85, 0.4),
    most_m=(2.5, 2.4, 1.8),
    styles={
        "slatted": Style(
            _slatted, {**_SHARED, "slat": Span(0.03, 0.07), "spacing": Span(0.1, 0.14)}
        ),
        "panelled": Style(
            _panelled,
            {
                **_SHARED,
                "foot": Span(0.22, 0.34),
                "head": Span(0.95, 1.2),
                "fields": Choice(2, 3, 4),
                "front": Choice("shaker", "grooved", "flat"),
            },
        ),
        "upholstered": Style(
            _upholstered,
            {
                **_SHARED,
                "head": Span(0.95, 1.25),
                "cloth": Choice(*FABRICS, *LEATHERS),
                "wing": Choice(0.0, 0.0, 0.12),
                "tufts": Choice(0, 4, 6, 8),
                "rows": Choice(1, 1, 2),
                "feet": Choice(*WOODS[:3], metal("brass")),
            },
        ),
        "iron": Style(
            _iron,
            {
                **_SHARED,
                "iron": Choice(metal("#26272a"), metal("#e8e6e0"), metal("brass"), metal("bronze")),
                "arch": Choice(0.0, 1.0, 1.0),
                "spacing": Span(0.09, 0.15),
            },
        ),
        "platform": Style(
            _platform,
            {
                **_SHARED,
                "head": Span(0.65, 0.85),
                "out": Span(0.06, 0.18),
                "planks": Choice(1, 2, 3),
                "frame": Choice(*WOODS),
            },
        ),
        "drawers": Style(
            _storage,
            {
                **_SHARED,
                "width": Choice(1.4, 1.6, 1.8),
                "base": Span(0.34, 0.42),
                "drawers": Choice(2, 3),
                "front": Choice("flat", "shaker", "grooved"),
                "handle": Choice("cup", "knob", "none"),
                "shelf": Choice(True, False),
                "inner": Choice(wood("birch"), paint("#e7e3da")),
            },
        ),
        "bunk": Style(_bunk, {**_SHARED, "mattress": Span(0.12, 0.15)}),
    },
)
