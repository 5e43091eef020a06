"""Meshes as they are drawn: with places in a light map, and by position alone.

The parts of a scene come in, arrays of vertices and corners go out. Knows no graphics library:
every back end draws the same meshes.
"""

from __future__ import annotations

import weakref
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.rays.self_occlusion import vertex_occlusion
from sailenv_ros.types.baked_light import LightChart, Unwrapping
from sailenv_ros.types.model import Mesh, Model
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents

__all__ = [
    "VERTEX",
    "DrawnMesh",
    "chart_table",
    "corner_sources",
    "drawn_meshes",
    "occludes_itself",
    "meshes_of",
    "owner_of",
    "unwrappings",
]

VERTEX = np.dtype(
    [("position", "<f4", 3), ("normal", "<f4", 3), ("uv", "<f4", 2), ("light_uv", "<f4", 2)]
)


@dataclass(frozen=True, eq=False, slots=True)
class DrawnMesh:
    """A mesh as it is drawn: with places in a light map if its model was unwrapped.

    Attributes
    ----------
    mesh : Mesh
    unwrapping : Unwrapping or None
    part : int
        Number of the mesh among its model's parts.
    owner : int
        Id of the instance if its vertices move; 0 for a mesh that all instances share.
    occlusion : (V,) float32 or None
        See `vertex_occlusion`; None where nothing is known of it.
    """

    mesh: Mesh
    unwrapping: Unwrapping | None
    part: int
    owner: int = 0
    occlusion: NDArray[np.float32] | None = None

    @property
    def key(self) -> tuple[int, int, int, int]:
        """Key that is unique to a drawn mesh while its objects live."""
        return id(self.mesh), id(self.unwrapping), self.owner, id(self.occlusion)

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """(M, 3) uint32: indices into `vertices`."""
        return (
            self.mesh.triangles if self.unwrapping is None else self.unwrapping.triangles[self.part]
        )

    @property
    def vertex_count(self) -> int:
        """Number of vertices that are drawn."""
        return len(
            self.mesh.positions if self.unwrapping is None else self.unwrapping.vertices[self.part]
        )

    def interleaved(self) -> NDArray[np.void]:
        """Return the vertices as the buffer holds them.

        What has no place in a light map has there 0 and the share that it hides of itself.
        """
        mesh = self.mesh
        result = np.zeros(self.vertex_count, VERTEX)
        chosen: slice | NDArray[np.uint32] = slice(None)
        if self.unwrapping is not None:
            chosen = self.unwrapping.vertices[self.part]
            result["light_uv"] = self.unwrapping.uvs[self.part]
        elif self.occlusion is not None:
            result["light_uv"][:, 1] = self.occlusion
        result["position"] = mesh.positions[chosen]
        result["normal"] = mesh.normals[chosen]
        result["uv"] = mesh.uvs[chosen]
        return result


def drawn_meshes(contents: SceneContents) -> list[list[DrawnMesh]]:
    """Return the meshes of each instance's parts, in their order."""
    return [
        meshes_of(drawn.model, flat, owner_of(drawn), occluded=occludes_itself(drawn, contents))
        for drawn, flat in zip(contents.instances, unwrappings(contents), strict=True)
    ]


def meshes_of(
    model: Model, unwrapping: Unwrapping | None, owner: int = 0, *, occluded: bool = False
) -> list[DrawnMesh]:
    """Return the meshes of a model's parts, in their order; see `DrawnMesh.owner`.

    Parameters
    ----------
    occluded : bool
        Whether what hides itself is darker, where it has no place in a light map and is rigid.
    """
    told = occluded and unwrapping is None and not owner
    occlusion = vertex_occlusion(model) if told else (None,) * len(model.parts)
    return [
        DrawnMesh(part.mesh, unwrapping, place, owner, own)
        for place, (part, own) in enumerate(zip(model.parts, occlusion, strict=True))
    ]


def occludes_itself(drawn: DrawnInstance, contents: SceneContents) -> bool:
    """Return whether an instance is lit as what can move is, in a room with baked light."""
    return contents.baked is not None and drawn.outside is None


def owner_of(drawn: DrawnInstance) -> int:
    """Return who owns the meshes of an instance, as `DrawnMesh.owner` says."""
    return drawn.instance.id if drawn.deforms else 0


def unwrappings(contents: SceneContents) -> list[Unwrapping | None]:
    """Return how each instance is unwrapped into the light map; None for those that are not."""
    charts = (_chart_of(drawn, contents) for drawn in contents.instances)
    return [
        None if chart is None else _unwrapped(drawn.model, chart.unwrapping)
        for drawn, chart in zip(contents.instances, charts, strict=True)
    ]


def _chart_of(drawn: DrawnInstance, contents: SceneContents) -> LightChart | None:
    """Return where an instance lies in the light map, in which nothing is of veils."""
    if contents.baked is None or drawn.model.is_veil:
        return None
    return contents.baked.charts.get(drawn.instance.id)


_unwrapped_models: weakref.WeakKeyDictionary[Model, tuple[Unwrapping, Unwrapping]] = (
    weakref.WeakKeyDictionary()
)
"""Last unwrapping of each model: the one that was baked, and the model's own."""


def _unwrapped(model: Model, baked: Unwrapping) -> Unwrapping:
    """Return how a model lies in the light map that was baked for it.

    With another material it has the same triangles in the same order, but perhaps other vertices.
    """
    kept = _unwrapped_models.get(model)
    if kept is None or kept[0] is not baked:
        kept = _unwrapped_models[model] = baked, _fitted(model, baked)
    return kept[1]


def _fitted(model: Model, baked: Unwrapping) -> Unwrapping:
    vertices, triangles, uvs, changed = [], [], [], False
    for part, copies, corners, places in zip(
        model.parts, baked.vertices, baked.triangles, baked.uvs, strict=True
    ):
        mesh = part.mesh
        same = not len(corners) or (
            int(copies.max(initial=0)) < len(mesh.positions)
            and np.array_equal(copies[corners], mesh.triangles)
        )
        if not same:
            # A corner's place in the map, and the vertex that it has now: each pair once.
            pairs = corners.astype(np.int64) * len(mesh.positions) + mesh.triangles
            used, again = np.unique(pairs, return_inverse=True)
            places = places[used // len(mesh.positions)]
            copies = (used % len(mesh.positions)).astype(np.uint32)
            corners, changed = again.reshape(-1, 3).astype(np.uint32), True
        vertices.append(copies)
        triangles.append(corners)
        uvs.append(places)
    if not changed:
        return baked
    return Unwrapping(vertices=tuple(vertices), triangles=tuple(triangles), uvs=tuple(uvs))


def corner_sources(vertices: NDArray[np.uint32], corners: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Return (K,): a vertex of each corner, from the triangles by both as `corners_of` gives them.

    What moves as one at rest has one place: any of a corner's vertices stands for all.
    """
    sources = np.zeros(int(corners.max()) + 1 if corners.size else 0, np.uint32)
    sources[corners.reshape(-1)] = vertices.reshape(-1)
    return sources


def chart_table(contents: SceneContents) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return each instance's offset and scale in the light map, and the pose that it is for."""
    count = len(contents.instances)
    charts, poses = np.zeros((count, 4)), np.full((count, 4, 4), np.nan)
    for row, drawn in enumerate(contents.instances):
        chart = _chart_of(drawn, contents)
        if chart is not None:
            charts[row] = *chart.offset, *chart.scale
            poses[row] = chart.world_from_body
    return charts, poses
