"""Bins: with a pedal, with a lid that swings, for paper, two side by side, on wheels."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hardware import LID_CLOSE, SPRING_CLOSE
from sailenv_content.families.hollows import vessel_walls
from sailenv_content.families.lathe import closed_ring, vessel
from sailenv_content.families.materials import metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.plumbing import tub
from sailenv_content.families.shaping import extruded, swept, turned
from sailenv_content.procedural.forms import rectangle

__all__ = ["FAMILY"]

BLACK = paint("#1d1e20", 0.5, 900.0)


def _pedal(b: PieceBuilder, v: Values) -> None:
    """Make a drum with a domed lid on a hinge, and a pedal."""
    r, h = v.radius, v.height
    ring = [(r + 0.004, 0.0), (r + 0.004, 0.03), (r, 0.032)]
    b.form(BLACK, turned([(0, 0), *ring, (0, 0.032)], segments=36))
    rows = [(r, 0.032), (r, h)]
    b.form(v.coat, vessel(rows, wall=0.004, floor=0.006, segments=40), collides="none")
    vessel_walls(b, rows, wall=0.004, floor=0.006, bands=1)
    z = h + 0.0035
    with b.hinge(
        "lid",
        "lid",
        at=(-r - 0.004, 0, z + 0.004),
        axis=(0, -1, 0),
        opens_deg=80.0,
        friction=0.2,
        damping=0.4,
        soft_close=LID_CLOSE,
    ):
        turn = np.linspace(0, np.pi / 2, 8)
        dome = [
            (0, z),
            (r, z),
            *[((r + 0.002) * np.cos(t), z + 0.012 + v.dome * np.sin(t)) for t in turn],
        ]
        dome[-1] = (0.0, dome[-1][1])
        b.form(v.lid, turned(dome, segments=40), volume=4e-4)
    b.box(BLACK, (0.03, 0.07, h), (-r - 0.012, 0.0, h / 2), bevel=0.006)
    with b.hinge(
        "pedal",
        "handle",
        at=(0.6 * r, 0, 0.02),
        axis=(0, 1, 0),
        opens_deg=8.0,
        friction=0.1,
        damping=0.2,
        soft_close=SPRING_CLOSE,
    ):
        b.box(v.metal, (0.06, 0.09, 0.008), (r + 0.045, 0.0, 0.025), bevel=0.003)


def _swing(b: PieceBuilder, v: Values) -> None:
    """Make a tall bin with a hood, in which a flap swings to both sides."""
    d, w, h = 0.3, 0.34, v.tall
    mesh = tub((d, w, h), wall=0.012, floor=0.01, radius=0.05, taper=0.03, slope=0.03)
    b.form(v.coat, mesh, collides="none", volume=0.002)
    b.collide((d - 0.06, w - 0.06, 0.01), (0.0, 0.0, 0.005))
    for sign in (-1.0, 1.0):
        b.collide((0.012, w - 0.03, h), (sign * (d / 2 - 0.02), 0.0, h / 2))
        b.collide((d - 0.03, 0.012, h), (0.0, sign * (w / 2 - 0.02), h / 2))
    z, rise = h + 0.003, 0.16
    for sy in (-1.0, 1.0):
        cheek = [(-d / 2, 0.0), (d / 2, 0.0), (0.06, rise), (-0.06, rise)]
        side = extruded(np.array(cheek), 0.02, bevel=0.004)
        b.form(v.lid, side, (0.0, sy * (w / 2 - 0.02) + 0.01, z), turn=(90, 0, 0))
    b.box(v.lid, (0.13, w - 0.03, 0.012), (0.0, 0.0, z + rise), bevel=0.004)
    back = float(np.degrees(np.arctan2(rise, d / 2 - 0.06)))
    b.box(
        v.lid,
        (0.012, w - 0.07, 0.17),
        (-d / 4 - 0.025, 0.0, z + rise / 2),
        turn=(0, 90 - back, 0),
        bevel=0.003,
    )
    lean = 90 - back
    at = (0.067, 0.0, z + rise - 0.012)
    with b.hinge(
        "flap",
        "lid",
        at=at,
        axis=(0, 1, 0),
        opens_deg=38.0,
        friction=0.02,
        damping=0.05,
        soft_close=SPRING_CLOSE,
    ):
        leaf = 0.165
        c, s = np.sin(np.radians(lean)), np.cos(np.radians(lean))
        middle = (at[0] + c * leaf / 2, 0.0, at[2] - s * leaf / 2)
        b.box(v.coat, (0.008, w - 0.075, leaf - 0.01), middle, turn=(0, -lean, 0), bevel=0.003)


def _paper(b: PieceBuilder, v: Values) -> None:
    """Make an open basket for paper, of wire or of sheet, with crumpled sheets in some."""
    r, h = 0.13 + 0.1 * (v.radius - 0.11), 0.28 + 0.3 * (v.radius - 0.11)
    rows = [(0.76 * r, 0.0), (r, h)]
    if v.wire:
        floor = [(0, 0), (0.76 * r, 0), (0.76 * r, 0.006), (0, 0.006)]
        b.form(v.metal, turned(floor, segments=28))
        for number in range(26):
            a = 2 * np.pi * number / 26
            path = [
                (0.75 * r * np.cos(a), 0.75 * r * np.sin(a), 0.004),
                (r * np.cos(a), r * np.sin(a), h),
            ]
            b.form(v.metal, swept(path, 0.002, sides=5), collides="none")
        for share in (0.25, 0.5, 0.75, 1.0):
            x = (0.76 + 0.24 * share) * r
            ring = [
                (x - 0.002, share * h - 0.003),
                (x + 0.002, share * h - 0.003),
                (x + 0.002, share * h + 0.003),
                (x - 0.002, share * h + 0.003),
            ]
            b.form(v.metal, closed_ring(ring, segments=36), collides="none", volume=1e-5)
        b.hull(turned([(0, 0), *rows, (0, h)], segments=14), (0, 0, 0))
    else:
        b.form(v.coat, vessel(rows, wall=0.004, floor=0.006, segments=36), collides="none")
        vessel_walls(b, rows, wall=0.004, floor=0.006, bands=1)
    sheet = paint("#e9e6df", 0.85, 300.0)
    ball = [(0, 0), (0.7, 0.25), (1.0, 0.9), (0.75, 1.55), (0, 1.8)]
    for number in range(v.sheets):
        size = b.between(0.028, 0.042)
        crumpled = turned(np.array(ball) * size, segments=7, crease_deg=10.0)
        a, out = 2.4 * number, 0.45 * r * (number > 0)
        at = (out * np.cos(a), out * np.sin(a), 0.01 + size + 0.035 * number)
        turn = (b.between(0, 90), b.between(0, 90), b.between(0, 360))
        with b.part("paper", "paper"):
            b.form(sheet, crumpled, at, turn=turn, collides="none")


def _sorting(b: PieceBuilder, v: Values) -> None:
    """Make two or three bins in one case, each with a lid of its colour."""
    d, each, h = 0.34, 0.26, v.tall
    w = each * v.count
    b.box(v.coat, (d, w, 0.03), (0.0, 0.0, 0.015), bevel=0.004)
    for number in range(v.count + 1):
        b.box(
            v.coat,
            (d - 0.024, 0.012, h - 0.03),
            (0.0, number * (each - 0.012 / v.count) + 0.006 - w / 2, 0.03 + (h - 0.03) / 2),
            bevel=0.003,
        )
    for sx in (-1.0, 1.0):
        b.box(
            v.coat,
            (0.012, w, h - 0.03),
            (sx * (d / 2 - 0.006), 0.0, 0.03 + (h - 0.03) / 2),
            bevel=0.003,
        )
    z = h + 0.0025
    for number in range(v.count):
        y = (number + 0.5) * each - w / 2
        colour = paint(("#3f7a4a", "#c9a13a", "#2f5a8c")[number], 0.4, 900.0)
        with b.hinge(
            f"lid {number + 1}",
            "lid",
            at=(-d / 2, y, z + 0.008),
            axis=(0, -1, 0),
            opens_deg=85.0,
            friction=0.3,
            damping=0.4,
            soft_close=LID_CLOSE,
        ):
            lid = extruded(rectangle(each - 0.006, d, 0.02), 0.022, bevel=0.006)
            b.form(colour, lid, (0.0, y, z))
            grip = (d / 2 + 0.006, y, z + 0.012)
            b.box(colour, (0.02, 0.09, 0.012), grip, bevel=0.004)


def _wheeled(b: PieceBuilder, v: Values) -> None:
    """Make a large bin on two wheels, with a lid and a bar to pull it."""
    d, w, h = 0.5, 0.48, 0.88
    mesh = tub((d, w, h), wall=0.02, floor=0.05, radius=0.05, taper=0.07, slope=0.07)
    b.form(v.green, mesh, volume=0.006)
    tyre = [(0, -0.025), (0.085, -0.025), (0.1, -0.015), (0.1, 0.015), (0.085, 0.025), (0, 0.025)]
    for sy in (-1.0, 1.0):
        b.form(
            BLACK,
            turned(tyre, segments=28),
            (-d / 2 + 0.05, sy * (w / 2 - 0.03), 0.1),
            turn=(90, 0, 0),
            volume=3e-4,
        )
    b.form(
        BLACK,
        swept(
            [(-d / 2 + 0.05, -w / 2 + 0.02, 0.1), (-d / 2 + 0.05, w / 2 - 0.02, 0.1)],
            0.012,
            sides=10,
        ),
        collides="none",
    )
    bar = [(-d / 2 - 0.06, -w / 2 + 0.06, h - 0.02), (-d / 2 - 0.06, w / 2 - 0.06, h - 0.02)]
    b.form(v.green, swept(bar, 0.014, sides=12))
    for sy in (-1.0, 1.0):
        b.box(
            v.green, (0.08, 0.03, 0.05), (-d / 2 - 0.03, sy * (w / 2 - 0.09), h - 0.03), bevel=0.008
        )
    z = h + 0.003
    with b.hinge(
        "lid",
        "lid",
        at=(-d / 2, 0, z + 0.01),
        axis=(0, -1, 0),
        opens_deg=100.0,
        friction=1.0,
        damping=1.0,
    ):
        b.form(
            v.lid,
            extruded(rectangle(w + 0.03, d + 0.04, 0.06), 0.035, bevel=0.014),
            (0.02, 0.0, z),
            volume=0.002,
        )


_COATS = tuple(
    paint(c, 0.35, 900.0)
    for c in ("#e9e6df", "#26282b", "#8c9a86", "#7c2a2a", "#54616b", "#c9a13a")
)
_STEEL = metal("steel", 1500.0)
_SHARED = {
    "radius": Span(0.11, 0.15),
    "height": Span(0.26, 0.62),
    "tall": Span(0.45, 0.6),
    "coat": Choice(*_COATS, _STEEL, _STEEL),
    "lid": Choice(*_COATS, _STEEL),
    "metal": Choice(_STEEL, metal("#232326"), metal("brass")),
}

FAMILY = Family(
    name="bin",
    category="waste bin",
    least_m=(0.18, 0.18, 0.2),
    most_m=(0.75, 0.9, 1.1),
    styles={
        "pedal": Style(_pedal, {**_SHARED, "dome": Span(0.01, 0.05)}),
        "swing": Style(_swing, _SHARED),
        "paper": Style(_paper, {**_SHARED, "wire": Choice(True, False), "sheets": Choice(0, 3, 6)}),
        "sorting": Style(
            _sorting, {**_SHARED, "count": Choice(2, 3), "coat": Choice(*_COATS[:3], _COATS[4])}
        ),
        "wheeled": Style(
            _wheeled,
            {
                **_SHARED,
                "green": Choice(*(paint(c, 0.5, 900.0) for c in ("#3a3f42", "#2f5a3a", "#4a3a2c"))),
                "lid": Choice(
                    *(paint(c, 0.5, 900.0) for c in ("#3a3f42", "#2f5a8c", "#c9a13a", "#2f5a3a"))
                ),
            },
        ),
    },
)
