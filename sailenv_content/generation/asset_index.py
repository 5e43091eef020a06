"""The catalogue as a generator sees it: how large an object is, where it carries others.

Names in, sizes in the body frame out. An object's size is that of what is drawn and of what
collides, whichever reaches further.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.arranging import shape_points, support_heights
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.types.model import Asset

__all__ = ["HOB", "AssetIndex"]

Floats = NDArray[np.float64]

LIGHT_GAP_M = 0.03
"""Between what glows of a lamp and its light [m]."""

HOB = "stove"
LET_IN = (HOB, "sink")
"""Categories of what is let into worktops."""

MAX_KEPT = 4096
"""Most sizes that are kept: pieces of families have names without end."""


class AssetIndex:
    """Sizes of objects, each computed once.

    Parameters
    ----------
    assets : AssetLibrary
    """

    def __init__(self, assets: AssetLibrary) -> None:
        self._assets = assets
        self._bounds = lru_cache(maxsize=MAX_KEPT)(self._measure)
        self._glow = lru_cache(maxsize=MAX_KEPT)(self._measure_glow)

    @property
    def assets(self) -> AssetLibrary:
        """The library of the assets."""
        return self._assets

    def asset(self, name: str) -> Asset:
        """Return an object; see `AssetLibrary.get` for errors."""
        return self._assets.get(name)

    def bounds(self, name: str, scale: float = 1.0) -> Floats:
        """Return (2, 3) float64: lowest and highest corner in the body frame [m]."""
        return np.asarray(self._bounds(name) * scale)

    def let_in(self, name: str, scale: float = 1.0) -> Mapping[str, Floats]:
        """Return (2, 3) float64: corners of the hob and the sink in a worktop, by category [m].

        A washbasin is a sink itself, and has nothing let in.
        """
        asset = self.asset(name)
        found = {}
        for part in asset.parts:
            if part.category in LET_IN and part.category != asset.category:
                points = np.concatenate([asset.model.parts[k].mesh.positions for k in part.meshes])
                corners = np.stack([points.min(axis=0), points.max(axis=0)])
                found[part.category] = corners.astype(np.float64) * scale
        return found

    def has(self, name: str, category: str) -> bool:
        """Return whether an object is of a category or has a part of it, as a row has a hob."""
        asset = self.asset(name)
        return category in (asset.category, *(part.category for part in asset.parts))

    def back_m(self, name: str, scale: float = 1.0) -> float:
        """Return how far what is drawn reaches behind the origin [m]; negative for behind."""
        return float(self.asset(name).model.bounds()[0, 0] * scale)

    def light_m(self, name: str, scale: float, *, up: bool) -> tuple[float, float, float]:
        """Return where a lamp's light is, in the body frame [m].

        It is above or below the middle of what glows, so that the shade does not keep it in; of a
        lamp that has nothing that glows, of the whole.
        """
        low, high = self._glow(name) * scale
        x, y = ((low + high) / 2.0)[:2].tolist()
        return x, y, float(high[2] + LIGHT_GAP_M if up else low[2] - LIGHT_GAP_M)

    def support_heights(
        self, name: str, scale: float, under: Floats, level: tuple[float, float] | None = None
    ) -> Floats:
        """Return the heights at which an object would carry something; see `arranging`."""
        return support_heights(self.asset(name), (scale,) * 3, under, level)

    def _measure_glow(self, name: str) -> Floats:
        parts = [part for part in self.asset(name).model.parts if any(part.material.glow)]
        if not parts:
            return self.bounds(name)
        points = np.concatenate([part.mesh.positions for part in parts]).astype(np.float64)
        return np.stack([points.min(axis=0), points.max(axis=0)])

    def _measure(self, name: str) -> Floats:
        asset = self.asset(name)
        bounds = asset.model.bounds().copy()
        if asset.collision:
            points = shape_points(asset.collision)
            bounds[0] = np.minimum(bounds[0], points.min(axis=0))
            bounds[1] = np.maximum(bounds[1], points.max(axis=0))
        bounds.flags.writeable = False
        return bounds
