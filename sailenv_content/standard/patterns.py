"""Fine structures of surfaces that have no picture of their own: weave, terry, leather, grain.

Each is a tile made by code, the same bytes every time: near-white colours that multiply the
material's, and where it matters a normal map. Coordinates run along the faces, in metres.
scipy, which loads slowly, is imported by what draws them: they are kept on disk.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest
from sailenv_ros.types.model import Texture

__all__ = [
    "PATTERNS",
    "Pattern",
    "PatternTextures",
    "normals_of",
    "pattern_maps",
]

EDGE_PX = 256
GRAIN_PX = 1024
"""Edge of the tile of wood, whose finest lines are 2 mm apart [px]."""

RINGS = 14
"""Growth rings between what is of mean height in the landscape of wood and its ridges."""

_CODE = "../sailenv_content/standard"

Field = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pattern:
    """One structure.

    Attributes
    ----------
    tile_m : float
        Edge of what one tile covers [m].
    height : callable
        Gives (N, N) float64 heights, 0 to 1, that tile without a seam.
    shade : float
        How much darker than the peaks the valleys are, 0 to 1.
    relief : float
        Slope of the normal map; 0 for none.
    """

    tile_m: float
    height: Callable[[], Field]
    shade: float
    relief: float = 0.0


def pattern_maps(pattern: Pattern) -> Mapping[str, Texture]:
    """Return the textures by their attributes' names in `Material`; the same objects each time."""
    return _maps(next(name for name, known in PATTERNS.items() if known is pattern))


class PatternTextures:
    """The textures of the patterns by name, ``PATTERN/ATTRIBUTE``; see `SharedTextures`."""

    def name_of(self, texture: Texture) -> str | None:
        """Return the name of a texture; None if it is of no pattern."""
        known = _names.get(id(texture))
        return None if known is None else known[1]

    def named(self, name: str) -> Texture:
        """Return a texture by its name; the same object each time."""
        pattern, _, attribute = name.partition("/")
        return _maps(pattern)[attribute]


_names: dict[int, tuple[Texture, str]] = {}
"""Textures that were asked for, and their names, by identity.

They are kept here: threads that ask for a pattern at once get textures each, of which `_maps` keeps
those of one, and another array would have the identity of what is gone.
"""


@cache
def _maps(name: str) -> Mapping[str, Texture]:
    """Return the textures of a pattern, kept on disk: wood takes half a second."""
    code = code_digest(_CODE, libraries=("scipy",))
    maps = cached_arrays("pattern", (name,), lambda: _drawn(PATTERNS[name]), code=code)
    for attribute, texture in maps.items():
        _names[id(texture)] = texture, f"{name}/{attribute}"
    return maps


def _drawn(pattern: Pattern) -> Arrays:
    height = pattern.height()
    bright = 1.0 - pattern.shade * (1.0 - height)
    pixels = np.full((*height.shape, 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * np.clip(bright, 0.0, 1.0))[..., None]
    maps = {"base_colour_texture": pixels}
    if pattern.relief:
        maps["normal_texture"] = normals_of(height, pattern.relief)
    for texture in maps.values():
        texture.flags.writeable = False
    return maps


def normals_of(height: Field, relief: float) -> Texture:
    """Return the tangent-space normals of a height field that wraps around."""
    right = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) * 0.5 * relief * 16.0
    # Rows run downwards and v upwards.
    up = (np.roll(height, 1, axis=0) - np.roll(height, -1, axis=0)) * 0.5 * relief * 16.0
    normal = np.dstack([-right, -up, np.ones_like(height)])
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    pixels = np.full((*height.shape, 4), 255, np.uint8)
    pixels[..., :3] = np.rint(127.5 * normal + 127.5)
    pixels.flags.writeable = False
    return pixels


def _noise(seed: int, *sigmas: float | tuple[float, float]) -> Field:
    """Sum smoothed white noise of several scales, wrapped around, spread over 0 to 1."""
    generator = np.random.default_rng(seed)
    total = np.zeros((EDGE_PX, EDGE_PX))
    for sigma in sigmas:
        total += _layer(generator, EDGE_PX, sigma)
    low, high = np.percentile(total, (1.0, 99.0))
    return np.asarray(np.clip((total - low) / (high - low), 0.0, 1.0))


def _layer(generator: np.random.Generator, edge: int, sigma: float | tuple[float, float]) -> Field:
    """Return (edge, edge): smooth noise that wraps around, of deviation 1; sigma in pixels."""
    from scipy import ndimage

    layer = ndimage.gaussian_filter(generator.standard_normal((edge, edge)), sigma, mode="wrap")
    return np.asarray(layer / layer.std())


def _weave() -> Field:
    """Plain weave: threads that go over and under each other."""
    v, u = np.mgrid[0:EDGE_PX, 0:EDGE_PX] * (32.0 * np.pi / EDGE_PX)
    over = np.abs(np.sin(u)) ** 0.6 * (0.5 + 0.5 * np.sign(np.sin(u) * np.sin(v)))
    under = np.abs(np.sin(v)) ** 0.6 * (0.5 - 0.5 * np.sign(np.sin(u) * np.sin(v)))
    return np.asarray(np.clip(0.75 * (over + under) + 0.25 * _noise(11, 1.0, 6.0), 0.0, 1.0))


def _terry() -> Field:
    """Loops of towelling and carpet pile."""
    return np.asarray(np.clip(0.8 * _noise(12, 1.0, 1.6) + 0.2 * _noise(16, 7.0), 0.0, 1.0))


def _leather() -> Field:
    """Grain: cells with creases between them."""
    from scipy import ndimage

    generator = np.random.default_rng(13)
    seeds = np.zeros((EDGE_PX, EDGE_PX), bool)
    seeds[tuple(generator.integers(0, EDGE_PX, (2, 900)))] = True
    tiled = np.tile(seeds, (3, 3))
    distance, places = ndimage.distance_transform_edt(~tiled, return_indices=True)
    labels = places[0] * tiled.shape[1] + places[1]
    middle = slice(EDGE_PX, 2 * EDGE_PX)
    rim = (labels != np.roll(labels, 1, 0)) | (labels != np.roll(labels, 1, 1))
    crease = ndimage.gaussian_filter(rim.astype(np.float64), 1.2)[middle, middle]
    return np.asarray(np.clip(1.0 - 1.6 * crease - 0.02 * distance[middle, middle], 0.0, 1.0))


def _grain() -> Field:
    """Wood: fibres along u, growth rings as a veneer shows them.

    Rings are lines of equal height in a smooth landscape, long along u. On its slopes they lie
    2 to 5 mm apart, as on quarter-sawn boards; around its ridges, 10 to 20 cm apart, they make
    the arches of flat-sawn ones.
    """
    from scipy import ndimage

    generator = np.random.default_rng(47)
    coarse = GRAIN_PX // 8
    figure = ndimage.zoom(
        _layer(generator, coarse, (4.2, 38.0)), 8, order=3, mode="grid-wrap", grid_mode=True
    )
    waver = _layer(generator, GRAIN_PX, (2.0, 40.0))
    age = RINGS * figure + 0.07 * waver
    # Years are good and bad: rings differ in width and in how dark their late wood is.
    years = np.arange(-8 * RINGS, 8 * RINGS)
    age += np.interp(age, years, generator.uniform(-0.45, 0.45, len(years)))
    strength = np.interp(age, years, generator.uniform(0.35, 1.0, len(years)))
    season = age % 1.0
    late = np.minimum((season / 0.8) ** 2, (1.0 - season) / 0.2)
    # Lines finer than the pixels would make others that are none.
    lines = np.hypot(*np.gradient(age))
    late *= strength * np.clip((0.7 - lines) / 0.4, 0.0, 1.0)
    fibres = _layer(generator, GRAIN_PX, (0.8, 22.0))
    tone = _layer(generator, coarse, (3.0, 30.0))
    broad = ndimage.zoom(tone, 8, order=1, mode="grid-wrap", grid_mode=True)
    return np.asarray(np.clip(0.8 - 0.5 * late + 0.07 * fibres + 0.06 * broad, 0.0, 1.0))


PATTERNS = {
    "weave": Pattern(tile_m=0.06, height=_weave, shade=0.45),
    "terry": Pattern(tile_m=0.14, height=_terry, shade=0.3, relief=0.2),
    "leather": Pattern(tile_m=0.12, height=_leather, shade=0.3, relief=0.25),
    "grain": Pattern(tile_m=1.2, height=_grain, shade=0.3),
}
