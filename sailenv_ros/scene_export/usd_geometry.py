"""Meshes of USD: drawn ones, shared where they are equal, and hulls that collide."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.contents import ExportedPiece, ExportedScene, Vector3
from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.scene_export.textures import texture_slots
from sailenv_ros.scene_export.usd_materials import UsdMaterials, is_lit
from sailenv_ros.scene_export.usd_text import UsdText, array, quoted, vector, vectors
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import ModelPart

__all__ = ["UsdGeometry", "used_points", "write_place", "write_points"]

Key = tuple[tuple[int, int], ...]


class UsdGeometry:
    """Drawn meshes of a scene.

    Parameters
    ----------
    text : UsdText
    scene : ExportedScene
    materials : UsdMaterials
        Written already.
    path : str
        Of the prim that holds the classes of what is there several times.
    """

    def __init__(
        self, text: UsdText, scene: ExportedScene, materials: UsdMaterials, path: str
    ) -> None:
        self._text = text
        self._materials = materials
        self._path = path
        self._classes: dict[Key, str] = {}
        pieces = [piece for body in scene.bodies for piece in body.pieces if piece.parts]
        pieces = [piece for piece in pieces if not piece.light_places]  # each has its own
        motion = scene.motion
        self._moved = {} if motion is None else motion.meshes
        self._codes = [] if motion is None else motion.codes
        self._counts = Counter(
            _key(piece.parts) for piece in pieces if piece.instance.id not in self._moved
        )
        self._shared = {_key(piece.parts): piece for piece in pieces}

    def write_classes(self) -> None:
        """Write what is there several times as classes, which instances inherit."""
        shared = [key for key, count in self._counts.items() if count > 1]
        if not shared:
            return
        names = FreeNames()
        with self._text.prim("Scope", self._path.rpartition("/")[2]):
            for key in shared:
                piece = self._shared[key]
                name = names.take(f"class {piece.instance.asset}")
                self._classes[key] = f"{self._path}/{name}"
                with self._text.prim("Xform", name, specifier="class"):
                    self._write_parts(piece)

    def write_piece(self, piece: ExportedPiece, scale: Vector3, name: str) -> None:
        """Write what is drawn of a piece, in the body's frame."""
        text, metadata = self._text, {}
        found = None if piece.light_places else self._classes.get(_key(piece.parts))
        if found is not None:
            metadata = {"inherits": f"<{found}>", "instanceable": "true"}
        with text.prim("Xform", name, metadata=metadata):
            if scale != (1.0, 1.0, 1.0):
                text.attribute("float3", "xformOp:scale", vector(scale))
                text.attribute("uniform token[]", "xformOpOrder", '["xformOp:scale"]')
            if found is None:
                self._write_parts(piece, self._moved.get(piece.instance.id, ()))

    def _write_parts(
        self, piece: ExportedPiece, samples: Sequence[Sequence[MovedMesh]] = ()
    ) -> None:
        text, names = self._text, FreeNames()
        for place, part in enumerate(piece.parts):
            name = names.take(part.names[0] if part.names else "mesh")
            mesh = part.mesh
            with text.prim("Mesh", name, schemas=["MaterialBindingAPI"]):
                if part.material.double_sided:
                    text.attribute("uniform bool", "doubleSided", "1")
                used = np.unique(mesh.triangles)
                points, triangles = used_points(mesh.positions, mesh.triangles)
                write_points(text, points, triangles)
                normals = vectors(mesh.normals[used], 6)
                text.attribute("normal3f[]", "normals", normals, of="vertex")
                if samples:
                    moved = [sample[place] for sample in samples]
                    self._write_samples("point3f[]", "points", [m.positions[used] for m in moved])
                    self._write_samples("normal3f[]", "normals", [m.normals[used] for m in moved])
                    ends = [np.stack([m.positions[used].min(0), m.positions[used].max(0)])
                            for m in moved]  # fmt: skip
                    self._write_samples("float3[]", "extent", ends)
                if any(texture_slots(part.material)):
                    uvs = vectors(mesh.uvs[used], 7)
                    text.attribute("texCoord2f[]", "primvars:st", uvs, of="vertex")
                lit = is_lit(piece, part.material)
                if lit:
                    across, down = piece.light_places[place][used].T
                    uvs = vectors(np.stack([across, 1.0 - down], axis=-1), 7)
                    text.attribute("texCoord2f[]", "primvars:st1", uvs, of="vertex")
                text.relate("material:binding", self._materials.path(part.material, lit=lit))

    def _write_samples(self, kind: str, name: str, arrays: Sequence[NDArray[Any]]) -> None:
        values = (vectors(array, 6) for array in arrays)
        self._text.samples(kind, name, dict(zip(self._codes, values, strict=True)))


def used_points(
    points: NDArray[Any], triangles: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[np.intp]]:
    """Return the points that triangles use, in their order, and the triangles of these."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return points[used], numbers.reshape(-1, 3)


def write_points(text: UsdText, points: NDArray[Any], triangles: NDArray[Any]) -> None:
    """Write points and triangles of a mesh, as they are."""
    text.attribute("float3[]", "extent", vectors(np.stack([points.min(0), points.max(0)])))
    counts = ", ".join(["3"] * len(triangles))
    text.attribute("int[]", "faceVertexCounts", f"[{counts}]")
    text.attribute("int[]", "faceVertexIndices", array(triangles))
    text.attribute("point3f[]", "points", vectors(points))
    text.attribute("uniform token", "subdivisionScheme", quoted("none"))


def write_place(
    text: UsdText,
    pose: Pose,
    *,
    more: Iterable[str] = (),
    samples: Mapping[float, Pose] = MappingProxyType({}),
) -> None:
    """Write the pose of an Xform; `more` are the operations that follow it.

    Poses by time codes are `samples`.
    """
    text.attribute("quatd", "xformOp:orient", _turn(pose))
    text.attribute("double3", "xformOp:translate", vector(pose.position_m))
    if samples:
        turns = {code: _turn(one) for code, one in samples.items()}
        text.samples("quatd", "xformOp:orient", turns)
        places = {code: vector(one.position_m) for code, one in samples.items()}
        text.samples("double3", "xformOp:translate", places)
    order = ["xformOp:translate", "xformOp:orient", *more]
    names = ", ".join(quoted(name) for name in order)
    text.attribute("uniform token[]", "xformOpOrder", f"[{names}]")


def _turn(pose: Pose) -> str:
    x, y, z, w = pose.orientation_xyzw
    return vector((w, x, y, z))


def _key(parts: Sequence[ModelPart]) -> Key:
    return tuple((id(part.mesh), id(part.material)) for part in parts)
