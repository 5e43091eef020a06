"""A sheet that waves, and where each of its points is: by rays against its triangles, in NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.model import Mesh, Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.tiny_scenes import Thing, mesh_of, snapshot_of

Doubles = NDArray[np.float64]

CELLS = 12


def sheet_mesh(size: float = 2.0) -> Mesh:
    """A grid in the plane x = 0 that faces -x."""
    place = np.linspace(-0.5 * size, 0.5 * size, CELLS + 1)
    y, z = np.meshgrid(-place, place)
    positions = np.stack([0.0 * y, y, z], axis=-1).reshape(-1, 3)
    corner = np.arange(CELLS * (CELLS + 1)).reshape(CELLS, CELLS + 1)[:, :-1].reshape(-1)
    up = corner + CELLS + 1
    triangles = np.concatenate([
        np.stack([corner, corner + 1, up + 1], axis=1), np.stack([corner, up + 1, up], axis=1)
    ])  # fmt: skip
    uvs = (positions[:, 1:] / size + 0.5)[:, ::-1]
    return mesh_of(positions, np.tile([-1.0, 0.0, 0.0], (len(positions), 1)), uvs, triangles)


def waved(model: Model, phase: float, *, above_m: float = -9.0) -> Deformation:
    """The sheet as a wave runs through it; what lies lower than `above_m` stays at rest."""
    rest = model.parts[0].mesh.positions.astype(np.float64)
    high = rest[:, 2] >= above_m
    moved = rest.copy()
    moved[high, 0] += 0.2 * np.sin(2.0 * rest[high, 1] + phase)
    moved[high, 1] += 0.05 * np.cos(3.0 * rest[high, 2] - phase)
    normals = np.tile(np.array([-1.0, 0.0, 0.0], np.float32), (len(rest), 1))
    return Deformation.of(model, [(moved.astype(np.float32), normals)])


def deforming_snapshot(
    things: Sequence[Thing], shapes: Sequence[Deformation | None], **kwargs: Any
) -> WorldSnapshot:
    """A snapshot in which things with a shape deform."""
    made = snapshot_of(things, **kwargs)
    drawn = tuple(
        replace(one, deforms=shape is not None)
        for one, shape in zip(made.contents.instances, shapes, strict=True)
    )
    ids = [one.instance.id for one in drawn]
    return replace(
        made,
        contents=replace(made.contents, instances=drawn),
        deformations={
            key: shape for key, shape in zip(ids, shapes, strict=True) if shape is not None
        },
    )


def corners_in_world(
    shape: Deformation, world_from_body: Doubles, scale: Sequence[float] = (1.0, 1.0, 1.0)
) -> Doubles:
    """(T, 3, 3): corners of the triangles of the first mesh."""
    points = shape.meshes[0].positions.astype(np.float64) * np.asarray(scale)
    world = points @ world_from_body[:3, :3].T + world_from_body[:3, 3]
    found: Doubles = world[shape.model.parts[0].mesh.triangles]
    return found


def first_hits(camera: Camera, corners: Doubles) -> tuple[NDArray[np.int64], Doubles]:
    """(H, W) the nearest triangle along each pixel's ray, -1 for none, and (H, W, 3) weights."""
    lens = camera.intrinsics
    rays = lens.rays().reshape(-1, 3) @ camera.world_from_camera[:3, :3].T
    eye = camera.world_from_camera[:3, 3]
    first, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(rays[:, None], ac[None])
    determinant = (p * ab).sum(axis=2)
    s = eye - first
    q = np.cross(s, ab)
    with np.errstate(all="ignore"):
        u = (p * s).sum(axis=2) / determinant
        v = (rays[:, None] * q).sum(axis=2) / determinant
        t = (q * ac).sum(axis=1) / determinant
        met = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    t = np.where(met, t, np.inf)
    nearest = t.argmin(axis=1)
    row = np.arange(len(rays))
    second, third = u[row, nearest], v[row, nearest]
    nearest = np.where(np.isfinite(t[row, nearest]), nearest, -1)
    shape = lens.height, lens.width
    weights = np.stack([1.0 - second - third, second, third], axis=1)
    return nearest.reshape(shape), weights.reshape(*shape, 3)
