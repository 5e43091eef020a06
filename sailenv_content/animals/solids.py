"""Solids that flow into each other: fields that are negative inside a body, and their union.

A field is a distance only near its surface, which is all that is needed: a mesh is put on the zero
of the union, see J. C. Hart, *Sphere Tracing* (1996), and I. Quilez, *smooth minimum*.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

__all__ = ["Body", "Solid", "ellipsoid", "loft", "tube"]

Doubles = NDArray[np.float64]
Indices = NDArray[np.int64]

_FAR = 1e3
"""Of what is nowhere near a solid [m]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Solid:
    """One solid of a body.

    Attributes
    ----------
    kind : {'ellipsoid', 'tube', 'loft'}
    joint : str
        That carries it.
    blend_m : float
        Width of the fillet where it meets others [m].
    low, high : (3,) float64
        Corners of the box outside of which it is not looked at [m].
    middle : (3,) float64
    axes : (3, 3) float64
        Rows: its own axes.
    sizes : (3,) float64
        Of an ellipsoid: half its lengths along them. Of a loft: 0 and the lengths of its ends.
    knots : (K, 4) float64
        Of a tube: places and radii. Of a loft: x, the middle's z, half the height, half the width.
    flat : float
        Of a tube: thickness across, y, over that along.
    removes : bool
        True carves it out.
    """

    kind: Literal["ellipsoid", "tube", "loft"]
    joint: str
    blend_m: float
    low: Doubles
    high: Doubles
    middle: Doubles = field(default_factory=lambda: np.zeros(3))
    axes: Doubles = field(default_factory=lambda: np.eye(3))
    sizes: Doubles = field(default_factory=lambda: np.zeros(3))
    knots: Doubles = field(default_factory=lambda: np.zeros((0, 4)))
    flat: float = 1.0
    removes: bool = False

    def at(self, points: Doubles) -> Doubles:
        """Return (N,): the field at (N, 3) points [m]."""
        if self.kind == "ellipsoid":
            own = (points - self.middle) @ self.axes.T / self.sizes
            length = np.sqrt(np.einsum("nk,nk->n", own, own))
            # Divided by the gradient's length: a distance near the surface.
            steep = np.linalg.norm(own / self.sizes, axis=1)
            return np.asarray(length * (length - 1.0) / np.maximum(steep, 1e-9), np.float64)
        return self._loft(points) if self.kind == "loft" else self._tube(points)

    def _tube(self, points: Doubles) -> Doubles:
        stretch = np.array([1.0, 1.0 / self.flat, 1.0])
        found = np.full(len(points), _FAR)
        for (*start, first), (*end, last) in zip(
            self.knots[:-1].tolist(), self.knots[1:].tolist(), strict=True
        ):
            begin = np.asarray(start)
            way = (np.asarray(end) - begin) * stretch
            own = (points - begin) * stretch
            share = np.clip(own @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
            off = own - share[:, None] * way
            radius = first + share * (last - first)
            np.minimum(found, np.sqrt(np.einsum("nk,nk->n", off, off)) - radius, out=found)
        return found

    def _loft(self, points: Doubles) -> Doubles:
        x, y, z = points.T
        along = np.clip(x, self.knots[0, 0], self.knots[-1, 0])
        middle, high, wide = (
            np.interp(along, self.knots[:, 0], self.knots[:, k]) for k in (1, 2, 3)
        )
        thin = np.minimum(high, wide)
        end = np.where(x < 0.0, self.sizes[1], self.sizes[2])
        off = ((x - along) / end) ** 2 + ((z - middle) / high) ** 2 + (y / wide) ** 2
        return np.asarray((np.sqrt(off) - 1.0) * thin, np.float64)


def ellipsoid(
    joint: str,
    middle: ArrayLike,
    sizes: ArrayLike,
    blend_m: float,
    *,
    axes: Doubles | None = None,
    removes: bool = False,
) -> Solid:
    """Return an ellipsoid of half lengths along its axes [m]."""
    at, half = np.asarray(middle, float), np.asarray(sizes, float)
    reach = float(half.max()) + blend_m
    return Solid(
        kind="ellipsoid",
        joint=joint,
        blend_m=blend_m,
        low=at - reach,
        high=at + reach,
        middle=at,
        axes=np.eye(3) if axes is None else axes,
        sizes=half,
        removes=removes,
    )


def tube(
    joint: str,
    places: Sequence[ArrayLike],
    radii: Sequence[float],
    blend_m: float,
    flat: float = 1.0,
) -> Solid:
    """Return a chain of round cones through places with radii [m]."""
    knots = np.column_stack([np.asarray(places, float), np.asarray(radii, float)])
    reach = knots[:, 3:] + blend_m
    return Solid(
        kind="tube",
        joint=joint,
        blend_m=blend_m,
        low=(knots[:, :3] - reach).min(axis=0),
        high=(knots[:, :3] + reach).max(axis=0),
        knots=knots,
        flat=flat,
    )


def loft(joint: str, rows: ArrayLike, ends_m: tuple[float, float], blend_m: float) -> Solid:
    """Return ellipses along x, joined smoothly.

    Parameters
    ----------
    rows : (K, 4) floats
        x, the lowest z, the highest z, half the width [m].
    ends_m : (2,) tuple of float
        Lengths of the rounded ends, at the back and at the front [m].
    """
    x, low, high, wide = np.asarray(rows, float).T
    along = np.linspace(x[0], x[-1], 64)
    sections = np.column_stack([0.5 * (low + high), 0.5 * (high - low), wide])
    knots = np.column_stack([along, PchipInterpolator(x, sections)(along)])
    reach = blend_m
    return Solid(
        kind="loft",
        joint=joint,
        blend_m=blend_m,
        low=np.array([x[0] - ends_m[0] - reach, -wide.max() - reach, low.min() - reach]),
        high=np.array([x[-1] + ends_m[1] + reach, wide.max() + reach, high.max() + reach]),
        sizes=np.array([0.0, *ends_m]),
        knots=knots,
    )


@dataclass(frozen=True, eq=False, slots=True)
class Body:
    """The union of solids, one after another; those that carve come last."""

    solids: tuple[Solid, ...]

    def near(self, points: Doubles) -> list[Indices]:
        """Return which of (N, 3) points each solid is looked at for."""
        return [
            np.flatnonzero(((points > solid.low) & (points < solid.high)).all(axis=1))
            for solid in self.solids
        ]

    def at(self, points: Doubles, near: list[Indices]) -> Doubles:
        """Return (N,): the field at (N, 3) points, by `near` of these or of places beside [m]."""
        found = np.full(len(points), _FAR)
        for solid, chosen in zip(self.solids, near, strict=True):
            if len(chosen):
                found[chosen] = _joined(found[chosen], solid.at(points[chosen]), solid)
        return found

    def on_grid(self, grid: tuple[Doubles, Doubles, Doubles]) -> Doubles:
        """Return (X, Y, Z): the field on the places of a grid [m]."""
        found = np.full([len(axis) for axis in grid], _FAR)
        for solid in self.solids:
            ranges = [
                slice(*np.searchsorted(axis, (low, high)).tolist())
                for axis, low, high in zip(grid, solid.low, solid.high, strict=True)
            ]
            own = np.meshgrid(*(a[r] for a, r in zip(grid, ranges, strict=True)), indexing="ij")
            points = np.column_stack([part.reshape(-1) for part in own])
            if len(points):
                part = found[tuple(ranges)]
                part[...] = _joined(part.reshape(-1), solid.at(points), solid).reshape(part.shape)
        return found

    def slope_at(
        self, points: Doubles, near: list[Indices], step_m: float
    ) -> tuple[Doubles, Doubles]:
        """Return (N,) and (N, 3): the field and its gradient at points; see `at`."""
        values = self.at(points, near)
        found = np.empty_like(points)
        for axis in range(3):
            step = np.zeros(3)
            step[axis] = step_m
            found[:, axis] = (self.at(points + step, near) - values) / step_m
        return values, found


def _joined(before: Doubles, new: Doubles, solid: Solid) -> Doubles:
    """Return the smooth union, or what is left where the new one is carved out."""
    if solid.removes:
        near = np.maximum(solid.blend_m - np.abs(before + new), 0.0)
        return np.asarray(np.maximum(before, -new) + near**2 / (4.0 * solid.blend_m), np.float64)
    near = np.maximum(solid.blend_m - np.abs(before - new), 0.0)
    return np.asarray(np.minimum(before, new) - near**2 / (4.0 * solid.blend_m), np.float64)
