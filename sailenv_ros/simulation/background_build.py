"""Background builds beside a running simulation, which shows the results once they exist.

Runs commands one after the other as child processes of lower priority, `sailenv setup` among them;
ends them with the simulator.
"""

from __future__ import annotations

import logging
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sailenv_ros.errors import SimulationClosed
from sailenv_ros.simulation.simulation import Simulation

__all__ = ["READY", "BackgroundBuild", "BuildStep", "furnishing"]

_log = logging.getLogger(__name__)

READY = "ready: "
"""Begins a line of `sailenv setup` that says what has been built."""

_NICENESS = 10
"""Niceness of a build, so that the simulation goes first."""

_CLOSE_TIMEOUT_S = 5.0

# Not a session of its own where it can be avoided: Linux shares the processor between sessions
# evenly, whatever the priority of what runs in them.
_OWN_GROUP: dict[str, Any] = (
    {"process_group": 0} if sys.version_info >= (3, 11) else {"start_new_session": True}
)


@dataclass(frozen=True, slots=True, kw_only=True)
class BuildStep:
    """One command that builds something.

    Attributes
    ----------
    command : tuple of str
        Says in lines what it does.
    by_hand : str
        What a user types to do the same.
    environment : mapping or None
        Its environment; None means this process's.
    done : callable
        Called in the build's thread once it has succeeded.
    """

    command: tuple[str, ...]
    by_hand: str
    environment: Mapping[str, str] | None = None
    done: Callable[[], None] = lambda: None


def furnishing(
    scene: str,
    *,
    everything: bool,
    scene_paths: Sequence[Path] = (),
    allow_modules: bool = False,
    light: bool = True,
) -> BuildStep:
    """Return the step that builds what is missing of furniture and light.

    Parameters
    ----------
    scene : str
        Name or file of the scene whose objects and light are built first.
    everything : bool
        False builds what that scene needs, True all furniture and the light of all rooms.
    scene_paths : sequence of Path
        More folders with scenes.
    allow_modules : bool
        True lets scene files have behaviours of Python modules.
    light : bool
        False bakes none: it would not be shown.
    """
    command = [sys.executable, "-m", "sailenv_ros.cli.main", "setup"]
    command += ["--scene", scene, "--parent", str(os.getpid())]
    if not everything:
        command.append("--only")
    for path in scene_paths:
        command += ["--scenes", str(path)]
    if allow_modules:
        command.append("--allow-modules")
    if not light:
        command += ["--light", "plain"]
    return BuildStep(command=tuple(command), by_hand="sailenv setup")


class BackgroundBuild:
    """Builds one thing after the other; a context manager.

    Parameters
    ----------
    simulation : Simulation
        Tells how far it is, and takes up furniture and light that were built.
    steps : sequence of BuildStep
        In this order. One that fails is reported, and the next one begins.
    """

    def __init__(self, simulation: Simulation, steps: Sequence[BuildStep]) -> None:
        self._simulation = simulation
        self._lock = threading.Lock()
        self._closing = threading.Event()
        self._process: subprocess.Popen[str] | None = None
        self._thread = threading.Thread(
            target=self._run, args=(tuple(steps),), name="background-build", daemon=True
        )
        self._thread.start()

    @property
    def running(self) -> bool:
        """True until all is built, or the build has failed."""
        return self._thread.is_alive()

    def close(self) -> None:
        """Stop what is being built; what is complete stays."""
        with self._lock:
            self._closing.set()
            if self._process is not None and self._process.poll() is None:
                # With all that it has started itself.
                os.killpg(self._process.pid, signal.SIGTERM)
        self._thread.join(_CLOSE_TIMEOUT_S)

    def __enter__(self) -> BackgroundBuild:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _run(self, steps: Sequence[BuildStep]) -> None:
        for step in steps:
            self._build(step)
        self._simulation.background_task = ""

    def _build(self, step: BuildStep) -> None:
        with self._lock:
            if self._closing.is_set():
                return
            # The kernel ends the child with the thread that started it, which is this one.
            process = self._process = subprocess.Popen(
                [*_standing_back(), *step.command],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                env=step.environment,
                **_OWN_GROUP,
            )
        assert process.stdout is not None
        with process, process.stdout as lines:
            for line in lines:
                self._report(line.strip())
        if self._closing.is_set():
            return
        if process.returncode:
            _log.warning(
                "building in the background ended with status %d; to do it by hand: %s",
                process.returncode,
                step.by_hand,
            )
        else:
            step.done()

    def _report(self, line: str) -> None:
        if line:
            _log.info("in the background: %s", line)
            self._simulation.background_task = line
        if line.startswith(READY):
            try:
                self._simulation.refresh()
            except SimulationClosed:
                self._closing.set()


def _standing_back() -> list[str]:
    """Return what begins a command that ends with this thread and stands back behind others."""
    found = []
    if shutil.which("setpriv"):
        found += ["setpriv", "--pdeathsig", "TERM"]
    if shutil.which("nice"):
        found += ["nice", "-n", str(_NICENESS)]
    return found
