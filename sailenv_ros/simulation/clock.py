"""Relation of simulated time to the wall clock: mode, speed, pause. Knows no thread."""

from __future__ import annotations

from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.types.scene_info import REAL_TIME_FACTOR, TimeMode
from sailenv_ros.types.validation import checked_flag

__all__ = ["Clock"]

_MODES = ("realtime", "lockstep")


class Clock:
    """The pace of one simulation.

    Parameters
    ----------
    mode : {'realtime', 'lockstep'}
    real_time_factor : float
        Simulated seconds per wall second that are aimed at, 0.1 to 10.
    paused : bool

    Raises
    ------
    UnknownName, InvalidRequest
        If a parameter cannot be accepted.
    """

    def __init__(self, mode: TimeMode, real_time_factor: float, *, paused: bool) -> None:
        if mode not in _MODES:
            raise UnknownName("mode", str(mode), _MODES)
        self.mode: TimeMode = mode
        self.paused = checked_flag("paused", paused)
        self.set_real_time_factor(real_time_factor)

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per wall second that are aimed at."""
        return self._real_time_factor

    @property
    def runs_by_itself(self) -> bool:
        """True if simulated time follows the wall clock now."""
        return self.mode == "realtime" and not self.paused

    def set_paused(self, paused: bool) -> bool:
        """Stop simulated time, or let it run again; return whether that changed anything.

        Raises
        ------
        InvalidState
            In lockstep mode.
        """
        if self.mode == "lockstep":
            what = "paused" if paused else "resumed"
            raise InvalidState(
                f"a lockstep simulation cannot be {what}: it moves by step alone; "
                "in mode realtime it runs by itself"
            )
        changed = paused != self.paused
        self.paused = paused
        return changed

    def set_real_time_factor(self, factor: float) -> None:
        """Change the speed of simulated time."""
        self._real_time_factor = REAL_TIME_FACTOR.number("real_time_factor", factor)
