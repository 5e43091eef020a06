"""Distances between bodies that are near each other, as physics finds them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from sailenv_ros.world.bodies import Body
from sailenv_ros.world.world import World

__all__ = ["BodyGap", "gaps"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BodyGap:
    """The shortest distance between two bodies.

    Attributes
    ----------
    first, second : int
        Instance ids.
    gap_m : float
        Below 0 where they overlap [m].
    rise : float
        z component of the unit vector there from the second to the first.
    """

    first: int
    second: int
    gap_m: float
    rise: float


def gaps(world: World, within_m: float, skipped: Callable[[Body, Body], bool]) -> Iterator[BodyGap]:
    """Yield the pairs of bodies that are nearer to each other than a distance, static ones too.

    Parameters
    ----------
    world : World
    within_m : float
        At least 0 [m].
    skipped : callable
        Whether a pair is left out.
    """
    client = world.client
    bodies = [
        (id_, body, client.getAABB(body.bullet_id, body.link))
        for id_, body in world.numbered_bodies
        if body.collides
    ]
    for (first, a, box_a), (second, b, box_b) in itertools.combinations(bodies, 2):
        apart = np.maximum(box_a[0], box_b[0]) - np.minimum(box_a[1], box_b[1])
        if (apart > within_m).any() or skipped(a, b):
            continue
        points = client.getClosestPoints(
            a.bullet_id, b.bullet_id, within_m, linkIndexA=a.link, linkIndexB=b.link
        )
        if points:
            nearest = min(points, key=lambda point: float(point[8]))
            yield BodyGap(
                first=first, second=second, gap_m=float(nearest[8]), rise=float(nearest[7][2])
            )
