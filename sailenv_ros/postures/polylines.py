"""Lines with corners, by the way along them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["Polyline"]

Doubles = NDArray[np.float64]

_SAMPLE_M = 0.02

_WINDOW_M = 0.3
"""How far before and behind a place the direction there is looked for [m]."""


class Polyline:
    """Straight lines from corner to corner.

    Parameters
    ----------
    corners : (N, 2) float64
        [m].
    """

    def __init__(self, corners: Doubles) -> None:
        self._corners = corners
        self._ways = np.concatenate(
            [[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))]
        )

    @property
    def length_m(self) -> float:
        """Length of it [m]."""
        return float(self._ways[-1])

    def at(self, ways_m: Doubles) -> Doubles:
        """Return (M, 2): the places after (M,) ways [m]."""
        return np.column_stack(
            [np.interp(ways_m, self._ways, column) for column in self._corners.T]
        )

    def headings(self, ways_m: Doubles) -> Doubles:
        """Return (M,): the directions there, smoothed [rad]; they do not leap by a turn."""
        ways = self.at(ways_m + _WINDOW_M) - self.at(ways_m - _WINDOW_M)
        return np.unwrap(np.arctan2(ways[:, 1], ways[:, 0]))

    def stops(self, step_m: float, turn_rad: float) -> Doubles:
        """Return (M,) ascending ways, the last one the length: one stop after each step.

        Steps are the shorter the more it turns there, so that few cut corners.

        Parameters
        ----------
        step_m : float
            Longest step [m].
        turn_rad : float
            Turn of as much effort as that [rad].
        """
        ways = np.linspace(0.0, self.length_m, max(2, math.ceil(self.length_m / _SAMPLE_M) + 1))
        turns = np.abs(np.diff(self.headings(ways)))
        efforts = np.concatenate([[0.0], np.cumsum(np.diff(ways) / step_m + turns / turn_rad)])
        count = max(1, math.ceil(efforts[-1] - 1e-9))
        return np.interp(np.linspace(0.0, efforts[-1], count + 1)[1:], efforts, ways)
