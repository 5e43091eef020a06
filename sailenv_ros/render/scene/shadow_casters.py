"""Bodies that cast into a shadow map, and the box along the light that encloses them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.snapshot import DrawnInstance, SceneContents

__all__ = ["CasterBoxes", "casts"]

LARGEST_SHEET_M = 12.0
LARGEST_CASTER_M = 40.0
"""Bodies with a longer diagonal (sheets without thickness: grounds; and still larger solids)
receive shadows and cast none: they would stretch the shadow map to their own size."""

FARTHEST_M = 1e5

BOUNDS_STEP_M = 0.125
"""Bounds of the map are multiples of this [m]: things that move in a room leave the map, and so
all that was drawn into it at rest, as it is."""


def casts(drawn: DrawnInstance) -> bool:
    """Return whether a body casts a shadow: walls and ceilings of halls do, grounds do not."""
    return bool(_casting([drawn], _boxes([drawn]))[0])


def _boxes(instances: Sequence[DrawnInstance]) -> NDArray[np.float64]:
    """Return (N, 2, 3): lowest and highest corner of each, in its own frame [m]."""
    bounds = np.array([drawn.model.bounds() for drawn in instances]).reshape(-1, 2, 3)
    scales = np.array([drawn.scale for drawn in instances], np.float64).reshape(-1, 1, 3)
    boxes: NDArray[np.float64] = bounds * scales
    return boxes


def _casting(instances: Sequence[DrawnInstance], boxes: NDArray[np.float64]) -> NDArray[np.bool_]:
    extents = boxes[:, 1] - boxes[:, 0]
    largest = np.where(extents.min(axis=1) < 1e-3, LARGEST_SHEET_M, LARGEST_CASTER_M)
    outside = np.array([drawn.outside is not None for drawn in instances], bool)
    casting: NDArray[np.bool_] = (np.linalg.norm(extents, axis=1) <= largest) & ~outside
    return casting


class CasterBoxes:
    """Boxes around the instances of the contents seen last, in their own frames."""

    def __init__(self) -> None:
        self._instances: tuple[DrawnInstance, ...] | None = None
        self._middles = self._halves = np.zeros((0, 3))
        self._casting = np.zeros(0, bool)

    def bounds(
        self,
        contents: SceneContents,
        light_from_body: NDArray[np.float64],
        framed: NDArray[np.bool_],
        *,
        still: bool,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the lowest and highest corner of what is framed and casts, in steps.

        Parameters
        ----------
        light_from_body : (N, 4, 4) float64
            Poses of all instances along the light's axes [m].
        framed : (N,) bool
        still : bool
            False if instances may turn: then spheres are enclosed, which turn within these bounds.
        """
        self._know(contents)
        counts = framed & self._casting
        turned, halves = light_from_body[counts, :3, :3], self._halves[counts]
        centres = _turned(turned, self._middles[counts]) + light_from_body[counts, :3, 3]
        if still:
            reach = _turned(np.abs(turned), halves)
        else:
            reach = np.linalg.norm(halves, axis=1, keepdims=True)
        # What has been flung out of the world must not take the map along.
        near = (np.abs(centres) <= FARTHEST_M).all(axis=1)
        if not near.any():
            return np.full(3, -5.0), np.full(3, 5.0)
        low, high = (centres - reach)[near].min(axis=0), (centres + reach)[near].max(axis=0)
        # What receives the shadow may lie behind the last caster.
        high[2] += 6.0
        step = BOUNDS_STEP_M
        return np.floor(low / step) * step, np.ceil(high / step) * step

    def _know(self, contents: SceneContents) -> None:
        if self._instances is contents.instances:
            return
        self._instances = contents.instances
        boxes = _boxes(contents.instances)
        self._middles = boxes.mean(axis=1)
        self._halves = 0.5 * (boxes[:, 1] - boxes[:, 0])
        self._casting = _casting(contents.instances, boxes)


def _turned(turn: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (K, 3): each vector turned by its own (3, 3)."""
    return (turn @ vectors[:, :, None])[:, :, 0]
