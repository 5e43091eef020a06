"""The rays of lenses that bend straight lines, computed once: directions of pixels' centres.

A lens comes in; unit rays go out, and what ground truth makes of them. Through a pin-hole points
are told by their depth, through other lenses by their distance along the ray, for these may see to
the side and behind.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.lens_models import MOST_COEFFICIENTS
from sailenv_ros.native.motion_kernels import BentLenses
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["bent_lenses", "depth_shares", "ranges_of_depths", "reach_of", "reach_view", "unit_rays"]

_NO_COEFFICIENTS = np.zeros(MOST_COEFFICIENTS)


def reach_view(lens: CameraIntrinsics) -> str:
    """Return the view that tells where on its ray a point is: ``depth`` or ``range``."""
    return "depth" if lens.is_pinhole else "range"


@lru_cache(maxsize=8)
def unit_rays(lens: CameraIntrinsics) -> NDArray[np.float64]:
    """Return (H, W, 3) float64 read-only: where each pixel's centre looks, in the optical frame.

    nan where the lens sees nothing.
    """
    rays = np.ascontiguousarray(lens.unit_rays())
    rays.flags.writeable = False
    return rays


@lru_cache(maxsize=8)
def depth_shares(lens: CameraIntrinsics) -> NDArray[np.float32]:
    """Return (H, W) float32 read-only: depth along the axis over distance along the ray."""
    shares = unit_rays(lens)[..., 2].astype(np.float32)
    shares.flags.writeable = False
    return shares


def ranges_of_depths(depth: NDArray[np.float32], lens: CameraIntrinsics) -> NDArray[np.float32]:
    """Return (H, W) float32: distances along rays [m] from depths along the axis [m].

    nan where the lens looks to the side or behind, where depths do not tell them.
    """
    shares = unit_rays(lens)[..., 2]
    shares = np.where(shares > 0.0, shares, np.nan)
    return (depth / shares).astype(np.float32)


def reach_of(
    views: Mapping[str, NDArray[Any]], lens: CameraIntrinsics
) -> NDArray[np.float32] | None:
    """Return where on its ray each pixel's point is [m], as `reach_view` says it; None if unknown.

    Of a frame without ``range`` it comes of ``depth``.
    """
    found = views.get(reach_view(lens))
    if found is None and "depth" in views:
        found = ranges_of_depths(views["depth"], lens)
    return found


def bent_lenses(begin: CameraIntrinsics, end: CameraIntrinsics) -> BentLenses | None:
    """Return two lenses as kernels of motion take them; None if both are pin-holes."""
    if begin.is_pinhole and end.is_pinhole:
        return None
    straight = end.is_pinhole
    return BentLenses(
        from_rays=None if begin.is_pinhole else unit_rays(begin),
        to_model=-1 if straight else end.law.model.number,
        to_coefficients=_NO_COEFFICIENTS if straight else end.law.padded,
        to_limit_rad=0.0 if straight else end.law.limit_rad,
        same=begin == end,
    )
