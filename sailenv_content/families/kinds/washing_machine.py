"""Machines for laundry: front loaders, top loaders, dryers, one on the other."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.appliances import knob_row
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.drums import STEEL, drum, front_with_hole
from sailenv_content.families.family import Family, Style
from sailenv_content.families.fronts import handle
from sailenv_content.families.hardware import LID_CLOSE, SEAL
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import closed_ring, sleeve, vessel
from sailenv_content.families.materials import PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import placed, turned

__all__ = ["FAMILY"]

RUBBER = paint("#4a4d50", 0.7, 1100.0)
WALL = 0.018


def _porthole(b: PieceBuilder, v: Values, x: float, radius: float, z: float, name: str) -> None:
    """Add a round door with a bowl of glass, its hinge at its left."""
    left = v.hinge == "left"
    sign = 1.0 if left else -1.0
    at = (x + 0.012, sign * (radius + 0.03), z)
    axis = (0.0, 0.0, sign)
    with b.hinge(name, "door", at=at, axis=axis, opens_deg=110.0, friction=0.8, detents=SEAL):
        r = radius + 0.026
        loop = [
            (radius - 0.03, 0.004), (r - 0.006, 0.001), (r, 0.008), (r - 0.006, 0.03),
            (r - 0.03, 0.036), (radius - 0.034, 0.022),
        ]  # fmt: skip
        ring = placed(closed_ring(loop, segments=44), turn_deg=(0.0, 90.0, 0.0))
        b.form(v.ring, ring, (x, 0.0, z), collides="none", volume=0.0012)
        if v.flat_door:
            disc = [(0, 0.016), (radius - 0.03, 0.016), (radius - 0.03, 0.022), (0, 0.022)]
            mesh = placed(turned(disc, segments=40), turn_deg=(0.0, 90.0, 0.0))
            b.form(v.pane, mesh, (x, 0.0, z), collides="none", volume=3e-4)
        else:
            rows = [(0.62 * radius, -0.075), (0.76 * radius, -0.06), (radius - 0.03, 0.012)]
            bowl = vessel(rows, wall=0.005, segments=36)
            mesh = placed(bowl, turn_deg=(0.0, 90.0, 0.0))
            b.form(v.pane, mesh, (x, 0.0, z), collides="none", volume=4e-4)
        b.collide((0.03, 1.5 * radius, 1.5 * radius), (x + 0.02, 0.0, z))
        grip = -sign * (r - 0.014)
        with b.part("handle", "handle"):
            b.box(v.grip, (0.012, 0.02, 0.09), (x + 0.036, grip, z), bevel=0.004)


def _front_loader(
    b: PieceBuilder, v: Values, base: float = 0.0, prefix: str = "", *, drawer: bool = True
) -> None:
    """Make a case with a drum, a porthole, a panel with a knob, and a drawer for powder."""
    d, w, h = v.depth, v.width, v.height
    front, panel = d / 2 - 0.03, 0.125
    z, radius = base + 0.46 * (h - panel) + 0.03, v.drum
    case = Box((-d / 2, -w / 2, base + 0.012), (front, w / 2, base + h - 0.028))
    size, mid = case.size, case.middle
    for sign in (-1.0, 1.0):
        side = (size[0], WALL, size[2])
        b.box(v.body, side, (mid[0], sign * (w - WALL) / 2, mid[2]), bevel=0.004)
    back = (0.012, w - 2 * WALL, size[2])
    b.box(v.body, back, (case.low[0] + 0.006, 0.0, mid[2]), bevel=0.001)
    for low in (case.low[2], case.high[2] - 0.012):
        b.box(v.body, (size[0], w - 2 * WALL, 0.012), (mid[0], 0.0, low + 0.006), bevel=0.001)
    b.box(v.top, (d - 0.006, w, 0.028), (-0.003, 0.0, base + h - 0.014), bevel=0.006)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            foot = turned([(0, 0), (0.022, 0), (0.02, 0.013), (0, 0.013)], segments=14)
            b.form(RUBBER, foot, (sx * 0.42 * d, sy * 0.42 * w, base), collides="none")
    face = Box((front, -w / 2, base + 0.03), (front + 0.016, w / 2, base + h - 0.03 - panel))
    front_with_hole(b, v, face, radius, z)
    seal = [
        (radius - 0.032, 0.0), (radius + 0.002, 0.0), (radius + 0.002, 0.02), (radius - 0.02, 0.022)
    ]  # fmt: skip
    mesh = placed(closed_ring(seal, segments=40), turn_deg=(0.0, 90.0, 0.0))
    b.form(RUBBER, mesh, (front - 0.012, 0.0, z), collides="none", volume=2e-4)
    tube = placed(
        sleeve([(radius, 0.0), (radius, 0.05)], wall=0.004, segments=40), turn_deg=(0, 90, 0)
    )
    b.form(v.body, tube, (front - 0.04, 0.0, z), collides="none", volume=2e-4)
    drum(b, v, front - 0.02, min(0.36, d - 0.14), radius + 0.035, z)
    _porthole(b, v, front + 0.018, radius, z, f"{prefix}door")
    top = Box(
        (front + 0.002, -w / 2, base + h - 0.028 - panel), (front + 0.018, w / 2, base + h - 0.028)
    )
    share = 0.3 if drawer else 0.0
    left = Box((top.low[0], top.high[1] - share * w, top.low[2]), top.high).inset(0.002)
    rest = Box(top.low, (top.high[0], top.high[1] - share * w, top.high[2]))
    b.box(v.face, rest.size, rest.middle, bevel=0.003)
    if drawer:
        with b.slide(f"{prefix}powder drawer", "drawer", by=0.2):
            b.box(v.face, left.size, left.middle, bevel=0.003)
            y, wide = float(left.middle[1]), float(left.size[1]) - 0.05
            low = float(left.low[2]) + 0.02
            tray = Box((front - 0.24, y - wide / 2, low), (front, y + wide / 2, low + 0.06))
            _tray(b, v.inner, tray)
            handle(
                b,
                v.face,
                "edge",
                float(left.high[0]),
                y,
                float(left.low[2]) + 0.01,
                length=0.7 * wide,
            )
    x, at_z = float(rest.high[0]), float(rest.middle[2])
    knob_row(b, v.knob, x, at_z, [float(rest.middle[1]) - 0.02], radius=0.026)
    window = (0.002, 0.1, 0.042)
    b.box(
        paint("#101214", 0.1), window, (x + 0.0006, -0.29 * w, at_z), bevel=0.0006, collides=False
    )
    digits = (0.002, 0.036, 0.014)
    b.box(
        paint("#8fd0a8", 0.4), digits, (x + 0.0012, -0.29 * w, at_z), bevel=0.0003, collides=False
    )
    for number in range(4):
        at = (x + 0.001, rest.middle[1] + 0.045 + 0.02 * number, at_z - 0.025)
        b.box(RUBBER, (0.003, 0.01, 0.006), at, bevel=0.001, collides=False)
    if v.hatch:
        at = (front + 0.017, -0.33 * w, base + 0.075)
        b.box(v.inner, (0.003, 0.11, 0.06), at, bevel=0.001, collides=False)


def _tray(b: PieceBuilder, material: PieceMaterial, room: Box) -> None:
    size, mid, wall = room.size, room.middle, 0.004
    b.box(material, (size[0], size[1], wall), (mid[0], mid[1], room.low[2] + wall / 2), bevel=0.001)
    for y in (-0.5, -0.12, 0.5):
        at = (mid[0], mid[1] + y * (size[1] - wall), mid[2])
        b.box(material, (size[0], wall, size[2]), at, bevel=0.001)
    at = (room.low[0] + wall / 2, mid[1], mid[2])
    b.box(material, (wall, size[1], size[2]), at, bevel=0.001)


def _dryer(b: PieceBuilder, v: Values) -> None:
    """Make a tumble dryer: no drawer, a flat door."""
    _front_loader(b, Values({**v.all, "hatch": True}), drawer=False)


def _tower(b: PieceBuilder, v: Values) -> None:
    """Stand a dryer on a washing machine."""
    _front_loader(b, v, 0.0, "lower ")
    _front_loader(
        b, Values({**v.all, "flat_door": True, "hatch": False}), v.height + 0.012, "upper ",
        drawer=False,
    )  # fmt: skip
    b.box(RUBBER, (v.depth - 0.06, v.width - 0.03, 0.012), (0.0, 0.0, v.height + 0.006))


def _top_loader(b: PieceBuilder, v: Values) -> None:
    """Make a case that is open at its top, with a drum, a lid, and a console behind."""
    d, w, h, wall = v.depth, v.wide, v.height, 0.02
    radius = min(d, w) / 2 - 0.06
    top = h - 0.03
    for sign in (-1.0, 1.0):
        b.box(
            v.body, (d, wall, top - 0.02), (0.0, sign * (w - wall) / 2, top / 2 + 0.01), bevel=0.006
        )
        at = (sign * (d - wall) / 2, 0.0, top / 2 + 0.01)
        b.box(v.body, (wall, w - 2 * wall, top - 0.02), at, bevel=0.006)
    b.box(v.body, (d - 0.02, w - 0.02, 0.02), (0.0, 0.0, 0.03), bevel=0.002)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            foot = turned([(0, 0), (0.022, 0), (0.02, 0.022), (0, 0.022)], segments=14)
            b.form(RUBBER, foot, (sx * 0.4 * d, sy * 0.4 * w, 0.0), collides="none")
    rim = [(radius - 0.03, -0.04), (radius, -0.04), (radius, 0.032), (radius - 0.03, 0.032)]
    # The deck is four boards around the hole, and a round collar over their edges.
    hole = radius - 0.02
    side = (w / 2 - hole, d / 2 - hole)
    for sign in (-1.0, 1.0):
        b.box(
            v.body, (d, side[0], 0.03), (0.0, sign * (hole + side[0] / 2), top + 0.015), bevel=0.006
        )
        at = (sign * (hole + side[1] / 2), 0.0, top + 0.015)
        b.box(v.body, (side[1], 2 * hole, 0.03), at, bevel=0.003)
    b.form(v.inner, closed_ring(rim, segments=44), (0, 0, top), collides="none", volume=8e-4)
    for quarter in range(4):
        turn = np.radians(45.0 + 90.0 * quarter)
        at = (1.13 * hole * np.cos(turn), 1.13 * hole * np.sin(turn), top + 0.012)
        b.box(
            v.body,
            (0.36 * hole, 0.8 * hole, 0.02),
            at,
            turn=(0, 0, 45.0 + 90.0 * quarter),
            bevel=0.003,
        )
    with b.part("drum", "washing machine"):
        tall = top - 0.12
        inner = vessel(
            [(radius - 0.03, 0.0), (radius - 0.02, 0.03), (radius - 0.02, tall)],
            wall=0.006,
            segments=40,
        )
        b.form(STEEL, inner, (0, 0, 0.1), collides="none", volume=0.003)
        post = turned(
            [(0, 0), (0.09, 0), (0.05, 0.06), (0.032, 0.1), (0.03, 0.3), (0, 0.33)], segments=20
        )
        b.form(v.inner, post, (0, 0, 0.11))
    b.collide((1.9 * radius, 1.9 * radius, 0.02), (0, 0, 0.1))
    tall = 0.13
    console = Box((-d / 2, -w / 2, h), (-d / 2 + 0.062, w / 2, h + tall))
    b.box(v.face, console.size, console.middle, bevel=0.012, top=(0.7, 1.0), lean=(-0.009, 0.0))
    knobs = [-0.3 * w, -0.12 * w, 0.3 * w]
    knob_row(b, v.knob, -d / 2 + 0.0605, h + 0.55 * tall, knobs, radius=0.028)
    hinge_x = -d / 2 + 0.106
    with b.hinge(
        "lid",
        "lid",
        at=(hinge_x, 0, h + 0.012),
        axis=(0, -1, 0),
        opens_deg=78.0,
        friction=1.2,
        soft_close=LID_CLOSE,
    ):
        reach, wide = d / 2 - 0.02 - hinge_x, 2 * radius + 0.02
        at = (hinge_x + reach / 2, 0.0, h + 0.012)
        if v.glass_lid:
            for sign in (-1.0, 1.0):
                b.box(
                    v.face,
                    (reach, 0.05, 0.016),
                    (at[0], sign * (wide - 0.05) / 2, at[2]),
                    bevel=0.005,
                )
                end = (at[0] + sign * (reach - 0.05) / 2, 0.0, at[2])
                b.box(v.face, (0.05, wide - 0.1, 0.016), end, bevel=0.005)
            b.box(v.pane, (reach - 0.1, wide - 0.1, 0.005), at, bevel=0.0006)
        else:
            b.box(v.body, (reach, wide, 0.018), at, bevel=0.006)
        b.box(v.grip, (0.012, 0.14, 0.012), (at[0] + reach / 2, 0.0, at[2]), bevel=0.004)


_BODIES = (
    paint("#eceae5", 0.3, 500.0),
    paint("#d7dadb", 0.3, 500.0),
    paint("#2b2d30", 0.35, 500.0),
    metal("steel", 700.0),
)
_SHARED = {
    "depth": Span(0.52, 0.62),
    "width": Choice(0.595, 0.6),
    "height": Span(0.83, 0.86),
    "drum": Span(0.155, 0.185),
    "hinge": "left",
    "body": Choice(*_BODIES, _BODIES[0]),
    "top": Choice(_BODIES[0], paint("#c9cccd", 0.4, 500.0)),
    "face": Choice(*_BODIES),
    "ring": Choice(metal("chrome"), paint("#e2e2df", 0.3), paint("#2b2d30", 0.25)),
    "pane": Choice(glass("#1c2023", 0.55), glass("#dfe8e6", 0.08)),
    "inner": paint("#c7cacb", 0.4),
    "grip": Choice(metal("chrome"), paint("#2b2d30", 0.3), paint("#e2e2df", 0.3)),
    "knob": Choice(metal("chrome"), paint("#2b2d30", 0.3), paint("#e8e6e0", 0.3)),
    "filled": Choice(True, False),
    "flat_door": False,
    "hatch": True,
}

FAMILY = Family(
    name="washing_machine",
    category="washing machine",
    least_m=(0.35, 0.4, 0.6),
    most_m=(0.75, 0.75, 1.9),
    styles={
        "front": Style(_front_loader, _SHARED),
        "compact": Style(
            _front_loader,
            {
                **_SHARED,
                "depth": Span(0.42, 0.46),
                "width": Span(0.5, 0.52),
                "height": Span(0.66, 0.7),
                "drum": Span(0.13, 0.15),
                "hatch": False,
            },
        ),
        "top": Style(
            _top_loader,
            {
                **_SHARED,
                "wide": Span(0.58, 0.68),
                "depth": Span(0.58, 0.66),
                "height": Span(0.88, 0.95),
                "glass_lid": Choice(True, False),
            },
        ),
        "dryer": Style(
            _dryer,
            {
                **_SHARED,
                "hinge": "right",
                "flat_door": Choice(True, True, False),
                "drum": Span(0.17, 0.19),
            },
            "tumble dryer",
        ),
        "tower": Style(_tower, {**_SHARED, "filled": Choice(True, False, False)}),
    },
)
