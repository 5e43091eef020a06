"""Lamps themselves in what a room mirrors: they have no body that a picture could show.

A lamp and pictures of depth around a point come in; its radiance by direction, or the irradiance of
its one direction, goes out. What lies between hides it. Knows no graphics library.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import LitPoints
from sailenv_ros.native.light_kernels import light_samples
from sailenv_ros.native.ray_types import RAY_LIGHT
from sailenv_ros.native.render_types import record
from sailenv_ros.render.scene.reflection_map import EDGE, Glint, octahedral_directions
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.lights import LAMP_TYPES, Light, area_sides, lamp_rows

__all__ = ["Seen", "Surroundings", "glint_of", "mirrored_lights", "radiance_of"]

SUBDIVISIONS = 4
"""Directions along a texel's edge that are looked in for an area light."""

NEAR_M = 0.02
"""Surfaces that are nearer than a lamp by less do not hide it: a pixel of depth is as wide."""


class Seen(NamedTuple):
    """Picture of what lies around a point.

    Attributes
    ----------
    radiance : (H, W, 3) float32
        Linear.
    depth_m : (H, W) float32
        Along the optical axis [m]; infinite where nothing is.
    """

    radiance: NDArray[np.float32]
    depth_m: NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True)
class Surroundings:
    """Pictures around a point by cameras that together see everything."""

    cameras: list[Camera]
    pictures: list[Seen]

    @property
    def position_m(self) -> NDArray[np.float64]:
        """(3,): the point [m]."""
        at: NDArray[np.float64] = self.cameras[0].world_from_camera[:3, 3]
        return at

    def is_free(self, offsets: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (N,): whether nothing lies on the way to points, (N, 3) from here [m]."""
        free = np.zeros(len(offsets), np.bool_)
        best = np.zeros(len(offsets))
        for camera, seen in zip(self.cameras, self.pictures, strict=True):
            x, y, z = (offsets @ camera.world_from_camera[:3, :3]).T
            mine = np.flatnonzero(z > best)
            best[mine] = z[mine]
            u, v = camera.intrinsics.places_of_rays(x[mine] / z[mine], y[mine] / z[mine])
            height, width = seen.depth_m.shape
            column = np.clip(np.rint(u), 0, width - 1).astype(np.intp)
            row = np.clip(np.rint(v), 0, height - 1).astype(np.intp)
            free[mine] = seen.depth_m[row, column] > z[mine] - NEAR_M
        return free


def mirrored_lights(
    lights: Iterable[Light], main: Light | None, live: Collection[Light]
) -> NDArray[np.void]:
    """Return (N,) RAY_LIGHT: all lights that shine, but those whose highlights are drawn live.

    Parameters
    ----------
    main : Light or None
        The light that casts the shadow map; drawn live.
    live : collection of Light
        Others that are.
    """
    rows = [
        light_record(light)
        for light in lights
        if light is not main and light not in live and any(light.power)
    ]
    return np.concatenate(rows) if rows else np.zeros(0, RAY_LIGHT)


def radiance_of(light: Light, around: Surroundings) -> NDArray[np.float32]:
    """Return (EDGE, EDGE, 3): what an area light adds to a map of all directions.

    It shines from its whole face and hides nothing, as light that is baked has it: behind that of a
    window lies the sky. All other lamps have no face.
    """
    result = np.zeros((EDGE, EDGE, 3), np.float32)
    forward = np.asarray(light.direction)
    middle = np.asarray(light.position_m) - around.position_m
    if light.type != "area" or middle @ forward >= 0.0:
        return result
    directions = octahedral_directions(EDGE * SUBDIVISIONS).reshape(-1, 3)
    along = directions @ forward.astype(np.float32)
    facing = np.flatnonzero(along < -1e-6)
    offsets = directions[facing] * (middle @ forward / along[facing])[:, None]
    on_it = np.ones(len(facing), np.bool_)
    for side in area_sides(light):
        on_it &= np.abs((offsets - middle) @ side) <= 0.5 * (side @ side)
    seen = np.zeros(len(directions), np.float32)
    seen[facing[on_it]] = around.is_free(offsets[on_it])
    share = seen.reshape(EDGE, SUBDIVISIONS, EDGE, SUBDIVISIONS).mean(axis=(1, 3))
    result[:] = share[..., None] * np.array(light.power, np.float32)
    return result


def glint_of(light: Light, around: Surroundings) -> Glint | None:
    """Return what arrives from a point or spot light; None of other kinds, and from hidden ones."""
    if light.type not in LAMP_TYPES:
        return None
    here = around.position_m.astype(np.float32)[None]
    nowhere = np.zeros((1, 3), np.float32)
    point = LitPoints(here, nowhere, nowhere, np.zeros((1, 2), np.float32))
    lamp = record(RAY_LIGHT, lamp=lamp_rows([light])[0])
    towards, _, irradiance = light_samples(lamp, point, np.full((1, 2), 0.5, np.float32))
    offset = towards[0, 0].astype(np.float64)
    if irradiance[0, 0] <= 0.0 or not around.is_free(offset[None])[0]:
        return None
    power = np.array(light.power)
    return Glint(offset / np.linalg.norm(offset), power * float(irradiance[0, 0]))
