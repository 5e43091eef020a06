"""Samples half a pixel apart, of which pictures with smooth edges are made.

A camera comes in, the camera of its samples goes out: sample k lies at pixel (k - 1) / 2, so W
pixels have 2 W + 1 samples, and those of odd numbers are the pixels' centres. The native renderer
has the same samples, see `native/src/kernels/edges.cpp`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera, CameraIntrinsics

__all__ = ["half_pixel_camera", "pixel_shares"]


@dataclass(frozen=True, kw_only=True)
class _Samples(CameraIntrinsics):
    """Of samples: they may be more, and see further, than the pixels of a picture may."""

    def __post_init__(self) -> None:
        pass


def half_pixel_camera(camera: Camera) -> Camera:
    """Return the camera whose pixels are the samples of this one's."""
    lens = camera.intrinsics
    width, height = 2 * lens.width + 1, 2 * lens.height + 1
    samples = _Samples(
        width=width,
        height=height,
        vertical_fov_deg=2.0 * math.degrees(math.atan2(0.5 * height, 2.0 * lens.fy)),
        near_m=lens.near_m,
        far_m=lens.far_m,
    )
    return replace(camera, intrinsics=samples)


def pixel_shares(samples: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Return the share of each pixel that samples half a pixel apart say.

    Parameters
    ----------
    samples : (2 H + 1, 2 W + 1) bool

    Returns
    -------
    shares : (H, W) float32
        By the trapezoid rule: the middle counts 4, the sides 2, the corners 1, of 16.
    """
    values = samples.astype(np.float32)
    rows = values[:-1:2] + 2.0 * values[1::2] + values[2::2]
    sums: NDArray[np.float32] = rows[:, :-1:2] + 2.0 * rows[:, 1::2] + rows[:, 2::2]
    return sums / np.float32(16.0)
