"""Shares of what rooms mirror, kept for rooms that are shown again: by all that decides on them."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from collections.abc import Hashable
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.digests import appearance_digest
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["ReflectionStore", "room_key"]

MOST_SHARES = 64
"""Of some rooms, each with a share for each of its lights; a share is about a megabyte."""

T = TypeVar("T")


class ReflectionStore(Generic[T]):
    """Shares of the rooms that were shown last, by content: equal rooms have equal ones."""

    def __init__(self) -> None:
        # What keys tell by identity is kept beside, as numbers are unique only while it lives.
        self._shares: OrderedDict[Hashable, tuple[T, object]] = OrderedDict()

    def get(self, key: Hashable) -> T | None:
        """Return a share that was put here, if it is still there."""
        found = self._shares.get(key)
        if found is None:
            return None
        self._shares.move_to_end(key)
        return found[0]

    def put(self, key: Hashable, share: T, snapshot: WorldSnapshot) -> None:
        """Keep a share of the room of a snapshot; the one that was used longest ago may go."""
        self._shares[key] = share, snapshot.contents
        while len(self._shares) > MOST_SHARES:
            self._shares.popitem(last=False)


def room_key(
    snapshot: WorldSnapshot, still: NDArray[np.bool_], points: NDArray[np.float64]
) -> Hashable:
    """Return what decides on what is mirrored of a room, but for its lights.

    That is its baked light, what stands where it stood for it, and the points that it is seen from.
    Light that was changed since it was read is told by identity, all else by its content.
    """
    contents = snapshot.contents
    assert contents.baked is not None
    digest = hashlib.blake2b(digest_size=16)
    for row in np.flatnonzero(still).tolist():
        drawn = contents.instances[row]
        told = drawn.instance.id, drawn.scale, tuple(drawn.lit_by)
        digest.update(repr(told).encode() + appearance_digest(drawn.model))
    baked = contents.baked.of_still
    light = baked.checksum or (id(baked.layers), id(baked.charts))
    return light, digest.digest(), points.tobytes()
