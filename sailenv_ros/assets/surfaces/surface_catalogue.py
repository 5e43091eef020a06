"""The surfaces by name: a name, a colour and a seed in, a `Surface` out; made once, then kept."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import TypeAlias

import numpy as np

from sailenv_ros.assets.surfaces.maps import (
    Floats,
    Surface,
    SurfaceMaps,
    surface_arrays,
    surface_of,
)
from sailenv_ros.assets.surfaces.mineral import concrete, plaster, roughcast
from sailenv_ros.assets.surfaces.textile import carpet, wallpaper_damask, wallpaper_stripes
from sailenv_ros.assets.surfaces.tiles import glazed_squares, metro, stone
from sailenv_ros.assets.surfaces.wood import herringbone, planks
from sailenv_ros.errors import UnknownName
from sailenv_ros.system.array_cache import Arrays, cached_arrays, code_digest

__all__ = ["surface", "surface_names"]

Vector3 = tuple[float, float, float]
Recipe: TypeAlias = Callable[[np.random.Generator, Floats], SurfaceMaps]

_KEPT = 8
"""Surfaces that are kept, of 12 MB each: more than a room has. Others are read from files."""


@dataclass(frozen=True, slots=True)
class _SurfaceEntry:
    recipe: Recipe
    colour: Vector3


_ENTRIES: Mapping[str, _SurfaceEntry] = MappingProxyType(
    {
        "plaster": _SurfaceEntry(plaster, (0.80, 0.78, 0.74)),
        "roughcast": _SurfaceEntry(roughcast, (0.74, 0.71, 0.65)),
        "concrete": _SurfaceEntry(concrete, (0.34, 0.335, 0.32)),
        "oak_planks": _SurfaceEntry(planks, (0.45, 0.285, 0.150)),
        "walnut_planks": _SurfaceEntry(planks, (0.170, 0.088, 0.046)),
        "oak_parquet": _SurfaceEntry(herringbone, (0.40, 0.235, 0.112)),
        "walnut_parquet": _SurfaceEntry(herringbone, (0.180, 0.092, 0.048)),
        "white_tiles": _SurfaceEntry(glazed_squares, (0.80, 0.80, 0.78)),
        "metro_tiles": _SurfaceEntry(metro, (0.82, 0.81, 0.78)),
        "stone_tiles": _SurfaceEntry(stone, (0.50, 0.44, 0.355)),
        "carpet": _SurfaceEntry(carpet, (0.30, 0.27, 0.23)),
        "wallpaper_stripes": _SurfaceEntry(wallpaper_stripes, (0.66, 0.62, 0.52)),
        "wallpaper_damask": _SurfaceEntry(wallpaper_damask, (0.47, 0.54, 0.52)),
    }
)


def surface_names() -> tuple[str, ...]:
    """Names of all surfaces."""
    return tuple(_ENTRIES)


def surface(name: str, *, colour: Vector3 | None = None, seed: int = 0) -> Surface:
    """Return a surface; the same object for the same arguments while it is kept.

    Parameters
    ----------
    name : str
        One of `surface_names`.
    colour : (3,) tuple of float or None
        Linear colour of what the surface is made of (the tiles, not their joints), 0 to 1, which
        its average comes near to; ``None`` for its own.
    seed : int
        0 or more: others give other grain, clouds and tones.

    Raises
    ------
    UnknownName
        If there is no such surface.
    """
    if name not in _ENTRIES:
        raise UnknownName("material", name, _ENTRIES)
    return _made(name, _ENTRIES[name].colour if colour is None else colour, seed)


@lru_cache(maxsize=_KEPT)
def _made(name: str, colour: Vector3, seed: int) -> Surface:
    def arrays() -> Arrays:
        rng = np.random.default_rng([zlib.crc32(name.encode()), seed])
        maps = _ENTRIES[name].recipe(rng, np.asarray(colour, dtype=np.float32))
        return surface_arrays(maps)

    code = code_digest("assets/surfaces", "types", libraries=("scipy",))
    return surface_of(name, cached_arrays("surface", [name, colour, seed], arrays, code=code))
