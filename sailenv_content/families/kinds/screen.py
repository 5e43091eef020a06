"""Screens: televisions on feet and on the wall, monitors, laptops, old sets with a tube."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.appliances import knob_row
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.framing import pictured
from sailenv_content.families.hardware import catch
from sailenv_content.families.materials import WOODS, PieceMaterial, metal, paint, printed
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import cushion, extruded, swept, turned
from sailenv_content.procedural.forms import rectangle
from sailenv_content.procedural.paintings import ARTS
from sailenv_ros.types.model import Material

__all__ = ["FAMILY"]

DARK = paint("#0b0c0e", 0.12, 1200.0)
BLACK = paint("#1a1b1d", 0.35, 900.0)
HOLLOW = paint("#1a1b1d", 0.4, 150.0)


def _shown(b: PieceBuilder, v: Values, aspect: float) -> PieceMaterial:
    """Return what a screen shows: nothing, or a picture that glows a little."""
    if v.off:
        return DARK
    number = int(b.rng.integers(1, 100000))
    picture = printed(f"picture {number}", ARTS[v.art](number, aspect))
    lit = Material(
        name=f"screen {number}",
        base_colour_texture=picture.surface.base_colour_texture,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        roughness=0.15,
    )
    return PieceMaterial(lit, 1.0, 1200.0)


def _flat(
    b: PieceBuilder, v: Values, width: float, height: float, x: float, low: float, deep: float
) -> None:
    """Add a flat screen whose back is at x: a case, a rim, the picture, a bulge behind."""
    rim, z = v.rim, low + height / 2
    b.box(v.case, (deep, width, height), (x + deep / 2, 0.0, z), bevel=0.004)
    size = (width - 2 * rim, height - 2.4 * rim)
    # Sides that stand out further are bright dashes where they mirror a window.
    front = x + deep + 0.0006
    mesh = pictured(*size, z + 0.2 * rim, front, thick=0.003)
    with b.part("screen", "tv"):
        b.form(_shown(b, v, size[0] / size[1]), mesh, collides="none")
    dot = (0.0015, 0.012, 0.003)
    b.box(v.trim, dot, (x + deep + 0.0004, 0.0, low + 0.5 * rim), bevel=0.0004, collides=False)


def _tv(b: PieceBuilder, v: Values) -> None:
    """Stand a flat set on two feet, a plate, or a bow."""
    w, h, lift = v.width, v.width * 0.565, v.lift
    _flat(b, v, w, h, -0.012, lift, 0.026)
    bulge = (0.035, 0.6 * w, 0.45 * h)
    b.box(BLACK, bulge, (-0.028, 0.0, lift + 0.28 * h), bevel=0.012)
    deep = 0.24
    if v.stand == "feet":
        for sign in (-1.0, 1.0):
            y = sign * 0.38 * w
            path = [(-deep / 2, y, 0.006), (-0.02, y, lift + 0.01), (deep / 2, y, 0.006)]
            b.form(v.trim, swept(path, 0.006, sides=10), collides="none")
            b.collide((deep, 0.014, 0.012), (0.0, y, 0.006))
    elif v.stand == "plate":
        plate = extruded(rectangle(0.42 * w, deep, 0.03, 6), 0.012, bevel=0.003)
        b.form(v.trim, plate)
        b.box(v.trim, (0.03, 0.12, lift + 0.05), (-0.025, 0.0, lift / 2 + 0.025), bevel=0.006)
    else:
        turn = np.linspace(0.0, np.pi, 15)
        bow = np.stack([0.3 * w * np.cos(turn), -0.02 + 0.13 * np.sin(turn)], -1)
        bent = np.stack([bow[:, 1], bow[:, 0], np.full(15, 0.008)], -1)
        b.form(v.trim, swept(bent, 0.008, sides=10), collides="none")
        ends = [(-0.02, -0.3 * w, 0.008), (-0.02, 0.3 * w, 0.008)]
        b.form(v.trim, swept(ends, 0.008, sides=10), collides="none")
        b.collide((0.15, 0.6 * w, 0.014), (0.05, 0.0, 0.008))
        b.box(v.trim, (0.03, 0.1, lift + 0.05), (-0.025, 0.0, lift / 2 + 0.025), bevel=0.006)


def _wall(b: PieceBuilder, v: Values) -> None:
    """Hang a flat set on the wall."""
    w, h = v.width, v.width * 0.565
    b.box(BLACK, (0.03, 0.4 * w, 0.5 * h), (0.015, 0.0, h / 2), bevel=0.004)
    _flat(b, v, w, h, 0.03, 0.0, 0.028)


def _monitor(b: PieceBuilder, v: Values) -> None:
    """Stand a monitor on a foot; it tilts."""
    w, h = v.width, v.width * v.ratio
    low, x = v.lift, 0.0
    if v.foot == "round":
        foot = [(0, 0), (0.11, 0), (0.108, 0.01), (0, 0.013)]
        b.form(v.trim, turned(foot, segments=32), (-0.02, 0.0, 0.0))
    else:
        plate = extruded(rectangle(0.26, 0.2, 0.02, 5), 0.01, bevel=0.003)
        b.form(v.trim, plate, (-0.01, 0.0, 0.0))
    neck = low + 0.55 * h
    b.box(v.trim, (0.014, 0.06, neck - 0.008), (-0.058, 0.0, neck / 2 + 0.004), bevel=0.004)
    at = (-0.045, 0.0, low + 0.5 * h)
    with b.hinge(
        "panel", "tv", at=at, axis=(0.0, -1.0, 0.0), opens_deg=18.0, friction=2.5, damping=0.5
    ):
        b.box(BLACK, (0.03, 0.1, 0.036), (-0.026, 0.0, low + 0.5 * h), bevel=0.004)
        _flat(b, v, w, h, x - 0.012, low, 0.022)


def _laptop(b: PieceBuilder, v: Values) -> None:
    """Make a laptop that is open; its lid shuts on its keys."""
    w, d = v.width, v.width * 0.68
    thick, up = 0.016, 0.0075
    base = extruded(rectangle(w, d, 0.012, 5), thick - 0.002, bevel=0.003)
    b.form(v.case, base, (0.0, 0.0, 0.002), collides="box")
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            foot = (0.012, 0.03, 0.003)
            b.box(BLACK, foot, (sx * 0.4 * d, sy * 0.4 * w, 0.0015), collides=False)
    rows, columns = 5, 13
    field = (0.46 * d, 0.86 * w)
    keys = BLACK if v.dark_keys else paint("#e2e2df", 0.5)
    pitch = (field[0] / rows, field[1] / columns)
    with b.part("keys", "keyboard"):
        for row in range(rows):
            x = -0.42 * d + (row + 0.5) * pitch[0] + 0.02
            gaps = [1.0] * columns if row < rows - 1 else [1.0, 1.0, 1.5, 5.0, 1.5, 1.0, 1.0, 1.0]
            y = field[1] / 2
            for wide in gaps:
                size = (pitch[0] - 0.003, wide * pitch[1] - 0.003, 0.0014)
                at = (x, y - wide * pitch[1] / 2, thick + 0.0006)
                b.box(keys, size, at, bevel=0.0005, collides=False)
                y -= wide * pitch[1]
    pad = (0.25 * d, 0.34 * w, 0.0006)
    b.box(v.trim, pad, (0.3 * d, 0.0, thick + 0.0001), bevel=0.0002, collides=False)
    at = (-d / 2 + 0.004, 0.0, thick + 0.004)
    hinge = swept([(at[0], -0.4 * w, at[2]), (at[0], 0.4 * w, at[2])], 0.0038, sides=12)
    b.form(BLACK, hinge, collides="none")
    lean = v.lean
    c, s = np.cos(np.radians(lean)), np.sin(np.radians(lean))

    def place(along: float, out: float) -> tuple[float, float, float]:
        """Return where a point of the lid is: so far up it, so far before its back."""
        return (at[0] - s * along + c * out, 0.0, at[2] + c * along + s * out)

    with b.hinge(
        "lid",
        "laptop",
        at=at,
        axis=(0.0, 1.0, 0.0),
        opens_deg=lean + 88.0,
        friction=0.4,
        detents=catch(0.5, at_deg=lean + 88.0, within_deg=8.0),
    ):
        tall = d - 0.012
        size = (up - 0.001, w, tall)
        turn = (0.0, -lean, 0.0)
        b.box(v.case, size, place(0.005 + tall / 2, 0.0), turn=turn, bevel=0.003)
        inner = (w - 0.016, tall - 0.02)
        mesh = pictured(*inner, 0.0, 0.0, thick=0.001)
        with b.part("screen", "laptop"):
            shown = _shown(b, v, inner[0] / inner[1])
            x = up / 2 - 0.0002
            b.form(shown, mesh, place(0.008 + tall / 2, x), turn=turn, collides="none")
        disc = turned([(0, 0), (0.012, 0), (0.011, 0.0006), (0, 0.0006)], segments=18)
        back = place(0.55 * tall, -up / 2 + 0.0006)
        b.form(v.trim, disc, back, turn=(0.0, -90.0 - lean, 0.0), collides="none")


def _retro(b: PieceBuilder, v: Values) -> None:
    """Build an old set of wood with a bulging tube, knobs and aerials."""
    w, h, d = v.wide, v.wide * 0.74, v.wide * 0.62
    leg = v.feet
    hollow = PieceMaterial(v.wood.surface, v.wood.tile_m, 130.0)
    b.box(hollow, (d, w, h), (0.0, 0.0, leg + h / 2), bevel=0.016)
    tail = (0.5 * d, 0.7 * w, 0.7 * h)
    b.box(HOLLOW, tail, (-d / 2 - 0.12 * d, 0.0, leg + 0.5 * h), bevel=0.03)
    x = d / 2
    wide, tall = 0.68 * w, 0.82 * h
    mid = (0.5 - 0.36) * w
    face = (0.012, 0.98 * w, 0.95 * h)
    b.box(v.face, face, (x + 0.002, 0.0, leg + h / 2), bevel=0.006)
    mesh = cushion((0.03, wide, tall), radius=0.014, puff=0.014, steps=10)
    with b.part("screen", "tv"):
        glass = paint("#2a302f", 0.08, 1500.0)
        b.form(glass, mesh, (x + 0.002, mid, leg + h / 2), collides="none")
    y = -0.5 * w + 0.13 * w
    knob_row(b, v.knob, x + 0.008, leg + 0.78 * h, [y], radius=0.05 * w)
    knob = turned([(0, 0), (0.03 * w, 0), (0.026 * w, 0.014), (0, 0.016)], segments=18)
    b.form(v.knob, knob, (x + 0.008, y, leg + 0.6 * h), turn=(0, 90, 0), collides="none")
    for number in range(7):
        at = (x + 0.009, y, leg + 0.12 * h + number * 0.045 * h)
        b.box(BLACK, (0.003, 0.16 * w, 0.014 * h), at, bevel=0.001, collides=False)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            top = (sx * 0.36 * d, sy * 0.4 * w, leg + 0.01)
            foot = (sx * 0.4 * d, sy * 0.44 * w, 0.0)
            b.form(v.wood, swept([foot, top], (0.009, 0.016), sides=12))
    if v.aerial:
        base = turned([(0, 0), (0.03, 0), (0.022, 0.02), (0, 0.024)], segments=16)
        b.form(BLACK, base, (-0.1 * d, 0.0, leg + h))
        for sign in (-1.0, 1.0):
            tip = (-0.12 * d, sign * 0.22 * w, leg + h + 0.5 * h)
            path = [(-0.1 * d, sign * 0.008, leg + h + 0.015), tip]
            b.form(metal("chrome"), swept(path, (0.003, 0.0016), sides=8), collides="none")


_CASES = (BLACK, paint("#2a2b2e", 0.4, 900.0), metal("alu", 1500.0), paint("#e4e2dc", 0.35, 900.0))
_SHARED = {
    "width": Span(0.8, 1.35),
    "rim": Span(0.007, 0.016),
    "lift": Span(0.05, 0.08),
    "stand": Choice("feet", "plate", "bow"),
    "case": Choice(*_CASES, BLACK),
    "trim": Choice(metal("steel"), metal("alu"), metal("#26272a")),
    "off": Choice(True, True, False),
    "art": Whole(0, len(ARTS) - 1),
}

FAMILY = Family(
    name="screen",
    category="tv",
    least_m=(0.04, 0.28, 0.1),
    most_m=(0.8, 1.7, 1.3),
    styles={
        "tv": Style(_tv, _SHARED),
        "wall": Style(_wall, {**_SHARED, "rim": Span(0.005, 0.012)}),
        "monitor": Style(
            _monitor,
            {
                **_SHARED,
                "width": Span(0.5, 0.72),
                "ratio": Choice(0.58, 0.58, 0.64, 0.44),
                "lift": Span(0.09, 0.13),
                "foot": Choice("round", "square"),
                "off": Choice(True, False),
            },
        ),
        "laptop": Style(
            _laptop,
            {
                **_SHARED,
                "width": Span(0.3, 0.38),
                "case": Choice(metal("alu", 1500.0), *_CASES),
                "dark_keys": Choice(True, True, False),
                "lean": Span(8.0, 30.0),
                "off": Choice(True, False),
            },
            "laptop",
        ),
        "retro": Style(
            _retro,
            {
                **_SHARED,
                "wide": Span(0.5, 0.68),
                "feet": Span(0.05, 0.12),
                "wood": Choice(*WOODS, paint("#b5533c", 0.4), paint("#e2dccb", 0.4)),
                "face": Choice(paint("#d9d2c0", 0.5), paint("#2b2d30", 0.4), metal("alu")),
                "knob": Choice(metal("chrome"), paint("#2b2d30", 0.3), metal("brass")),
                "aerial": Choice(True, False),
            },
        ),
    },
)
