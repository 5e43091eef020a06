"""Drums of washing machines: hollow, with laundry in them, behind a round opening."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import CLOTHES
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import vessel
from sailenv_content.families.materials import fabric, metal
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import cushion, extruded, placed

__all__ = ["STEEL", "drum", "front_with_hole"]

STEEL = metal("steel", 1500.0)


def _ring_of_boxes(b: PieceBuilder, radius: float, length: float, x: float, z: float) -> None:
    """Let the wall of a drum that lies along x collide, so that it stays hollow."""
    count, thick = 12, 0.012
    wide = 2.0 * (radius + thick) * np.tan(np.pi / count)
    for number in range(count):
        turn = 2.0 * np.pi * number / count
        out = radius + thick / 2
        at = (x, out * np.sin(turn), z + out * np.cos(turn))
        b.collide((length, wide, thick), at, (-np.degrees(turn), 0.0, 0.0))


def front_with_hole(b: PieceBuilder, v: Values, panel: Box, radius: float, z: float) -> None:
    """Add a front around a round opening: a frame, and corners to a circle."""
    size, mid = panel.size, panel.middle
    half = radius + 0.012
    rest = (size[1] / 2 - half, half)
    for sign in (-1.0, 1.0):
        at = (mid[0], sign * (half + rest[0] / 2), mid[2])
        b.box(v.body, (size[0], rest[0], size[2]), at, bevel=0.002)
    for low, high in ((panel.low[2], z - half), (z + half, panel.high[2])):
        b.box(v.body, (size[0], 2 * half, high - low), (mid[0], 0.0, (low + high) / 2), bevel=0.002)
    # A square with a round hole: each corner between an arc and its two sides.
    for quarter in range(4):
        turns = np.linspace(0.0, np.pi / 2, 11) + quarter * np.pi / 2
        arc = radius * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
        ends = half * np.stack([np.cos(turns[[0, -1]]), np.sin(turns[[0, -1]])], axis=-1)
        corner = ends.sum(axis=0)
        for k in range(10):
            along = np.array([ends[0], ends[0] + (corner - ends[0]), ends[1]])
            first, last = (_square_point(along, (k + s) / 10) for s in (0, 1))
            wedge = np.array([arc[k], first, last, arc[k + 1]])
            mesh = extruded(wedge, size[0], bevel=0.0003)
            # Its x and y become y and z.
            mesh = placed(placed(mesh, turn_deg=(90.0, 0.0, 0.0)), turn_deg=(0.0, 0.0, 90.0))
            b.form(v.body, mesh, (panel.low[0], 0.0, z), collides="none")


def _square_point(corners: np.ndarray, share: float) -> np.ndarray:
    first = min(int(2 * share), 1)
    rest = 2 * share - first
    return np.asarray(corners[first] * (1 - rest) + corners[first + 1] * rest)


def drum(b: PieceBuilder, v: Values, front: float, depth: float, radius: float, z: float) -> None:
    """Add a drum of steel that is open at its front, with ribs, a seal, and clothes in it."""
    inner = vessel([(radius - 0.01, 0.0), (radius, 0.03), (radius, depth)], wall=0.006, segments=36)
    lying = placed(inner, turn_deg=(0.0, 90.0, 0.0))
    with b.part("drum", "washing machine"):
        b.form(STEEL, lying, (front - depth, 0.0, z), collides="none", volume=0.002)
        for number in range(3):
            turn = 2 * np.pi * number / 3 + 0.5
            at = (
                front - depth / 2,
                (radius - 0.028) * np.sin(turn),
                z + (radius - 0.028) * np.cos(turn),
            )
            rib = (0.7 * depth, 0.03, 0.045)
            b.box(STEEL, rib, at, turn=(-np.degrees(turn), 0, 0), bevel=0.012, collides=False)
    _ring_of_boxes(b, radius, depth, front - depth / 2, z)
    b.collide((0.012, 2 * radius, 2 * radius), (front - depth + 0.006, 0.0, z))
    if v.filled:
        with b.part("laundry", "clothes"):
            for number in range(int(b.rng.integers(3, 7))):
                cloth = fabric(b.pick(*CLOTHES))
                size = (b.between(0.14, 0.24), b.between(0.14, 0.22), b.between(0.05, 0.09))
                mesh = cushion(size, radius=0.03, puff=0.02, tile_m=cloth.tile_m, steps=6)
                at = (
                    front - depth / 2 + b.between(-0.06, 0.05),
                    b.between(-0.3, 0.3) * radius,
                    z - 0.66 * radius + 0.035 * number,
                )
                tilt = tuple(b.between(-22.0, 22.0) for _ in range(3))
                b.form(cloth, mesh, at, turn=tilt, collides="none")
