"""Houses for dolls: rooms with furniture behind a front that opens, a roof."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.fronts import CLEARANCE_M
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import paint
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import extruded, placed, turned
from sailenv_content.families.toys import GAY

__all__ = ["dolls_house"]


def dolls_house(b: PieceBuilder, v: Values) -> None:
    """Build a house of dolls: floors with furniture behind two leaves that open, a roof."""
    d, w, h, wall = v.depth, v.width, v.height, 0.01
    body = 0.68 * h
    for sign in (-1.0, 1.0):
        b.box(v.wall, (d, wall, body), (0.0, sign * (w - wall) / 2, body / 2), bevel=0.001)
    b.box(v.wall, (wall, w - 2 * wall, body), (-d / 2 + wall / 2, 0.0, body / 2), bevel=0.001)
    levels = np.linspace(0.0, body - wall, int(v.floors) + 1)
    for z in levels:
        b.box(v.timber, (d - wall, w - 2 * wall, wall), (wall / 2, 0.0, z + wall / 2), bevel=0.001)
    tall = float(levels[1] - levels[0] - wall)
    for low in levels[:-1]:
        split = b.between(-0.1, 0.1) * w
        b.box(v.wall, (d - 0.03, 0.006, tall), (-0.004, split, low + wall + tall / 2), bevel=0.001)
        for y in (split / 2 - w / 4, split / 2 + w / 4):
            _furnish(b, y, float(low) + wall, tall, d)
    slope = np.array([(-0.54 * w, 0.0), (0.54 * w, 0.0), (0.0, h - body)])
    gable = placed(extruded(slope * (0.86, 0.86), d - 0.01, bevel=0.001), turn_deg=(90, 0, 0))
    gable = placed(gable, turn_deg=(0, 0, 90))
    b.form(v.wall, gable, (-d / 2, 0.0, body))
    angle = float(np.degrees(np.arctan2(h - body, 0.5 * w)))
    length = float(np.hypot(h - body, 0.58 * w))
    for sign in (-1.0, 1.0):
        at = (0.0, sign * 0.27 * w, body + 0.46 * (h - body) + 0.012)
        b.box(v.roof, (d + 0.03, length, 0.012), at, turn=(-sign * angle, 0, 0), bevel=0.003)
    b.box(v.roof, (0.05, 0.05, 0.1), (-0.08, 0.24 * w, h - 0.05), bevel=0.002)
    front = Box((d / 2 + 0.001, -w / 2, 0.002), (d / 2 + 0.011, w / 2, body - 0.004)).inset(0.001)
    for name, leaf in zip(
        ("right front", "left front"), front.columns([1.0, 1.0], CLEARANCE_M), strict=True
    ):
        left = name == "left front"
        at = (leaf.high[0], leaf.high[1] if left else leaf.low[1], leaf.middle[2])
        axis = (0.0, 0.0, 1.0 if left else -1.0)
        with b.hinge(name, "door", at=at, axis=axis, opens_deg=115.0, friction=0.08):
            b.box(v.wall, leaf.size, leaf.middle, bevel=0.001)
            x = float(leaf.high[0]) + 0.001
            for low in levels[:-1]:
                for share in (0.3, 0.72):
                    y = leaf.low[1] + share * leaf.size[1]
                    z = low + 0.55 * tall + wall
                    b.box(
                        v.trim, (0.005, 0.062, 0.5 * tall), (x, y, z), bevel=0.001, collides=False
                    )
                    b.box(
                        paint("#7fa6b8", 0.1),
                        (0.006, 0.05, 0.5 * tall - 0.012),
                        (x, y, z),
                        bevel=0.001,
                        collides=False,
                    )
                    b.box(
                        v.trim, (0.0068, 0.004, 0.5 * tall), (x, y, z), bevel=0.0005, collides=False
                    )
                    b.box(v.trim, (0.0068, 0.05, 0.004), (x, y, z), bevel=0.0005, collides=False)
            side = leaf.low[1] + 0.014 if left else leaf.high[1] - 0.014
            knob = turned([(0, 0), (0.004, 0.0), (0.006, 0.008), (0, 0.011)], segments=12)
            b.form(v.trim, knob, (leaf.high[0], side, 0.5 * body), turn=(0, 90, 0), collides="none")


def _furnish(b: PieceBuilder, y: float, z: float, tall: float, d: float) -> None:
    """Put a bed, or a table with chairs, or a cupboard into a room of a doll's house."""
    kind, one, two = b.pick("bed", "table", "cupboard"), b.pick(*GAY), b.pick(*GAY)
    if kind == "bed":
        b.box(one, (0.15, 0.09, 0.03), (-0.02, y, z + 0.022), bevel=0.003, collides=False)
        b.box(GAY[6], (0.14, 0.084, 0.016), (-0.02, y, z + 0.045), bevel=0.005, collides=False)
        b.box(two, (0.09, 0.088, 0.014), (0.01, y, z + 0.052), bevel=0.005, collides=False)
        b.box(one, (0.008, 0.09, 0.075), (-0.098, y, z + 0.0375), bevel=0.002, collides=False)
        foot = (0.14, 0.08, 0.01)
        b.box(one, foot, (-0.02, y, z + 0.005), bevel=0.001, collides=False)
    elif kind == "table":
        top = turned([(0, 0), (0.05, 0), (0.05, 0.006), (0, 0.006)], segments=20)
        b.form(one, top, (0.0, y, z + 0.055), collides="none")
        post = turned([(0, 0), (0.026, 0), (0.01, 0.012), (0.008, 0.056), (0, 0.056)], segments=14)
        b.form(one, post, (0.0, y, z), collides="none")
        for sx in (-1.0, 1.0):
            seat = (0.035, 0.035, 0.034)
            b.box(two, seat, (sx * 0.072, y, z + 0.017), bevel=0.002, collides=False)
    else:
        size = (0.05, 0.09, min(0.12, 0.8 * tall))
        at = (-d / 2 + 0.04, y, z + size[2] / 2)
        b.box(one, size, at, bevel=0.002, collides=False)
        for sy in (-1.0, 1.0):
            door = (0.004, 0.04, size[2] - 0.01)
            b.box(two, door, (at[0] + 0.026, y + sy * 0.021, at[2]), bevel=0.001, collides=False)
