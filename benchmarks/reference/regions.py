"""Regions of the compared pictures, by which differences are distinguished.

Ground truth of a view in, a number for each pixel out: the index of one of `REGIONS`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["REGIONS", "VIEWS", "regions_of"]

REGIONS = ("outside", "edges", "textures", "smooth")
"""Beyond all surfaces; where surfaces meet or bend; where the base colour varies; the rest."""

VIEWS = ("depth", "instance", "normals", "albedo")
"""The views that `regions_of` needs."""

REACH_PX = 2
"""Distance from an edge, or from the outside, within which a pixel belongs to that region [px]."""

LEAST_COSINE = 0.9
"""Between the normals of neighbours on one surface."""

LEAST_BEND = 0.02
"""Of 1 / depth, from one pixel to the next: over a plane 1 / depth is linear."""

LEAST_VARIATION = 0.08
"""Standard deviation of the base colour within 5 x 5 pixels, as a share of its mean."""

Mask = NDArray[np.bool_]


def regions_of(views: Mapping[str, NDArray[Any]]) -> NDArray[np.uint8]:
    """Tell what each pixel shows.

    Parameters
    ----------
    views : mapping of str to array
        Those of `VIEWS`, of one picture.

    Returns
    -------
    regions : (H, W) uint8
        Indices of `REGIONS`; the first that fits.
    """
    depth = views["depth"]
    outside = ~(np.isfinite(depth) & (depth > 0.0))
    nearness = np.where(outside, 0.0, 1.0 / np.where(outside, 1.0, depth))
    colour = views["albedo"].mean(axis=-1)
    variation = np.sqrt(np.maximum(_blurred(colour**2) - _blurred(colour) ** 2, 0.0))
    fits = (
        _widened(outside),
        _widened(_edges(views["instance"], views["normals"], nearness)),
        variation > LEAST_VARIATION * (_blurred(colour) + 0.02),
        np.ones(depth.shape, np.bool_),
    )
    regions: NDArray[np.uint8] = np.argmax(np.stack(fits), axis=0).astype(np.uint8)
    return regions


def _edges(ids: NDArray[Any], normals: NDArray[Any], nearness: NDArray[Any]) -> Mask:
    found = np.zeros(ids.shape, np.bool_)
    for axis in (0, 1):
        size = ids.shape[axis]
        first, second = _along(axis, slice(0, size - 1)), _along(axis, slice(1, size))
        turned = (normals[first] * normals[second]).sum(axis=-1) < LEAST_COSINE
        differs = (ids[first] != ids[second]) | turned
        found[first] |= differs
        found[second] |= differs
        middle = _along(axis, slice(1, size - 1))
        both = nearness[_along(axis, slice(0, size - 2))] + nearness[_along(axis, slice(2, size))]
        found[middle] |= np.abs(both - 2.0 * nearness[middle]) > LEAST_BEND * nearness[middle]
    return found


def _along(axis: int, part: slice) -> tuple[slice, slice]:
    return (part, slice(None)) if axis == 0 else (slice(None), part)


def _shifts(image: NDArray[Any], reach: int) -> list[NDArray[Any]]:
    padded = np.pad(image, reach, mode="edge")
    height, width = image.shape
    steps = range(2 * reach + 1)
    return [padded[v : v + height, u : u + width] for v in steps for u in steps]


def _widened(mask: Mask) -> Mask:
    wide: Mask = np.any(_shifts(mask, REACH_PX), axis=0)
    return wide


def _blurred(image: NDArray[Any]) -> NDArray[Any]:
    mean: NDArray[Any] = np.mean(_shifts(image, 2), axis=0)
    return mean
