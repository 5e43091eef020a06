"""Shadows of what can move as changes of light maps. From what rays found at points to texels."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.moved_surfaces import MovedSurfaces
from sailenv_ros.light.relight.quality import FINE
from sailenv_ros.native.relight_kernels import smooth_change, spread_change
from sailenv_ros.native.relight_types import PatchMap

__all__ = ["INSIDE", "PointChanges", "brightened", "difference_of"]

Floats = NDArray[np.float32]
Maps = Sequence[NDArray[np.float16]]

INSIDE = 3
"""State of points of which nothing is known: they lie inside of something."""

MOST = 6e4
"""Largest value of a light map."""

SMOOTHING, NARROW = 2, 0.4
"""Texels to each side that are averaged over at most, and by how much less far than patches as
what hides light is near: many rays leave little noise."""


class PointChanges(NamedTuple):
    """What changes at points: (K,) states, (K, C) changes, (K,) distances of what was met [m]."""

    state: NDArray[np.uint8]
    change: Floats
    nearness: Floats

    @classmethod
    def none(cls, points: int, channels: int) -> PointChanges:
        """Return those of points at which nothing changes."""
        nothing = np.zeros((points, channels), np.float32)
        return cls(np.zeros(points, np.uint8), nothing, np.ones(points, np.float32))

    def copy(self) -> PointChanges:
        """Return a copy that may be written to."""
        return PointChanges(self.state.copy(), self.change.copy(), self.nearness.copy())

    def put(self, at: NDArray[np.intp], found: PointChanges) -> None:
        """Write what was found over what is known of some points."""
        self.state[at], self.change[at], self.nearness[at] = found

    def replaced(
        self, kept: NDArray[np.bool_], found: PointChanges, order: NDArray[np.intp]
    ) -> PointChanges:
        """Return those of the points that are kept and of others, in an order of both."""
        return PointChanges(
            np.concatenate([self.state[kept], found.state])[order],
            np.concatenate([self.change[kept], found.change])[order],
            np.concatenate([self.nearness[kept], found.nearness])[order],
        )


def difference_of(
    maps: Maps,
    surfaces: MovedSurfaces,
    at_patches: PointChanges,
    texels: NDArray[np.intp],
    at_texels: PointChanges,
    sharp: int,
    threads: int,
) -> tuple[NDArray[np.intp], Floats]:
    """Spread what was found over the texels of maps.

    Parameters
    ----------
    maps : sequence of (side, side, 3) or (side, side) float16
        C channels in all.
    surfaces : MovedSurfaces
    at_patches : PointChanges
        Of all patches; where texels know better they are inside.
    texels : (K,) intp
        Those of which something was found.
    at_texels : PointChanges
    sharp : int
        How many of the last channels have edges that are not smoothed.
    threads : int

    Returns
    -------
    places : (M,) intp
        Of texels in the map.
    difference : (M, C) float32
    """
    after = [one.copy() for one in maps]
    patches = surfaces.patches()
    state, change = _smooth(patches, at_patches, FINE.smoothing, 4, threads)
    spread_change(surfaces.texels(), patches, state, change, after, threads=threads)
    if len(texels):
        _put_texels(maps, after, surfaces, texels, at_texels, sharp, threads)
    pairs = [(_flat(old), _flat(new)) for old, new in zip(maps, after, strict=True)]
    changed = np.zeros(len(pairs[0][0]), bool)
    for old, new in pairs:
        changed |= (old != new).any(axis=1)
    places = np.flatnonzero(changed)
    return places, np.concatenate(
        [new[places].astype(np.float32) - old[places] for old, new in pairs], axis=1
    )


def brightened(
    maps: Maps, places: NDArray[np.intp], difference: Floats
) -> list[NDArray[np.float16]]:
    """Return copies of maps to which a difference is added, as far as nothing gets below 0."""
    after = [one.copy() for one in maps]
    _add(maps, after, places, difference)
    return after


def _add(before: Maps, after: Maps, places: NDArray[np.integer], change: Floats) -> None:
    for old, new, own in _columns(before, after, change):
        new[places] = np.clip(old[places] + own, 0.0, MOST)


def _put_texels(
    before: Maps,
    after: Maps,
    surfaces: MovedSurfaces,
    texels: NDArray[np.intp],
    found: PointChanges,
    sharp: int,
    threads: int,
) -> None:
    """Write what was found at texels over what patches say of them."""
    scene = surfaces.scene
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
    soft = change.shape[1] - sharp
    change[:, soft:] = found.change[:, soft:]
    known = _filled(of_map, rows, columns, state, change)
    _add(before, after, places[known], change[known])


def _smooth(
    patches: PatchMap, found: PointChanges, radius: int, step: int, threads: int
) -> tuple[NDArray[np.uint8], Floats]:
    return smooth_change(
        patches, radius, found.state, found.nearness, found.change, step=step, threads=threads
    )


def _flat(layer: NDArray[np.float16]) -> NDArray[np.float16]:
    """Return (texels, channels) of a map."""
    return layer.reshape(layer.shape[0] * layer.shape[1], -1)


def _columns(
    before: Maps, after: Maps, values: Floats
) -> Iterator[tuple[NDArray[np.float16], NDArray[np.float16], Floats]]:
    """Return maps, flat, and the columns of values that belong to each."""
    column = 0
    for old, new in zip(before, after, strict=True):
        depth = _flat(old).shape[1]
        yield _flat(old), _flat(new), values[:, column : column + depth]
        column += depth


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
