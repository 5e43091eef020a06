"""A photographed sky as it is seen behind windows: blended with the room as photographers do.

Out there is ten times the light of the room. Estate agents' photographers take a second picture of
the windows with a shorter exposure and blend it in. So does this: broad differences of brightness
are compressed, fine ones are kept (Durand and Dorsey 2002, "Fast bilateral filtering for the
display of high-dynamic-range images", with a guided filter, He et al. 2010). Only what is seen is
changed: light and reflections come from the sky as it is.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.system.array_cache import cached_arrays, code_digest
from sailenv_ros.types.colour import HALF_MOST, LUMINANCE
from sailenv_ros.types.digests import sky_digest
from sailenv_ros.types.lights import Environment, SkyMap

__all__ = ["FINER", "seen_exposure", "seen_sky"]

FINER = 2
"""Pixels of what is seen for one of the file, along each side: windows magnify the sky, and
bilinear look-ups show its pixels as squares."""

CAPPED = 0.97
"""Pixels of more than this share of the greatest luminance belong to the sun and its glare."""

SPOT_PX, BLUR_PX = 15, 6.0
"""Largest spot, and how far around it colours are averaged."""

WIDE_PX, AMIDST = 12.0, 0.85
"""A spot lies amidst the glare if that takes such a share of what is around it, so far."""

KNEE, SHOULDER = 0.18, 0.62
"""Exposed luminance up to which nothing is compressed, and that nothing broad reaches. The tone
curve makes light grey of it: the white of walls in the sun is brighter."""

BASE_PX, BASE_VARIANCE = 24, 0.08
"""Width of the differences that are compressed [px], and the variance of log luminance below which
a difference is fine."""

DETAIL = 1.35
"""Fine differences are made so much stronger, in stops: a pixel of the sky is some pixels of the
picture, and lenses are sharper."""

BRIGHTEST = 0.85
"""Exposed luminance that no pixel passes."""


def seen_exposure(environment: Environment) -> float | None:
    """Return for which exposure a sky is blended [stops]; None if it is shown as it is."""
    return environment.exposure if environment.sky_blend else None


@lru_cache(maxsize=1)
def seen_sky(sky: SkyMap, exposure: float | None = None) -> NDArray[np.float16]:
    """Return (`FINER` H, `FINER` 2 H, 3) float16: the radiance that is seen of a sky.

    A sky's file holds no sun (`assets.skies`): where it stood, luminance is capped, and what is
    left of the pixels that overflowed in the camera are odd hues and dark rings. Such spots amidst
    the glare take the mean colour of what is around them.

    Parameters
    ----------
    sky : SkyMap
    exposure : float or None
        Of the surroundings [stops]: it is blended for a picture of that exposure. None leaves
        brightness as it is: so it lights and is mirrored.
    """
    found: NDArray[np.float16] = cached_arrays(
        "sky",
        [sky_digest(sky), exposure, cv2.__version__],
        lambda: {"seen": _made(sky, exposure)},
        code=code_digest("render/scene", "types"),
    )["seen"]
    return found


def _made(sky: SkyMap, exposure: float | None) -> NDArray[np.float16]:
    radiance = _without_spots(sky.radiance.astype(np.float32))
    if exposure is not None:
        radiance = _blended(radiance, 2.0**exposure)
    height, width = radiance.shape[:2]
    around = 4
    # Left and right border on each other.
    wrapped = np.concatenate([radiance[:, -around:], radiance, radiance[:, :around]], axis=1)
    size = (FINER * wrapped.shape[1], FINER * height)
    finer = cv2.resize(wrapped, size, interpolation=cv2.INTER_CUBIC)
    kept = finer[:, FINER * around : FINER * (around + width)]
    result: NDArray[np.float16] = np.clip(kept, 0.0, HALF_MOST).astype(np.float16)
    result = np.ascontiguousarray(result)
    result.flags.writeable = False
    return result


def _without_spots(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    light = radiance @ LUMINANCE.astype(np.float32)
    glare = (light >= CAPPED * light.max()).astype(np.uint8)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (SPOT_PX, SPOT_PX))
    capped = glare.astype(np.float32)
    # Leaves and twigs before the glare are many, and stay.
    amidst = cv2.GaussianBlur(capped, (0, 0), WIDE_PX) > AMIDST
    mended = ((cv2.morphologyEx(glare, cv2.MORPH_CLOSE, disc) > 0) & amidst)[..., None]
    share = cv2.GaussianBlur(capped, (0, 0), BLUR_PX)[..., None]
    mean = cv2.GaussianBlur(radiance * capped[..., None], (0, 0), BLUR_PX)
    mean /= np.maximum(share, 1e-6)
    result: NDArray[np.float32] = np.where(mended, mean, radiance).astype(np.float32)
    return result


def _blended(radiance: NDArray[np.float32], factor: float) -> NDArray[np.float32]:
    """Return radiance with its broad differences compressed for a picture of that exposure."""
    light = np.maximum(radiance @ LUMINANCE.astype(np.float32), 1e-4) * np.float32(factor)
    fine = np.log2(light)
    broad = _broad(fine)
    target = np.log2(compressed(np.exp2(broad))) + np.float32(DETAIL) * (fine - broad)
    # Where nothing is compressed fine differences are as they were.
    share = np.clip((np.exp2(broad) - KNEE) / KNEE, 0.0, 1.0)
    wanted: NDArray[np.float32] = np.exp2(fine + share * (target - fine))
    wanted = np.minimum(wanted, np.maximum(BRIGHTEST, np.minimum(light, KNEE)))
    result: NDArray[np.float32] = radiance * (wanted / light)[..., None].astype(np.float32)
    return result


def compressed(light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return exposed luminance as it is up to `KNEE`, and towards `SHOULDER` beyond."""
    room = np.float32(SHOULDER - KNEE)
    above = KNEE + room * (1.0 - np.exp(-(light - KNEE) / room))
    result: NDArray[np.float32] = np.where(light > KNEE, above, light).astype(np.float32)
    return result


def _broad(fine: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the broad part of an image: its guided filter by itself, around the seam too."""
    edge = 2 * BASE_PX
    wide = np.concatenate([fine[:, -edge:], fine, fine[:, :edge]], axis=1)
    size = (2 * BASE_PX + 1, 2 * BASE_PX + 1)

    def mean(values: NDArray[np.float32]) -> NDArray[np.float32]:
        return np.asarray(cv2.blur(values, size, borderType=cv2.BORDER_REPLICATE), np.float32)

    middle = mean(wide)
    variance = np.maximum(mean(wide * wide) - middle * middle, 0.0)
    slope = (variance / (variance + BASE_VARIANCE)).astype(np.float32)
    result: NDArray[np.float32] = mean(slope) * wide + mean(middle - slope * middle)
    return result[:, edge:-edge]
