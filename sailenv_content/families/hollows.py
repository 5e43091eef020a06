"""Collision of what is hollow: walls in sectors and a floor, so that things can lie inside.

A `PieceBuilder` and the measures by which a vessel or a tub is drawn in [m] in; hulls are added to
the part that it is at.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.shaping import Floats

__all__ = ["tub_walls", "vessel_walls"]


def vessel_walls(
    b: PieceBuilder,
    outside: ArrayLike,
    *,
    wall: float,
    floor: float,
    at: ArrayLike = (0.0, 0.0, 0.0),
    oval: float = 1.0,
    sectors: int = 10,
    bands: int = 2,
) -> None:
    """Let a vessel collide; see `lathe.vessel`.

    Parameters
    ----------
    outside : (N, 2) array-like
        Radius and height of its outer side, from its base up.
    floor : float
        Height of its inner floor above its base.
    at : (3,) array-like
        Where its frame's origin is.
    oval : float
        Its size along y against that along x.
    sectors, bands : int
        Into how many hulls its wall is divided, around and upwards.
    """
    rows = np.asarray(outside, np.float64)
    place, stretch = np.asarray(at, np.float64), np.array([1.0, oval, 1.0])
    base, top = float(rows[0, 1]), float(rows[-1, 1])
    inner_z = base + floor

    def ring(z: float, inset: float, turns: Floats) -> Floats:
        radius = max(float(np.interp(z, rows[:, 1], rows[:, 0])) - inset, 1e-3)
        return np.stack(
            [radius * np.cos(turns), radius * np.sin(turns), np.full(len(turns), z)], axis=-1
        )

    around = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    whole = np.linspace(0.0, 2.0 * np.pi, 2 * sectors, endpoint=False)
    heights = [*rows[rows[:, 1] < inner_z, 1].tolist(), inner_z]
    solid = np.concatenate([ring(z, 0.0, whole) for z in heights])
    b.collide_points(solid * stretch + place)
    for low, high in pairwise(np.linspace(inner_z, top, bands + 1).tolist()):
        for first, last in pairwise(around.tolist()):
            turns = np.array([first, (first + last) / 2.0, last])
            points = [ring(z, inset, turns) for z in (low, high) for inset in (0.0, wall)]
            b.collide_points(np.concatenate(points) * stretch + place)


def tub_walls(
    b: PieceBuilder,
    size: tuple[float, float, float],
    *,
    wall: float,
    floor: float,
    taper: float = 0.0,
    slope: float = 0.04,
    at: ArrayLike = (0.0, 0.0, 0.0),
) -> None:
    """Let a tub collide as a floor and four walls; see `plumbing.tub`."""
    place = np.asarray(at, np.float64)
    depth, width, height = size

    def corner(sx: float, sy: float, inset: float, z: float) -> Floats:
        return np.array([sx * (depth / 2.0 - inset), sy * (width / 2.0 - inset), z]) + place

    signs = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
    b.collide_points(np.array([corner(x, y, taper, z) for x, y in signs for z in (0.0, floor)]))
    for first, last in zip(signs, [*signs[1:], signs[0]], strict=True):
        ends = (first, last)
        outer = [
            corner(x, y, inset, z) for x, y in ends for inset, z in ((taper, 0.0), (0.0, height))
        ]
        inner = [
            corner(x, y, inset, z)
            for x, y in ends
            for inset, z in ((wall + slope, floor), (wall, height))
        ]
        b.collide_points(np.array([*outer, *inner]))
