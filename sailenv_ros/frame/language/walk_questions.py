"""Questions about ways upon the floor, by the maps of free space of robots of some widths."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.language.asking import Asker, Question, balanced_pairs
from sailenv_ros.frame.language.relation_laws import View
from sailenv_ros.frame.language.seen_objects import SeenObject
from sailenv_ros.space.free_space import FREE, OCCUPIED, BodySize, FreeSpace

__all__ = ["reached_cells", "walk_questions"]

NEAR_M, FAR_M = 0.5, 0.8
"""Distance from an object up to which a place reaches it, and from which it does not [m]."""

WIDER_M = 0.6
"""Distance from an object within which another goal counts as a rival [m]."""

LEG_M = 0.3
"""Least length of a way's first leg whose direction is told [m]."""

SECTOR_DEG, ANY_SECTOR_DEG = 30.0, 60.0
"""Half the angle around each of four directions in which the shortest way begins, and in which all
others do that are hardly longer."""

LONGER_M = 0.1
"""By how much a way is longer that is no rival of the shortest one [m]."""

RING_M = 0.3, 0.45
"""Distances from the start at which ways are compared [m]."""

_DIRECTIONS = {"ahead": 0.0, "left": 90.0, "backwards": 180.0, "right": -90.0}


def walk_questions(asker: Asker) -> Iterator[Question]:
    """Yield what each robot that can stand below the camera reaches, and where ways begin."""
    view = asker.graph.view
    for space in view.facts.spaces:
        start = view.camera_m[:2]
        if not space.is_free(start):
            continue
        away = space.distances_m(start)
        reached = np.isfinite(away)
        # A way of one cell's width is there or not by how cells happen to lie.
        wide, tight = (reached_cells(space, start, wider=wider) for wider in (True, False))
        yes, no = [], []
        for one in asker.named:
            near = _nearness(space, one)
            nearest = float(near[reached].min())
            proof = {"id": one.id, "radius_m": space.body.radius_m, "nearest_m": nearest}
            robot = _size(space.body)
            if near[wide].min(initial=np.inf) <= NEAR_M:
                yes.append(asker.ask("reach", "yes", (one,), proof, robot=robot))
                if space is view.facts.spaces[0]:
                    ways = np.where(near <= NEAR_M, away, np.inf)
                    yield from _path(asker, view, space, one, ways, reached & (near <= WIDER_M))
            elif near[tight].min() > FAR_M:
                no.append(asker.ask("reach", "no", (one,), proof, robot=robot))
        yield from balanced_pairs(asker, yes, no)


def reached_cells(
    space: FreeSpace, start: NDArray[np.float64], *, wider: bool
) -> NDArray[np.bool_]:
    """Return (H, W) the cells that a robot reaches that is a cell wider at each side, or narrower.

    None where the wider one cannot stand at the start.
    """
    around = np.pad(space.free, 1)
    height, width = space.cells.shape
    shifted = np.stack([around[y : y + height, x : x + width] for y in range(3) for x in range(3)])
    free = shifted.all(axis=0) if wider else shifted.any(axis=0)
    other = dataclasses.replace(space, cells=np.where(free, FREE, OCCUPIED).astype(np.int8))
    if not other.is_free(start):
        return np.zeros_like(free)
    return np.isfinite(other.distances_m(start))


def _nearness(space: FreeSpace, one: SeenObject) -> NDArray[np.float64]:
    """Return (H, W) how far the middle of each cell is from an object's box, across the floor."""
    height, width = space.cells.shape
    rows, columns = np.mgrid[:height, :width]
    x = space.origin_m[0] + (columns + 0.5) * space.resolution_m
    y = space.origin_m[1] + (rows + 0.5) * space.resolution_m
    if one.is_upright:
        upright = int(np.argmax(np.abs(one.turn[2])))
        flat = np.stack([x - one.middle_m[0], y - one.middle_m[1], np.zeros_like(x)], axis=-1)
        offset = np.abs(flat @ one.turn) - 0.5 * one.size_m
        offset[..., upright] = 0.0
    else:
        low, high = one.corners_m[:, :2].min(axis=0), one.corners_m[:, :2].max(axis=0)
        offset = np.stack(
            [np.maximum(low[0] - x, x - high[0]), np.maximum(low[1] - y, y - high[1])], axis=-1
        )
    return np.asarray(np.linalg.norm(offset.clip(min=0.0), axis=-1))


def _path(
    asker: Asker,
    view: View,
    space: FreeSpace,
    one: SeenObject,
    away: NDArray[np.float64],
    goals: NDArray[np.bool_],
) -> Iterator[Question]:
    """Ask in which direction the way to the nearest cell near an object begins.

    No way to goals in a wider ring begins otherwise.
    """
    forward = view.forward[:2]
    if np.linalg.norm(forward) < 0.3:  # it looks down, or up
        return
    row, column = np.unravel_index(int(np.argmin(away)), away.shape)
    goal = space.position_of(int(row), int(column))
    corners = space.path(view.camera_m[:2], goal)
    leg = corners[1, :2] - corners[0, :2]
    ahead = math.degrees(math.atan2(forward[1], forward[0]))
    bearing = math.degrees(math.atan2(leg[1], leg[0])) - ahead
    rivals = _rivals_deg(space, view.camera_m[:2], goals) - ahead
    for word, middle in _DIRECTIONS.items():
        clear = (np.abs(_turn_deg(rivals - middle)) <= ANY_SECTOR_DEG).all()
        off = abs(float(_turn_deg(np.array(bearing - middle))))
        if clear and off <= SECTOR_DEG and np.linalg.norm(leg) >= LEG_M:
            proof = {
                "id": one.id,
                "radius_m": space.body.radius_m,
                "left_deg": (bearing + 180.0) % 360.0 - 180.0,
                "length_m": float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum()),
                "corners_m": corners.tolist(),
            }
            yield asker.ask("path", word, (one,), proof, robot=_size(space.body))


def _rivals_deg(
    space: FreeSpace, start: NDArray[np.float64], goals: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the directions from the world's x axis [deg] in which ways that are short begin."""
    there, back = space.distances_m(start), space.distances_to_m(goals)
    ring = (there >= RING_M[0]) & (there <= RING_M[1])
    sums = np.where(ring, there + back, np.inf)
    rows, columns = np.nonzero(sums <= sums.min() + LONGER_M)
    x = space.origin_m[0] + (columns + 0.5) * space.resolution_m - start[0]
    y = space.origin_m[1] + (rows + 0.5) * space.resolution_m - start[1]
    directions: NDArray[np.float64] = np.degrees(np.arctan2(y, x))
    return directions


def _turn_deg(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((angle + 180.0) % 360.0 - 180.0)


def _size(body: BodySize) -> str:
    return f"{2.0 * body.radius_m:.1f} m wide and {body.height_m:g} m tall"
