"""Cloth that hangs: sheets in folds, of any outline, and the rods that carry them.

Measures in [m] in, closed `Mesh`es out, in the frame of what carries them: x out of the wall, y
along it, z up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.lathe import closed_ring
from sailenv_content.families.materials import PieceMaterial
from sailenv_content.families.shaping import placed, swept, turned
from sailenv_content.procedural.forms import circle, loft
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["fringe", "hanging", "hoop", "rod", "straight"]


def hanging(
    rows: ArrayLike,
    *,
    folds: float,
    depth: float,
    top_depth: float,
    phase: float = 0.0,
    wander: float = 0.5,
    thick: float = 0.003,
    tile_m: float = 0.06,
) -> Mesh:
    """Return a sheet in folds, around x = 0.

    Parameters
    ----------
    rows : (N, 3) array-like
        From its foot up: height, place of its middle along y, and width there [m].
    folds : float
        How many.
    depth, top_depth : float
        Of the folds at its foot and at its top, to each side of the middle [m].
    phase : float
        Of the first fold [rad].
    wander : float
        By how much folds differ from one another; 0 for folds that are held.
    """
    z, middle, width = np.asarray(rows, np.float64).T
    share = np.linspace(0.0, 1.0, max(9, round(10 * folds) + 1))
    fall = ((z.max() - z) / max(float(np.ptp(z)), 1e-9))[:, None]
    swing = wander * np.sin(2.3 * fall + 5.0 * share + phase) * fall
    turn = 2.0 * np.pi * folds * share + phase + swing
    reach = top_depth + (depth - top_depth) * fall**0.7
    reach = reach * (1.0 + 0.3 * wander * np.sin(7.0 * share + phase))
    x = reach * np.sin(turn)
    # Folds bulge a little beyond half a period, as cloth does.
    y = middle[:, None] + width[:, None] * (share - 0.5) - 0.25 * reach * np.sin(2.0 * turn)
    ahead = np.stack([np.gradient(x, axis=1), np.gradient(y, axis=1)], axis=-1)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=-1, keepdims=True), 1e-9)
    out = np.stack([ahead[..., 1], -ahead[..., 0]], axis=-1) * (0.5 * thick)
    flat = np.stack([x, y], axis=-1)
    rings = np.empty((len(z), 2 * len(share), 3))
    rings[:, : len(share), :2] = flat + out
    rings[:, len(share) :, :2] = (flat - out)[:, ::-1]
    rings[..., 2] = z[:, None]
    raw = loft(rings, caps=False)
    length = float(np.linalg.norm(np.diff(flat[0], axis=0), axis=1).sum())
    across = np.concatenate([share, share[::-1], share[:1]]) * length
    uvs = np.stack([np.tile(across, len(z)), raw.positions[:, 2]], axis=-1) / tile_m
    # Both ends are strips between front and back: a fan would leave the sheet.
    front = np.arange(len(share) - 1)
    back = 2 * len(share) - 1 - front
    strip = [[front, front + 1, back - 1], [front, back - 1, back]]
    end = np.concatenate([np.stack(three, axis=-1) for three in strip])
    upper = end + (len(z) - 1) * len(across)
    triangles = np.concatenate([raw.triangles, end[:, ::-1], upper])
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=triangles), 65.0)


def straight(low: float, high: float, middle: float, width: float, count: int = 9) -> np.ndarray:
    """Return (count, 3) rows of a sheet that is as wide everywhere; see `hanging`."""
    z = np.linspace(low, high, count)
    return np.stack([z, np.full(count, middle), np.full(count, width)], axis=-1)


def hoop(radius: float, thick: float, *, segments: int = 16) -> Mesh:
    """Return a ring about the y axis, around the origin."""
    mesh = closed_ring(circle(8) * thick + (radius, 0.0), segments=segments)
    return placed(mesh, turn_deg=(90.0, 0.0, 0.0))


def fringe(
    b: PieceBuilder, material: PieceMaterial, ends: np.ndarray, out: tuple[float, float]
) -> None:
    """Add threads from points (N, 3) that lie down on the floor, by a vector in x and y [m]."""
    for point in ends:
        aside = b.between(-0.006, 0.006)
        tip = point + np.array([out[0] + aside, out[1] + aside, 0.0])
        path = [point, (point + tip) / 2 + (0.0, 0.0, 0.001), (tip[0], tip[1], 0.003)]
        b.form(material, swept(path, 0.003, sides=4), collides="none", volume=1e-7)


def rod(
    b: PieceBuilder,
    material: PieceMaterial,
    width: float,
    x: float,
    z: float,
    *,
    radius: float = 0.011,
    ends: str = "ball",
    brackets: bool = True,
) -> None:
    """Add a rod along y with knobs at its ends, on two arms from the wall."""
    half = width / 2.0
    b.form(material, swept([(x, -half, z), (x, half, z)], radius, sides=14))
    r = 2.0 * radius
    profiles = {
        "ball": [(0, -r), (0.6 * r, -0.8 * r), (r, 0), (0.6 * r, 0.8 * r), (0, r)],
        "cap": [(0, -0.2 * r), (0.75 * r, -0.2 * r), (0.75 * r, 0.9 * r), (0, 0.9 * r)],
        "spear": [(0, -0.2 * r), (0.8 * r, 0), (0.45 * r, 0.4 * r), (0.8 * r, r), (0, 3.2 * r)],
        "disc": [(0, 0), (1.3 * r, 0), (1.3 * r, 0.35 * r), (0, 0.35 * r)],
    }
    knob = turned(profiles[ends], segments=18)
    for sign in (-1.0, 1.0):
        at = (x, sign * (half + 0.3 * radius), z)
        b.form(material, knob, at, turn=(-90.0 * sign, 0.0, 0.0))
        if brackets:
            y = sign * (half - 0.03)
            arm = [(0.004, y, z - 0.02), (0.6 * x, y, z - 0.018), (x, y, z - 0.5 * radius)]
            b.form(material, swept(arm, 0.006, sides=8), collides="none")
            plate = turned([(0, 0), (0.02, 0), (0.02, 0.005), (0, 0.006)], segments=16)
            b.form(material, plate, (0.0, y, z - 0.02), turn=(0.0, 90.0, 0.0))
