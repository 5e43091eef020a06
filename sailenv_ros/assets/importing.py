"""A user's own model file → an `Asset`: checked, stood upright, sized, with collision pieces.

A path to a glTF, an OBJ or a zip archive in, an `Asset` out. Writes nothing but a folder for what
it unpacks, which is gone afterwards.
"""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.archives import MAX_ARCHIVE_BYTES, unpack_zip
from sailenv_ros.assets.gltf_layout import check_layout
from sailenv_ros.assets.hulls import convex_hull, convex_parts, merged
from sailenv_ros.assets.meshes import RawMesh, is_open, smooth_mesh
from sailenv_ros.assets.model_files import MODEL_SUFFIXES, RawPart, read_parts
from sailenv_ros.errors import AssetError, InvalidRequest
from sailenv_ros.types.model import Asset, CollisionShape, Model, ModelPart
from sailenv_ros.types.validation import IDENTIFIER

__all__ = ["import_asset"]

DENSITY_KG_M3 = 150.0
"""Mean density of household objects, which are mostly air."""

LARGEST_M = 50.0
SMALLEST_M = 1e-3


def import_asset(
    path: Path,
    *,
    name: str,
    display_name: str | None = None,
    category: str,
    height_m: float | None = None,
    mass_kg: float | None = None,
    convex: bool = True,
) -> Asset:
    """Make an asset from a model file.

    Parameters
    ----------
    path : Path
        ``.glb``, ``.gltf``, ``.obj`` with its ``.mtl``, or a ``.zip`` with one of them.
    name : str
        Catalogue name: lower-case letters, digits and underscores.
    display_name : str or None
        ``None`` makes one from `name`.
    category : str
        Name of its category; not checked here.
    height_m : float or None
        Scales the model to this height [m]; ``None`` takes its unit for the metre.
    mass_kg : float or None
        ``None`` estimates it from its size.
    convex : bool
        True for a convex decomposition, False for one hull around it all, which takes no time.

    Raises
    ------
    InvalidRequest
        If a name or a size cannot be accepted.
    AssetError
        If the file is malformed, too large (200 MB, 5 million triangles) or malicious.
    """
    if not IDENTIFIER.fullmatch(name):
        raise InvalidRequest("asset name", name, "lower-case letters, digits and _, at most 63")
    if height_m is not None and not SMALLEST_M <= height_m <= LARGEST_M:
        raise InvalidRequest("height_m", height_m, f"a length from {SMALLEST_M} to {LARGEST_M} [m]")
    check_file(path)
    with tempfile.TemporaryDirectory(prefix="sailenv-") as folder:
        file = _model_file(path, Path(folder))
        if file.suffix.lower() in (".glb", ".gltf"):
            check_layout(file)
        parts = read_parts(file)
    meshes = [_standing(parts, part, height_m) for part in parts]
    collision = _collision(meshes, convex=convex)
    model = Model(name=name, parts=_drawn(parts, meshes))
    low, high = model.bounds()
    return Asset(
        name=name,
        display_name=display_name or name.replace("_", " ").title(),
        category=category,
        model=model,
        collision=collision,
        mass_kg=_estimated_kg(low, high) if mass_kg is None else mass_kg,
        centre_of_mass_m=(0.0, 0.0, float(high[2]) / 2.0),
    )


def check_file(path: Path) -> None:
    """Refuse a file that is not there, or is larger than archives may be.

    Raises
    ------
    AssetError
    """
    if not path.is_file():
        raise AssetError(path.name, f"there is no such file ({path})")
    if path.stat().st_size > MAX_ARCHIVE_BYTES:
        raise AssetError(path.name, f"it is larger than {MAX_ARCHIVE_BYTES // 2**20} MB")


def _model_file(path: Path, folder: Path) -> Path:
    if path.suffix.lower() != ".zip":
        return path
    files = unpack_zip(path, folder)
    models = [file for file in files if file.suffix.lower() in MODEL_SUFFIXES]
    if len(models) != 1:
        found = ", ".join(sorted(file.name for file in models)) or "none"
        raise AssetError(path.name, f"it must hold one model file, and it holds: {found}")
    return models[0]


def _standing(parts: Sequence[RawPart], part: RawPart, height_m: float | None) -> RawMesh:
    """Return a part's mesh in metres, the whole model's base centred on the origin."""
    low, high = bounds_of(parts)
    size = high - low
    if not size.max() > 0.0:
        raise AssetError(part.name, "the model has no extent")
    scale = 1.0 if height_m is None else height_m / max(float(size[2]), 1e-9)
    if not SMALLEST_M <= scale * float(size.max()) <= LARGEST_M:
        raise AssetError(
            part.name,
            f"it would be {scale * float(size.max()):.4g} m large, and {SMALLEST_M} to "
            f"{LARGEST_M} m are accepted; give its height",
        )
    base = np.array([*(low[:2] + high[:2]) / 2.0, low[2]])
    mesh = part.mesh
    return RawMesh(
        positions=(mesh.positions - base) * scale,
        uvs=mesh.uvs,
        triangles=mesh.triangles,
        normals=mesh.normals,
    )


def bounds_of(parts: Sequence[RawPart]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lowest and the highest corner of what triangles of some parts use."""
    points = np.concatenate([p.mesh.positions[np.unique(p.mesh.triangles)] for p in parts])
    return points.min(axis=0), points.max(axis=0)


def _drawn(parts: Sequence[RawPart], meshes: Sequence[RawMesh]) -> tuple[ModelPart, ...]:
    drawn = []
    for part, mesh in zip(parts, meshes, strict=True):
        material = part.material
        if not material.double_sided and is_open(mesh):
            material = dataclasses.replace(material, double_sided=True)
        smooth = smooth_mesh(mesh)
        if len(smooth.triangles):
            drawn.append(ModelPart(mesh=smooth, material=material))
    if not drawn:
        raise AssetError(parts[0].name, "none of its triangles has an area, for its size")
    return tuple(drawn)


def _collision(meshes: Sequence[RawMesh], *, convex: bool) -> tuple[CollisionShape, ...]:
    whole = merged(meshes)
    if convex:
        return convex_parts(whole)
    return (convex_hull(whole.positions[np.unique(whole.triangles)]),)


def _estimated_kg(low: NDArray[np.float64], high: NDArray[np.float64]) -> float:
    volume = float(np.prod(np.maximum(high - low, SMALLEST_M)))
    return float(np.clip(DENSITY_KG_M3 * volume, 0.01, 500.0))
