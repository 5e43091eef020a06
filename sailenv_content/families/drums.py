"""Drums of washing machines: hollow, with laundry in them, behind a round opening."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import CLOTHES
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import vessel
from sailenv_content.families.materials import fabric, metal
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import cushion, placed
from sailenv_content.procedural.forms import loft
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["STEEL", "drum", "front_with_hole"]

STEEL = metal("steel", 1500.0)

BEVEL_M = 0.002


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
    """Add a front around a round opening: one sheet, so that no seams are seen."""
    size, mid = panel.size, panel.middle
    half = radius + 0.012
    wide = size[1] / 2 - half
    for sign in (-1.0, 1.0):
        b.collide((size[0], wide, size[2]), (mid[0], sign * (half + wide / 2), mid[2]))
    for low, high in ((panel.low[2], z - half), (z + half, panel.high[2])):
        b.collide((size[0], 2 * half, high - low), (mid[0], 0.0, (low + high) / 2))
    corners = np.array([panel.low, panel.high])[:, 1:] - (0.0, z)
    mesh = _sheet_with_hole(corners, radius, float(size[0]))
    # Its x and y become y and z.
    mesh = placed(placed(mesh, turn_deg=(90.0, 0.0, 0.0)), turn_deg=(0.0, 0.0, 90.0))
    b.form(v.body, mesh, (panel.low[0], 0.0, z), collides="none")


def _sheet_with_hole(corners: np.ndarray, radius: float, thickness: float) -> Mesh:
    """Return a rectangle in x and y, from the lowest to the highest corner, around a circle."""
    around = corners[[0, 1, 1, 0], 0], corners[[0, 0, 1, 1], 1]
    # None of them is that of a corner.
    even = np.linspace(-np.pi, np.pi, 40, endpoint=False) + 0.0123
    turns = np.sort(np.concatenate([even, np.arctan2(*around[::-1])]))
    out = np.stack([np.cos(turns), np.sin(turns)], axis=-1)

    def rectangle(inset: float) -> np.ndarray:
        reach = np.where(out < 0.0, corners[0] + inset, corners[1] - inset)
        nearest = np.abs(reach) / np.maximum(np.abs(out), 1e-9)
        return np.asarray(out * nearest.min(axis=1, keepdims=True))

    rows = [
        (rectangle(0.0), 0.0),
        (rectangle(0.0), thickness - BEVEL_M),
        (rectangle(BEVEL_M), thickness),
        (out * (radius + BEVEL_M), thickness),
        (out * radius, thickness - BEVEL_M),
        (out * radius, 0.0),
    ]
    rings = np.array([np.column_stack([flat, np.full(len(flat), up)]) for flat, up in rows])
    raw = loft(np.concatenate([rings, rings[:1]]), caps=False)
    uvs = raw.positions[:, :2] + raw.positions[:, 2:]
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 30.0)


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
