"""Toys: teddies, blocks, trains, cars, balls, rings on a stick, houses for dolls."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.dolls_houses import dolls_house
from sailenv_content.families.family import Family, Style
from sailenv_content.families.lathe import closed_ring
from sailenv_content.families.materials import (
    FABRICS,
    fabric,
    metal,
    printed,
    wood,
)
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import Floats, extruded, placed, turned
from sailenv_content.families.toy_vehicles import car, train
from sailenv_content.families.toys import BLACK, GAY, blob, lacquer
from sailenv_content.procedural.forms import circle
from sailenv_ros.types.colour import srgb_from_linear

__all__ = ["FAMILY"]


def _teddy(b: PieceBuilder, v: Values) -> None:
    """Sew a bear, a rabbit or a cat that sits, with a ribbon or a jumper."""
    s = v.size
    fur, pale = v.fur, v.pale
    jumper = v.jumper if v.dressed else fur
    blob(b, jumper, (0.19 * s, 0.2 * s, 0.23 * s), (0.0, 0.0, 0.25 * s))
    blob(b, fur, (0.16 * s, 0.18 * s, 0.155 * s), (0.02 * s, 0.0, 0.59 * s))
    blob(b, pale, (0.075 * s, 0.08 * s, 0.06 * s), (0.155 * s, 0.0, 0.555 * s), collides=False)
    if not v.dressed:
        blob(b, pale, (0.06 * s, 0.13 * s, 0.15 * s), (0.145 * s, 0.0, 0.25 * s), collides=False)
    blob(b, BLACK, (0.02 * s, 0.028 * s, 0.018 * s), (0.225 * s, 0.0, 0.58 * s), collides=False)
    for sign in (-1.0, 1.0):
        eye = (0.155 * s, sign * 0.07 * s, 0.64 * s)
        blob(b, BLACK, (0.017 * s, 0.018 * s, 0.02 * s), eye, collides=False)
        if v.ears == "long":
            ear = (0.035 * s, 0.05 * s, 0.16 * s)
            at = (0.0, sign * 0.09 * s, 0.83 * s)
            blob(b, fur, ear, at, turn=(sign * -12.0, -8.0, 0.0), collides=False)
        else:
            up = 0.72 if v.ears == "round" else 0.745
            ear = (0.03 * s, 0.062 * s, 0.065 * s if v.ears == "round" else 0.085 * s)
            at = (0.0, sign * 0.125 * s, up * s)
            blob(b, fur, ear, at, turn=(sign * -30.0, 0.0, 0.0), collides=False)
            inner = (0.027 * s, sign * 0.125 * s, up * s - 0.005)
            blob(b, pale, (0.012 * s, 0.036 * s, 0.04 * s), inner, collides=False)
        arm = (0.11 * s, sign * 0.2 * s, 0.29 * s)
        blob(b, jumper, (0.062 * s, 0.062 * s, 0.16 * s), arm, turn=(sign * 22.0, -48.0, 0.0))
        hand = (0.215 * s, sign * 0.235 * s, 0.2 * s)
        blob(b, fur, (0.06 * s, 0.06 * s, 0.06 * s), hand, collides=False)
        leg = (0.23 * s, sign * 0.15 * s, 0.082 * s)
        blob(b, fur, (0.19 * s, 0.08 * s, 0.08 * s), leg, turn=(0.0, 0.0, sign * 14.0))
        foot = (0.385 * s, sign * 0.19 * s, 0.1 * s)
        blob(b, fur, (0.055 * s, 0.085 * s, 0.1 * s), foot, turn=(0, 0, sign * 14.0))
        sole = (0.43 * s, sign * 0.2 * s, 0.1 * s)
        blob(
            b, pale, (0.02 * s, 0.05 * s, 0.065 * s), sole, turn=(0, 0, sign * 14.0), collides=False
        )
    if v.ribbon:
        ring = closed_ring(circle(8) * 0.017 * s + (0.115 * s, 0.0), segments=24)
        b.form(v.jumper, ring, (0.02 * s, 0.0, 0.465 * s), collides="none", volume=1e-5)
        for sign in (-1.0, 1.0):
            bow = (0.155 * s, sign * 0.055 * s, 0.46 * s)
            blob(b, v.jumper, (0.018 * s, 0.055 * s, 0.035 * s), bow, collides=False)


def _blocks(b: PieceBuilder, v: Values) -> None:
    """Build a tower, a gate or a castle of blocks, with arches, columns and roofs."""
    a = v.block
    rows = int(v.rows)

    def cube(x: float, y: float, level: float, wide: float = 1.0, high: float = 1.0) -> None:
        turn = (0.0, 0.0, b.between(-5.0, 5.0))
        size = (a, wide * a, high * a)
        at = (x * a, y * a, (level + high / 2) * a)
        b.box(b.pick(*v.colours), size, at, turn=turn, bevel=0.0018)

    def roof(y: float, level: float) -> None:
        outline = np.array([(-0.5, 0.0), (0.5, 0.0), (0.0, 0.55)]) * a
        mesh = placed(extruded(outline, a, bevel=0.0015), turn_deg=(90.0, 0.0, 0.0))
        mesh = placed(mesh, turn_deg=(0.0, 0.0, 90.0))
        b.form(b.pick(*v.colours), mesh, (-a / 2, y * a, level * a))

    def column(y: float, level: float, high: float) -> None:
        mesh = turned([(0, 0), (0.42 * a, 0), (0.42 * a, high * a), (0, high * a)], segments=24)
        b.form(b.pick(*v.colours), mesh, (0.0, y * a, level * a))

    if v.plan == "tower":
        for level in range(rows + 1):
            cube(b.between(-0.06, 0.06), b.between(-0.06, 0.06), level)
        roof(0.0, rows + 1)
        for _ in range(4):
            x, y = b.between(1.3, 2.4) * b.pick(-1, 1), b.between(-1.6, 1.6)
            cube(x, y, 0.0, b.pick(1.0, 1.0, 2.0))
        return
    wide = 2.2 if v.plan == "gate" else 3.2
    for sign in (-1.0, 1.0):
        for level in range(rows):
            if v.plan == "castle" and level == rows - 1:
                column(sign * wide / 2, level, 1.0)
            else:
                cube(0.0, sign * wide / 2, level)
        if v.plan == "castle":
            roof(sign * wide / 2, rows)
    if v.plan == "gate":
        cube(0.0, 0.0, rows, wide + 1.0, 0.5)
        for y in (-1.0, 1.0):
            column(y, rows + 0.5, 0.9)
        cube(0.0, 0.0, rows + 1.4, 3.0, 0.5)
        roof(0.0, rows + 1.9)
    else:
        for y in (-0.55, 0.55):
            for level in range(max(1, rows - 2)):
                cube(0.0, y, level)
            roof(y, max(1, rows - 2))


def _ball(b: PieceBuilder, v: Values) -> None:
    """Make a ball with stripes, dots, or patches."""
    r = v.radius
    pixels = np.full((256, 512, 4), 255, np.uint8)
    lat, lon = np.mgrid[0:256, 0:512]
    if v.print == "beach":
        number = (lon * 6 // 512) % len(v.colours)
        number[(lat < 22) | (lat > 234)] = 0
    elif v.print == "bands":
        number = (lat * 7 // 256) % 2
    elif v.print == "dots":
        u, w = (lon / 512 * 8) % 1.0 - 0.5, (lat / 256 * 5) % 1.0 - 0.5
        number = ((u**2 + w**2) < 0.09).astype(int)
    else:
        number = ((lon * 8 // 512) + (lat * 5 // 256)) % 2
    for index, one in enumerate(v.colours):
        srgb = srgb_from_linear(np.array(one.surface.base_colour[:3]))
        pixels[number == index, :3] = np.rint(255.0 * srgb)
    skin = printed(f"ball {v.print}", pixels)
    turns = np.linspace(-np.pi / 2, np.pi / 2, 25)
    rows: Floats = np.stack([r * np.cos(turns), r + r * np.sin(turns)], axis=-1)
    rows[[0, -1], 0] = 0.0
    mesh = turned(rows, segments=40)
    # Once around, and once from pole to pole.
    uvs = mesh.uvs.astype(np.float64)
    uvs = (uvs - uvs.min(axis=0)) / np.maximum(np.ptp(uvs, axis=0), 1e-9)
    mesh = type(mesh)(
        positions=mesh.positions, normals=mesh.normals,
        uvs=uvs[:, ::-1].astype(np.float32), triangles=mesh.triangles,
    )  # fmt: skip
    b.form(skin, mesh, volume=4.0 * np.pi * r**2 * 0.004)


def _rings(b: PieceBuilder, v: Values) -> None:
    """Stack rings of wood on a stick."""
    base, count = v.base, int(v.count)
    foot = turned([(0, 0), (base, 0), (base, 0.008), (0.94 * base, 0.014), (0, 0.014)], segments=32)
    b.form(v.timber, foot)
    z, thick = 0.0145, 0.017
    for number in range(count):
        outer = base * (0.96 - 0.55 * number / count)
        ring = circle(14) * (0.5 * (outer - 0.011), thick / 2) + (0.5 * (outer + 0.011), thick / 2)
        mesh = closed_ring(ring, segments=36)
        colour = v.colours[number % len(v.colours)]
        b.form(colour, mesh, (0.0, 0.0, z))
        z += thick + 0.0005
    stick = turned([(0, 0), (0.0095, 0), (0.008, z - 0.01), (0, z - 0.008)], segments=14)
    b.form(v.timber, stick, (0, 0, 0.012), collides="none")
    head = [(0, 0), (0.014, 0.002), (0.021, 0.016), (0.016, 0.032), (0, 0.038)]
    b.form(b.pick(*v.colours), turned(head, segments=22), (0.0, 0.0, z))


_FURS = tuple(
    fabric(c) for c in ("#8a6238", "#6b4a30", "#c9a878", "#b9b2a6", "#d9d2c4", "#7f8388", "#c9a0a0")
)
_SETS = (
    GAY,
    tuple(wood(n) for n in ("beech", "birch", "walnut", "oak")),
    tuple(lacquer(c) for c in ("#d9b8a4", "#a9b8a0", "#a4b4c0", "#e2d6b8", "#c9a9b4")),
    (GAY[0], GAY[6], GAY[2]),
)
_SHARED = {"colours": Choice(*_SETS), "timber": Choice(wood("beech"), wood("birch"), wood("oak"))}

FAMILY = Family(
    name="toy",
    category="toy",
    least_m=(0.03, 0.03, 0.05),
    most_m=(1.0, 0.9, 1.0),
    styles={
        "teddy": Style(
            _teddy,
            {
                "size": Span(0.26, 0.46),
                "fur": Choice(*_FURS),
                "pale": Choice(fabric("#e2d2b4"), fabric("#efe8da"), fabric("#d9b9a6")),
                "jumper": Choice(*FABRICS),
                "dressed": Choice(True, False),
                "ribbon": Choice(True, False),
                "ears": Choice("round", "round", "long", "pointed"),
            },
            "teddy bear",
        ),
        "blocks": Style(
            _blocks,
            {
                **_SHARED,
                "block": Span(0.034, 0.046),
                "rows": Whole(2, 4),
                "plan": Choice("tower", "gate", "castle"),
            },
        ),
        "train": Style(train, {**_SHARED, "gauge": Span(0.06, 0.085), "wagons": Whole(1, 3)}),
        "car": Style(
            car,
            {
                "gauge": Span(0.07, 0.12),
                "paint": Choice(*GAY),
                "second": Choice(*GAY, metal("chrome")),
                "body": Choice("car", "van", "lorry"),
            },
        ),
        "ball": Style(
            _ball,
            {
                "radius": Span(0.06, 0.13),
                "print": Choice("beach", "bands", "dots", "checks"),
                "colours": Choice(
                    *(tuple(GAY[(k + i) % 8] for i in range(2)) for k in range(8)), GAY[:4]
                ),
            },
            "sports ball",
        ),
        "rings": Style(_rings, {**_SHARED, "base": Span(0.055, 0.075), "count": Whole(5, 7)}),
        "house": Style(
            dolls_house,
            {
                "depth": Span(0.26, 0.32),
                "width": Span(0.48, 0.62),
                "height": Span(0.6, 0.8),
                "floors": Whole(2, 2),
                "wall": Choice(*(lacquer(c) for c in ("#e6dfd0", "#d9b8a4", "#a4b4c0", "#b8c4a8"))),
                "trim": Choice(lacquer("#f2eee4"), lacquer("#54616b")),
                "roof": Choice(lacquer("#8a3b32"), lacquer("#4a5560"), wood("oak")),
                "timber": wood("birch"),
            },
        ),
    },
)
