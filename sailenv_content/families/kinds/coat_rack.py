"""Coat racks: hooks on a board, a stand like a tree, a rail on wheels, a hall panel; with coats."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import CLOTHES, hung_clothes
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import WOODS, PieceMaterial, fabric, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import swept, turned
from sailenv_content.procedural.forms import curve, loft
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh

__all__ = ["FAMILY"]


def _coat(
    b: PieceBuilder, x: float, y: float, z: float, tall: float, *, yaw_deg: float = 0.0
) -> None:
    """Hang a coat by its collar, its back to where x comes from."""
    rows, wide = 9, b.between(0.2, 0.25)
    t = np.linspace(0.0, 1.0, rows)
    half = np.interp(t, [0, 0.06, 0.14, 0.5, 1.0], [0.03, 0.07, 0.75, 0.8, 1.0]) * wide
    deep = np.interp(t, [0, 0.1, 0.5, 1.0], [0.025, 0.045, 0.06, 0.075])
    turn = np.linspace(0.0, 2 * np.pi, 28, endpoint=False)
    folds = 1.0 + 0.16 * t[:, None] * np.sin(7 * turn + b.between(0.0, 6.0))
    rings = np.empty((rows, 28, 3))
    rings[..., 0] = deep[:, None] * (np.cos(turn) + 0.75) * folds
    rings[..., 1] = half[:, None] * np.sin(turn) * (0.9 + 0.1 * folds)
    rings[..., 2] = -tall * t[:, None]
    raw = loft(rings[::-1])
    cloth = fabric(b.pick(*CLOTHES))
    uvs = raw.uvs * np.array([4.0 * wide, tall]) / cloth.tile_m
    mesh = smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 70.0)
    with b.frame((x, y, z), yaw_deg), b.part("coat", "clothes"):
        b.form(cloth, mesh, collides="none", volume=0.012)


def _hook(b: PieceBuilder, material: PieceMaterial, x: float, y: float, z: float) -> None:
    """Add a bent hook on a face at x."""
    path = curve(
        [(x, y, z), (x + 0.03, y, z - 0.015), (x + 0.055, y, z), (x + 0.062, y, z + 0.035)], 10
    )
    b.form(material, swept(path, 0.005, sides=8))
    plate = [(0, 0), (0.014, 0), (0.014, 0.004), (0, 0.005)]
    b.form(material, turned(plate, segments=14), (x, y, z), turn=(0, 90, 0), collides="none")
    tip = [(0, 0), (0.007, 0.003), (0.009, 0.009), (0, 0.016)]
    b.form(material, turned(tip, segments=12), (x + 0.062, y, z + 0.032), collides="none")


def _board(b: PieceBuilder, v: Values) -> None:
    """Make hooks or pegs on a board on the wall, with a shelf for hats above."""
    w = v.width
    coats = [b.between(0.7, 1.0) if b.chance(0.45) else 0.0 for _ in range(v.hooks)]
    low = max(*coats, 0.055) - 0.055  # what hangs from it reaches down to the origin
    board = (0.022, w, 0.11)
    b.box(v.material, board, (0.011, 0.0, low + 0.055), bevel=0.004)
    for number in range(v.hooks):
        y = (number + 0.5) / v.hooks * w - w / 2
        if v.pegs:
            peg = [(0.022, y, low + 0.05), (0.1, y, low + 0.066)]
            b.form(v.material, swept(peg, (0.009, 0.012), sides=12))
        else:
            _hook(b, v.metal, 0.022, y, low + 0.05)
        if coats[number]:
            _coat(b, 0.045, y, low + 0.055, coats[number])
    if v.shelf:
        b.box(v.material, (0.24, w, 0.02), (0.12, 0.0, low + 0.12))


def _tree(b: PieceBuilder, v: Values) -> None:
    """Make a pole with arms at its top, and a foot."""
    h = v.height
    if v.bent:
        for k in range(4):
            a = k * np.pi / 2
            c, s = np.cos(a), np.sin(a)
            foot = curve(
                [(0.0, 0.0, 0.3), (0.1 * c, 0.1 * s, 0.14), (0.28 * c, 0.28 * s, 0.012)], 12
            )
            b.form(v.material, swept(foot, 0.012, sides=10))
    else:
        base = [(0, 0), (0.19, 0), (0.19, 0.012), (0.17, 0.024), (0.03, 0.03), (0, 0.03)]
        b.form(v.metal, turned(base, segments=36))
    low = 0.02 if not v.bent else 0.26
    b.form(v.material, swept([(0, 0, low), (0, 0, h)], 0.016, sides=14, tile_m=v.material.tile_m))
    knob = [(0, 0), (0.02, 0.005), (0.026, 0.025), (0.016, 0.045), (0, 0.05)]
    b.form(v.material, turned(knob, segments=18), (0, 0, h - 0.005))
    for k in range(v.arms):
        a = 2 * np.pi * k / v.arms
        c, s = np.cos(a), np.sin(a)
        z = h - 0.12 - 0.16 * (k % 2)
        arm = curve(
            [
                (0.01 * c, 0.01 * s, z - 0.04),
                (0.1 * c, 0.1 * s, z - 0.02),
                (0.17 * c, 0.17 * s, z + 0.06),
            ],
            9,
        )
        b.form(v.material, swept(arm, np.linspace(0.011, 0.008, 9), sides=9))
        if b.chance(0.35):
            tall = b.between(0.7, 1.0)
            _coat(b, 0.1 * c, 0.1 * s, z - 0.01, tall, yaw_deg=float(np.degrees(a)))


def _rail(b: PieceBuilder, v: Values) -> None:
    """Make a rail between two frames on wheels, with clothes and a shelf for shoes."""
    w, h, d = v.width, v.height, 0.42
    for sy in (-1.0, 1.0):
        y = sy * (w / 2 - 0.012)
        b.form(v.metal, swept([(0, y, 0.08), (0, y, h)], 0.012, sides=12))
        b.form(v.metal, swept([(-d / 2, y, 0.075), (d / 2, y, 0.075)], 0.012, sides=12))
        for sx in (-1.0, 1.0):
            wheel = [(0, -0.01), (0.026, -0.01), (0.03, 0.0), (0.026, 0.01), (0, 0.01)]
            b.form(
                paint("#232326", 0.5),
                turned(wheel, segments=18),
                (sx * (d / 2 - 0.02), y, 0.03),
                turn=(90, 0, 0),
            )
            stem = [(sx * (d / 2 - 0.02), y, 0.03), (sx * (d / 2 - 0.02), y, 0.075)]
            b.form(v.metal, swept(stem, 0.006, sides=8), collides="none")
    b.form(v.metal, swept([(0, -w / 2 + 0.01, h), (0, w / 2 - 0.01, h)], 0.012, sides=12))
    for k in range(4):
        x = (k + 0.5) / 4 * d - d / 2
        b.box(v.material, (0.07, w - 0.05, 0.014), (x, 0.0, 0.097))
    room = Box((-0.24, -w / 2 + 0.03, 0.3), (0.24, w / 2 - 0.03, h + 0.06))
    hung_clothes(b, room, rail=False)


def _hall(b: PieceBuilder, v: Values) -> None:
    """Make a tall panel of slats with hooks, a seat below and a shelf above."""
    w, h = v.width, v.height
    count = max(5, round(w / 0.11))
    for number in range(count):
        y = (number + 0.5) / count * w - w / 2
        b.box(v.material, (0.02, w / count - 0.014, h), (0.012, y, h / 2), collides=False)
    for z in (0.3, h - 0.3):
        b.box(v.material, (0.012, w, 0.06), (0.0, 0.0, z))
    b.collide((0.024, w, h), (0.012, 0.0, h / 2))
    b.box(v.material, (0.3, w, 0.028), (0.172, 0.0, h - 0.02))
    b.box(v.material, (0.36, w, 0.036), (0.202, 0.0, 0.44), bevel=0.006)
    for sy in (-1.0, 1.0):
        b.box(v.material, (0.34, 0.03, 0.42), (0.19, sy * (w / 2 - 0.03), 0.21))
    for number in range(v.hooks):
        y = (number + 0.5) / v.hooks * w - w / 2
        _hook(b, v.metal, 0.022, y, h - 0.3)
        if b.chance(0.5):
            _coat(b, 0.04, y, h - 0.3, b.between(0.7, 0.9))


_SHARED = {
    "width": Span(0.6, 1.0),
    "height": Span(1.65, 1.85),
    "hooks": Whole(4, 6),
    "material": Choice(*WOODS, paint("#e9e6df"), paint("#33373b")),
    "metal": Choice(metal("#232326"), metal("brass"), metal("chrome")),
}

FAMILY = Family(
    name="coat_rack",
    category="coat rack",
    least_m=(0.06, 0.3, 0.1),
    most_m=(0.9, 1.5, 2.1),
    styles={
        "hooks": Style(_board, {**_SHARED, "pegs": False, "shelf": Choice(True, False)}),
        "pegs": Style(_board, {**_SHARED, "pegs": True, "shelf": Choice(True, False)}),
        "tree": Style(
            _tree,
            {
                **_SHARED,
                "arms": Whole(6, 8),
                "bent": Choice(True, False),
                "material": Choice(*WOODS, metal("#232326")),
            },
        ),
        "rail": Style(_rail, {**_SHARED, "width": Span(0.9, 1.3), "height": Span(1.45, 1.65)}),
        "hall": Style(_hall, _SHARED),
    },
)
