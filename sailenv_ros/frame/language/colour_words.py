"""Words for colours: the eleven basic ones of English, where a colour is a clear case of one.

After B. Berlin and P. Kay, *Basic Color Terms* (1969). Regions lie in CIELAB's lightness, chroma
and hue, with gaps between them: a colour in a gap has no word, as people would disagree.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.colour import XYZ_FROM_RGB

__all__ = ["COLOUR_WORDS", "colour_words"]

_STEPS = 64
"""Steps of each channel's square root in the table of words."""


class _Region(NamedTuple):
    """Colours that a word is clear of: spans of lightness, chroma and hue [deg]."""

    word: str
    lightness: tuple[float, float]
    chroma: tuple[float, float]
    hue: tuple[float, float] = (0.0, 360.0)


_REGIONS: Sequence[_Region] = (
    _Region("black", (0, 16), (0, 8)),
    _Region("grey", (30, 72), (0, 6)),
    _Region("white", (86, 101), (0, 9)),
    _Region("red", (25, 60), (45, 200), (15, 42)),
    _Region("orange", (58, 82), (50, 200), (52, 76)),
    _Region("brown", (15, 48), (14, 48), (38, 82)),
    _Region("yellow", (72, 101), (45, 200), (84, 105)),
    _Region("green", (20, 92), (20, 200), (112, 172)),
    _Region("blue", (10, 85), (18, 200), (232, 300)),
    _Region("purple", (15, 60), (25, 200), (304, 332)),
    _Region("pink", (62, 90), (22, 70), (335, 375)),
)

COLOUR_WORDS: tuple[str, ...] = ("", *(region.word for region in _REGIONS))
"""Words by their numbers; 0 is for colours without one."""


def colour_words(linear: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the numbers of the words for colours.

    Parameters
    ----------
    linear : (..., 3) float32
        Linear red, green and blue, 0 to 1.

    Returns
    -------
    words : (...) uint8
        Places in `COLOUR_WORDS`.
    """
    roots = np.sqrt(np.nan_to_num(linear).clip(0.0, 1.0))
    places = np.minimum((roots * _STEPS).astype(np.int64), _STEPS - 1)
    words: NDArray[np.uint8] = _table()[places[..., 0], places[..., 1], places[..., 2]]
    return words


@lru_cache(maxsize=1)
def _table() -> NDArray[np.uint8]:
    """Return (64, 64, 64) uint8: words by the square roots of linear red, green and blue."""
    middles = ((np.arange(_STEPS) + 0.5) / _STEPS) ** 2
    linear = np.stack(np.meshgrid(middles, middles, middles, indexing="ij"), axis=-1)
    lightness, chroma, hue = _lch(linear)
    words = np.zeros(lightness.shape, np.uint8)
    for number, region in enumerate(_REGIONS, start=1):
        turned = (hue - region.hue[0]) % 360.0
        inside = turned <= region.hue[1] - region.hue[0]
        for values, (low, high) in ((lightness, region.lightness), (chroma, region.chroma)):
            inside &= (values >= low) & (values <= high)
        words[inside] = number
    return words


def _lch(linear: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Return lightness, chroma and hue [deg] of CIELAB (CIE 15), for the white of sRGB."""
    white = XYZ_FROM_RGB.sum(axis=1)
    ratio = linear @ XYZ_FROM_RGB.T / white
    cubic = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    x, y, z = np.moveaxis(cubic, -1, 0)
    a, b = 500.0 * (x - y), 200.0 * (y - z)
    return 116.0 * y - 16.0, np.hypot(a, b), np.degrees(np.arctan2(b, a)) % 360.0
