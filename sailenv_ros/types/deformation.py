"""Vertices of what deforms, at one instant: skin, cloth.

A `Model` is at rest. An instance that deforms has a `Deformation` in each snapshot, which says
where the vertices of its model are then. Topology, texture coordinates and materials stay the
model's. The vertices at rest are the surface's own coordinates: by them its points are found at
every instant, so that motion is as exact as that of rigid bodies. An unchanged shape is the same
object.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.mesh import joined_vectors
from sailenv_ros.types.model import Material, Model, ModelPart

__all__ = ["Deformation", "MovedMesh"]


class MovedMesh(NamedTuple):
    """Vertices of one mesh of a model; read-only.

    Attributes
    ----------
    positions : (V, 3) float32
        In the body frame, before the scale [m].
    normals : (V, 3) float32
        Unit normals.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]


MakeMeshes: TypeAlias = Callable[[], Iterable[tuple[NDArray[np.float32], NDArray[np.float32]]]]


class Deformation:
    """Where the vertices of a model are at one instant; compared by identity.

    Parameters
    ----------
    model : Model
        The surface at rest.
    make : callable
        Returns positions and normals for each part of the model; called once, when they are needed.

    Attributes
    ----------
    model : Model
    """

    def __init__(self, model: Model, make: MakeMeshes) -> None:
        self.model = model
        self._make = make
        self._chosen: dict[tuple[int, ...], Deformation] = {}

    @classmethod
    def of(
        cls, model: Model, meshes: Sequence[tuple[NDArray[np.float32], NDArray[np.float32]]]
    ) -> Deformation:
        """Return the deformation of a model whose vertices are known."""
        return cls(model, lambda: meshes)

    @cached_property
    def meshes(self) -> tuple[MovedMesh, ...]:
        """The vertices of each part.

        Raises
        ------
        InvalidRequest
            If they are not finite numbers, three for each vertex.
        """
        made = tuple(MovedMesh(_frozen(a), _frozen(b)) for a, b in self._make())
        shapes = [part.mesh.positions.shape for part in self.model.parts]
        for moved in ([mesh.positions.shape for mesh in made], [m.normals.shape for m in made]):
            if moved != shapes:
                raise InvalidRequest("vertices of a deformation", moved, f"shapes {shapes}")
        return made

    @cached_property
    def positions(self) -> NDArray[np.float32]:
        """(V, 3) float32: vertices of all parts, one part after another; see `Model.positions`."""
        return joined_vectors(mesh.positions for mesh in self.meshes)

    @cached_property
    def bounds(self) -> NDArray[np.float64]:
        """(2, 3) float64: lowest and highest corner of all vertices, before the scale [m]."""
        if not len(self.positions):
            return np.zeros((2, 3))
        # Rows of one coordinate are compared many at a time.
        columns = self.positions.T.copy()
        return np.array([columns.min(axis=1), columns.max(axis=1)], np.float64)

    def only(self, meshes: tuple[int, ...]) -> Deformation:
        """Return that of some parts, by their places; the same object for the same ones."""
        if meshes not in self._chosen:
            model = self.model.only(meshes)
            made = Deformation(model, lambda: [self.meshes[place] for place in meshes])
            # One step, so that two threads get the same object.
            self._chosen.setdefault(meshes, made)
        return self._chosen[meshes]

    def __reduce__(self) -> Any:
        # Without textures: they are many times as large, and nobody asks a shape for its looks.
        parts = tuple(
            ModelPart(mesh=part.mesh, material=_plain(part.material)) for part in self.model.parts
        )
        meshes = tuple((mesh.positions, mesh.normals) for mesh in self.meshes)
        return Deformation.of, (Model(name=self.model.name, parts=parts), meshes)


def _plain(material: Material) -> Material:
    alpha = material.alpha if material.alpha == "blend" else "opaque"
    return Material(name=material.name, alpha=alpha, double_sided=material.double_sided)


def _frozen(values: NDArray[np.float32]) -> NDArray[np.float32]:
    array = np.ascontiguousarray(values, np.float32)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InvalidRequest("vertices", f"shape {array.shape}", "finite numbers (V, 3)")
    if array.flags.writeable:
        array = array.view()
        array.flags.writeable = False
    return array
