"""Announcements of a simulation: kept as it was last, and told to listeners."""

from __future__ import annotations

from collections.abc import Callable

from sailenv_ros.errors import InvalidState
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.listeners import Listeners
from sailenv_ros.simulation.loop import SimulationLoop
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.space import FreeSpace
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.joints import JointState
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["ListenedSimulation"]


class ListenedSimulation(Operations):
    """The part of `Simulation` that listens to its loop; its methods never block.

    Parameters
    ----------
    loop : SimulationLoop
        Not begun yet; `_listen` is what it calls as it begins.
    """

    def __init__(self, loop: SimulationLoop) -> None:
        self._loop = loop
        self._info: SceneInfo | None = None
        self._sim_time_ns = 0
        self._info_listeners = Listeners[SceneInfo]()
        self._step_listeners = Listeners[int]()
        self._map_listeners = Listeners[FreeSpace]()

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last; never blocks."""
        assert self._info is not None
        return self._info

    @property
    def sim_time_ns(self) -> int:
        """Simulated time as of the last step [ns]; never blocks."""
        return self._sim_time_ns

    def on_info(self, listener: Callable[[SceneInfo], None]) -> Callable[[], None]:
        """Have a quick function called, now and at every change; gives the one that ends it.

        Changes are told from the loop thread, before any frame that depends on them.
        """
        end = self._info_listeners.add(listener)
        listener(self.info)
        return end

    def on_step(self, listener: Callable[[int], None]) -> Callable[[], None]:
        """Have a quick function called with the simulated time [ns] after physics advanced."""
        return self._step_listeners.add(listener)

    def on_free_space(self, listener: Callable[[FreeSpace], None]) -> Callable[[], None]:
        """Have a quick function called with each map that `free_space` makes."""
        return self._map_listeners.add(listener)

    def contacts_of_steps(self, seconds: float) -> tuple[Contact, ...]:
        """Return what touched what in the last time [s]; for listeners of `on_step` alone.

        Raises
        ------
        InvalidState
            If it is called from another thread than theirs, which has the operation `contacts`.
        """
        if self._loop.core is None or not self._loop.is_mine:
            raise InvalidState("this is for listeners of on_step; others call contacts(seconds)")
        return self._loop.core.world.contacts(seconds)

    def core_now(self) -> SimulationCore:
        """Return the simulation's core, to be read; for listeners of `on_step` alone.

        Raises
        ------
        InvalidState
            If it is called from another thread than theirs, which has operations.
        """
        if self._loop.core is None or not self._loop.is_mine:
            raise InvalidState("this is for listeners of on_step; others call operations")
        return self._loop.core

    def joints_now(self) -> tuple[JointState, ...]:
        """Return the states of all joints; for listeners of `on_step` alone.

        Raises
        ------
        InvalidState
            If it is called from another thread than theirs, which has the operation `get_joints`.
        """
        if self._loop.core is None or not self._loop.is_mine:
            raise InvalidState("this is for listeners of on_step; others call get_joints()")
        return self._loop.core.world.joints()

    def _listen(self, core: SimulationCore) -> None:
        core.on_info, core.on_step = self._take_info, self._take_step
        core.on_free_space = self._map_listeners
        self._take_info(core.info)

    def _take_info(self, info: SceneInfo) -> None:
        self._info = info
        self._info_listeners(info)

    def _take_step(self, sim_time_ns: int) -> None:
        self._sim_time_ns = sim_time_ns
        self._step_listeners(sim_time_ns)
