"""Hoods over a cooker: with a chimney, slanted, flat with a drawer, of wood, with a glass edge."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.appliances import STEEL, knob_row
from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import WOODS, PieceMaterial, glass, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import extruded, placed
from sailenv_content.procedural.forms import loft, rectangle
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["FAMILY"]

BLACK = paint("#17181a", 0.3, 700.0)
LAMP = paint("#f6efd9", 0.3)


def _funnel(lower: tuple[float, float], upper: tuple[float, float], height: float) -> Mesh:
    """Return a solid between two rectangles, both with their backs at x = 0."""
    rings = []
    for (deep, wide), z in ((lower, 0.0), (upper, height)):
        flat = rectangle(wide, deep, 0.006, 2) + np.array([deep / 2, 0.0])
        rings.append(np.c_[flat, np.full(len(flat), z)])
    raw = loft(np.array(rings))
    uvs = raw.positions[:, 1:]
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 35.0)


def _underside(b: PieceBuilder, d: float, w: float, z: float) -> None:
    """Add the filters and the lamps below."""
    count = max(2, round(w / 0.3))
    for number in range(count):
        y = (number - (count - 1) / 2) * (w - 0.06) / count
        size = (0.7 * d, (w - 0.06) / count - 0.01, 0.006)
        b.box(STEEL, size, (0.45 * d, y, z - 0.002), bevel=0.002, collides=False)
        for row in range(9):
            x = 0.45 * d + (row - 4) * 0.075 * d
            b.box(
                BLACK,
                (0.004, size[1] - 0.02, 0.002),
                (x, y, z - 0.0056),
                collides=False,
                bevel=0.0005,
            )
    for sign in (-1.0, 1.0):
        b.box(
            LAMP,
            (0.04, 0.07, 0.006),
            (0.9 * d, sign * 0.3 * w, z - 0.001),
            bevel=0.002,
            collides=False,
        )


def _buttons(b: PieceBuilder, x: float, z: float, count: int) -> None:
    for number in range(count):
        y = (number - (count - 1) / 2) * 0.035
        b.box(BLACK, (0.005, 0.018, 0.01), (x, y, z), bevel=0.002, collides=False)


def _chimney(b: PieceBuilder, v: Values) -> None:
    """Make a pyramid below a chimney."""
    d, w, h, rim = v.depth, v.width, v.height, v.rim
    b.box(v.body, (d, w, rim), (d / 2, 0.0, rim / 2), bevel=0.003)
    slope = 0.26 * h
    b.form(v.body, _funnel((d - 0.004, w - 0.004), (v.duct, v.duct + 0.06), slope), (0.0, 0.0, rim))
    tall = h - rim - slope
    for low, share, size in ((0.0, 0.62, 0.0), (0.62, 0.38, 0.008)):
        box = (v.duct - size, v.duct + 0.06 - 2 * size, share * tall)
        z = rim + slope + (low + share / 2) * tall
        b.box(v.body, box, ((v.duct - size) / 2, 0.0, z), bevel=0.002)
    _underside(b, d, w, 0.0)
    _buttons(b, d + 0.001, rim / 2, 4)


def _slanted(b: PieceBuilder, v: Values) -> None:
    """Lean a plate of glass from the wall, with a chimney above; it folds open."""
    d, w, h = v.depth, v.width, v.height
    lean, tall = 34.0, 0.52 * h
    box = (0.26, w - 0.04, 0.1)
    b.box(BLACK, box, (0.13, 0.0, 0.05), bevel=0.004)
    c, s = np.cos(np.radians(lean)), np.sin(np.radians(lean))
    b.form(BLACK, _funnel((0.26, w - 0.06), (0.06, w - 0.06), tall - 0.12), (0.0, 0.0, 0.1))
    b.box(
        v.body,
        (0.2, v.duct + 0.06, h - tall),
        (0.1, 0.0, tall + (h - tall) / 2 + 0.03),
        bevel=0.003,
    )
    gap = 0.03
    length = tall / c - gap
    at = (0.09, 0.0, tall)
    reach = gap + length / 2
    mid = (0.11 + s * reach, 0.0, tall - c * reach + 0.02)
    with b.hinge("plate", "hood", at=at, axis=(0.0, -1.0, 0.0), opens_deg=25.0, friction=6.0):
        b.box(v.plate, (0.008, w, length), mid, turn=(0.0, -lean, 0.0), bevel=0.002)
        grip = (mid[0] + s * 0.4 * length + 0.008, 0.0, mid[2] - c * 0.4 * length + 0.008)
        b.box(
            STEEL,
            (0.012, 0.5 * w, 0.008),
            grip,
            turn=(0.0, -lean, 0.0),
            bevel=0.002,
            collides=False,
        )
    del d


def _flat(b: PieceBuilder, v: Values) -> None:
    """Build a flat one below a cupboard, with a front that pulls out."""
    d, w = v.depth * 0.62, v.width
    b.box(v.body, (d, w, 0.13), (d / 2, 0.0, 0.065), bevel=0.004)
    b.box(
        v.wood,
        (d - 0.04, w, v.height * 0.62),
        (d / 2 - 0.02, 0.0, 0.131 + v.height * 0.31),
        bevel=0.002,
    )
    with b.slide("front", "drawer", by=0.2, friction=4.0):
        b.box(v.body, (0.022, w, 0.06), (d + 0.013, 0.0, 0.032), bevel=0.004)
        b.box(v.plate, (0.16, w - 0.05, 0.006), (d - 0.076, 0.0, -0.006), bevel=0.001)
    b.box(
        v.wood,
        (0.018, w - 0.004, v.height * 0.6),
        (d - 0.03, 0.0, 0.134 + v.height * 0.31),
        bevel=0.003,
    )
    knob_row(b, v.knob, d - 0.0024, 0.098, [-0.3 * w, 0.3 * w], radius=0.012)


def _mantel(b: PieceBuilder, v: Values) -> None:
    """Plaster a funnel over a beam of wood."""
    d, w, h = v.depth, v.width, v.height
    b.box(v.wood, (d + 0.03, w + 0.05, 0.13), (d / 2 + 0.015, 0.0, 0.065), bevel=0.006)
    b.form(v.plaster, _funnel((d - 0.01, w), (0.3, 0.6 * w), h - 0.13), (0.0, 0.0, 0.13))
    _underside(b, d, w - 0.06, 0.0)
    for sign in (-1.0, 1.0):
        outline = np.array([(0.0, 0.0), (0.16, 0.16), (0.0, 0.16)])
        mesh = placed(extruded(outline, 0.05, bevel=0.003), turn_deg=(90.0, 0.0, 0.0))
        b.form(v.wood, mesh, (0.0, sign * (w / 2 - 0.03) + 0.025, -0.16))


def _visor(b: PieceBuilder, v: Values) -> None:
    """Carry a bowed sheet of glass below a chimney."""
    d, w, h = v.depth, v.width, v.height
    turn = np.linspace(-1.0, 1.0, 21)
    front = np.stack([d - 0.1 * turn**2, w / 2 * turn], axis=-1)
    outline = np.concatenate([front, [(0.0, w / 2), (0.0, -w / 2)]])
    b.form(v.pane, extruded(outline, 0.008, bevel=0.002), (0.002, 0.0, 0.05), collides="box")
    b.box(v.body, (0.36, 0.62 * w, 0.07), (0.18, 0.0, 0.03), bevel=0.008)
    _underside(b, 0.36, 0.6 * w, -0.006)
    b.box(
        v.body,
        (v.duct, v.duct + 0.05, h - 0.07),
        (v.duct / 2, 0.0, 0.066 + (h - 0.07) / 2),
        bevel=0.002,
    )
    _buttons(b, 0.361, 0.03, 5)


def _body(kind: str) -> PieceMaterial:
    return metal(kind, 350.0)


_SHARED = {
    "depth": Span(0.46, 0.52),
    "width": Choice(0.6, 0.6, 0.9),
    "height": Span(0.58, 0.78),
    "rim": Span(0.04, 0.07),
    "duct": Span(0.22, 0.26),
    "body": Choice(_body("steel"), _body("#26272a"), _body("#e6e4de"), _body("copper")),
    "plate": Choice(paint("#101214", 0.06, 900.0), paint("#e9e7e2", 0.06, 900.0)),
    "pane": Choice(glass("#cfe0dc", 0.08), glass("#23282a", 0.6)),
    "wood": Choice(*WOODS, paint("#e9e6df")),
    "plaster": Choice(paint("#e4ded2", 0.95, 300.0), paint("#c9b9a0", 0.95, 300.0)),
    "knob": Choice(BLACK, metal("chrome")),
    "buttons": Whole(3, 5),
}

FAMILY = Family(
    name="hood",
    category="hood",
    least_m=(0.2, 0.5, 0.3),
    most_m=(0.7, 1.1, 1.1),
    styles={
        "chimney": Style(_chimney, _SHARED),
        "slanted": Style(_slanted, _SHARED),
        "flat": Style(_flat, {**_SHARED, "width": 0.6}),
        "mantel": Style(_mantel, {**_SHARED, "width": Span(0.8, 0.95)}),
        "visor": Style(_visor, _SHARED),
    },
)
