"""What each texel gives back of the light it gets, and what it gives of itself.

From `Scenery`, `Layout` and `Texels` to albedo and emission. Metals, too, give back their base
colour to everywhere: the amount is right, the direction is the mean one. Normal maps do nothing.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.bake.layout import Layout
from sailenv_ros.bake.scenery import Scenery
from sailenv_ros.bake.texels import Texels
from sailenv_ros.model import Material

__all__ = ["albedo_of", "emission_of"]

BRIGHTEST = 0.95
"""No surface gives back more: bounces would not end."""

GLOSS = 0.09
"""Share of the light from everywhere that the surface of something that is no metal gives back
before any colour is met: Schlick's Fresnel term from 0.04 on, averaged over directions with the
cosine, is 0.04 + 0.96 / 21 = 0.086; both ways through the surface little more is lost."""


def emission_of(scenery: Scenery, texels: Texels) -> NDArray[np.float32]:
    """Give (N, 3) float32: linear radiance that each texel emits."""
    table = np.zeros((len(scenery.materials) + 1, 3), dtype=np.float32)
    for place, material in enumerate(scenery.materials):
        table[place] = material.emission
    return table[scenery.material[texels.triangle]]


def albedo_of(scenery: Scenery, layout: Layout, texels: Texels) -> NDArray[np.float32]:
    """Give (N, 3) float32: linear share of the light that each texel gives back."""
    material = scenery.material[texels.triangle]
    order = np.argsort(material, kind="stable")
    bounds = np.searchsorted(material[order], np.arange(len(scenery.materials) + 1))
    fineness = _texture_texels(scenery, layout)
    albedo = np.zeros((texels.count, 3), dtype=np.float32)
    for place, look in enumerate(scenery.materials):
        chosen = order[bounds[place] : bounds[place + 1]]
        albedo[chosen] = look.base_colour[:3]
        if look.base_colour_texture is not None and len(chosen):
            triangle = texels.triangle[chosen]
            at = np.einsum("nc,ncx->nx", texels.weights[chosen], scenery.uvs[triangle])
            albedo[chosen] *= _sampled(look, at, float(np.median(fineness[triangle])))
        gloss = GLOSS * (1.0 - look.metallic)
        albedo[chosen] = gloss + (1.0 - gloss) * albedo[chosen]
    return np.clip(albedo, 0.0, BRIGHTEST)


def _texture_texels(scenery: Scenery, layout: Layout) -> NDArray[np.float64]:
    """Give (T,) float64: length in texture coordinates of one texel of the map, per triangle."""

    def area(points: NDArray[np.float32]) -> NDArray[np.float64]:
        a, b = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
        size: NDArray[np.float64] = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).astype(float)
        return size

    return np.sqrt(area(scenery.uvs) / np.maximum(area(layout.places), 1e-9))


def _sampled(look: Material, at: NDArray[np.float32], texel: float) -> NDArray[np.float32]:
    """Give (N, 3) float32: linear colour of the texture, averaged over about a texel of the map."""
    texture = look.base_colour_texture
    assert texture is not None
    height, width = texture.shape[:2]
    wide = int(np.clip(round(1.0 / max(texel, 1e-6)), 1, width))
    high = int(np.clip(round(wide * height / width), 1, height))
    linear = cv2.LUT(np.ascontiguousarray(texture[..., :3]), _LINEAR)
    small = cv2.resize(linear, (wide, high), interpolation=cv2.INTER_AREA).reshape(high, wide, 3)
    column = np.floor(at[:, 0] * wide).astype(np.int64) % wide
    row = np.floor((1.0 - at[:, 1]) * high).astype(np.int64) % high
    colours: NDArray[np.float32] = small[row, column]
    return colours


def _linear_of_srgb() -> NDArray[np.float32]:
    value = np.arange(256) / 255.0
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return linear.astype(np.float32)


_LINEAR = _linear_of_srgb()
