"""The debug agent: a camera of the web viewer's own that follows the mover while somebody watches.

Blocking requests to a `Simulation`, from any thread but the simulation's.
"""

from __future__ import annotations

import contextlib
import threading
import weakref

from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = ["NAME", "DebugAgent"]

NAME = "debug_agent"

RATE_HZ = 30.0


class _Watchers:
    """Number of clients that watch the debug agent of a simulation, in all its viewers."""

    def __init__(self) -> None:
        self.guard = threading.Lock()
        self.count = 0


_watchers: weakref.WeakKeyDictionary[Simulation, _Watchers] = weakref.WeakKeyDictionary()


class DebugAgent:
    """Comes with the first who watches it and goes with the last; viewers of a simulation share it.

    Parameters
    ----------
    simulation : Simulation
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._watchers = _watchers.setdefault(simulation, _Watchers())
        self._intrinsics = CameraIntrinsics()
        self._picture = PictureSettings()

    @property
    def intrinsics(self) -> CameraIntrinsics:
        """Intrinsics of its camera."""
        return self._intrinsics

    def begin(self) -> None:
        """Count one more who watches; register the agent if there is none.

        Raises
        ------
        InvalidRequest
            If there are too many agents.
        """
        with self._watchers.guard:
            if all(spec.name != NAME for spec in self._simulation.info.agents):
                spec = AgentSpec(
                    name=NAME,
                    intrinsics=self._intrinsics,
                    rate_hz=RATE_HZ,
                    picture=self._picture,
                )
                self._simulation.register_agent(spec)
            self._watchers.count += 1

    def end(self) -> None:
        """Count one less; remove the agent with the last."""
        with self._watchers.guard:
            self._watchers.count -= 1
            if self._watchers.count:
                return
            # Whoever watches next finds the picture as it was left.
            for spec in self._simulation.info.agents:
                if spec.name == NAME:
                    self._picture = spec.picture
            # The simulation may have ended, or another client may have deleted it.
            with contextlib.suppress(SailenvError):
                self._simulation.delete_agent(NAME)

    def set_intrinsics(self, intrinsics: CameraIntrinsics) -> None:
        """Change its lens or size, for all who watch it."""
        with self._watchers.guard:
            self._intrinsics = intrinsics
            if self._watchers.count:
                self._simulation.set_intrinsics(intrinsics, agent=NAME)
