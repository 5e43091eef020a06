"""Scenes that stand still, for baking, and the baked light read where a renderer would read it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.settings import BakeSettings
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.tiny_scenes import Thing, box_mesh, contents_of, mesh_of, model_of, snapshot_of

COARSE = BakeSettings(texel_m=0.1, fine_texel_m=0.1, probe_spacing_m=1.0, rays=64, light_rays=16)
"""Settings that take well under a second in a small scene."""

DARK = Environment(background="colour", background_colour=(0.0, 0.0, 0.0))

UP = Pose((0.0, 0.0, 0.0))


def still(things: Sequence[Thing], **kwargs: Any) -> WorldSnapshot:
    """A snapshot of things of which none can move."""
    kwargs.setdefault("environment", DARK)
    contents = contents_of(things, **kwargs)
    instances = tuple(
        replace(drawn, instance=replace(drawn.instance, static=True))
        for drawn in contents.instances
    )
    return snapshot_of(things, contents=replace(contents, instances=instances))


def ground(size: float, **material: Any) -> Model:
    """A square in the plane z = 0 that faces up."""
    h = 0.5 * size
    corners = [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)]
    uvs = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return model_of(mesh_of(corners, [(0, 0, 1)] * 4, uvs, [(0, 1, 2), (0, 2, 3)]), **material)


def hollow(size: float | Sequence[float], **material: Any) -> Model:
    """A box around the origin that is seen from inside."""
    box = box_mesh(size)
    return model_of(
        mesh_of(box.positions, -box.normals, box.uvs, box.triangles[:, ::-1]), **material
    )


def read(
    baked: BakedLight, instance: int, snapshot: WorldSnapshot, array: NDArray[Any], steps: int = 7
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read a light map at points spread over an instance, bilinearly.

    Returns
    -------
    points : (N, 3) float64
        World frame.
    values : (N, ...) float64
    """
    row = [drawn.instance.id for drawn in snapshot.contents.instances].index(instance)
    drawn, pose = snapshot.contents.instances[row], snapshot.world_from_body[row]
    chart = baked.charts[instance]
    grid = [
        ((i + 0.3) / steps, (j + 0.4) / steps) for i in range(steps) for j in range(steps - i - 1)
    ]
    weights = np.array([(1 - a - b, a, b) for a, b in grid])
    points, places = [], []
    flat = chart.unwrapping
    for part, vertices, triangles, uvs in zip(
        drawn.model.parts, flat.vertices, flat.triangles, flat.uvs, strict=True
    ):
        corners = part.mesh.positions[vertices[triangles]] * np.asarray(drawn.scale)
        points.append(np.einsum("wc,tcx->twx", weights, corners).reshape(-1, 3))
        places.append(np.einsum("wc,tcx->twx", weights, uvs[triangles]).reshape(-1, 2))
    at = np.concatenate(places) * np.array(chart.scale) + np.array(chart.offset)
    world = np.concatenate(points) @ pose[:3, :3].T + pose[:3, 3]
    return world, bilinear(array, at)


def bilinear(array: NDArray[Any], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Look up as a texture unit does; `at` is x then y, each 0 to 1."""
    height, width = array.shape[:2]
    x, y = at[:, 0] * width - 0.5, at[:, 1] * height - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    extra = (1,) * (array.ndim - 2)
    right, down = (x - left).reshape(-1, *extra), (y - top).reshape(-1, *extra)
    columns = [np.clip(left + i, 0, width - 1) for i in (0, 1)]
    rows = [np.clip(top + i, 0, height - 1) for i in (0, 1)]
    values = array.astype(np.float64)
    upper = values[rows[0], columns[0]] * (1 - right) + values[rows[0], columns[1]] * right
    lower = values[rows[1], columns[0]] * (1 - right) + values[rows[1], columns[1]] * right
    result: NDArray[np.float64] = upper * (1 - down) + lower * down
    return result
