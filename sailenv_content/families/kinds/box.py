"""Boxes with lids: a blanket chest, cardboard with flaps, for jewels, a crate, a tin."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import folded
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import front_panel
from sailenv_content.families.hardware import LID_CLOSE
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import open_box
from sailenv_content.families.materials import WOODS, fabric, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import swept
from sailenv_content.procedural.forms import curve

__all__ = ["FAMILY"]


def _chest(b: PieceBuilder, v: Values) -> None:
    """Make a chest for blankets, with panels at its front and a lid on hinges."""
    d, w, h, t = v.depth, v.width, v.height, 0.02
    plinth = v.legs
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(
                v.material,
                (0.06, 0.06, plinth),
                (sx * (d / 2 - 0.035), sy * (w / 2 - 0.035), plinth / 2),
            )
    outer = Box((-d / 2, -w / 2, plinth), (d / 2, w / 2, h))
    room = open_box(b, v.material, outer, t)
    face = Box(
        (d / 2 + 0.0005, -w / 2 + 0.01, plinth + 0.02), (d / 2 + 0.016, w / 2 - 0.01, h - 0.02)
    )
    for column in face.columns([1.0] * v.fields, 0.012):
        front_panel(b, v.material, v.front, column)
    z, back = h + 0.0025, -d / 2
    with b.hinge(
        "lid",
        "lid",
        at=(back, 0.0, z + 0.012),
        axis=(0, -1, 0),
        opens_deg=95.0,
        friction=2.0,
        damping=2.0,
        soft_close=LID_CLOSE,
    ):
        b.box(v.top, (d + 0.03, w + 0.03, 0.024), (0.015, 0.0, z + 0.012), bevel=0.005)
        if v.cloth is not None:
            b.box(v.cloth, (d - 0.02, w - 0.02, 0.03), (0.005, 0.0, z + 0.039), bevel=0.014)
    folded(b, room.within((0.02, 0.02, 0.001), (0.02, 0.02, 0.1)))


def _cardboard(b: PieceBuilder, v: Values) -> None:
    """Make a carton with four flaps, those at the ends below the others."""
    d, w, h, t = v.depth, v.width, v.height, 0.005
    open_box(b, v.material, Box((-d / 2, -w / 2, 0.0), (d / 2, w / 2, h)), t)
    low, high = h + 0.002, h + 0.009
    half = min(w / 2 - 0.004, d / 2 - 0.004)
    for sign, name in ((1.0, "left flap"), (-1.0, "right flap")):
        at = (0.0, sign * w / 2, low + t / 2)
        with b.hinge(
            name,
            "lid",
            at=at,
            axis=(-sign, 0, 0) if sign < 0 else (-1.0, 0, 0),
            opens_deg=200.0,
            friction=0.05,
            damping=0.05,
        ):
            b.box(
                v.material,
                (d - 0.012, half, t),
                (0.0, sign * (w / 2 - half / 2), low + t / 2),
                bevel=0.001,
            )
    for sign, name in ((1.0, "front flap"), (-1.0, "back flap")):
        at = (sign * d / 2, 0.0, high + t / 2)
        with b.hinge(
            name, "lid", at=at, axis=(0, sign, 0), opens_deg=200.0, friction=0.05, damping=0.05
        ):
            b.box(
                v.material,
                (d / 2 - 0.002, w, t),
                (sign * (d / 4 + 0.001), 0.0, high + t / 2),
                bevel=0.001,
            )
            tape = (d / 2 - 0.004 - 0.03, 0.05, 0.0006)
            if sign > 0:
                b.box(
                    paint("#a8844e", 0.2),
                    tape,
                    (sign * (d / 4), 0.0, high + t + 0.0004),
                    bevel=0.0002,
                    collides=False,
                )
    label = (d / 2 + 0.0006, b.between(-0.2, 0.2) * w, 0.55 * h)
    b.box(paint("#e9e5dc", 0.7), (0.001, 0.1, 0.07), label, bevel=0.0003, collides=False)


def _jewels(b: PieceBuilder, v: Values) -> None:
    """Make a small box lined with cloth, with a clasp."""
    d, w, h, t = v.small_d, v.small_w, v.small_h, 0.008
    outer = Box((-d / 2, -w / 2, 0.0), (d / 2, w / 2, h))
    room = open_box(b, v.material, outer, t, liner=v.cloth)
    for share in (0.33, 0.66):
        y = room.low[1] + share * room.size[1]
        b.box(
            v.cloth,
            (room.size[0], 0.006, 0.6 * room.size[2]),
            (0.0, y, room.low[2] + 0.3 * room.size[2]),
            bevel=0.002,
        )
    z = h + 0.002
    with b.hinge(
        "lid",
        "lid",
        at=(-d / 2, 0.0, z + 0.005),
        axis=(0, -1, 0),
        opens_deg=100.0,
        friction=0.1,
        damping=0.05,
        soft_close=LID_CLOSE,
    ):
        b.box(v.material, (d, w, 0.012), (0.0, 0.0, z + 0.006), bevel=0.003)
        b.box(v.top, (0.8 * d, 0.8 * w, 0.005), (0.0, 0.0, z + 0.0145), bevel=0.0015)
        b.box(
            v.cloth,
            (d - 2 * t - 0.002, w - 2 * t - 0.002, 0.001),
            (0.0, 0.0, z - 0.0005),
            bevel=0.0003,
            collides=False,
        )
        b.box(v.metal, (0.003, 0.016, 0.02), (d / 2 + 0.002, 0.0, z), bevel=0.001)


def _crate(b: PieceBuilder, v: Values) -> None:
    """Nail boards to a crate that is open, with holes for the hands."""
    d, w, h, t = v.depth, v.width, v.height, 0.012
    rows = 3
    for row in range(rows):
        z = (row + 0.5) / rows * (h - 0.004)
        tall = h / rows - 0.012
        for sx in (-1.0, 1.0):
            b.box(v.material, (t, w, tall), (sx * (d - t) / 2, 0.0, z + 0.004), bevel=0.0015)
        for sy in (-1.0, 1.0):
            if row == rows - 1:
                for sx in (-1.0, 1.0):
                    size = ((d - 2 * t - 0.1) / 2, t, tall)
                    b.box(
                        v.material,
                        size,
                        (sx * (size[0] + 0.1) / 2, sy * (w - t) / 2, z + 0.004),
                        bevel=0.0015,
                    )
            else:
                b.box(
                    v.material,
                    (d - 2 * t, t, tall),
                    (0.0, sy * (w - t) / 2, z + 0.004),
                    bevel=0.0015,
                )
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            b.box(
                v.material,
                (0.024, 0.024, h - 0.01),
                (sx * (d / 2 - t - 0.013), sy * (w / 2 - t - 0.013), h / 2),
            )
    for number in range(4):
        x = (number + 0.5) / 4 * (d - 2 * t) - (d - 2 * t) / 2
        b.box(v.material, ((d - 2 * t) / 4 - 0.01, w - 2 * t, 0.01), (x, 0.0, 0.011), bevel=0.001)
    folded(b, Box((-d / 2 + 0.04, -w / 2 + 0.04, 0.017), (d / 2 - 0.04, w / 2 - 0.04, 0.7 * h)))


def _trunk(b: PieceBuilder, v: Values) -> None:
    """Make a trunk with corners and bands of metal, handles at its ends and a lid."""
    d, w, h, t = v.depth, v.width, 0.75 * v.height + 0.08, 0.014
    outer = Box((-d / 2, -w / 2, 0.0), (d / 2, w / 2, h))
    room = open_box(b, v.coat, outer, t, liner=v.cloth)
    z, tall = h + 0.0025, 0.09
    for share in (-0.3, 0.3):
        b.box(
            v.metal,
            (0.003, 0.035, h),
            (d / 2 + 0.0018, share * w, h / 2),
            bevel=0.001,
            collides=False,
        )
    for sy in (-1.0, 1.0):
        y = sy * (w / 2)
        bow = curve(
            [
                (-0.07, y, 0.6 * h),
                (-0.05, y + sy * 0.03, 0.6 * h - 0.02),
                (0.05, y + sy * 0.03, 0.6 * h - 0.02),
                (0.07, y, 0.6 * h),
            ],
            12,
        )
        with b.part("handle", "handle"):
            b.form(v.leather, swept(bow, 0.008, sides=8))
    folded(b, room.within((0.02, 0.02, 0.004), (0.02, 0.02, 0.08)))
    with b.hinge(
        "lid",
        "lid",
        at=(-d / 2, 0.0, z),
        axis=(0, -1, 0),
        opens_deg=92.0,
        friction=2.0,
        damping=2.0,
        soft_close=LID_CLOSE,
    ):
        b.box(v.coat, (d, w, t), (0.0, 0.0, z + tall - t / 2), bevel=0.004)
        for sign in (-1.0, 1.0):
            b.box(
                v.coat, (t, w, tall - t), (sign * (d - t) / 2, 0.0, z + (tall - t) / 2), bevel=0.003
            )
            b.box(
                v.coat,
                (d - 2 * t, t, tall - t),
                (0.0, sign * (w - t) / 2, z + (tall - t) / 2),
                bevel=0.003,
            )
        for share in (-0.3, 0.3):
            b.box(
                v.metal,
                (d - 0.01, 0.035, 0.003),
                (0.0, share * w, z + tall + 0.0016),
                bevel=0.001,
                collides=False,
            )
            b.box(
                v.metal,
                (0.003, 0.035, tall - 0.004),
                (d / 2 + 0.0018, share * w, z + tall / 2),
                bevel=0.001,
                collides=False,
            )
        for sx in (-1.0, 1.0):
            for sy in (-1.0, 1.0):
                b.box(
                    v.metal,
                    (0.05, 0.05, 0.05),
                    (sx * (d / 2 - 0.0225), sy * (w / 2 - 0.0225), z + tall - 0.0225),
                    bevel=0.006,
                    collides=False,
                )
        b.box(
            v.metal,
            (0.004, 0.07, 0.05),
            (d / 2 + 0.0025, 0.0, z + 0.028),
            bevel=0.0015,
            collides=False,
        )


_SHARED = {
    "depth": Span(0.28, 0.4),
    "width": Span(0.36, 0.55),
    "height": Span(0.22, 0.34),
    "material": Choice(*WOODS),
    "cloth": Choice(*(fabric(c) for c in ("#8a3b32", "#3d5a5c", "#c9bda8", "#4a4a52"))),
    "metal": Choice(metal("brass"), metal("steel"), metal("#26272a")),
    "top": Choice(*WOODS),
}

FAMILY = Family(
    name="box",
    category="box",
    least_m=(0.1, 0.12, 0.05),
    most_m=(0.65, 1.4, 0.7),
    styles={
        "chest": Style(
            _chest,
            {
                **_SHARED,
                "depth": Span(0.42, 0.5),
                "width": Span(0.85, 1.2),
                "height": Span(0.42, 0.5),
                "legs": Span(0.03, 0.08),
                "material": Choice(*WOODS, paint("#e9e6df"), paint("#54616b")),
                "fields": Choice(1, 2, 3),
                "front": Choice("flat", "shaker", "grooved"),
                "cloth": Choice(None, fabric("#6f7a83"), fabric("#b98a3e")),
            },
        ),
        "carton": Style(
            _cardboard,
            {
                **_SHARED,
                "material": Choice(
                    *(paint(c, 0.9, 300.0) for c in ("#b0895a", "#a67c4c", "#c2a276"))
                ),
            },
        ),
        "jewels": Style(
            _jewels,
            {
                **_SHARED,
                "small_d": Span(0.13, 0.2),
                "small_w": Span(0.18, 0.28),
                "small_h": Span(0.06, 0.1),
            },
        ),
        "crate": Style(_crate, {**_SHARED, "material": Choice(*WOODS[:5])}),
        "trunk": Style(
            _trunk,
            {
                **_SHARED,
                "depth": Span(0.4, 0.5),
                "width": Span(0.7, 0.95),
                "height": Span(0.36, 0.5),
                "coat": Choice(
                    *(
                        paint(c, 0.5)
                        for c in ("#3a4a3f", "#2f3f57", "#5b3a24", "#26282b", "#8a3b32")
                    )
                ),
                "leather": Choice(paint("#5b3a24", 0.6), paint("#2a2623", 0.6)),
            },
        ),
    },
)
