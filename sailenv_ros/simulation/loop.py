"""The thread that owns a simulation: requests between physics steps, time by the wall clock.

Everything of PyBullet and OpenGL happens here; what other threads ask for is queued and done in
the order it came.
"""

from __future__ import annotations

import collections
import logging
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

from sailenv_ros.errors import DeadlineExceeded, SimulationClosed
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.pacing import Pacer
from sailenv_ros.system.futures import wait_for
from sailenv_ros.system.own_process import OwnProcess
from sailenv_ros.world.world import World

__all__ = ["SimulationLoop"]

_log = logging.getLogger(__name__)

TICK_STEPS = 2
"""Steps between two looks at the clock while no frame is due (120 per simulated second)."""

_DRAW_TIMEOUT_S = 60.0
_CLOSE_TIMEOUT_S = 10.0
_START_TIMEOUT_S = 120.0

T = TypeVar("T")


class SimulationLoop:
    """Runs one core in a thread of its own.

    Attributes
    ----------
    core : SimulationCore or None
        None until it has begun.
    closing : bool
        True once it has ended or is ending.
    ended : str
        Why it has ended; empty while it runs.
    process : OwnProcess
        Where its thread is.
    """

    def __init__(self) -> None:
        self.core: SimulationCore | None = None
        self.closing = False
        self.ended = ""
        self.process = OwnProcess("Simulation")
        self._wake = threading.Condition()
        self._queue: collections.deque[tuple[Future[Any], Callable[[SimulationCore], Any]]] = (
            collections.deque()
        )
        self._pacer = Pacer(1.0)
        self._thread: threading.Thread | None = None

    def start(
        self,
        make_core: Callable[[], SimulationCore],
        on_start: Callable[[SimulationCore], None],
    ) -> None:
        """Begin; return once it runs, or raise why it does not.

        Parameters
        ----------
        make_core : callable
            Called in the thread.
        on_start : callable
            Called there too, before anything is served.
        """
        started: Future[None] = Future()
        self._thread = threading.Thread(
            target=self._run,
            args=(make_core, on_start, started),
            name="sailenv-simulation",
            daemon=True,
        )
        self._thread.start()
        wait_for(started, "the simulation to start", _START_TIMEOUT_S)

    @property
    def is_mine(self) -> bool:
        """True in the loop's own thread."""
        return threading.current_thread() is self._thread

    def submit(self, call: Callable[[SimulationCore], T]) -> Future[T]:
        """Queue something to be done with the core.

        Raises
        ------
        SimulationClosed
            If the simulation has ended, or is another process's.
        """
        self.process.require()
        future: Future[T] = Future()
        with self._wake:
            if self.closing:
                raise SimulationClosed(self.ended or "it was closed")
            self._queue.append((future, call))
            self._wake.notify_all()
        return future

    def nudge(self) -> None:
        """Have the loop look what is to be done."""
        with self._wake:
            self._wake.notify_all()

    def close(self) -> None:
        """Interrupt what runs and wait for the thread, unless this is called in it."""
        self.closing = True
        self.nudge()
        if self._thread is not None and not self.is_mine:
            self._thread.join(_CLOSE_TIMEOUT_S)
            if self._thread.is_alive():
                raise DeadlineExceeded("the simulation's thread to end", _CLOSE_TIMEOUT_S)

    # -- in the thread ---------------------------------------------------------------------

    def _run(
        self,
        make_core: Callable[[], SimulationCore],
        on_start: Callable[[SimulationCore], None],
        started: Future[None],
    ) -> None:
        try:
            core = make_core()
        except BaseException as error:
            self.closing = True
            self.ended = str(error)
            started.set_exception(error)
            return
        self.core = core
        core.frames.run_later = self._run_here
        on_start(core)
        why = "it was closed"
        self._pacer.restart(core.world.step_count, factor=core.clock.real_time_factor)
        started.set_result(None)
        try:
            while not self.closing:
                self._serve(core)
                self._advance(core)
                self._rest(core)
        except Exception as error:
            why = f"{type(error).__name__}: {error}"
            _log.exception("the simulation ends because of an internal error")
        finally:
            self._end(core, why)

    def _serve(self, core: SimulationCore) -> None:
        """Execute the requests that are queued now."""
        while self._queue and not self.closing:
            future, call = self._queue.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            before = _pace(core)
            try:
                result = call(core)
            except Exception as error:
                future.set_exception(error)
            else:
                future.set_result(result)
            if _pace(core) != before:
                self._pacer.restart(core.world.step_count, factor=core.clock.real_time_factor)

    def _advance(self, core: SimulationCore) -> None:
        if core.clock.runs_by_itself:
            target = self._pacer.target(core.world.step_count)
            if target > core.world.step_count:
                core.advance_to(target, every_frame=False)
        else:
            core.streams.render_due()

    def _rest(self, core: SimulationCore) -> None:
        """Wait until there is something to do."""
        with self._wake:
            if self._queue or self.closing:
                return
            if not core.clock.runs_by_itself:
                self._wake.wait()
                return
            due = core.streams.next_due_step()
            goal = core.world.step_count + TICK_STEPS
            self._wake.wait(self._pacer.wait_s(goal if due is None else min(goal, due)))

    def _end(self, core: SimulationCore, why: str) -> None:
        with self._wake:
            self.closing = True
            self.ended = why
            waiting = list(self._queue)
            self._queue.clear()
        for future, _ in waiting:
            if future.set_running_or_notify_cancel():
                future.set_exception(SimulationClosed(why))
        core.close(why)

    def _run_here(self, call: Callable[[], T]) -> T:
        """Run a function in the loop's thread and return its result."""
        if self.is_mine:
            return call()
        future = self.submit(lambda core: call())
        return wait_for(future, "objects to be drawn alone", _DRAW_TIMEOUT_S)


def _pace(core: SimulationCore) -> tuple[World, bool, float]:
    """Return what time's pace depends on: when it changes, the clock begins again."""
    return core.world, core.clock.runs_by_itself, core.clock.real_time_factor
