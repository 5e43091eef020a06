"""Rays against the scenery with embree. From `Scenery` to `RayScene`; knows no light."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from sailenv_ros.bake.scenery import Scenery

__all__ = ["Hits", "RayScene", "in_chunks"]

Floats = NDArray[np.float32]

NEVER = 1e30
"""Length of rays without end [m]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Hits:
    """What rays met first.

    Attributes
    ----------
    triangle : (R,) int32
        -1 where they met nothing.
    distance : (R,) float32
        In lengths of the direction; huge where they met nothing.
    second, third : (R,) float32
        Weights of the triangle's second and third corner.
    """

    triangle: NDArray[np.int32]
    distance: Floats
    second: Floats
    third: Floats


class RayScene:
    """The solid triangles of a scenery, ready to be met by rays from any thread."""

    def __init__(self, scenery: Scenery) -> None:
        self._triangles = np.flatnonzero(scenery.solid).astype(np.int32)
        self._scene = EmbreeScene()
        self.rays = 0
        """How many rays were cast."""
        if len(self._triangles):
            self._mesh = TriangleMesh(self._scene, scenery.corners[self._triangles])
            # The first query builds the tree; threads shall find it built.
            nowhere = np.zeros((1, 3), np.float32)
            self._scene.run(nowhere, nowhere + 1)

    def hits(self, origins: Floats, directions: Floats) -> Hits:
        """Find what rays meet first."""
        self.rays += len(origins)
        if not len(self._triangles):
            none = np.zeros(len(origins), np.float32)
            never = np.full(len(origins), NEVER, np.float32)
            found = np.full(len(origins), -1, np.int32)
            return Hits(triangle=found, distance=never, second=none, third=none)
        answer = self._scene.run(origins, directions, output=1)
        met = answer["primID"]
        return Hits(
            triangle=np.where(met >= 0, self._triangles[met], np.int32(-1)),
            distance=answer["tfar"],
            second=answer["u"],
            third=answer["v"],
        )

    def is_free(self, origins: Floats, directions: Floats, lengths: Floats) -> NDArray[np.bool_]:
        """Tell of each ray whether nothing lies within its length, in lengths of the direction."""
        self.rays += len(origins)
        if not len(self._triangles) or not len(origins):
            return np.ones(len(origins), dtype=bool)
        answer = self._scene.run(origins, directions, lengths, query="OCCLUDED")
        free: NDArray[np.bool_] = answer < 0
        return free


def in_chunks(
    work: Callable[[int, int], None],
    count: int,
    size: int,
    workers: int,
    told: Callable[[float], None] = lambda share: None,
) -> None:
    """Do ``work(first, end)`` for all of `count` items in several threads.

    Results do not depend on the number of threads as long as pieces do not share what they write.
    """
    pieces = [(first, min(first + size, count)) for first in range(0, count, size)]
    pool = ThreadPoolExecutor(workers)
    try:
        for done, future in enumerate([pool.submit(work, *piece) for piece in pieces]):
            future.result()
            told((done + 1) / len(pieces))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
