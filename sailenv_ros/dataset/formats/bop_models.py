"""Assets → what BOP wants of object models: meshes in millimetres, sizes, symmetries.

See https://github.com/thodan/bop_toolkit/blob/master/docs/bop_datasets_format.md.
"""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree
from scipy.spatial.distance import pdist
from scipy.spatial.transform import Rotation

from sailenv_ros.frame.truth.ply import ply_bytes
from sailenv_ros.types.model import Model

__all__ = ["MM_PER_M", "ObjectModel"]

MM_PER_M = 1000.0

SAMPLES = 4000
"""Points of the surface by which symmetries are found."""

SAME_SHARE = 0.02
"""Share of the diameter within which a turned surface must lie on itself."""

_QUARTERS = (0.25, 0.5, 0.75)
_ODD_ANGLES_DEG = (11.0, 37.0, 101.0)
"""Angles outside every discrete symmetry group; a surface they leave unchanged has a continuous
symmetry."""


class ObjectModel:
    """The surface of an asset at one scale.

    Parameters
    ----------
    model : Model
    scale : (3,) array
        Along its axes.

    Attributes
    ----------
    vertices : (V, 3) float64
        In the object's own frame [mm].
    triangles : (T, 3) int32
    """

    def __init__(self, model: Model, scale: NDArray[np.float64]) -> None:
        vertices, triangles, colours, first = [], [], [], 0
        for part in model.parts:
            if part.material.alpha == "blend":
                continue  # labels do not see it either
            vertices.append(part.mesh.positions.astype(np.float64) * scale * MM_PER_M)
            triangles.append(part.mesh.triangles.astype(np.int32) + first)
            rgb = np.clip(np.asarray(part.material.base_colour[:3]), 0.0, 1.0)
            colours.append(
                np.tile((255.0 * rgb ** (1 / 2.2) + 0.5).astype(np.uint8), (len(vertices[-1]), 1))
            )
            first += len(vertices[-1])
        self.vertices = np.concatenate(vertices) if vertices else np.zeros((0, 3))
        self.triangles = np.concatenate(triangles) if triangles else np.zeros((0, 3), np.int32)
        self._colours = np.concatenate(colours) if colours else np.zeros((0, 3), np.uint8)

    def ply(self) -> bytes:
        """Return the mesh as a PLY file [mm], coloured by its materials without their textures."""
        columns: dict[str, NDArray[Any]] = {
            name: self.vertices[:, axis].astype(np.float32) for axis, name in enumerate("xyz")
        }
        columns |= {
            name: self._colours[:, channel] for channel, name in enumerate(("red", "green", "blue"))
        }
        return ply_bytes(columns, self.triangles)

    def info(self) -> dict[str, Any]:
        """Return its entry of `models_info.json`: diameter, box, symmetries of the shape [mm]."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        made: dict[str, Any] = {"diameter": self._diameter()}
        for axis, name in enumerate("xyz"):
            made[f"min_{name}"] = float(low[axis])
            made[f"size_{name}"] = float(high[axis] - low[axis])
        continuous, discrete = self._symmetries()
        if discrete:
            made["symmetries_discrete"] = discrete
        if continuous:
            made["symmetries_continuous"] = continuous
        return made

    def _diameter(self) -> float:
        points = self.vertices
        with contextlib.suppress(QhullError):  # it is flat
            points = points[ConvexHull(points).vertices]
        return float(pdist(np.unique(points, axis=0)).max(initial=0.0))

    def _symmetries(self) -> tuple[list[dict[str, Any]], list[list[float]]]:
        """Return turns about the axes through the middle of the box that leave the shape alike.

        Of its shape alone: its colours may distinguish what these call alike.
        """
        points = self._surface_points()
        if not len(points):
            return [], []
        centre = 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))
        tree = cKDTree(points)
        spacing = float(np.max(tree.query(points, k=2)[0][:, 1]))
        tolerance = max(SAME_SHARE * self._diameter(), 1.5 * spacing)

        def alike(turn: Rotation) -> bool:
            moved = turn.apply(points - centre) + centre
            return bool(tree.query(moved)[0].max() <= tolerance)

        continuous: list[dict[str, Any]] = []
        discrete: list[list[float]] = []
        for axis in np.eye(3):
            turns = [Rotation.from_rotvec(np.radians(a) * axis) for a in _ODD_ANGLES_DEG]
            if all(alike(turn) for turn in turns):
                continuous.append({"axis": axis.tolist(), "offset": centre.tolist()})
                continue
            for share in _QUARTERS:
                turn = Rotation.from_rotvec(2.0 * np.pi * share * axis)
                if alike(turn):
                    matrix = np.eye(4)
                    matrix[:3, :3] = np.rint(turn.as_matrix())
                    matrix[:3, 3] = centre - matrix[:3, :3] @ centre
                    discrete.append(matrix.reshape(-1).tolist())
        return continuous, discrete

    def _surface_points(self) -> NDArray[np.float64]:
        """Return points that are spread over the surface; always the same ones."""
        corners = self.vertices[self.triangles]
        edges = corners[:, 1:] - corners[:, :1]
        areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        total = areas.sum()
        if not total > 0.0:
            return np.zeros((0, 3))
        generator = np.random.default_rng(0)
        # Evenly along the surface: steps of equal area, not chance, decide how many each gets.
        steps = (np.arange(SAMPLES) + 0.5) / SAMPLES * total
        chosen = np.minimum(np.searchsorted(np.cumsum(areas), steps), len(areas) - 1)
        u, v = generator.random((2, SAMPLES))
        outside = u + v > 1.0
        u[outside], v[outside] = 1.0 - u[outside], 1.0 - v[outside]
        at = corners[chosen, 0] + u[:, None] * edges[chosen, 0] + v[:, None] * edges[chosen, 1]
        return np.asarray(at, np.float64)
