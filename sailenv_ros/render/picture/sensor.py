"""Light as a camera's sensor gathers it: bloom, and noise.

Radiance comes in, radiance goes out. Bloom: a share of the light of each pixel is spread around
it, as lenses and eyes do. What is spread is taken away where it came from, so a uniform picture
stays as it is.

Noise: photons come one by one, and reading adds some. A pixel of exposed radiance x collects
n = x · full_well electrons, give or take √n (shot noise; a normal distribution stands for
Poisson's), and reading it adds `read_noise` electrons: the variance is
x / full_well + (read_noise / full_well)². The same camera at the same simulated time has the same
noise.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.picture_kernels import gather_light
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["noise_variance", "normal_numbers", "sensor_light", "sensor_seed"]


def sensor_light(
    radiance: NDArray[np.float16],
    settings: PictureSettings,
    name: str,
    sim_time_ns: int,
    *,
    threads: int = 1,
) -> NDArray[np.float16]:
    """Spread light and add noise.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear, as the scene's exposure left it; the fourth number is kept.
    settings : PictureSettings
        Of which `bloom` and `full_well` count.
    name : str
        Of the camera; with the time, the noise's seed.
    sim_time_ns : int
    threads : int
        The result does not depend on it.

    Returns
    -------
    radiance : (H, W, 4) float16
        A fresh array; 0 or more.
    """
    shot = read = 0.0
    normal: NDArray[np.float32] | None = None
    if settings.full_well > 0.0:
        shot, read = noise_variance(settings)
        normal = normal_numbers()
    seed = sensor_seed(name, sim_time_ns)
    return gather_light(radiance, settings.bloom, shot, read, seed, normal, threads=threads)


def noise_variance(settings: PictureSettings) -> tuple[float, float]:
    """Return a and b of a·x + b, the variance of radiance x as the scene's exposure left it.

    Of settings whose `full_well` is not 0. Exposure gathers electrons, too.
    """
    electrons = settings.full_well * 2.0**settings.exposure
    return 1.0 / electrons, (settings.read_noise / electrons) ** 2


def sensor_seed(name: str, sim_time_ns: int) -> int:
    """Return the seed of what a camera's sensor draws at an instant, -2⁶³ to 2⁶³ - 1."""
    digest = hashlib.sha256(f"{name}/{sim_time_ns}".encode()).digest()
    return int.from_bytes(digest[:8], "little", signed=True)


@lru_cache(maxsize=1)
def normal_numbers() -> NDArray[np.float32]:
    """Return (65536,) float32 read-only: all equally likely, together a normal distribution."""
    distribution = NormalDist()
    upper = np.array([distribution.inv_cdf((k + 0.5) / 65536) for k in range(32768, 65536)])
    upper /= np.sqrt((upper**2).mean())
    numbers = np.concatenate([-upper[::-1], upper]).astype(np.float32)
    numbers.flags.writeable = False
    return numbers
