"""Geometry of a link → what is drawn of it, and what it collides as."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.hulls import convex_hull, hulls_of_pieces, merged
from sailenv_ros.assets.meshes import RawMesh, components, is_open, smooth_mesh, welded
from sailenv_ros.assets.model_files import MAX_TRIANGLES, MODEL_SUFFIXES, RawPart, read_parts
from sailenv_ros.assets.part_budget import simplified_parts
from sailenv_ros.assets.robots.raw_links import RawGeometry
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    Material,
    ModelPart,
    SphereShape,
)

__all__ = ["collision_of", "drawn_parts"]

Doubles = NDArray[np.float64]

BARE = (0.6, 0.6, 0.62, 1.0)
"""Colour of what has none in its file."""

ROUND = 64
"""Corners of a circle that is drawn."""

MOST_PIECES = 24
"""Pieces of one collision mesh that get a hull each; more get one hull together."""

LARGEST_M = 100.0

# Model files have y up, and are read as if they did; robots' have z up, as their links.
_FILE_FROM_BODY = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])


def drawn_parts(geometries: Sequence[RawGeometry], name: str) -> tuple[ModelPart, ...]:
    """Return what is drawn of a link, in its frame.

    Raises
    ------
    AssetError
        If a file cannot be read, or the link would be too large.
    """
    raw = [part for geometry in geometries for part in _raw_parts(geometry)]
    if not raw:
        return ()
    points = np.concatenate(
        [part.mesh.positions[part.mesh.triangles].reshape(-1, 3) for part in raw]
    )
    size = np.ptp(points, axis=0)
    if not np.isfinite(points).all() or float(np.abs(points).max()) > LARGEST_M:
        raise AssetError(name, f"it would reach farther than {LARGEST_M:g} m from its frame")
    parts = []
    for part in simplified_parts(raw, float(np.linalg.norm(size))):
        mesh = smooth_mesh(part.mesh)
        if len(mesh.triangles):
            material = part.material
            if is_open(part.mesh):
                material = replace(material, double_sided=True)
            parts.append(ModelPart(mesh=mesh, material=material))
    return tuple(parts)


def collision_of(geometries: Sequence[RawGeometry]) -> tuple[CollisionShape, ...]:
    """Return what a link collides as: boxes and balls as they are, all else as convex hulls."""
    return tuple(shape for geometry in geometries for shape in _shapes(geometry))


def _shapes(geometry: RawGeometry) -> Iterator[CollisionShape]:
    pose = geometry.pose
    if geometry.kind == "box":
        x, y, z = geometry.size
        yield BoxShape(
            half_extents_m=(0.5 * x, 0.5 * y, 0.5 * z),
            centre_m=pose.position_m,
            orientation_xyzw=pose.orientation_xyzw,
        )
    elif geometry.kind == "sphere":
        yield SphereShape(radius_m=geometry.size[0], centre_m=pose.position_m)
    elif geometry.kind == "mesh":
        mesh = merged([part.mesh for part in _raw_parts(geometry)])
        mesh = welded(replace(mesh, uvs=np.zeros_like(mesh.uvs)))
        if int(components(mesh).max()) >= MOST_PIECES:
            yield convex_hull(mesh.positions)
        else:
            yield from hulls_of_pieces(mesh)
    else:
        mesh = _solid(geometry, corners=ROUND)
        turn, place = pose.matrix()[:3, :3], np.asarray(pose.position_m)
        yield ConvexShape(points=mesh.positions @ turn.T + place)


def _raw_parts(geometry: RawGeometry) -> list[RawPart]:
    """Return the meshes of a geometry in the link's frame."""
    if geometry.kind != "mesh":
        parts = [_part(_solid(geometry, corners=ROUND))]
    elif geometry.mesh is not None:
        parts = [_part(geometry.mesh)]
    else:
        assert geometry.file is not None
        parts = _of_file(geometry.file)
    scale = np.asarray(geometry.scale)
    matrix, coloured = geometry.pose.matrix(), geometry.colour
    placed = []
    for part in parts:
        points = (part.mesh.positions * scale) @ matrix[:3, :3].T + matrix[:3, 3]
        triangles = part.mesh.triangles
        if np.prod(scale) < 0.0:
            triangles = triangles[:, ::-1].copy()
        mesh = replace(part.mesh, positions=points, triangles=triangles, normals=None)
        material = part.material
        if not material.name:
            red, green, blue, alpha = coloured or BARE
            material = Material(
                base_colour=(red, green, blue, alpha),
                roughness=geometry.roughness,
                alpha="blend" if alpha < 0.95 else "opaque",
            )
        elif coloured is not None:
            # A description tints what its meshes bring: white leaves them as they are.
            product = [a * b for a, b in zip(material.base_colour, coloured, strict=True)]
            red, green, blue, alpha = product
            material = replace(material, base_colour=(red, green, blue, alpha))
        placed.append(replace(part, mesh=mesh, material=material))
    return placed


def _part(mesh: RawMesh) -> RawPart:
    return RawPart(name="", mesh=mesh, material=Material(), textured=False)


def _of_file(path: Path) -> list[RawPart]:
    """Read a mesh file; what has no material of its own has one without a name."""
    if path.suffix.lower() not in MODEL_SUFFIXES:
        return [_part(_of_other_file(path))]
    own = path.suffix.lower() != ".obj" or _has_materials(path)
    found = []
    for part in read_parts(path):
        positions = part.mesh.positions @ _FILE_FROM_BODY.T
        material = part.material if own else Material()
        if own and not material.name:
            material = replace(material, name="own")
        mesh = replace(part.mesh, positions=positions, normals=None)
        found.append(replace(part, mesh=mesh, material=material))
    return found


def _has_materials(path: Path) -> bool:
    """Return whether an OBJ file's library of materials lies beside it."""
    with path.open("r", encoding="utf-8", errors="replace") as lines:
        for line in lines:
            if line.startswith("mtllib "):
                return (path.parent / line.split(maxsplit=1)[1].strip()).is_file()
            if line.startswith("f "):
                return False
    return False


def _of_other_file(path: Path) -> RawMesh:
    """Read STL, COLLADA or what else the reader of meshes knows."""
    import trimesh

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # authors' oddities
            loaded: Any = trimesh.load(path, force="mesh", process=False)
        positions = np.asarray(loaded.vertices, np.float64)
        triangles = np.asarray(loaded.faces, np.int64)
    except Exception as problem:  # whatever a broken file makes the reader stumble over
        shown = " ".join(f"{type(problem).__name__}: {problem}".split())[:200]
        raise AssetError(path.name, f"it cannot be read ({shown})") from problem
    if not len(triangles) or not np.isfinite(positions).all():
        raise AssetError(path.name, "it holds no triangles, or coordinates that are not finite")
    if len(triangles) > MAX_TRIANGLES:
        raise AssetError(path.name, f"it has more than {MAX_TRIANGLES} triangles")
    return welded(
        RawMesh(positions=positions, uvs=np.zeros((len(positions), 2)), triangles=triangles)
    )


def _solid(geometry: RawGeometry, *, corners: int) -> RawMesh:
    import trimesh

    kind, size = geometry.kind, geometry.size
    if kind == "box":
        mesh = trimesh.creation.box(size)
    elif kind in ("sphere", "ellipsoid"):
        mesh = trimesh.creation.icosphere(subdivisions=3 if corners == ROUND else 1)
        mesh.apply_scale(size * 3 if kind == "sphere" else size)
    elif kind == "cylinder":
        mesh = trimesh.creation.cylinder(radius=size[0], height=size[1], sections=corners)
    else:
        rounds = (corners // 3, corners // 3)
        mesh = trimesh.creation.capsule(radius=size[0], height=size[1], count=rounds)
    points = np.asarray(mesh.vertices, np.float64)
    return RawMesh(
        positions=points,
        uvs=np.zeros((len(points), 2)),
        triangles=np.asarray(mesh.faces, np.int64),
    )


def box_tensor(points: Doubles, mass_kg: float) -> Doubles:
    """Return the (3, 3) inertia of a box around points [kg m²]."""
    x, y, z = np.maximum(np.ptp(points, axis=0), 1e-3)
    return np.diag([y * y + z * z, x * x + z * z, x * x + y * y]) * mass_kg / 12.0
