"""Models as rays meet them: all triangles but those of glass, in a tree, at rest or deformed.

From `Model` and `Deformation` to trees. Each is made once; the tree of a deformed model is that of
its rest with other boxes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.deformation_kernels import refit
from sailenv_ros.native.render_types import address
from sailenv_ros.native.surface_kernels import DeformingSurface, SurfaceTree
from sailenv_ros.rays.model_triangles import triangles_of
from sailenv_ros.rays.triangle_tree import TriangleTree, triangle_tree
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.model import Material, Model

__all__ = ["OpaqueModel", "deformed_model", "opaque_model", "surface_between"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class OpaqueModel:
    """One model's triangles but those of glass.

    Attributes
    ----------
    corners : (T, 3, 3) float64
    uvs : (T, 3, 2) float32
    material : (T,) int32
        Place in `materials` of each triangle's.
    vertex_of : (T, 3) uint32
        Their corners among the vertices of all parts, one part after another.
    tree : TriangleTree
        Keeps the arrays that its record points to.
    """

    corners: NDArray[np.float64]
    uvs: NDArray[np.float32]
    material: NDArray[np.int32]
    materials: tuple[Material, ...]
    vertex_of: NDArray[np.uint32]
    tree: TriangleTree

    @property
    def masked(self) -> list[int]:
        """Places in `materials` of what has holes."""
        return [place for place, look in enumerate(self.materials) if look.alpha == "mask"]


_at_rest: WeakKeyDictionary[Model, OpaqueModel] = WeakKeyDictionary()
_deformed: WeakKeyDictionary[Deformation, OpaqueModel] = WeakKeyDictionary()


def opaque_model(model: Model) -> OpaqueModel:
    """Return what rays need of a model at rest; the same object each time."""
    if model not in _at_rest:
        every = triangles_of(model)
        chosen = ~every.chosen_by("blend")
        corners = every.corners[chosen].astype(np.float64)
        vertices, first = [np.zeros((0, 3), np.uint32)], 0
        for part in model.parts:
            vertices.append(part.mesh.triangles + np.uint32(first))
            first += len(part.mesh.positions)
        _at_rest[model] = OpaqueModel(
            corners=corners,
            uvs=every.uvs[chosen],
            material=every.part[chosen],
            materials=every.materials,
            vertex_of=np.ascontiguousarray(np.concatenate(vertices)[chosen]),
            tree=triangle_tree(corners, every.two_sided[chosen]),
        )
    return _at_rest[model]


def deformed_model(deformation: Deformation) -> OpaqueModel:
    """Return what rays need of a model at an instant; the same object each time."""
    if deformation not in _deformed:
        rest = opaque_model(deformation.model)
        nodes, corners, blocks = refit(
            deformation.positions, rest.vertex_of, rest.tree.order, rest.tree.nodes
        )
        record = rest.tree.record.copy()
        record["nodes_at"], record["triangles_at"] = address(nodes), address(blocks)
        low, high = deformation.bounds
        record.kept = (*record.kept, nodes, blocks)
        tree = replace(rest.tree, record=record, nodes=nodes, low=low, high=high)
        _deformed[deformation] = replace(rest, corners=corners, tree=tree)
    return _deformed[deformation]


def surface_between(
    instance_id: int,
    scale: tuple[float, float, float],
    present: Deformation | Model,
    target: Deformation | Model,
    *,
    with_tree: bool = True,
) -> DeformingSurface:
    """Return the surface of an instance where it is, and where it is looked for.

    Parameters
    ----------
    present, target : Deformation or Model
        Of one model; the model itself is the surface at rest.
    with_tree : bool
        Whether triangles can be looked for in it.
    """
    tree = None
    if with_tree:
        now = opaque_model(present) if isinstance(present, Model) else deformed_model(present)
        tree = SurfaceTree(now.tree.record, now.vertex_of)
    return DeformingSurface(instance_id, scale, present.positions, target.positions, tree)
