"""Mineral surfaces: painted plaster, roughcast, concrete. A colour in, `SurfaceMaps` out."""

from __future__ import annotations

import numpy as np

from sailenv_ros.assets.surfaces.maps import Floats, SurfaceMaps
from sailenv_ros.assets.surfaces.noise import banded, blurred, cloudy, ramp

__all__ = ["concrete", "plaster", "roughcast"]


def plaster(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Plain wall, painted with a roller: fine orange peel, hardly any change of colour."""
    peel = banded(rng, 2.0, 6.0)
    wide = cloudy(rng, 2.0)
    light = 1.0 + 0.006 * peel + 0.010 * wide
    return SurfaceMaps(
        albedo=(colour * light[..., np.newaxis]).astype(np.float32),
        height_m=(0.000045 * peel + 0.0005 * blurred(rng, 90.0)).astype(np.float32),
        roughness=(0.78 + 0.03 * peel).astype(np.float32),
        tile_m=(1.5, 1.5),
    )


def roughcast(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Render with grains of 2 to 4 mm, thrown on and rubbed."""
    grains = banded(rng, 2.5, 6.0)
    rubbed = np.minimum(grains, np.float32(1.0)) + 0.5 * np.maximum(grains - 1.0, 0.0)
    wide = cloudy(rng, 1.6)
    hollow = ramp(grains, -0.4, -2.2)
    light = (1.0 + 0.012 * wide) * (1.0 - 0.22 * hollow)
    return SurfaceMaps(
        albedo=(colour * light[..., np.newaxis]).astype(np.float32),
        height_m=(0.00045 * rubbed).astype(np.float32),
        roughness=np.full(grains.shape, 0.92, np.float32),
        tile_m=(1.0, 1.0),
    )


def concrete(rng: np.random.Generator, colour: Floats) -> SurfaceMaps:
    """Cast concrete, ground: clouds of grey, fine sand, a few blow holes."""
    clouds = cloudy(rng, 1.45)
    sand = banded(rng, 1.2, 4.0)
    spots = banded(rng, 4.0, 9.0)
    holes = ramp(spots + 0.25 * clouds, 3.4, 3.9)
    light = (1.0 + 0.06 * clouds + 0.03 * sand) * (1.0 - 0.55 * holes)
    tint = np.stack([0.010 * clouds, np.zeros_like(clouds), -0.014 * clouds], axis=-1)
    return SurfaceMaps(
        albedo=(colour * (light[..., np.newaxis] + tint)).astype(np.float32),
        height_m=(0.00003 * sand + 0.0002 * blurred(rng, 60.0) - 0.0012 * holes).astype(np.float32),
        roughness=(0.68 + 0.05 * clouds + 0.03 * sand).astype(np.float32),
        tile_m=(2.0, 2.0),
    )
