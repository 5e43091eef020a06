"""Furniture and light built beside a running simulation, which shows them once they are there.

Runs `sailenv setup` as a child process of lower priority; ends it with the simulator.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path

from sailenv_ros.errors import SimulationClosed
from sailenv_ros.simulation.simulation import Simulation

__all__ = ["READY", "BackgroundBuild"]

_log = logging.getLogger(__name__)

READY = "ready: "
"""Begins a line of `sailenv setup` that says what has been built."""

_CLOSE_TIMEOUT_S = 5.0


class BackgroundBuild:
    """Builds what is missing of furniture and light; a context manager.

    Parameters
    ----------
    simulation : Simulation
        Takes up what was built; its scene's objects and light are built first.
    scene : str
        The scene's name or file.
    everything : bool
        False builds what that scene needs, True all furniture and the light of all rooms.
    scene_paths : sequence of Path
        More folders with scenes.
    allow_modules : bool
        True lets scene files have behaviours of Python modules.
    """

    def __init__(
        self,
        simulation: Simulation,
        scene: str,
        *,
        everything: bool,
        scene_paths: Sequence[Path] = (),
        allow_modules: bool = False,
    ) -> None:
        self._simulation = simulation
        command = [sys.executable, "-m", "sailenv_ros.cli.main", "setup"]
        command += ["--scene", scene, "--parent", str(os.getpid())]
        if not everything:
            command.append("--only")
        for path in scene_paths:
            command += ["--scenes", str(path)]
        if allow_modules:
            command.append("--allow-modules")
        self._lock = threading.Lock()
        self._closing = False
        self._process: subprocess.Popen[str] | None = None
        self._thread = threading.Thread(
            target=self._run, args=(command,), name="background-build", daemon=True
        )
        self._thread.start()

    @property
    def running(self) -> bool:
        """True until all is built, or the build has failed."""
        return self._thread.is_alive()

    def close(self) -> None:
        """Break off what is being built; what is complete stays."""
        with self._lock:
            self._closing = True
            if self._process is not None:
                self._process.kill()
        self._thread.join(_CLOSE_TIMEOUT_S)

    def __enter__(self) -> BackgroundBuild:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _run(self, command: Sequence[str]) -> None:
        with self._lock:
            if self._closing:
                return
            # The kernel ends the child with the thread that started it, which is this one.
            process = self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
            )
        assert process.stdout is not None
        with process, process.stdout as lines:
            for line in lines:
                self._report(line.rstrip())
        self._simulation.background_task = ""
        if process.returncode and not self._closing:
            _log.warning(
                "building in the background ended with status %d; to do it by hand: sailenv setup",
                process.returncode,
            )

    def _report(self, line: str) -> None:
        if line:
            _log.info("in the background: %s", line)
            self._simulation.background_task = line
        if line.startswith(READY):
            try:
                self._simulation.refresh()
            except SimulationClosed:
                self._closing = True
