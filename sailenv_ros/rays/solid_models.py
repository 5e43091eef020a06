"""The solid surfaces of models, as rays of light meet them. From `Model` to trees of triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary, WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.ray_types import RAY_INSTANCE
from sailenv_ros.native.render_types import address
from sailenv_ros.rays.model_triangles import joined, triangles_of
from sailenv_ros.rays.triangle_tree import TriangleTree, triangle_tree
from sailenv_ros.types.baked_light import Unwrapping
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.model import Material, Mesh, Model

__all__ = ["SolidModel", "SolidModels", "solid_model"]

_MARGIN_M = 1e-4
"""Balls and boxes around instances are larger by this: kernels have poses in floats."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidModel:
    """The solid surface of a model at one scale.

    Attributes
    ----------
    tree : TriangleTree
        In floats.
    triangles : (S,) int32
        Place of each of its triangles among all of the model's, part by part.
    turned : bool
        Whether the second and the third corner of triangles are exchanged: a mirrored model's run
        the other way round.
    centre : (3,) float64
        Of a ball around it, in the body frame [m].
    radius : float
        [m].
    made_of : tuple
        What `solid_model` knows it by.
    """

    tree: TriangleTree
    triangles: NDArray[np.int32]
    turned: bool
    centre: NDArray[np.float64]
    radius: float
    made_of: tuple[object, ...]


class SolidModels:
    """The surfaces of several instances; kept as long as this is.

    Parameters
    ----------
    solids : sequence of SolidModel
        Of each instance.
    """

    def __init__(self, solids: Sequence[SolidModel]) -> None:
        self._kept = tuple(solids)
        self._shapes = np.array([address(one.tree.record) for one in solids], np.uint64)
        self._centres = np.array([one.centre for one in solids]).reshape(-1, 3)
        halves = [(one.tree.high - one.tree.low) / 2.0 for one in solids]
        self._halves = np.array(halves).reshape(-1, 3)
        self._radii = np.array([one.radius for one in solids])

    def at(self, poses: NDArray[np.float64]) -> tuple[NDArray[np.void], NDArray[np.float64]]:
        """Return (N,) RAY_INSTANCE, where they stand alone, and (N, 6) boxes around them [m].

        Parameters
        ----------
        poses : (N, 4, 4) float64
            World from body.
        """
        turns = poses[:, :3, :3]
        middles = np.einsum("nij,nj->ni", turns, self._centres) + poses[:, :3, 3]
        halves = np.einsum("nij,nj->ni", np.abs(turns), self._halves) + _MARGIN_M
        rows = np.zeros(len(poses), RAY_INSTANCE)
        rows["shape_at"] = self._shapes
        rows["body_from_world"] = invert(poses)[:, :3].reshape(-1, 12)
        rows["sphere"][:, :3] = middles
        rows["sphere"][:, 3] = self._radii * 1.0001 + _MARGIN_M
        return rows, np.concatenate([middles - halves, middles + halves], axis=1)


_Known = WeakValueDictionary[tuple[object, ...], SolidModel]
_made: WeakKeyDictionary[Mesh, _Known] = WeakKeyDictionary()
"""Surfaces that somebody uses, by the first mesh of a model: with other colours it has the same."""


def solid_model(
    model: Model, scale: tuple[float, float, float], unwrapping: Unwrapping | None
) -> SolidModel:
    """Return the surface of a model; glass, and what a mask leaves mostly open, is left out.

    It is the same object as long as somebody keeps it.

    Parameters
    ----------
    model : Model
        With one part at least.
    scale : (3,) tuple of float
    unwrapping : Unwrapping or None
        With it the tree knows where triangles lie in the model's chart.
    """
    parts = model.parts
    made_of = (
        unwrapping,
        *(thing for part in parts for thing in (part.mesh, *_rule(part.material))),
    )
    key = (scale, *(id(thing) if isinstance(thing, _OBJECTS) else thing for thing in made_of))
    known = _made.setdefault(parts[0].mesh, WeakValueDictionary())
    found = known.get(key)
    if found is None:
        # The first mesh lives as long as the entry anyway, and must not live because of it.
        others = tuple(thing for thing in made_of if thing is not parts[0].mesh)
        found = known[key] = _solid_model(model, scale, unwrapping, others)
    return found


_OBJECTS = (Mesh, Unwrapping, np.ndarray)


def _rule(material: Material) -> tuple[object, ...]:
    """Return all of a material that tells which triangles are solid, and from which side."""
    rule: tuple[object, ...] = material.alpha, material.double_sided
    if material.alpha != "opaque":
        rule += (material.base_colour[3],)
    if material.alpha == "mask":
        rule += material.alpha_cutoff, material.base_colour_texture
    return rule


def _solid_model(
    model: Model,
    scale: tuple[float, float, float],
    unwrapping: Unwrapping | None,
    made_of: tuple[object, ...],
) -> SolidModel:
    every = triangles_of(model)
    solid = np.flatnonzero(every.passes == 0.0)
    corners = (every.corners[solid] * np.asarray(scale)).astype(np.float32)
    places = None
    if unwrapping is not None:
        flat = zip(unwrapping.uvs, unwrapping.triangles, strict=True)
        places = joined([uvs[triangles] for uvs, triangles in flat], (3, 2))[solid]
    turned = bool(np.prod(scale) < 0.0)
    if turned:
        corners, places = corners[:, [0, 2, 1]], None if places is None else places[:, [0, 2, 1]]
    tree = triangle_tree(corners, every.two_sided[solid], places)
    centre = (tree.low + tree.high) / 2.0
    far = np.linalg.norm(corners.reshape(-1, 3) - centre, axis=1).max(initial=0.0)
    return SolidModel(
        tree=tree,
        triangles=solid.astype(np.int32),
        turned=turned,
        centre=centre,
        radius=float(far),
        made_of=made_of,
    )
