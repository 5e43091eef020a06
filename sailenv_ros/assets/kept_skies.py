"""Skies while something shows them: the same object for all, and few beside.

`skies` itself keeps the last ones that were asked for, 3 MB each, and a stream asks for all. What
is in that file is not changed for this: it shapes the furniture, which would be built again.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from sailenv_ros.assets.kept_assets import KeptAssets
from sailenv_ros.assets.skies import _loaded, _turned, load_sky
from sailenv_ros.types.lights import SkyMap

__all__ = ["kept_sky"]

_kept: KeptAssets[tuple[Path | None, float], SkyMap] = KeptAssets(most=1)


def kept_sky(name: str, files: Mapping[str, Path], rotation_deg: float) -> SkyMap:
    """Return a sky; the same object while it is in use. See `load_sky` for the rest."""
    return _kept.get((files.get(name), rotation_deg), partial(_load, name, files, rotation_deg))


def _load(name: str, files: Mapping[str, Path], rotation_deg: float) -> SkyMap:
    sky = load_sky(name, files, rotation_deg)
    for cache in (_loaded, _turned):
        cache.cache_clear()
    return sky
