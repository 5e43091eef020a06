"""Meshes of USD → corners of triangles, with normals and texture coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Corners", "corners_of", "faces_by_material"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Corners:
    """Corners of triangles, three in a row; normals and places are None where there are none.

    Attributes
    ----------
    positions, normals : (N, 3) float64
    uvs : (N, 2) float64
        v runs up.
    """

    positions: NDArray[np.float64]
    normals: NDArray[np.float64] | None
    uvs: NDArray[np.float64] | None


def faces_by_material(prim: Any) -> Iterator[tuple[Any, NDArray[np.int64]]]:
    """Yield the materials of a mesh, None for none, and the faces that have them."""
    from pxr import UsdGeom, UsdShade

    count = len(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get() or ())
    left = np.ones(count, bool)
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        faces = np.array(subset.GetIndicesAttr().Get() or (), np.int64)
        faces = faces[(faces >= 0) & (faces < count)]
        left[faces] = False
        yield _bound(subset.GetPrim()), faces
    yield _bound(prim), np.flatnonzero(left)


def _bound(prim: Any) -> Any:
    from pxr import UsdShade

    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    return material if material else None


def corners_of(prim: Any, faces: NDArray[np.int64]) -> Corners:
    """Return the corners of faces of a mesh, which are cut into triangles from their first corner.

    Raises
    ------
    ValueError
        If the mesh names points that it does not have.
    """
    from pxr import UsdGeom

    mesh = UsdGeom.Mesh(prim)
    time = _time()
    points = np.array(mesh.GetPointsAttr().Get(time) or (), np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time) or (), np.int64)
    indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(time) or (), np.int64)
    if counts.sum() != len(indices) or (counts < 0).any():
        raise ValueError(f"the faces of {prim.GetPath()} do not fit its corners")
    if len(indices) and not 0 <= indices.min() <= indices.max() < len(points):
        raise ValueError(f"a face of {prim.GetPath()} names a point that is not there")
    begins = np.cumsum(counts) - counts
    corners, owner = [], []
    for size in np.unique(counts[faces]).tolist():
        own = faces[counts[faces] == size]
        for second in range(1, size - 1):
            fan = begins[own][:, None] + (0, second, second + 1)
            corners.append(fan)
            owner.append(np.repeat(own, 3))
    flat = np.concatenate([c.reshape(-1) for c in corners]) if corners else np.zeros(0, np.int64)
    face = np.concatenate(owner) if owner else np.zeros(0, np.int64)
    if mesh.GetOrientationAttr().Get() == "leftHanded":
        flat = flat.reshape(-1, 3)[:, ::-1].reshape(-1)
    normals = _values(mesh.GetNormalsAttr().Get(time), mesh.GetNormalsInterpolation())
    uvs = None
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("st")
    if primvar and primvar.HasValue():
        uvs = _values(primvar.ComputeFlattened(time), primvar.GetInterpolation())
    return Corners(
        positions=points[indices[flat]],
        normals=_at(normals, flat, face, indices, 3),
        uvs=_at(uvs, flat, face, indices, 2),
    )


def _time() -> Any:
    from pxr import Usd

    return Usd.TimeCode.EarliestTime()


def _values(values: Any, interpolation: str) -> tuple[NDArray[np.float64], str] | None:
    return None if values is None or not len(values) else (np.array(values, float), interpolation)


def _at(
    found: tuple[NDArray[np.float64], str] | None,
    corners: NDArray[np.int64],
    face: NDArray[np.int64],
    indices: NDArray[np.int64],
    width: int,
) -> NDArray[np.float64] | None:
    """Return values at corners by how they are spread over a mesh; None if they do not fit."""
    if found is None or found[0].ndim != 2 or found[0].shape[1] != width:
        return None
    values, interpolation = found
    wanted = {
        "vertex": indices[corners],
        "varying": indices[corners],
        "faceVarying": corners,
        "uniform": face,
        "constant": np.zeros_like(corners),
    }.get(interpolation)
    if wanted is None or (len(wanted) and wanted.max() >= len(values)):
        return None
    picked: NDArray[np.float64] = values[wanted]
    return picked
