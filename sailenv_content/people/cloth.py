"""Looks of clothes and hair: woven cloth with creases, stripes and checks, leather, strands."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from sailenv_content.standard.patterns import normals_of
from sailenv_ros.types.colour import linear_from_hex, srgb_from_linear
from sailenv_ros.types.model import Material

__all__ = ["TILE_M", "cloth", "leather", "strands"]

Doubles = NDArray[np.float64]
Texture = NDArray[np.uint8]

TILE_M = 0.6
"""Edge of what a picture of cloth shows [m]."""

_EDGE_PX = 512


@lru_cache(maxsize=64)
def cloth(
    colour: str, print_: str = "", second: str = "#f2efe6", fabric: str = "weave"
) -> Material:
    """Return cloth of a colour ``#rrggbb``, perhaps with a print in a second one.

    Parameters
    ----------
    print_ : {'', 'stripes', 'checks', 'dots'}
    fabric : {'weave', 'denim'}
    """
    height = _creases(fabric)
    base, other = (np.array(linear_from_hex(text)) for text in (colour, second))
    share = _print(print_)[..., None]
    shade = (0.80 + 0.20 * height)[..., None]
    if fabric == "denim":
        worn = 0.10 * ndimage.gaussian_filter(_noise(5), 0.7, mode="wrap")[..., None]
        picture = ((1.0 - share) * base + share * other) * shade * (1.0 + worn) + 0.012 * worn
    else:
        picture = ((1.0 - share) * base + share * other) * shade
    return Material(
        name=f"{fabric} {colour} {print_}".rstrip(),
        roughness=0.92,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        base_colour_texture=_encoded(picture),
        normal_texture=normals_of(height, 0.9),
        double_sided=True,
    )


@lru_cache(maxsize=32)
def leather(colour: str) -> Material:
    """Return smooth leather of a colour."""
    red, green, blue = linear_from_hex(colour)
    return Material(
        name=f"leather {colour}",
        roughness=0.42,
        base_colour=(red, green, blue, 1.0),
        double_sided=True,
    )


@lru_cache(maxsize=32)
def strands(colour: str, curls: float) -> Material:
    """Return hair that runs along v, or curls, from 0 to 1."""
    along = ndimage.gaussian_filter(_noise(11), (40.0 * (1.0 - 0.93 * curls), 1.2), mode="wrap")
    along = (along - along.mean()) / along.std()
    height = np.clip(0.5 + 0.22 * along, 0.0, 1.0)
    base = np.array(linear_from_hex(colour))
    picture = base * (0.55 + 0.9 * height)[..., None]
    return Material(
        name=f"hair {colour}",
        roughness=0.55,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        base_colour_texture=_encoded(np.clip(picture, 0.0, 1.0)),
        normal_texture=normals_of(height, 1.3),
        double_sided=True,
    )


@lru_cache(maxsize=4)
def _creases(fabric: str) -> Doubles:
    """Return (E, E) heights, 0 to 1: folds that run slantwise, and threads."""
    folds = ndimage.gaussian_filter(_noise(3), (34.0, 13.0), mode="wrap")
    folds = folds / folds.std() + 0.5 * _scaled(
        ndimage.gaussian_filter(_noise(4), 9.0, mode="wrap")
    )
    rows, columns = np.mgrid[:_EDGE_PX, :_EDGE_PX]
    step = 2.0 * np.pi / (6.0 if fabric == "denim" else 4.0)
    threads = (
        np.sin(step * (rows + columns))
        if fabric == "denim"
        else np.sin(step * rows) * np.sin(step * columns)
    )
    height = 0.5 + 0.16 * folds + 0.012 * threads
    return np.asarray(np.clip(height, 0.0, 1.0), np.float64)


def _print(name: str) -> Doubles:
    rows, columns = np.mgrid[:_EDGE_PX, :_EDGE_PX] / _EDGE_PX
    if name == "stripes":
        return np.asarray((rows * 16.0) % 1.0 < 0.4, np.float64)
    if name == "checks":
        across, down = ((place * 12.0) % 1.0 < 0.5 for place in (columns, rows))
        return np.asarray(0.45 * across + 0.45 * down, np.float64)
    if name == "dots":
        u, v = (columns * 14.0) % 1.0 - 0.5, (rows * 14.0) % 1.0 - 0.5
        return np.asarray(np.hypot(u, v) < 0.22, np.float64)
    return np.zeros((_EDGE_PX, _EDGE_PX))


def _noise(seed: int) -> Doubles:
    return np.random.default_rng(seed).standard_normal((_EDGE_PX, _EDGE_PX))


def _scaled(field: Doubles) -> Doubles:
    scaled: Doubles = field / field.std()
    return scaled


def _encoded(linear: Doubles) -> Texture:
    pixels = np.full((*linear.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * srgb_from_linear(np.clip(linear, 0.0, 1.0)))
    pixels.flags.writeable = False
    return pixels
