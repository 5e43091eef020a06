"""Automatic exposure: brings the mean light of a picture to middle grey, as fast as time allows.

The meter takes the mean of the logarithm of luminance (Reinhard et al., Photographic Tone
Reproduction for Digital Images, 2002, equation 1), which a bright window moves little. What it asks
for is followed as a filter of first order follows its input.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.colour import LUMINANCE
from sailenv_ros.types.picture_settings import LIMITS
from sailenv_ros.types.snapshot import AdaptedExposure

__all__ = ["MAX_STOPS", "MIDDLE_GREY", "followed", "metered_exposure", "with_exposure"]

MIDDLE_GREY = 0.18
"""Radiance that the mean is brought to."""

MAX_STOPS = 8.0
"""Most stops that a picture is brightened or darkened by."""

DARKEST = 1e-4
"""Radiance that is added before the logarithm, so that black pixels do not count for all."""

METERED_ROWS = 120
"""Least rows and columns that are looked at, where there are so many."""


def metered_exposure(radiance: NDArray[np.float16]) -> float:
    """Return the stops that bring a picture's mean light to `MIDDLE_GREY`.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear light at the sensor; the fourth number does not count.

    Returns
    -------
    stops : float
        From -`MAX_STOPS` to `MAX_STOPS`.
    """
    step = max(1, min(radiance.shape[:2]) // METERED_ROWS)
    seen = radiance[step // 2 :: step, step // 2 :: step, :3].astype(np.float64)
    mean = float(np.log2(np.maximum(seen @ LUMINANCE, 0.0) + DARKEST).mean())
    return min(max(math.log2(MIDDLE_GREY) - mean, -MAX_STOPS), MAX_STOPS)


def followed(
    before: AdaptedExposure | None, wanted: float, sim_time_ns: int, time_constant_s: float
) -> AdaptedExposure:
    """Return the exposure on its way from that of before to the wanted one.

    Parameters
    ----------
    before : AdaptedExposure or None
        None has the wanted one at once: the camera looked there long enough.
    wanted : float
        Stops.
    sim_time_ns : int
        Now [ns].
    time_constant_s : float
        After it 63 % of the way are gone [s]; above 0.
    """
    if before is None:
        return AdaptedExposure(wanted, sim_time_ns)
    passed_s = (sim_time_ns - before.sim_time_ns) * 1e-9
    left = math.exp(-max(passed_s, 0.0) / time_constant_s)
    return AdaptedExposure(wanted + (before.stops - wanted) * left, sim_time_ns)


def with_exposure(camera: Camera, adapted: AdaptedExposure | None) -> Camera:
    """Return a camera whose own exposure has the automatic one in it."""
    if adapted is None:
        return camera
    most = LIMITS["exposure"].most
    assert most is not None
    exposure = min(max(camera.picture.exposure + adapted.stops, -most), most)
    return replace(camera, picture=replace(camera.picture, exposure=exposure))
