"""Baked light made by hand, for scenes of a few solids."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.baked_light import BakedLight, LightChart, LightLayer, ProbeGrid, Unwrapping
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Model

SIZE = 32
"""Texels along an edge of the light map."""

GRID = ProbeGrid(origin_m=(-5.0, -5.0, -5.0), spacing_m=(5.0, 5.0, 5.0), shape=(3, 3, 3))


def unwrapped(model: Model) -> Unwrapping:
    """Lay a model out by its own texture coordinates."""
    meshes = [part.mesh for part in model.parts]
    return Unwrapping(
        vertices=tuple(np.arange(len(mesh.positions), dtype=np.uint32) for mesh in meshes),
        triangles=tuple(mesh.triangles for mesh in meshes),
        uvs=tuple(mesh.uvs for mesh in meshes),
    )


def chart(model: Model, pose: Pose) -> LightChart:
    """Map a model to the whole light map but a border of four texels."""
    return LightChart(
        unwrapping=unwrapped(model),
        offset=(4 / SIZE, 4 / SIZE),
        scale=((SIZE - 8) / SIZE, (SIZE - 8) / SIZE),
        world_from_body=pose.matrix(),
    )


def layer(
    light: Light | None,
    *,
    direct: ArrayLike = 0.0,
    bounced: ArrayLike = 0.0,
    probe_direct: ArrayLike = 0.0,
    probe_bounced: ArrayLike = 0.0,
    visible: ArrayLike | None = None,
) -> LightLayer:
    """A layer of constants, or of whatever broadcasts to a layer's arrays."""

    def half(value: ArrayLike, *shape: int) -> NDArray[np.float16]:
        return np.broadcast_to(np.asarray(value, np.float16), shape).copy()

    visibility = None
    if visible is not None:
        share = np.broadcast_to(np.asarray(visible, float), (SIZE, SIZE))
        visibility = np.round(255.0 * share).astype(np.uint8)
    return LightLayer(
        light=light,
        direct=half(direct, SIZE, SIZE),
        bounced=half(bounced, SIZE, SIZE, 3),
        probe_direct=half(probe_direct, *GRID.shape, 4, 3),
        probe_bounced=half(probe_bounced, *GRID.shape, 4, 3),
        visibility=visibility,
    )


def baked(
    charts: dict[int, LightChart],
    layers: Sequence[LightLayer],
    surroundings: LightLayer | None = None,
) -> BakedLight:
    """Put a bake together; without surroundings they are black."""
    first = layer(None) if surroundings is None else surroundings
    return BakedLight(fingerprint="test", charts=charts, layers=(first, *layers), probes=GRID)
