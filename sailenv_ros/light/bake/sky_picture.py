"""The sky's radiance by direction, as light is computed from it: `Environment` to an array."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.lights import Environment

__all__ = ["sky_picture"]

ROWS = 64
"""Rows of the low-resolution sky picture; finer details light nothing noticeably."""


def sky_picture(environment: Environment) -> NDArray[np.float32]:
    """Return (H, 2 H, 3) float32: what is seen where nothing is hit, laid out as in `SkyMap`."""
    if environment.background == "colour":
        return np.full((2, 4, 3), environment.background_colour, dtype=np.float32)
    if environment.sky is not None:
        radiance = environment.sky.radiance.astype(np.float32)
        size = (2 * ROWS, ROWS) if len(radiance) > ROWS else radiance.shape[1::-1]
        import cv2

        return np.asarray(cv2.resize(radiance, size, interpolation=cv2.INTER_AREA), np.float32)
    polar = (np.arange(ROWS) + 0.5) / ROWS * np.pi
    up = np.cos(polar)[:, None]
    zenith, horizon, ground = (
        np.array(colour)
        for colour in (environment.sky_zenith, environment.sky_horizon, environment.sky_ground)
    )
    upper = horizon + (zenith - horizon) * np.sqrt(np.clip(up, 0.0, 1.0))
    low = np.clip(-up / 0.12, 0.0, 1.0)
    rows = upper + (ground - upper) * (low * low * (3.0 - 2.0 * low))
    return np.repeat(rows[:, None], 2 * ROWS, axis=1).astype(np.float32)
