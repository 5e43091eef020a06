"""The view `raw`: what the pixels of a sensor behind a Bayer filter count, before any processing.

Noise has the law and the random numbers of the picture's (`sensor`): both are of one exposure.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.picture.sensor import noise_variance, normal_numbers, sensor_seed
from sailenv_ros.types.bayer import BLACK_LEVEL, WHITE_LEVEL, mosaic
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["raw_data"]


def raw_data(
    light: NDArray[np.float16], settings: PictureSettings, name: str, sim_time_ns: int
) -> NDArray[np.uint16]:
    """Count light.

    Parameters
    ----------
    light : (H, W, 4) float16
        Linear, as it arrives at the sensor, without noise; the fourth number is not looked at.
    settings : PictureSettings
        Of which `exposure`, `gain`, `full_well` and `read_noise` count.
    name : str
        Of the camera; with the time, the noise's seed.
    sim_time_ns : int

    Returns
    -------
    raw : (H, W) uint16
        See `VIEWS`: `BLACK_LEVEL` + (`WHITE_LEVEL` - `BLACK_LEVEL`) · 2^(exposure + gain) · light,
        rounded, as far as 16 bits go.
    """
    height, width = light.shape[:2]
    counted = mosaic(light).astype(np.float64)
    if settings.full_well > 0.0:
        shot, read = noise_variance(settings)
        seed = sensor_seed(name, sim_time_ns)
        counted += np.sqrt(counted * shot + read) * _noise(height, width, seed)
    scale = (WHITE_LEVEL - BLACK_LEVEL) * 2.0 ** (settings.exposure + settings.gain)
    counted *= scale
    counted += BLACK_LEVEL
    raw: NDArray[np.uint16] = np.rint(counted.clip(0.0, WHITE_LEVEL)).astype(np.uint16)
    return raw


def _noise(height: int, width: int, seed: int) -> NDArray[np.float32]:
    """Return (H, W) float32: numbers of a normal distribution, those that `gather_light` adds.

    S. Vigna's SplitMix64, as in `native/src/kernels/sensor.cpp`: each pixel has 16 bits a colour.
    """
    with np.errstate(over="ignore"):
        z = np.arange(1, height * width + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        z += np.uint64(seed % 2**64)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    bits = (z ^ (z >> np.uint64(31))).reshape(height, width)
    shifts = np.array([0, 16, 32], np.uint64)
    shift = mosaic(np.broadcast_to(shifts, (height, width, 3)))
    numbers: NDArray[np.float32] = normal_numbers()[(bits >> shift) & np.uint64(0xFFFF)]
    return numbers
