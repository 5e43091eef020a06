"""Hollows: boxes along the axes that are divided into rows and columns."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sailenv_content.families.shaping import Floats

__all__ = ["Box"]


class Box:
    """A hollow with sides along the axes: lowest and highest corner [m]."""

    def __init__(self, low: Iterable[float], high: Iterable[float]) -> None:
        self.low, self.high = np.array(list(low), np.float64), np.array(list(high), np.float64)

    @property
    def size(self) -> Floats:
        """Sides along x, y, z [m]."""
        return np.asarray(self.high - self.low)

    @property
    def middle(self) -> Floats:
        """[m]."""
        return np.asarray((self.high + self.low) / 2.0)

    def rows(self, heights: Iterable[float], gap: float) -> list[Box]:
        """Divide it into rows from below, of heights by share, with gaps between them [m]."""
        shares = np.array(list(heights), np.float64)
        free = self.size[2] - gap * (len(shares) - 1)
        made, z = [], float(self.low[2])
        for height in free * shares / shares.sum():
            made.append(Box((*self.low[:2], z), (*self.high[:2], z + height)))
            z += float(height) + gap
        return made

    def columns(self, widths: Iterable[float], gap: float) -> list[Box]:
        """Divide it into columns from the right, of widths by share, with gaps between them [m]."""
        shares = np.array(list(widths), np.float64)
        free = self.size[1] - gap * (len(shares) - 1)
        made, y = [], float(self.low[1])
        for width in free * shares / shares.sum():
            made.append(Box((self.low[0], y, self.low[2]), (self.high[0], y + width, self.high[2])))
            y += float(width) + gap
        return made

    def within(
        self,
        low: tuple[float, float, float] = (0.0, 0.0, 0.0),
        high: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Box:
        """Return it without margins at its lower and at its upper sides [m]."""
        return Box(self.low + np.array(low), self.high - np.array(high))

    def inset(self, by: float) -> Box:
        """Return it without a rim at its sides, its top and its bottom [m]."""
        rim = np.array([0.0, by, by])
        return Box(self.low + rim, self.high - rim)
