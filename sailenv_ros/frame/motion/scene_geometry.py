"""The triangles of a scene's instances, wherever their poses put them: what rays meet.

Models in, once; rays at any instant against all of them out. A model's tree is built once, in its
own frame, and shared by all instances and all geometries that have it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.library import thread_count
from sailenv_ros.native.ray_kernels import RayHits, RayModels, TriangleTree, build_tree, cast_rays
from sailenv_ros.space import RayCast
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.model import Material, Model
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


@dataclass(frozen=True, eq=False, slots=True)
class _Triangles:
    """One model's triangles with all that rays need.

    `skin` is the number in `masked` of each triangle's material, -1 for what has no holes.
    """

    corners: Doubles
    two_sided: NDArray[np.bool_]
    uvs: NDArray[np.float32]
    skin: NDArray[np.int32]
    masked: tuple[Material, ...]
    tree: TriangleTree


_kept: WeakKeyDictionary[Model, _Triangles] = WeakKeyDictionary()


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
        corners = self._ray_models.corners[hits.triangle[met]]
        own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        turned = np.einsum("nji,nj->ni", placed[0][hits.instance[met], :, :3], own)
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

    def _met(
        self, placed: tuple[Doubles, NDArray[np.int32]], origins: Doubles, directions: Doubles
    ) -> RayHits:
        """Return what rays meet first, holes passed; -1 is no instance."""
        models, threads = self._ray_models, thread_count()
        origins, directions = (
            np.ascontiguousarray(array, np.float64).reshape(-1, 3)
            for array in (origins, directions)
        )
        nearest = np.zeros(len(origins))
        hits = cast_rays(models, *placed, origins, directions, nearest, threads=threads)
        for _ in range(MOST_HOLES):
            open_ = np.flatnonzero(self._in_hole(hits))
            if not len(open_):
                break
            again = cast_rays(
                *(models, *placed, origins[open_], directions[open_]),
                hits.distance[open_],
                threads=threads,
            )
            hits.distance[open_], hits.weights[open_] = again.distance, again.weights
            hits.instance[open_], hits.triangle[open_] = again.instance, again.triangle
        return hits

    def _placed(self, states: InstanceStates) -> tuple[Doubles, NDArray[np.int32]]:
        """Return model_from_world and the models' numbers."""
        unknown = [number for number in states.ids.tolist() if number not in self._model_of_id]
        if unknown:
            accepted = "among those of the geometry: take it from the scene as it is in the frames"
            raise InvalidRequest("instance id", unknown[0], accepted)
        numbers = np.array([self._model_of_id[key] for key in states.ids.tolist()], np.int32)
        result = np.empty((len(states), 3, 4))
        rotation_t = np.swapaxes(states.matrices[:, :3, :3], 1, 2)
        result[..., :3] = rotation_t / states.scales[..., None]
        moved = np.einsum("nij,nj->ni", rotation_t, states.positions)
        result[..., 3] = -moved / states.scales
        return result, numbers

    @cached_property
    def _parts(self) -> list[_Triangles]:
        return [_triangles_of(model) for model in self._models]

    @cached_property
    def _ray_models(self) -> RayModels:
        parts = self._parts
        corners = [part.corners for part in parts]
        trees = [part.tree for part in parts]
        return RayModels(
            corners=np.concatenate([np.zeros((0, 3, 3)), *corners]),
            two_sided=np.concatenate([np.zeros(0, bool), *(part.two_sided for part in parts)]),
            first_triangle=np.array([0, *accumulate(map(len, corners))], np.int64),
            first_node=np.array([0, *accumulate(len(t.bounds) for t in trees)], np.int64),
            tree=TriangleTree(
                np.concatenate([np.zeros((0, 6)), *(t.bounds for t in trees)]),
                np.concatenate([np.zeros((0, 2), np.int32), *(t.children for t in trees)]),
                np.concatenate([np.zeros(0, np.int32), *(t.order for t in trees)]),
            ),
        )

    @cached_property
    def _has_holes(self) -> bool:
        return any(part.masked for part in self._parts)

    def _in_hole(self, hits: RayHits) -> NDArray[np.bool_]:
        """Return which rays met a masked surface where there is none of it."""
        found = np.zeros(len(hits.distance), np.bool_)
        if not self._has_holes:
            return found
        firsts = self._ray_models.first_triangle
        for number, part in enumerate(self._parts):
            if not part.masked:
                continue
            own = (hits.triangle >= firsts[number]) & (hits.triangle < firsts[number + 1])
            rows = np.flatnonzero(own)
            local = hits.triangle[rows] - firsts[number]
            for place, material in enumerate(part.masked):
                chosen = part.skin[local] == place
                if chosen.any():
                    at, of = rows[chosen], local[chosen]
                    second, third = hits.weights[at].T[:, :, None]
                    uvs = part.uvs[of].astype(np.float64)
                    uv = uvs[:, 0] * (1.0 - second - third) + uvs[:, 1] * second
                    found[at] = _alpha(material, uv + uvs[:, 2] * third) < material.alpha_cutoff
        return found


def _triangles_of(model: Model) -> _Triangles:
    """Return what rays need of a model; the same object each time."""
    if model not in _kept:
        parts = [part for part in model.parts if part.material.alpha != "blend"]
        masked = tuple(part.material for part in parts if part.material.alpha == "mask")
        counts = [len(part.mesh.triangles) for part in parts]
        skins = [
            masked.index(part.material) if part.material.alpha == "mask" else -1 for part in parts
        ]
        corners = np.concatenate(
            [
                np.zeros((0, 3, 3)),
                *(part.mesh.positions[part.mesh.triangles].astype(np.float64) for part in parts),
            ]
        )
        sides = np.array([part.material.double_sided for part in parts], np.bool_)
        _kept[model] = _Triangles(
            corners=corners,
            two_sided=np.repeat(sides, counts),
            uvs=np.concatenate(
                [
                    np.zeros((0, 3, 2), np.float32),
                    *(part.mesh.uvs[part.mesh.triangles] for part in parts),
                ]
            ),
            skin=np.repeat(np.array(skins, np.int32), counts),
            masked=masked,
            tree=build_tree(corners),
        )
    return _kept[model]


def _alpha(material: Material, uv: Doubles) -> Doubles:
    """Return the alpha of a material at (R, 2) texture coordinates: that of the nearest texel."""
    alpha = np.full(len(uv), material.base_colour[3])
    texture = material.base_colour_texture
    if texture is not None:
        height, width = texture.shape[:2]
        column = np.floor(uv[:, 0] * width).astype(np.int64) % width
        row = np.floor((1.0 - uv[:, 1]) * height).astype(np.int64) % height
        alpha *= texture[row, column, 3] / 255.0
    return alpha
