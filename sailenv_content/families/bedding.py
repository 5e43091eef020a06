"""Bedding: a mattress, a duvet that hangs over its sides, pillows at the head, which is at -x."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial, fabric
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import Floats, cushion
from sailenv_content.families.upholstery import pad
from sailenv_content.procedural.forms import loft
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["LINENS", "bedding", "draped", "throw_over_arm"]

LINENS = tuple(
    fabric(c)
    for c in (
        "#e9e5dc",
        "#c9d2d6",
        "#8fa0a8",
        "#b9a892",
        "#566273",
        "#a8715c",
        "#7f8f7a",
        "#d9b9a6",
        "#3f4650",
    )
)
WHITE = fabric("#eeebe4")


def draped(
    b: PieceBuilder,
    length: float,
    width: float,
    *,
    hang: float,
    thick: float = 0.025,
    puff: float = 0.03,
    tile_m: float = 0.06,
) -> Mesh:
    """Return a cover over a bed, its lower side at z = 0 and its sides hanging down, with folds.

    Parameters
    ----------
    length, width : float
        Along x, and of what it lies on along y [m].
    hang : float
        By which its sides hang down [m].
    """
    rows, columns = 25, 33
    x = np.linspace(-length / 2.0, length / 2.0, rows)
    half, corner = width / 2.0, 0.04
    path = np.linspace(-1.0, 1.0, columns) * (half + hang)
    over = np.clip(np.abs(path) - (half - corner), 0.0, None)
    turn = np.clip(over / (1.57 * corner), 0.0, 1.0) * np.pi / 2.0
    down = np.clip(over - 1.57 * corner, 0.0, None)
    flat = np.minimum(np.abs(path), half - corner) + corner * np.sin(turn)
    y, z = np.sign(path) * flat, -corner * (1.0 - np.cos(turn)) - down
    normal = np.stack([np.sign(path) * np.sin(turn), np.cos(turn)], -1)
    folds = _folds(b, x, path)
    hanging = np.clip(down / 0.12, 0.0, 1.0)
    lift = thick + puff * (1.0 - (np.abs(path) / (half + hang)) ** 4) + 0.012 * folds
    lift = lift + 0.018 * hanging * (1.0 + np.sin(x[:, None] * 21.0 + folds * 3.0))
    near_end = np.minimum(np.arange(rows), np.arange(rows)[::-1])[:, None]
    lift = thick * 0.6 + (lift - thick * 0.6) * np.clip(near_end / 1.5, 0.0, 1.0)
    rings = np.empty((rows, 2 * columns, 3))
    rings[:, :, 0] = x[:, None]
    low = 0.001
    rings[:, :columns, 1] = y + low * normal[:, 0]
    rings[:, :columns, 2] = z + low * normal[:, 1]
    rings[:, columns:, 1] = (y + lift * normal[:, 0])[:, ::-1]
    rings[:, columns:, 2] = (z + lift * normal[:, 1])[:, ::-1]
    raw = loft(rings)
    across = np.concatenate([path, path[::-1], path[:1]])
    uvs = np.empty((len(raw.positions), 2))
    uvs[:, 0] = raw.positions[:, 0] / tile_m
    uvs[: rows * len(across), 1] = np.tile(across, rows) / tile_m
    uvs[rows * len(across) :, 1] = 0.0
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 60.0)


def _folds(b: PieceBuilder, x: Floats, y: Floats) -> Floats:
    """Return (len(x), len(y)) of smooth noise, about -1 to 1."""
    total = np.zeros((len(x), len(y)))
    for _ in range(7):
        along, across = b.rng.uniform(-9.0, 9.0, 2)
        total += np.sin(along * x[:, None] + across * y[None, :] + b.between(0.0, 6.28))
    return total / 4.0


def throw_over_arm(b: PieceBuilder, v: Values, width: float) -> None:
    """Lay a throw over an arm of a seat that has one, tucked in beside the seat."""
    if v.all.get("throw") is None:
        return
    with b.part("throw", "blanket"):
        sign, long = b.pick(-1.0, 1.0), b.between(0.3, 0.42)
        mesh = draped(b, long, v.arm + 0.014, hang=0.7 * v.arm_height, thick=0.008, puff=0.006)
        at = (0.1 * v.depth, sign * (width - v.arm) / 2, v.arm_height + 0.006)
        b.form(v.throw, mesh, at, collides="none")


def bedding(
    b: PieceBuilder,
    on: Box,
    *,
    thick: float,
    cover: PieceMaterial,
    pillow: PieceMaterial,
    throw: PieceMaterial | None = None,
    hang: float = 0.16,
) -> None:
    """Lay a mattress, pillows, a duvet and sometimes a throw on the floor of a hollow.

    Parameters
    ----------
    on : Box
        Where the mattress lies: along x and y; its lower side is what it lies on.
    thick : float
        Of the mattress [m].
    hang : float
        By which the duvet hangs over its sides [m]; 0 where boards are at its sides.
    """
    length, width = float(on.size[0]), float(on.size[1])
    x, y, base = float(on.middle[0]), float(on.middle[1]), float(on.low[2])
    top = base + thick
    size = (length, width, thick)
    pad(b, WHITE, size, (x, y, base + thick / 2.0), puff=0.006, radius=0.045)
    count = 2 if width > 1.15 else 1
    wide = min(0.72, width / count - 0.06)
    for number in range(count):
        with b.part("pillow", "pillow"):
            at_y = y + (number - (count - 1) / 2.0) * width / count + b.between(-0.015, 0.015)
            turn = (0.0, 14.0 + b.between(-3.0, 3.0), b.between(-4.0, 4.0))
            at = (on.low[0] + 0.27, at_y, top + 0.085)
            mesh = cushion(
                (0.46, wide, 0.09), radius=0.04, puff=0.055, tile_m=0.06, steps=10, pinch=0.8
            )
            b.form(pillow, mesh, at, turn=turn, collides="none")
    tail = 0.03 if hang else 0.01
    reach = length * b.between(0.64, 0.7) + tail
    middle = x + length / 2.0 + tail - reach / 2.0
    side = hang if hang else 0.0
    inner = width if hang else width - 0.02
    with b.part("duvet", "blanket"):
        b.form(cover, draped(b, reach, inner, hang=side), (middle, y, top + 0.006), collides="none")
        if b.chance(0.7):  # turned back at its head end
            fold = b.between(0.22, 0.34)
            mesh = draped(b, fold, inner + 0.05, hang=side * 0.96, thick=0.02, puff=0.015)
            at = (middle - reach / 2.0 + fold / 2.0 - 0.02, y, top + 0.038)
            b.form(b.pick(cover, WHITE, pillow), mesh, at, collides="none")
    if throw is not None:
        with b.part("throw", "blanket"):
            long = b.between(0.38, 0.55)
            mesh = draped(b, long, inner + 0.07, hang=side * 1.1, thick=0.012, puff=0.02)
            at = (x + length / 2.0 - long / 2.0 - 0.14, y, top + 0.062)
            b.form(throw, mesh, at, collides="none")
