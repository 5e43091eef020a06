"""Pictures of skies: from the packs' files to `SkyMap`s, each loaded once.

Made from high-dynamic-range photographs by `bake_sky` when a pack is built; brightness is brought
to one scale, so that a scene looks alike under another sky.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.pack import PACK_FILE, AssetPack
from sailenv_ros.errors import AssetError, UnknownName
from sailenv_ros.extras import need
from sailenv_ros.system.files import write_file
from sailenv_ros.types.colour import LUMINANCE
from sailenv_ros.types.lights import SkyMap

__all__ = ["SKIES", "bake_sky", "load_sky", "sky_files"]

SKIES = "skies"
"""Name of the folder in a pack."""

MEAN_RADIANCE = 0.65
"""Mean radiance of the upper half, without the sun, after baking."""

SUN_RADIANCE = 6.0
"""Brighter than this times the median is the sun: lights stand for it, the map does not."""


def sky_files(folders: Iterable[Path]) -> Mapping[str, Path]:
    """Return the files of all skies in some packs' folders, by name."""
    return {
        path.stem: path for folder in folders for path in sorted((folder / SKIES).glob("*.npy"))
    }


def load_sky(name: str, files: Mapping[str, Path], rotation_deg: float = 0.0) -> SkyMap:
    """Return a sky; the same object each time.

    Parameters
    ----------
    name : str
    files : mapping of str to Path
        See `sky_files`.
    rotation_deg : float
        Turns it about the vertical, counter-clockwise as seen from above, to the nearest column.

    Raises
    ------
    UnknownName
        If no pack has it.
    AssetError
        If its file cannot be used.
    """
    if name not in files:
        raise UnknownName("sky", name, files)
    sky = _loaded(files[name])
    columns = sky.radiance.shape[1]
    # Columns run clockwise.
    turned = -round(rotation_deg / 360.0 * columns) % columns
    return sky if turned == 0 else _turned(files[name], turned)


@lru_cache(maxsize=8)
def _turned(path: Path, columns: int) -> SkyMap:
    sky = _loaded(path)
    radiance = np.roll(sky.radiance, columns, axis=1)
    radiance.flags.writeable = False
    return replace(sky, radiance=radiance)


@lru_cache(maxsize=8)
def _loaded(path: Path) -> SkyMap:
    pack = path.parents[1]
    if (pack / PACK_FILE).is_file():
        AssetPack(pack).check_file(path)
    try:
        radiance = np.load(io.BytesIO(path.read_bytes()), allow_pickle=False)
    except Exception as problem:  # whatever a damaged file leads to
        raise AssetError(path.name, f"the sky cannot be read ({problem})") from None
    if radiance.ndim != 3 or radiance.shape[1:] != (2 * radiance.shape[0], 3):
        raise AssetError(path.name, f"a sky is (H, 2 H, 3), and this is {radiance.shape}")
    radiance = np.ascontiguousarray(radiance, dtype=np.float16)
    radiance.flags.writeable = False
    rows = len(radiance)
    return SkyMap(
        radiance=radiance,
        zenith=_mean(radiance[: rows // 4]),
        horizon=_mean(radiance[rows * 3 // 8 : rows // 2]),
        ground=_mean(radiance[rows * 5 // 8 :]),
    )


def _mean(part: NDArray[np.float16]) -> tuple[float, float, float]:
    red, green, blue = part.astype(np.float64).mean(axis=(0, 1))
    return float(red), float(green), float(blue)


def bake_sky(photograph: Path, target: Path) -> None:
    """Turn an OpenEXR panorama into a sky's file.

    Raises
    ------
    AssetError
        If it cannot be read.
    MissingPackage
        If OpenEXR is not installed.
    OSError
        If the sky's file cannot be written.
    """
    openexr = need("OpenEXR", "building the furniture pack")
    try:
        with openexr.File(str(photograph)) as file:
            pixels = np.asarray(file.channels()["RGB"].pixels, dtype=np.float64)
    except (RuntimeError, OSError, KeyError) as problem:
        raise AssetError(photograph.name, f"the panorama cannot be read ({problem})") from None
    radiance = np.maximum(pixels, 0.0)
    light = radiance @ LUMINANCE
    sky = light[: len(light) // 2]
    limit = SUN_RADIANCE * float(np.median(sky))
    radiance *= np.minimum(1.0, limit / np.maximum(light, 1e-6))[..., None]
    scale = MEAN_RADIANCE / float(np.minimum(sky, limit).mean())
    data = io.BytesIO()
    np.save(data, (radiance * scale).astype(np.float16))
    write_file(target, data.getvalue())
