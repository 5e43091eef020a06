"""Pacing of simulated time by the wall clock; the only place that reads it for that."""

from __future__ import annotations

import time
from collections.abc import Callable

from sailenv_ros.world.bullet import STEPS_PER_SECOND

__all__ = ["Pacer"]

MAX_LAG_S = 0.25
"""Wall time that the simulation tries to catch up; what lies further back is given up."""


class Pacer:
    """Computes which step simulated time should have reached.

    Parameters
    ----------
    factor : float
        Simulated seconds per wall second.
    clock : callable
        Wall clock [s].
    """

    def __init__(self, factor: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._steps_per_s = STEPS_PER_SECOND * factor
        self._clock = clock
        self._wall_s = clock()
        self._step = 0
        self.lost_s = 0.0

    def restart(self, step: int, *, factor: float | None = None) -> None:
        """Begin again: that step is now, with another factor if one is given."""
        if factor is not None:
            self._steps_per_s = STEPS_PER_SECOND * factor
        self._wall_s = self._clock()
        self._step = step

    def target(self, step: int) -> int:
        """Return the step that should have been reached; gives up what lies too far back.

        Parameters
        ----------
        step : int
            The step that has been reached.
        """
        now = self._clock()
        # A hair more than measured: 0.1 s are 24 steps, not 23.999.
        target = self._step + int((now - self._wall_s) * self._steps_per_s + 1e-6)
        lag_s = (target - step) / self._steps_per_s
        if lag_s > MAX_LAG_S:
            # Frames that take longer than this still find a world that has moved.
            self.lost_s += lag_s - MAX_LAG_S
            self._wall_s, self._step = now - MAX_LAG_S, step
            return step + int(MAX_LAG_S * self._steps_per_s)
        return target

    def wait_s(self, step: int) -> float:
        """Return the wall time until a step is due [s]; 0 if it is."""
        due = self._wall_s + (step - self._step) / self._steps_per_s
        return max(0.0, due - self._clock())
