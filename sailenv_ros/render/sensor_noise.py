"""The noise of a camera's sensor: photons come one by one, and reading adds some.

Radiance comes in, radiance with noise goes out. A pixel of exposed radiance x collects n = x ·
full_well electrons, give or take √n (shot noise; a normal distribution stands for Poisson's), and
reading it adds `read_noise` electrons: the variance is x / full_well + (read_noise / full_well)².
The same camera at the same simulated time has the same noise.
"""

from __future__ import annotations

import hashlib

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.picture_settings import PictureSettings

__all__ = ["add_sensor_noise"]


def add_sensor_noise(
    radiance: NDArray[np.float16], settings: PictureSettings, name: str, sim_time_ns: int
) -> NDArray[np.float16]:
    """Add noise.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, as the scene's exposure left it; the fourth number is kept.
    settings : PictureSettings
        Of which `full_well` is not 0.
    name : str
        Of the camera; with the time, the generator's seed.
    sim_time_ns : int

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array; 0 or more.
    """
    generator = np.random.Generator(np.random.SFC64(_seed(name, sim_time_ns)))
    factor = 2.0**settings.exposure
    light = radiance[..., :3].astype(np.float32)
    # Variance in units of the radiance that comes in: exposure gathers electrons, too.
    shot = np.float32(1.0 / (settings.full_well * factor))
    read = np.float32((settings.read_noise / (settings.full_well * factor)) ** 2)
    spread = np.sqrt(light * shot + read)
    light += spread * generator.standard_normal(light.shape, np.float32)
    result = radiance.copy()
    np.clip(light, 0.0, 6e4, out=light)
    result[..., :3] = light
    return result


def _seed(name: str, sim_time_ns: int) -> list[int]:
    digest = hashlib.sha256(f"{name}/{sim_time_ns}".encode()).digest()
    return [int.from_bytes(digest[at : at + 4], "little") for at in range(0, 32, 4)]
