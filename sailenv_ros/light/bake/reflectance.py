"""Albedo and emission of each texel.

From `StaticGeometry`, `Layout` and `Texels` to albedo and emission. What is mirrored goes
everywhere, too: the amount is right, the direction is the mean one. Normal maps do nothing.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.layout import Layout
from sailenv_ros.light.bake.returned_light import returned
from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.rays.static_geometry import StaticGeometry
from sailenv_ros.types.colour import LINEAR_OF_SRGB8
from sailenv_ros.types.model import Material

__all__ = ["albedo_of", "emission_of", "returned"]

BRIGHTEST = 0.95
"""No surface gives back more: bounces would not end."""


def emission_of(geometry: StaticGeometry, layout: Layout, texels: Texels) -> NDArray[np.float32]:
    """Return (N, 3) float32: linear radiance that each texel emits, in its texture's pattern."""
    material = geometry.material[texels.triangle]
    emission = np.zeros((texels.count, 3), dtype=np.float32)
    fineness = None
    for place, look in enumerate(geometry.materials):
        if not any(look.emission):
            continue
        chosen = np.flatnonzero(material == place)
        if not len(chosen):
            continue
        emission[chosen] = look.emission
        if look.base_colour_texture is not None:
            fineness = _texture_texels(geometry, layout) if fineness is None else fineness
            emission[chosen] *= _picture_at(geometry, texels, chosen, look, fineness)
    return emission


def albedo_of(geometry: StaticGeometry, layout: Layout, texels: Texels) -> NDArray[np.float32]:
    """Return (N, 3) float32: linear share of the light that each texel gives back."""
    material = geometry.material[texels.triangle]
    order = np.argsort(material, kind="stable")
    bounds = np.searchsorted(material[order], np.arange(len(geometry.materials) + 1))
    fineness = _texture_texels(geometry, layout)
    albedo = np.zeros((texels.count, 3), dtype=np.float32)
    for place, look in enumerate(geometry.materials):
        chosen = order[bounds[place] : bounds[place + 1]]
        if not len(chosen):
            continue
        triangle = texels.triangle[chosen]
        at = np.einsum("nc,ncx->nx", texels.weights[chosen], geometry.uvs[triangle])
        texel = float(np.median(fineness[triangle]))
        base = np.tile(np.asarray(look.base_colour[:3], np.float32), (len(chosen), 1))
        if look.base_colour_texture is not None:
            base *= _picture_at(geometry, texels, chosen, look, fineness)
        finish = np.array([[look.roughness, look.metallic]])
        if look.metallic_roughness_texture is not None:
            shares = look.metallic_roughness_texture[..., 1:3].astype(np.float32) / 255.0
            finish = finish * _sampled(shares, at, texel)
        albedo[chosen] = returned(base, *finish.T[:, :, None])
    return np.clip(albedo, 0.0, BRIGHTEST)


def _picture_at(
    geometry: StaticGeometry,
    texels: Texels,
    chosen: NDArray[np.intp],
    look: Material,
    fineness: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return (len(chosen), 3) float32: linear colour of a material's picture at texels."""
    assert look.base_colour_texture is not None
    triangle = texels.triangle[chosen]
    at = np.einsum("nc,ncx->nx", texels.weights[chosen], geometry.uvs[triangle])
    colours = np.ascontiguousarray(look.base_colour_texture[..., :3])
    linear = np.asarray(cv2.LUT(colours, _LINEAR), np.float32)
    return _sampled(linear, at, float(np.median(fineness[triangle])))


def _texture_texels(geometry: StaticGeometry, layout: Layout) -> NDArray[np.float64]:
    """Return (T,) float64: length in texture coordinates of one texel of the map, per triangle."""

    def area(points: NDArray[np.float32]) -> NDArray[np.float64]:
        a, b = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        size: NDArray[np.float64] = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).astype(float)
        return size

    return np.sqrt(area(geometry.uvs) / np.maximum(area(layout.places), 1e-9))


def _sampled(
    values: NDArray[np.float32], at: NDArray[np.float32], texel: float
) -> NDArray[np.float32]:
    """Return (N, C) float32: a texture's values, averaged over about a texel of the map."""
    height, width = values.shape[:2]
    wide = int(np.clip(round(1.0 / max(texel, 1e-6)), 1, width))
    high = int(np.clip(round(wide * height / width), 1, height))
    small = cv2.resize(values, (wide, high), interpolation=cv2.INTER_AREA).reshape(high, wide, -1)
    column = np.floor(at[:, 0] * wide).astype(np.int64) % wide
    row = np.floor((1.0 - at[:, 1]) * high).astype(np.int64) % high
    found: NDArray[np.float32] = small[row, column]
    return found


_LINEAR = LINEAR_OF_SRGB8.astype(np.float32)
