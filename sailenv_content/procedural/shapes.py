"""Boxes, rods and parts: what the makers of objects are built on."""

from __future__ import annotations

import dataclasses

import numpy as np

from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.solids import box_mesh, cylinder_mesh
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.model import Material, Mesh, Texture

__all__ = ["Vector3", "box", "painted_part", "part", "printed_part", "raw_mesh", "rod"]

Vector3 = tuple[float, float, float]


def part(name: str, mesh: RawMesh | Mesh, **material: object) -> RawPart:
    """Return a mesh with a material of that name; the rest of the material in keywords."""
    return RawPart(
        name=name,
        mesh=mesh if isinstance(mesh, RawMesh) else raw_mesh(mesh),
        material=Material(name=name, **material),  # type: ignore[arg-type]
        textured=True,
    )


def raw_mesh(mesh: Mesh) -> RawMesh:
    """Return a finished mesh as one that can be worked on."""
    return RawMesh(
        positions=mesh.positions.astype(np.float64),
        uvs=mesh.uvs.astype(np.float64),
        triangles=mesh.triangles.astype(np.int64),
        normals=mesh.normals.astype(np.float64),
    )


def box(size: Vector3, centre: Vector3) -> RawMesh:
    """Return a box."""
    raw = raw_mesh(box_mesh(size))
    return dataclasses.replace(raw, positions=raw.positions + np.asarray(centre))


def rod(radius: float, length: float, centre: Vector3, end_radius: float | None = None) -> RawMesh:
    """Return a cylinder or a cone's stump along x."""
    raw = raw_mesh(cylinder_mesh(1.0, 1.0))
    z = raw.positions[:, 2] + 0.5
    scale = radius + (radius if end_radius is None else end_radius) * z - radius * z
    positions = np.stack(
        [raw.positions[:, 2] * length, raw.positions[:, 0] * scale, raw.positions[:, 1] * scale],
        axis=1,
    )
    return RawMesh(positions=positions + np.asarray(centre), uvs=raw.uvs, triangles=raw.triangles)


def painted_part(
    name: str, mesh: RawMesh, colour: str, *, roughness: float = 0.5, **more: object
) -> RawPart:
    """Return a mesh of one colour, ``#rrggbb``; words of its name choose a finish."""
    base_colour = (*colour_of(colour), 1.0)
    return part(name, mesh, base_colour=base_colour, roughness=roughness, **more)


def colour_of(text: str) -> tuple[float, float, float]:
    """Return the linear colour of ``#rrggbb``."""
    srgb = np.frombuffer(bytes.fromhex(text[1:]), np.uint8) / 255.0
    red, green, blue = (float(value) for value in linear_from_srgb(srgb))
    return red, green, blue


def printed_part(name: str, mesh: RawMesh, print_: Texture, *, roughness: float = 0.8) -> RawPart:
    """Return a mesh that a picture is printed on."""
    return part(
        name,
        mesh,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        base_colour_texture=print_,
        roughness=roughness,
    )
