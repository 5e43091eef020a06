"""Small things that shine, or that lie close to a lamp: where they are.

Of rays in all directions few meet a lamp, and what they find is noise. So each point looks at each
lamp besides, into the cone of a ball around it; both samples are joined by the balance heuristic
(Veach and Guibas 1995), whatever it is that they meet.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.bake.direct import squared_distances
from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.rays.static_geometry import StaticGeometry
from sailenv_ros.types.lights import LAMP_TYPES, Light

__all__ = ["MOST_EMITTERS", "emitters_of", "without_nested"]

Floats = NDArray[np.float32]

MOST_EMITTERS = 12

LARGEST_M = 0.5
"""Radius of a ball around an emitter; what is larger is met often enough."""

GROUP_M = 0.04
"""Side of the cells of space that join what shines to one emitter, cell by cell [m]."""

MOST_CELLS = 100
"""Length up to which things are looked through for bulbs [cells]."""

LEAST_SHARE = 0.002
"""Least power of an emitter that is sampled, as a share of the strongest one's."""

NESTED = 0.25
"""Share of its radius by which the middle of an emitter lies within a larger one, to be nested."""

LEVELS = 30.0, 300.0, 3000.0
"""Surfaces around a lamp are emitters where at least so many times as much light arrives as at the
median distance; each level is within the former."""

NEAREST_M = 0.02
"""Surfaces nearer to the middle of a lamp count as that far [m]."""


def emitters_of(
    geometry: StaticGeometry,
    texels: Texels,
    emitted: Iterable[Floats],
    lights: Sequence[Light],
    albedo: Floats,
) -> NDArray[np.float32]:
    """Return (E, 4) float32: middle and radius [m] of balls around small things that shine.

    Parameters
    ----------
    emitted : iterable of (N, 3) float32
        By texels: by themselves, and by the light in each lamp.
    lights : sequence of Light
    albedo : (N, 3) float32
    """
    owner = geometry.owner[texels.triangle]
    shining = (*emitted, *_close_to_lamps(lights, texels, albedo))
    found: list[tuple[float, list[float]]] = []
    for emission in shining:
        bright = np.flatnonzero(emission.any(axis=1))
        for own in np.unique(owner[bright]):
            members = bright[owner[bright] == own]
            positions = texels.positions[members].astype(np.float64)
            for group in _groups(positions):
                points = positions[group]
                middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
                radius = float(np.linalg.norm(points - middle, axis=1).max()) + 0.01
                power = float(emission[members[group]].mean()) * radius * radius
                if radius <= LARGEST_M:
                    found.append((power, [*middle, radius]))
    found.sort(key=lambda one: -one[0])
    chosen = [ball for power, ball in found if power >= LEAST_SHARE * found[0][0]]
    return np.array(chosen[:MOST_EMITTERS], np.float32).reshape(-1, 4)


def without_nested(emitters: Floats) -> Floats:
    """Return (E, 4) float32: emitters without those that lie in a larger one, or nearly so.

    One cone does for a bulb and its shade, as long as few rays are cast into it.
    """
    kept: list[Floats] = []
    for ball in emitters[np.argsort(-emitters[:, 3], kind="stable")]:
        within = (np.linalg.norm(one[:3] - ball[:3]) + NESTED * ball[3] <= one[3] for one in kept)
        if not any(within):
            kept.append(ball)
    return np.array(kept, np.float32).reshape(-1, 4)


def _groups(positions: NDArray[np.float64]) -> list[NDArray[np.intp]]:
    """Return which points lie near each other: the bulbs of a chandelier are a group each."""
    # Whose light is read from disk needs none of it.
    from scipy.ndimage import label

    cells = np.floor((positions - positions.min(axis=0)) / GROUP_M).astype(np.intp)
    if cells.max() >= MOST_CELLS:
        return [np.arange(len(positions))]
    filled = np.zeros(cells.max(axis=0) + 1, bool)
    filled[tuple(cells.T)] = True
    numbers, count = label(filled, np.ones((3, 3, 3)))
    of_point = numbers[tuple(cells.T)]
    return [np.flatnonzero(of_point == number) for number in range(1, count + 1)]


def _close_to_lamps(lights: Sequence[Light], texels: Texels, albedo: Floats) -> list[Floats]:
    """Return what texels close to lamps send back of their light, as if they faced it.

    Lamps are balls, which may shine on what their middle lies behind: a stem through them.

    Parameters
    ----------
    albedo : (N, 3) float32

    Returns
    -------
    sent : list of (N, 3) float32
        For 1 W/sr: one of each level for each point and spot light, 0 of texels beyond it.
    """
    found = []
    for light in lights:
        if light.type not in LAMP_TYPES:
            continue
        square = squared_distances(light, texels.positions)
        square = np.maximum(square, np.float32(NEAREST_M**2))
        sent = albedo / square[:, None]
        usual = float(np.median(square))
        found += [np.where((times * square < usual)[:, None], sent, 0) for times in LEVELS]
    return found
