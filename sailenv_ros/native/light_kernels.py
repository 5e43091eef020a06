"""Direct light of lamps at points, by src/kernels/direct_light.cpp; see `light.bake.direct`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import LitPoints, RayList
from sailenv_ros.native.library import Kernel, checked

__all__ = ["direct_light", "light_rays", "light_samples", "rectangle_form_factors"]

Floats = NDArray[np.float32]

_SAMPLES = Kernel("light_samples", "aaiaaaa")
_RAYS = Kernel("light_rays", "aaiaaa")
_DIRECT = Kernel("direct_light", "aaiaaaa")
_FORM_FACTORS = Kernel("form_factors", "aaiaaa")


def light_samples(
    light: NDArray[np.void], points: LitPoints, pattern: Floats
) -> tuple[Floats, Floats, Floats]:
    """Choose points on a light for each point that is lit.

    Parameters
    ----------
    light : (1,) RAY_LIGHT
    points : LitPoints
        Their positions and shifts are read.
    pattern : (M, 2) float32
        A net of points of the unit square.

    Returns
    -------
    towards : (N, M, 3) float32
        From each point; not unit length, but for directional lights.
    lengths : (N, M) float32
        In lengths of these, up to where something is in the way.
    irradiance : (N, M) float32
        On a surface that faces the sample, if nothing is in the way; the mean over M counts.
    """
    checked("pattern", pattern, np.float32, (None, 2))
    shape = points.count, len(pattern)
    towards = np.empty((*shape, 3), np.float32)
    lengths, irradiance = np.empty((2, *shape), np.float32)
    _SAMPLES(light, points.record, len(pattern), pattern, towards, lengths, irradiance)
    return towards, lengths, irradiance


def light_rays(
    light: NDArray[np.void], points: LitPoints, pattern: Floats
) -> tuple[NDArray[np.int32], Floats, Floats, Floats]:
    """Make rays to a light, those that may bring light.

    Returns
    -------
    place : (R,) int32
        Which of the N M rays each is, point by point.
    origins, towards : (R, 3) float32
        From a little off the face.
    lengths : (R,) float32
        In lengths of `towards`.
    """
    checked("pattern", pattern, np.float32, (None, 2))
    made = RayList(points.count * len(pattern))
    lengths = np.empty(points.count * len(pattern), np.float32)
    _RAYS(light, points.record, len(pattern), pattern, made.record, lengths)
    place, origins, towards = made.rays()
    return place, origins, towards, lengths[: len(place)]


def direct_light(
    light: NDArray[np.void], points: LitPoints, pattern: Floats, free: Floats
) -> tuple[Floats, Floats]:
    """Return (N,) irradiance / pi, and (N,) the share of the rays that arrive, both float32.

    Parameters
    ----------
    free : (N, M) float32
        How much of each ray to the light arrives.
    """
    checked("pattern", pattern, np.float32, (None, 2))
    checked("free shares", free, np.float32, (points.count, len(pattern)))
    arriving, share = np.empty((2, points.count), np.float32)
    _DIRECT(light, points.record, len(pattern), pattern, free, arriving, share)
    return arriving, share


def rectangle_form_factors(
    corners: NDArray[np.float64],
    direction: NDArray[np.float64],
    positions: Floats,
    normals: Floats,
) -> Floats:
    """Return (N,) float32: irradiance / pi from a rectangle of radiance 1, 0 to 1.

    Parameters
    ----------
    corners : (4, 3) float64
        One after another.
    direction : (3,) float64
        In which it shines.
    positions, normals : (N, 3) float32
        Of what it shines on.
    """
    checked("corners", corners, np.float64, (4, 3))
    checked("direction", direction, np.float64, (3,))
    checked("positions", positions, np.float32, (None, 3))
    checked("normals", normals, np.float32, (len(positions), 3))
    found = np.empty(len(positions), np.float32)
    _FORM_FACTORS(corners, direction, len(positions), positions, normals, found)
    return found
