"""Shadows of what can move as changes of light maps. From what rays found at points to texels."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.moved_surfaces import MovedSurfaces
from sailenv_ros.light.relight.quality import FINE
from sailenv_ros.native.relight_kernels import smooth_change, spread_change
from sailenv_ros.native.relight_types import PatchMap
from sailenv_ros.types.colour import HALF_MOST

__all__ = ["INSIDE", "PointChanges", "ShadowMaps", "with_neighbours"]

Floats = NDArray[np.float32]
Maps = Sequence[NDArray[np.float16]]

INSIDE = 3
"""State of points of which nothing is known: they lie inside of something."""

FAR_M = 2.0
"""Distance that stands for all that is farther, in the kernels too [m]."""

TILE = 4
"""Texels to a side of a patch."""

MOST_FORGOTTEN = 0.5
"""Share of the patches beyond which it is quicker to write all again."""

SMOOTHING, NARROW = 2, 0.4
"""Texels to each side that are averaged over at most, and by how much less far than patches as
what hides light is near: many rays leave little noise."""


class PointChanges(NamedTuple):
    """Changes of light at points.

    Attributes
    ----------
    state : (K,) uint8
        As `gather_change` tells it.
    change : (K, C) float32
        Irradiance / pi.
    nearness : (K,) float32
        Harmonic mean of the distances of what was met [m].
    """

    state: NDArray[np.uint8]
    change: Floats
    nearness: Floats

    @classmethod
    def none(cls, points: int, channels: int) -> PointChanges:
        """Return those of points at which nothing changes."""
        nothing = np.zeros((points, channels), np.float32)
        return cls(np.zeros(points, np.uint8), nothing, np.full(points, FAR_M, np.float32))

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]], kind: str) -> PointChanges:
        """Return those that are kept in arrays under the name of a kind of points."""
        return cls(*(arrays[f"{kind}_{name}"] for name in cls._fields))

    def arrays(self, kind: str) -> dict[str, NDArray[Any]]:
        """Return arrays to keep them in."""
        return {f"{kind}_{name}": array for name, array in self._asdict().items()}

    def copy(self) -> PointChanges:
        """Return a copy that may be written to."""
        return PointChanges(self.state.copy(), self.change.copy(), self.nearness.copy())

    def at(self, places: NDArray[np.integer]) -> PointChanges:
        """Return those of some points."""
        return PointChanges(self.state[places], self.change[places], self.nearness[places])

    def put(self, at: NDArray[np.integer], found: PointChanges) -> None:
        """Write what was found over what is known of some points."""
        self.state[at], self.change[at], self.nearness[at] = found

    def replaced(
        self, kept: NDArray[np.bool_], found: Sequence[PointChanges], order: NDArray[np.intp]
    ) -> PointChanges:
        """Return those of the points that are kept and of others, in an order of all."""
        return PointChanges(
            np.concatenate([self.state[kept], *(one.state for one in found)])[order],
            np.concatenate([self.change[kept], *(one.change for one in found)])[order],
            np.concatenate([self.nearness[kept], *(one.nearness for one in found)])[order],
        )


class ShadowMaps:
    """Light maps with shadows in them; what has not changed is kept from one time to the next.

    Parameters
    ----------
    surfaces : MovedSurfaces
    sharp : int
        How many of the last channels have edges that are not smoothed.
    """

    def __init__(self, surfaces: MovedSurfaces, sharp: int) -> None:
        self._surfaces, self._sharp = surfaces, sharp
        self._known: tuple[Maps, Maps] | None = None
        self._forgotten = np.zeros(len(surfaces.wanted), bool)

    def copy(self) -> ShadowMaps:
        """Return the same maps, which are written apart from these."""
        same = copy.copy(self)
        same._forgotten = self._forgotten.copy()
        return same

    def forget(self, patches: NDArray[np.bool_]) -> None:
        """Have what was found at (P,) patches written again."""
        self._forgotten |= patches

    def on(
        self,
        maps: Maps,
        at_patches: PointChanges,
        texels: NDArray[np.intp],
        at_texels: PointChanges,
        threads: int,
    ) -> Maps:
        """Return maps of a light with what was found in them.

        Parameters
        ----------
        maps : sequence of (side, side, 3) or (side, side) float16
            C channels in all; nobody writes to them.
        at_patches : PointChanges
            Of all patches; where texels know better they are inside.
        texels : (K,) intp
            Those of which something was found.
        at_texels : PointChanges
        threads : int
        """
        surfaces, scene = self._surfaces, self._surfaces.scene
        kept = self._kept(maps)
        if kept is not None and not self._forgotten.any():
            return kept
        if self._forgotten.mean() > MOST_FORGOTTEN:
            kept = None
        mapped, written = surfaces.texels(), None
        if kept is None:
            after = [one.copy() for one in maps]
        else:
            tiles = _tiles_near(scene, self._forgotten, FINE.smoothing + 1)
            of_map = np.repeat(np.repeat(tiles, TILE, 0), TILE, 1)[: scene.side, : scene.side]
            after = [
                np.where(of_map if new.ndim == 2 else of_map[..., None], old, new)
                for old, new in zip(maps, kept, strict=True)
            ]
            written = of_map.reshape(-1)[scene.places]
            mapped = surfaces.texels(written)
        patches = surfaces.patches()
        state, change = _smooth(patches, at_patches, FINE.smoothing, 4, threads)
        spread_change(mapped, patches, state, change, after, threads=threads)
        if len(texels):
            wanted = np.ones(len(texels), bool) if written is None else written[texels]
            self._put_texels(maps, after, texels, at_texels, wanted, threads)
        self._known = maps, after
        self._forgotten[:] = False
        return after

    def _kept(self, maps: Maps) -> Maps | None:
        """Return what was returned for the same maps, if those were the last."""
        if self._known is None:
            return None
        before, after = self._known
        same = all(one is other for one, other in zip(before, maps, strict=True))
        return after if same else None

    def _put_texels(
        self,
        before: Maps,
        after: Maps,
        texels: NDArray[np.intp],
        found: PointChanges,
        wanted: NDArray[np.bool_],
        threads: int,
    ) -> None:
        """Write what was found at texels over what patches say of them, where it is wanted."""
        surfaces, scene = self._surfaces, self._surfaces.scene
        places = scene.places[texels]
        of_map = np.full((scene.side, scene.side), -1, np.int32)
        of_map.reshape(-1)[places] = np.arange(len(places), dtype=np.int32)
        rows, columns = np.divmod(places, scene.side)
        own = PatchMap(
            of_map, np.stack([columns, rows], axis=1).astype(np.float32),
            surfaces.positions[texels], surfaces.normals[texels], scene.owners[texels],
        )  # fmt: skip
        narrow = found._replace(nearness=found.nearness * np.float32(NARROW))
        state, change = _smooth(own, narrow, SMOOTHING, 1, threads)
        soft = change.shape[1] - self._sharp
        change[:, soft:] = found.change[:, soft:]
        known = _filled(of_map, rows, columns, state, change) & wanted
        at, column = places[known], 0
        for old, new in zip(before, after, strict=True):
            depth = _flat(old).shape[1]
            lit = _flat(old)[at] + change[known, column : column + depth]
            _flat(new)[at] = np.clip(lit, 0.0, HALF_MOST)
            column += depth


def with_neighbours(scene: BakedScene, patches: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (P,) bool: patches, and those beside them in the map."""
    columns, rows = scene.patches.places.astype(np.intp).T
    found: NDArray[np.bool_] = _tiles_near(scene, patches, 1)[rows // TILE, columns // TILE]
    return found


def _tiles_near(scene: BakedScene, patches: NDArray[np.bool_], by: int) -> NDArray[np.bool_]:
    """Return the tiles of the map, up to so many from those of patches."""
    tiles = np.zeros((scene.side // TILE + 1, scene.side // TILE + 1), bool)
    columns, rows = scene.patches.places[patches].astype(np.intp).T
    tiles[rows // TILE, columns // TILE] = True
    return _widened(_widened(tiles, by).T, by).T


def _widened(tiles: NDArray[np.bool_], by: int) -> NDArray[np.bool_]:
    """Return tiles with so many rows more above and below."""
    wide = tiles.copy()
    for step in range(1, by + 1):
        wide[step:] |= tiles[:-step]
        wide[:-step] |= tiles[step:]
    return wide


def _smooth(
    patches: PatchMap, found: PointChanges, radius: int, step: int, threads: int
) -> tuple[NDArray[np.uint8], Floats]:
    return smooth_change(
        patches, radius, found.state, found.nearness, found.change, step=step, threads=threads
    )


def _flat(layer: NDArray[np.float16]) -> NDArray[np.float16]:
    """Return (texels, channels) of a map."""
    return layer.reshape(layer.shape[0] * layer.shape[1], -1)


def _filled(
    of_map: NDArray[np.int32],
    rows: NDArray[np.int32],
    columns: NDArray[np.int32],
    state: NDArray[np.uint8],
    change: Floats,
) -> NDArray[np.bool_]:
    """Give texels inside of something what those beside them have: they are looked up there.

    Returns
    -------
    known : (K,) bool
        Where `change`, which is written to, is known.
    """
    inside = np.flatnonzero(state == INSIDE)
    total, count = np.zeros((len(inside), change.shape[1]), np.float32), np.zeros(len(inside))
    last = len(of_map) - 1
    for down, across in itertools.product((-1, 0, 1), repeat=2):
        row = np.clip(rows[inside] + down, 0, last)
        beside = of_map[row, np.clip(columns[inside] + across, 0, last)]
        found = (beside >= 0) & (state[beside] != INSIDE)
        total[found] += change[beside[found]]
        count += found
    filled = count > 0
    change[inside[filled]] = total[filled] / count[filled, None].astype(np.float32)
    known: NDArray[np.bool_] = state != INSIDE
    known[inside[filled]] = True
    return known
