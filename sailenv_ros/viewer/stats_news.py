"""News of how fast the simulation runs, and of what can be undone, which is told at once.

One for all clients, in the viewer's event loop.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer.edit_history import EditHistory
from sailenv_ros.viewer.messages import StatsMessage

__all__ = ["STATS_S", "StatsNews"]

STATS_S = 0.5
"""Time between two reports of how fast the simulation runs [s]."""


class StatsNews:
    """Says how fast simulated time runs, and what can be undone.

    Parameters
    ----------
    simulation : Simulation
    history : EditHistory
    tell : callable
        Sends a message to all clients; their number is its `viewers`.
    viewers : callable
        Gives that number.
    time_stands : callable
        Called at each report while simulated time stands still.
    capturing : callable
        Gives how far a data set is that is captured, in words; empty for none.
    """

    def __init__(
        self,
        simulation: Simulation,
        history: EditHistory,
        *,
        tell: Callable[[StatsMessage], None],
        viewers: Callable[[], int],
        time_stands: Callable[[], None],
        capturing: Callable[[], str],
    ) -> None:
        self._simulation = simulation
        self._history = history
        self._tell = tell
        self._viewers = viewers
        self._time_stands = time_stands
        self._capturing = capturing
        self._real_time_factor = 0.0
        self._told = ("", "")

    async def run(self) -> None:
        """Tell again and again, until this is cancelled."""
        before = (time.monotonic(), self._simulation.sim_time_ns)
        while True:
            await asyncio.sleep(STATS_S)
            now = (time.monotonic(), self._simulation.sim_time_ns)
            self._real_time_factor = max(0.0, (now[1] - before[1]) * 1e-9 / (now[0] - before[0]))
            if now[1] == before[1]:
                self._time_stands()
            before = now
            self._send()

    def history_changed(self) -> None:
        """Tell at once what can be undone, if that is something else now."""
        if (self._history.undo_what, self._history.redo_what) != self._told:
            self._send()

    def _send(self) -> None:
        self._history.forget_other_scenes(self._simulation.info.epoch)
        self._told = (self._history.undo_what, self._history.redo_what)
        self._tell(
            {
                "type": "stats",
                "time_s": self._simulation.sim_time_ns * 1e-9,
                "real_time_factor": self._real_time_factor,
                "skipped_frames": self._simulation.skipped_frames,
                "viewers": self._viewers(),
                "building": self._simulation.background_task,
                "capturing": self._capturing(),
                "undo": self._told[0],
                "redo": self._told[1],
            }
        )
