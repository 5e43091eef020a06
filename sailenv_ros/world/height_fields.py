"""Height fields of furniture: its highest surface over its own axes, by rays from above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.model import Model
from sailenv_ros.world.bodies import Body

__all__ = ["STEP_M", "HeightField", "height_field_of", "heights_at", "heights_over"]

Doubles = NDArray[np.float64]

STEP_M = 0.02
"""From one place of a field to the next [m]."""

_ABOVE_M = 3.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class HeightField:
    """Heights over a piece of furniture.

    Attributes
    ----------
    model : Model
    scale : (3,) tuple of float
        Of the piece.
    piece_from_world : (4, 4) float64
    x, y : (X,), (Y,) float64
        Places along the piece's axes [m].
    heights : (X, Y) float64
        Of the highest surface there, in the piece's frame [m]; -1 for none.
    step_m : float
        From one place to the next [m].
    """

    model: Model
    scale: tuple[float, float, float]
    piece_from_world: Doubles
    x: Doubles
    y: Doubles
    heights: Doubles
    step_m: float

    def exact(self, places: Doubles) -> Doubles:
        """Return (N,) heights as `at` does, each by a ray of its own."""
        matrix = self.piece_from_world
        own = places @ matrix[:2, :2].T + matrix[:2, 3]
        found = heights_at(self.model, self.scale, own)
        return np.where(found < 0.0, -np.inf, found - float(matrix[2, 3]))

    def at(self, places: Doubles) -> Doubles:
        """Return (N,) heights of the piece at (N, 2) places of the world; -inf for none [m]."""
        matrix, grid = self.piece_from_world, self.heights
        own = places @ matrix[:2, :2].T + matrix[:2, 3]
        cells = (own - [self.x[0], self.y[0]]) / self.step_m
        first = np.floor(cells).astype(np.int64)
        there = (first >= 0).all(axis=1) & (first < np.array(grid.shape) - 1).all(axis=1)
        row, column = first[there].T
        u, v = (cells[there] - first[there]).T
        found = np.full(len(places), -np.inf)
        found[there] = (1.0 - u) * ((1.0 - v) * grid[row, column] + v * grid[row, column + 1]) + (
            u * ((1.0 - v) * grid[row + 1, column] + v * grid[row + 1, column + 1])
        )
        # Beside an edge the mean of a surface and of nothing is neither.
        nearest = grid[row + (u > 0.5), column + (v > 0.5)]
        found[there] = np.where(
            np.minimum.reduce([grid[row + i, column + k] for i in (0, 1) for k in (0, 1)]) < 0.0,
            np.where(nearest < 0.0, -np.inf, nearest),
            found[there],
        )
        return found - float(matrix[2, 3])


def height_field_of(body: Body, step_m: float = STEP_M) -> HeightField:
    """Return the field over a piece as it stands."""
    model, scale = body.placement.asset.model, body.placement.scale
    low, high = model.bounds() * np.asarray(scale)
    x, y = (np.arange(low[k], high[k] + step_m, step_m) for k in (0, 1))
    return HeightField(
        model=model,
        scale=scale,
        piece_from_world=invert(body.world_from_body()),
        x=x,
        y=y,
        heights=heights_over(model, scale, x, y),
        step_m=step_m,
    )


def heights_over(
    model: Model, scale: tuple[float, float, float], along: Doubles, across: Doubles
) -> Doubles:
    """Return (X, Y): heights of the highest surface over places of a model; -1 for none [m]."""
    x, y = np.meshgrid(along, across, indexing="ij")
    found = heights_at(model, scale, np.stack([x, y], axis=-1).reshape(-1, 2))
    return found.reshape(x.shape)


def heights_at(model: Model, scale: tuple[float, float, float], places: Doubles) -> Doubles:
    """Return (N,): the same over (N, 2) places."""
    origins = np.column_stack([places, np.full(len(places), _ABOVE_M)])
    states = InstanceStates(
        ids=np.array([1], np.uint16),
        positions=np.zeros((1, 3)),
        orientations=np.array([[0.0, 0.0, 0.0, 1.0]]),
        linear_velocities=np.zeros((1, 3)),
        angular_velocities=np.zeros((1, 3)),
        scales=np.array([scale]),
    )
    down = np.broadcast_to(np.array([0.0, 0.0, -1.0]), origins.shape)
    hits = SceneGeometry({1: model}).cast(states, origins, down)
    return np.where(np.isfinite(hits.distance), _ABOVE_M - hits.distance, -1.0)
