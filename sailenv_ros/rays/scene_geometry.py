"""The triangles of a scene's instances, wherever their poses put them: what rays meet.

Models in, once; rays at any instant against all of them out. A model's tree is built once, in its
own frame, and shared by all instances and all geometries that have it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.ray_kernels import BoxTree, RayHits, build_tree, cast_rays
from sailenv_ros.native.ray_types import RAY_SHAPE
from sailenv_ros.rays.cutouts import surface_at
from sailenv_ros.rays.opaque_models import OpaqueModel, deformed_model, opaque_model
from sailenv_ros.space import RayCast
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents

__all__ = ["SceneGeometry", "SurfaceHits"]

Doubles = NDArray[np.float64]

MOST_HOLES = 64
"""Surfaces with holes that one ray may pass."""


class SurfaceHits(NamedTuple):
    """First hit of each ray.

    Attributes
    ----------
    distance : (R,) float64
        In lengths of the ray's direction; inf where it meets nothing.
    instance : (R,) int64
        Instance ids; 0 where it meets nothing.
    """

    distance: Doubles
    instance: NDArray[np.int64]


class _ModelSet:
    """Models, whose triangles are counted on from one to the next."""

    def __init__(self, models: list[OpaqueModel]) -> None:
        self.models = models

    @cached_property
    def firsts(self) -> NDArray[np.int64]:
        """(S + 1,) where each model's triangles begin, and where the last one's end."""
        return np.array([0, *accumulate(len(model.corners) for model in self.models)], np.int64)

    @cached_property
    def shapes(self) -> NDArray[np.void]:
        """(S,) RAY_SHAPE."""
        shapes = np.concatenate(
            [np.zeros(0, RAY_SHAPE), *(model.tree.record for model in self.models)]
        )
        shapes["first_triangle"] = self.firsts[:-1]
        return shapes

    @cached_property
    def bounds(self) -> Doubles:
        """(S, 2, 3): corners of boxes around the models."""
        bounds = [(model.tree.low, model.tree.high) for model in self.models]
        return np.array(bounds, np.float64).reshape(-1, 2, 3)

    @cached_property
    def corners(self) -> Doubles:
        """(T, 3, 3): of all triangles."""
        return np.concatenate([np.zeros((0, 3, 3)), *(model.corners for model in self.models)])


class _Placed(NamedTuple):
    """Instances at one instant: a tree over them, model_from_world, numbers of their models."""

    tree: BoxTree
    model_from_world: Doubles
    numbers: NDArray[np.int32]
    models: _ModelSet


class SceneGeometry:
    """The models of a scene's instances.

    As in the views, what is transparent is not met, holes of masked materials are passed, and the
    backs of one-sided surfaces are not there.

    Parameters
    ----------
    models : mapping of int to Model
        By instance id.
    """

    def __init__(self, models: Mapping[int, Model]) -> None:
        self._models = list({id(model): model for model in models.values()}.values())
        numbers = {id(model): number for number, model in enumerate(self._models)}
        self._model_of_id = {int(key): numbers[id(model)] for key, model in models.items()}

    @classmethod
    def of_contents(cls, contents: SceneContents) -> SceneGeometry:
        """Return the geometry of what a scene holds."""
        return cls({drawn.instance.id: drawn.model for drawn in contents.instances})

    def cast(self, states: InstanceStates, origins: Doubles, directions: Doubles) -> SurfaceHits:
        """Find what rays meet first at one instant.

        Parameters
        ----------
        states : InstanceStates
            Where the instances are.
        origins, directions : (R, 3) float64
            In the world [m]; directions of any length.

        Raises
        ------
        InvalidRequest
            If there is an instance whose model is not known.
        """
        hits = self._met(self._placed(states), origins, directions)
        ids = np.append(states.ids, 0).astype(np.int64)
        return SurfaceHits(distance=hits.distance, instance=ids[hits.instance])

    def cast_surfaces(
        self, states: InstanceStates, origins: Doubles, directions: Doubles
    ) -> RayCast:
        """Find what rays meet first at one instant, where, and how it is turned there.

        Parameters
        ----------
        states : InstanceStates
            Where the instances are.
        origins, directions : (R, 3) float64
            In the world [m]; directions of any length but 0.

        Raises
        ------
        InvalidRequest
            If there is an instance whose model is not known.
        """
        placed = self._placed(states)
        hits = self._met(placed, origins, directions)
        met = hits.instance >= 0
        normals = np.zeros((len(hits.distance), 3))
        # An instance's own axes to the world's: normals take the transpose of the way back.
        corners = placed.models.corners[hits.triangle[met]]
        own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        turned = np.einsum("nji,nj->ni", placed.model_from_world[hits.instance[met], :, :3], own)
        normals[met] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        away = np.einsum("ni,ni->n", normals, directions) > 0.0
        normals[away] *= -1.0
        with np.errstate(invalid="ignore"):
            points = np.where(met[:, None], origins + hits.distance[:, None] * directions, np.nan)
        return RayCast(
            instance_ids=np.append(states.ids, 0).astype(np.uint16)[hits.instance],
            distances_m=hits.distance * np.linalg.norm(directions, axis=1),
            points_m=points,
            normals=normals,
        )

    # -- inside ----------------------------------------------------------------------------

    def _met(self, placed: _Placed, origins: Doubles, directions: Doubles) -> RayHits:
        """Return what rays meet first, holes passed; -1 is no instance."""
        threads = thread_count()
        origins, directions = (
            np.ascontiguousarray(array, np.float64).reshape(-1, 3)
            for array in (origins, directions)
        )
        nearest = np.zeros(len(origins))
        given = placed.models.shapes, placed[:3]
        hits = cast_rays(*given, origins, directions, nearest, threads=threads)
        for _ in range(MOST_HOLES):
            open_ = np.flatnonzero(_in_hole(placed.models, hits))
            if not len(open_):
                break
            again = cast_rays(
                *(*given, origins[open_], directions[open_]),
                hits.distance[open_],
                threads=threads,
            )
            hits.distance[open_], hits.weights[open_] = again.distance, again.weights
            hits.instance[open_], hits.triangle[open_] = again.instance, again.triangle
        return hits

    def _placed(self, states: InstanceStates) -> _Placed:
        """Return a tree over the instances, model_from_world and the models' numbers."""
        unknown = [number for number in states.ids.tolist() if number not in self._model_of_id]
        if unknown:
            accepted = "among those of the geometry: take it from the scene as it is in the frames"
            raise InvalidRequest("instance id", unknown[0], accepted)
        numbers = np.array([self._model_of_id[key] for key in states.ids.tolist()], np.int32)
        models = self._at_rest
        if states.deformations:
            shapes = [deformed_model(shape) for shape in states.deformations.values()]
            for number, id_ in enumerate(states.deformations, start=len(models.models)):
                numbers[states.row(id_)] = number
            models = _ModelSet([*models.models, *shapes])
        result = np.empty((len(states), 3, 4))
        rotations, scales = states.matrices[:, :3, :3], states.scales
        rotation_t = np.swapaxes(rotations, 1, 2)
        result[..., :3] = rotation_t / scales[..., None]
        moved = np.einsum("nij,nj->ni", rotation_t, states.positions)
        result[..., 3] = -moved / scales
        low, high = models.bounds[numbers, 0], models.bounds[numbers, 1]
        linear = rotations * scales[:, None, :]
        middle = np.einsum("nij,nj->ni", linear, (low + high) / 2.0) + states.positions
        half = np.einsum("nij,nj->ni", np.abs(linear), (high - low) / 2.0) * (1.0 + 1e-6)
        boxes = np.concatenate([middle - half, middle + half], axis=1)
        return _Placed(build_tree(np.ascontiguousarray(boxes), 1), result, numbers, models)

    @cached_property
    def _at_rest(self) -> _ModelSet:
        return _ModelSet([opaque_model(model) for model in self._models])


def _in_hole(models: _ModelSet, hits: RayHits) -> NDArray[np.bool_]:
    """Return which rays met a masked surface where there is none of it."""
    found = np.zeros(len(hits.distance), np.bool_)
    for number, model in enumerate(models.models):
        if not model.masked:
            continue
        first, end = models.firsts[number : number + 2]
        rows = np.flatnonzero((hits.triangle >= first) & (hits.triangle < end))
        local = hits.triangle[rows] - first
        for place in model.masked:
            chosen = model.material[local] == place
            if chosen.any():
                at, of = rows[chosen], local[chosen]
                second, third = hits.weights[at].T[:, :, None]
                uvs = model.uvs[of].astype(np.float64)
                uv = uvs[:, 0] * (1.0 - second - third) + uvs[:, 1] * second
                found[at] = ~surface_at(model.materials[place], uv + uvs[:, 2] * third)
    return found
