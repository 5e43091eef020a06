"""Automatic exposure: brings mean light to middle grey, but keeps highlights below white.

The meter takes the mean of the logarithm of luminance (Reinhard et al., Photographic Tone
Reproduction for Digital Images, 2002, equation 1), which a bright window moves little, and holds
back where more than a small share of the light would be white. It meters pictures, whose
exposure follows as a filter of first order follows its input, and rooms in baked light.
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

__all__ = [
    "HIGHLIGHT",
    "MAX_STOPS",
    "MIDDLE_GREY",
    "WHITE_SHARE",
    "followed",
    "metered_exposure",
    "picture_exposure",
    "with_exposure",
]

MIDDLE_GREY = 0.18
"""Radiance that the mean is brought to."""

MAX_STOPS = 8.0
"""Most stops that a picture is brightened or darkened by."""

DARKEST = 1e-4
"""Radiance that is added before the logarithm, so that black pixels do not count for all."""

WHITE_SHARE = 0.01
"""Share of the light that may become brighter than `HIGHLIGHT`."""

HIGHLIGHT = 3.0
"""Radiance, after exposure, that is nearly white: the filmic curve makes 246 of 255 of it."""

METERED_ROWS = 120
"""Least rows and columns that are looked at, where there are so many."""


def metered_exposure(light: NDArray[np.floating], wanted: float | None = None) -> float:
    """Return the stops for light: its mean becomes `MIDDLE_GREY`, its highlights do not clip.

    Parameters
    ----------
    light : (N, 3) float
        Linear radiance of points that count alike; without any, the wanted stops, or 0.
    wanted : float or None
        Stops that are right but for highlights; None takes those of the mean.

    Returns
    -------
    stops : float
        From -`MAX_STOPS` to `MAX_STOPS`.
    """
    if not len(light):
        return wanted or 0.0
    seen = np.maximum(light.astype(np.float64), 0.0)
    if wanted is None:
        wanted = math.log2(MIDDLE_GREY) - float(np.log2(seen @ LUMINANCE + DARKEST).mean())
    bright = np.sort(seen.max(axis=1))[-1 - int(WHITE_SHARE * len(seen))] + DARKEST
    return min(max(min(wanted, math.log2(HIGHLIGHT / bright)), -MAX_STOPS), MAX_STOPS)


def picture_exposure(
    radiance: NDArray[np.float16], inside: NDArray[np.bool_] | None = None
) -> float:
    """Return the stops for a picture; see `metered_exposure`.

    Parameters
    ----------
    radiance : (H, W, 4) float16
        Linear light at the sensor; the fourth number does not count.
    inside : (H, W) bool or None
        Pixels that count, if there are any: not what is seen through windows.
    """
    step = max(1, min(radiance.shape[:2]) // METERED_ROWS)
    rows = slice(step // 2, None, step)
    seen = radiance[rows, rows, :3]
    counts = np.ones(seen.shape[:2], bool) if inside is None else inside[rows, rows]
    return metered_exposure(seen[counts] if counts.any() else seen.reshape(-1, 3))


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
