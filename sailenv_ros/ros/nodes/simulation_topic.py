"""A topic that follows the simulation's steps, and is quiet once it has ended.

Called from the simulation's loop thread, as `announcements` is.
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable

from sailenv_ros.simulation import Simulation

__all__ = ["SimulationTopic"]


class SimulationTopic(ABC):
    """Follows a simulation between `begin` and `end`; a subclass says what is published."""

    def __init__(self) -> None:
        self._publishing = threading.Lock()
        self._ended = False
        self._stops: list[Callable[[], None]] = []

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on."""
        self._stops.append(simulation.on_step(lambda now_ns: self._follow(simulation, now_ns)))

    def end(self) -> None:
        """Stop following; nothing is published after this returns."""
        with self._publishing:
            self._ended = True
        for stop in self._stops:
            stop()

    def _follow(self, simulation: Simulation, now_ns: int) -> None:
        with self._publishing:
            if not self._ended:
                self._publish(simulation, now_ns)

    @abstractmethod
    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        """Publish what there is to say at this simulated time [ns]; one call at a time."""
