"""Keeps alpha-tested foliage as dense from afar as it is nearby.

A texture with holes and its cut-off come in; out goes how the cut-off changes with the mip-map
level, so that each level covers the same area. Averaging makes thin leaves ever more transparent:
against one cut-off they would vanish from afar.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Material

__all__ = ["cutoff_by_level"]

LEAST_EDGE_PX = 8
"""Smaller levels have too few texels to tell."""


def cutoff_by_level(material: Material, edge: int) -> tuple[float, float]:
    """Return how the cut-off falls.

    Parameters
    ----------
    material : Material
    edge : int
        Edge of the texture's finest level on the GPU [px].

    Returns
    -------
    slope : float
        By how much the cut-off falls from level to level, 0 or more.
    least : float
        Where it stops falling.
    """
    texture, cutoff = material.base_colour_texture, material.alpha_cutoff
    if material.alpha != "mask" or texture is None:
        return 0.0, cutoff
    alpha = material.base_colour[3] / 255.0 * texture[..., 3].astype(np.float32)
    covered = float((alpha >= cutoff).mean())
    if not 0.0 < covered < 1.0:
        return 0.0, cutoff
    fitting = np.array(list(_fitting(alpha, edge, covered)))
    if not fitting.size:
        return 0.0, cutoff
    least = min(cutoff, float(fitting.min()))
    # Levels at which it has stopped falling do not say how fast it fell.
    falling = fitting[: int(np.argmin(fitting)) + 1]
    level = np.arange(1, len(falling) + 1)
    slope = float((level * (cutoff - falling)).sum() / (level * level).sum())
    return max(slope, 0.0), least


def _fitting(alpha: NDArray[np.float32], edge: int, covered: float) -> list[float]:
    """Return, for each level after the first, the cut-off that covers so much of it."""
    found = []
    size = edge // 2
    while size >= LEAST_EDGE_PX:
        level = cv2.resize(alpha, (size, size), interpolation=cv2.INTER_AREA)
        found.append(float(np.quantile(level, 1.0 - covered)))
        size //= 2
    return found
