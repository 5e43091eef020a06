"""Lays models' surfaces flat with xatlas. From `Model` to `Unwrapping` and its size in texels.

Knows neither where instances stand nor what lights them.
"""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.extras import need
from sailenv_ros.types.baked_light import Unwrapping
from sailenv_ros.types.model import Mesh, Model

__all__ = ["Chart", "unwrapped"]

UNSEEN = 0.2
"""Share of the usual fineness that surfaces have which nobody sees."""

_Flat: TypeAlias = tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float32]]
"""Copied vertices, triangles and places, as xatlas gives them."""


_TASKS = Path("/proc/self/task")

LONGEST_WAIT_S = 2.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Chart:
    """A model, unwrapped.

    Attributes
    ----------
    unwrapping : Unwrapping
    width, height : int
        Of the smallest picture of it in which bilinear look-ups never meet other pieces [texels].
    pieces : int
        Number of surfaces that were unwrapped each by itself.
    """

    unwrapping: Unwrapping
    width: int
    height: int
    pieces: int


def unwrapped(
    model: Model,
    scale: tuple[float, float, float],
    texel_m: float,
    visible_triangles: NDArray[np.bool_] | None = None,
) -> Chart:
    """Lay a model flat.

    Parameters
    ----------
    model : Model
        With at least one triangle.
    scale : (3,) tuple of float
        Of the instance for which the texels have their size.
    texel_m : float
        Side of a texel [m].
    visible_triangles : (T,) bool or None
        Triangles that are seen at all, part after part; the others' texels are larger.
    """
    seen = np.ones(model.triangle_count, bool) if visible_triangles is None else visible_triangles
    xatlas = need("xatlas", "baking light")
    before = _threads()
    atlas = xatlas.Atlas()
    first = 0
    pieces: list[list[NDArray[np.intp]]] = []
    for part in model.parts:
        own = seen[first : first + len(part.mesh.triangles)]
        first += len(own)
        pieces.append(
            [chosen for chosen in (np.flatnonzero(own), np.flatnonzero(~own)) if len(chosen)]
        )
        for chosen in pieces[-1]:
            size = np.abs(np.asarray(scale)) * (1.0 if own[chosen[0]] else UNSEEN)
            points = (part.mesh.positions * size).astype(np.float32)
            # A thread of xatlas that still works on the mesh before may take up what is half
            # written, and end the process: twice in 8,600 atlases, never in 11,000 so.
            _wait_for_rest(before)
            atlas.add_mesh(points, np.ascontiguousarray(part.mesh.triangles[chosen]))
    _wait_for_rest(before)
    packing = xatlas.PackOptions()
    packing.texels_per_unit = 1.0 / texel_m
    packing.padding = 1
    packing.bilinear = True
    atlas.generate(xatlas.ChartOptions(), packing)
    number = iter(range(atlas.mesh_count))
    parts = [
        _joined(part.mesh, [(chosen, atlas.get_mesh(next(number))) for chosen in chosens])
        for part, chosens in zip(model.parts, pieces, strict=True)
    ]
    _wait_for_rest(before)
    return Chart(
        unwrapping=Unwrapping(
            vertices=tuple(part[0] for part in parts),
            triangles=tuple(part[1] for part in parts),
            uvs=tuple(part[2] for part in parts),
        ),
        width=atlas.width,
        height=atlas.height,
        pieces=atlas.chart_count,
    )


def _joined(
    mesh: Mesh, found: list[tuple[NDArray[np.intp], _Flat]]
) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float32]]:
    """Put the pieces of a part together again, its triangles in their own order."""
    vertices, uvs = [np.zeros(0, np.uint32)], [np.zeros((0, 2), np.float32)]
    triangles = np.zeros(mesh.triangles.shape, dtype=np.uint32)
    count = 0
    for chosen, (copied, corners, places) in found:
        triangles[chosen] = corners + np.uint32(count)
        vertices.append(copied)
        uvs.append(places)
        count += len(copied)
    joined = np.concatenate(vertices), triangles, np.concatenate(uvs)
    for array in joined:
        array.flags.writeable = False
    return joined


def _threads() -> frozenset[str]:
    """Return the system's numbers of this process's threads."""
    return frozenset(task.name for task in _TASKS.iterdir()) if _TASKS.is_dir() else frozenset()


def _wait_for_rest(before: frozenset[str]) -> None:
    """Wait until the threads that have come since sleep.

    An atlas that goes while one of its threads is just falling asleep is never told that the
    thread has ended (xatlas notifies without holding the lock), and waits forever. A thread that
    the system calls sleeping is past that moment.
    """
    late = time.monotonic() + LONGEST_WAIT_S
    while time.monotonic() < late and any(map(_is_awake, _threads() - before)):
        time.sleep(0.001)


def _is_awake(thread: str) -> bool:
    with suppress(OSError):
        # After the name in brackets, which may hold anything, comes the state.
        state = (_TASKS / thread / "stat").read_text().rpartition(")")[2].split()[0]
        return state in "RD"
    return False
