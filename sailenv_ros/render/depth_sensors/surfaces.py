"""The surfaces that a depth sensor looks at, and the random numbers of one measurement.

All sums are of operations that are rounded exactly; angles go through tables. So the same surfaces
give the same bytes on every processor.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.picture.sensor import normal_numbers
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["Noise", "Numbers", "Surfaces", "ramp", "table_of_cosine"]

Numbers: TypeAlias = NDArray[np.float32]
"""Numbers of single precision."""

_STEPS = 4096
"""Entries of a table over the cosine, besides the one for 1."""


@dataclass(frozen=True, kw_only=True)
class Surfaces:
    """Surfaces that the pixels of a sensor see.

    Attributes
    ----------
    lens : CameraIntrinsics
    depth : (H, W) float32
        Along the optical axis [m]; ``inf`` or ``nan`` where there is nothing.
    normals, albedo : (H, W, 3) float32
    metallic_roughness : (H, W, 2) float32
    """

    lens: CameraIntrinsics
    depth: Numbers
    normals: Numbers
    albedo: Numbers
    metallic_roughness: Numbers

    @cached_property
    def rays(self) -> Numbers:
        """(H, W, 3): the point at depth 1 m that each pixel sees."""
        return _rays(self.lens)

    @cached_property
    def ray_lengths(self) -> Numbers:
        """(H, W): distance over depth."""
        x, y = self.rays[..., 0], self.rays[..., 1]
        lengths: Numbers = np.sqrt(x * x + y * y + np.float32(1.0))
        return lengths

    @cached_property
    def heights(self) -> Numbers:
        """(H, W): normal · ray, negative for surfaces that face the sensor."""
        n, r = self.normals, self.rays
        heights: Numbers = n[..., 0] * r[..., 0] + n[..., 1] * r[..., 1] + n[..., 2]
        return heights

    @cached_property
    def cosine(self) -> Numbers:
        """(H, W): cosine of the angle of incidence, 0 to 1."""
        cosine: Numbers = np.clip(-self.heights / self.ray_lengths, 0.0, 1.0)
        return cosine

    def returned(self, matt_above: float) -> Numbers:
        """Return (H, W): diffuse reflectance × cosine, 1 for white that faces the sensor.

        Infra-red reflectance is taken to be the luminance of the base colour (Rec. 709). Metals and
        surfaces of a roughness below `matt_above` throw the light elsewhere, the smoother the more.
        """
        red, green, blue = (self.albedo[..., k] for k in range(3))
        luminance = (
            np.float32(0.2126) * red + np.float32(0.7152) * green + np.float32(0.0722) * blue
        )
        metallic, roughness = (self.metallic_roughness[..., k] for k in range(2))
        matt = np.minimum(roughness / np.float32(matt_above), np.float32(1.0))
        light: Numbers = luminance * matt * (1 - metallic * (1 - roughness)) * self.cosine
        return light


class Noise:
    """Random numbers of one measurement; each request draws further ones.

    Parameters
    ----------
    seed : int
        0 to 2⁶⁴ - 1.
    """

    def __init__(self, seed: int) -> None:
        self._generator = np.random.Generator(np.random.PCG64(seed))

    def uniform(self, shape: tuple[int, ...]) -> Numbers:
        """Return numbers from 0 to below 1, in steps of 1 / 65536."""
        drawn = self._generator.integers(0, 65536, shape, np.uint16)
        numbers: Numbers = drawn.astype(np.float32) * np.float32(1 / 65536)
        return numbers

    def normal(self, shape: tuple[int, ...]) -> Numbers:
        """Return independent numbers of a normal distribution of variance 1."""
        numbers: Numbers = normal_numbers()[self._generator.integers(0, 65536, shape, np.uint16)]
        return numbers

    def correlated(self, height: int, width: int, across: int) -> Numbers:
        """Return (height, width): as `normal`, each the mean of a window of the numbers around.

        Parameters
        ----------
        height, width : int
        across : int
            Side of the window [px], 1 for independent numbers.
        """
        rows, columns = height + across - 1, width + across - 1
        field = self.normal((rows, columns))
        if across == 1:
            return field
        # Integers: their sums do not depend on the order.
        steps = np.zeros((rows + 1, columns + 1), np.int64)
        steps[1:, 1:] = np.rint(field * np.float32(65536.0)).astype(np.int64)
        sums = steps.cumsum(axis=0).cumsum(axis=1)
        window = (
            sums[across:, across:]
            - sums[:-across, across:]
            - sums[across:, :-across]
            + sums[:-across, :-across]
        )
        means: Numbers = window.astype(np.float32) * np.float32(1 / (65536 * across))
        return means


def ramp(values: Numbers, zero_at: float, one_at: float) -> Numbers:
    """Return 0 below `zero_at`, 1 above `one_at` (or the other way round), linear between."""
    scale = np.float32(1.0 / (one_at - zero_at))
    share: Numbers = np.clip(
        (values - np.float32(zero_at)) * scale, np.float32(0.0), np.float32(1.0)
    )
    return share


def table_of_cosine(cosine: Numbers, function: Callable[[float], float]) -> Numbers:
    """Return a function of the angle of incidence [rad], in steps of 1 / 4096 of its cosine.

    Parameters
    ----------
    cosine : (...) float32
        0 to 1.
    function : callable
        Asked for angles from 0 to below π / 2.
    """
    places = np.rint(cosine * np.float32(_STEPS)).astype(np.int32)
    found: Numbers = _table(function)[places]
    return found


@lru_cache(maxsize=32)
def _table(function: Callable[[float], float]) -> Numbers:
    # The first entry is of a quarter of a step, where the angle is not yet a right one.
    cosines = [0.25 / _STEPS, *(k / _STEPS for k in range(1, _STEPS + 1))]
    return np.array([function(math.acos(c)) for c in cosines], np.float32)


@lru_cache(maxsize=8)
def _rays(lens: CameraIntrinsics) -> Numbers:
    rays = lens.rays().astype(np.float32)
    rays.flags.writeable = False
    return rays
