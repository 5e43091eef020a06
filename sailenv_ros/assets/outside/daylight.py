"""Light of sun and sky on what lies outside: shadows by boxes and balls that stand for it.

Points and a normal in, the radiance that a white surface would have there out. It is computed
once, when a room is built, and is part of the colour then.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.colour import LUMINANCE
from sailenv_ros.types.lights import Environment, Light

__all__ = ["Daylight", "Occluders", "daylight_of"]

Floats = NDArray[np.float64]
Vector3 = tuple[float, float, float]

_SKY_RAYS = 18
_LIFT_M = 0.03
_SUN_THROUGH, _SKY_THROUGH = 0.15, 0.4
"""Shares of the sun's and the sky's light that come through foliage."""

_HANDED_ON = 0.22
"""Share of the sky's light that surfaces in its way send instead."""


@dataclass(frozen=True, slots=True)
class Daylight:
    """Sun and sky.

    Attributes
    ----------
    towards_sun : (3,) tuple of float
        Unit vector.
    sun : (3,) tuple of float
        Irradiance at normal incidence [W/m²]; zeros for an overcast sky.
    zenith, horizon, ground : (3,) tuple of float
        Radiance of the sky's parts [W/(m² sr)].
    """

    towards_sun: Vector3
    sun: Vector3
    zenith: Vector3
    horizon: Vector3
    ground: Vector3

    def sky(self, directions: Floats) -> Floats:
        """Return (N, 3) radiance from unit directions (N, 3)."""
        up = directions[:, 2:]
        zenith, horizon, ground = (
            np.asarray(part) for part in (self.zenith, self.horizon, self.ground)
        )
        above = horizon + (zenith - horizon) * np.clip(up, 0.0, 1.0) ** 0.6
        return np.where(up > 0.0, above, ground)

    @property
    def is_night(self) -> bool:
        """True if windows are lit while the sky is dark."""
        return float(np.dot(self.horizon, LUMINANCE)) < 0.1 and not any(self.sun)


def daylight_of(lights: Sequence[Light], environment: Environment) -> Daylight:
    """Return the light outside a scene: its strongest directional light and its sky."""
    suns = [light for light in lights if light.type == "directional"]
    sun = max(suns, key=lambda light: light.intensity, default=None)
    x, y, z = (0.0, 0.0, -1.0) if sun is None else sun.direction
    return Daylight(
        towards_sun=(-x, -y, -z),
        sun=(0.0, 0.0, 0.0) if sun is None or z >= 0.0 else sun.power,
        zenith=environment.sky_zenith,
        horizon=environment.sky_horizon,
        ground=environment.sky_ground,
    )


class Occluders:
    """Blockers of light: boxes along the axes and balls of foliage."""

    def __init__(self) -> None:
        self._boxes: list[tuple[Vector3, Vector3]] = []
        self._balls: list[tuple[Vector3, float]] = []
        self._crowns: list[tuple[Vector3, float]] = []

    def add_box(self, low: Vector3, high: Vector3) -> None:
        """Add a box between opposite corners [m]."""
        self._boxes.append((low, high))

    def add_ball(self, centre: Vector3, radius_m: float) -> None:
        """Add a ball of foliage, through which some sunlight falls."""
        self._balls.append((centre, radius_m))

    def add_crown(self, centre: Vector3, radius_m: float) -> None:
        """Add a ball that keeps light of the sky away, as a tree does on the whole."""
        self._crowns.append((centre, radius_m))

    def sky_light(self, daylight: Daylight, points: Floats, normals: Floats) -> Floats:
        """Return (N, 3): radiance of white surfaces in the light of the sky.

        Parameters
        ----------
        daylight : Daylight
        points, normals : (N, 3) float64
            In the world [m], and unit normals.
        """
        start = points + _LIFT_M * normals
        total = np.zeros((len(start), 3))
        directions = _upper_half(_SKY_RAYS)
        radiance = daylight.sky(directions)
        mean = radiance.mean(axis=0)
        for direction, arrives in zip(directions, radiance, strict=True):
            weight = 2.0 / _SKY_RAYS * np.clip((normals * direction).sum(axis=1), 0.0, None)
            free = self._passes(start, direction, self._crowns, _SKY_THROUGH)
            total += weight[:, None] * (
                free[:, None] * arrives + (1.0 - free[:, None]) * _HANDED_ON * mean
            )
        below = 0.5 - 0.5 * normals[:, 2:]
        total += below * _HANDED_ON * (np.asarray(daylight.ground) + mean)
        return total

    def sun_light(self, daylight: Daylight, points: Floats, normals: Floats) -> Floats:
        """Return (N,): share of the sun's irradiance that white surfaces send on, as radiance."""
        towards = np.asarray(daylight.towards_sun)
        facing = np.clip((normals * towards).sum(axis=1), 0.0, None)
        result = np.zeros(len(points))
        lit = facing > 0.0
        if any(daylight.sun) and lit.any():
            start = (points + _LIFT_M * normals)[lit]
            passes = self._passes(start, towards, self._balls, _SUN_THROUGH)
            result[lit] = facing[lit] * passes / math.pi
        return result

    def _passes(
        self,
        start: Floats,
        direction: Floats,
        balls: Sequence[tuple[Vector3, float]],
        through: float,
    ) -> Floats:
        """Return (N,): the share of light from a direction that nothing keeps away."""
        share = np.ones(len(start), np.float32)
        x, y, z = start.T.astype(np.float32)
        dx, dy, dz = (float(d) if abs(d) > 1e-6 else 1e-6 for d in direction)
        for (x0, y0, z0), (x1, y1, z1) in self._boxes:
            ax, bx = (x0 - x) / dx, (x1 - x) / dx
            ay, by = (y0 - y) / dy, (y1 - y) / dy
            az, bz = (z0 - z) / dz, (z1 - z) / dz
            near = np.maximum(np.maximum(np.minimum(ax, bx), np.minimum(ay, by)), 1e-3)
            near = np.maximum(near, np.minimum(az, bz))
            far = np.minimum(np.minimum(np.maximum(ax, bx), np.maximum(ay, by)), np.maximum(az, bz))
            share[near < far] = 0.0
        for (cx, cy, cz), radius in balls:
            tx, ty, tz = cx - x, cy - y, cz - z
            along = tx * dx + ty * dy + tz * dz
            across = tx * tx + ty * ty + tz * tz - along * along
            # Foliage ends softly.
            depth = np.clip((radius * radius - across) / (0.35 * radius * radius), 0.0, 1.0)
            share *= np.where(along > 0.0, 1.0 - (1.0 - through) * depth, 1.0)
        return share.astype(np.float64)


@lru_cache(maxsize=2)
def _upper_half(count: int) -> Floats:
    """Return (N, 3) unit vectors that are spread evenly over the upper half of a sphere."""
    up = (np.arange(count) + 0.5) / count
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - up * up)
    result: Floats = np.stack([flat * np.cos(turn), flat * np.sin(turn), up], axis=1)
    return result
