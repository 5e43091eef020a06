"""The requests about motion: behaviours that come and go, movers that are driven.

Part of `SimulationCore`; each method does all of it or raises and leaves everything as it was.
Knows no thread and no renderer.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.mover import Controller, MoverCommand
from sailenv_ros.world.world import World

__all__ = ["MotionRequests"]


class MotionRequests:
    """What clients may ask of what moves; `SimulationCore` has the world and the agents."""

    _agents: AgentTable
    _world: World
    _seed: int

    def attach_behaviour(
        self, obj: int | str, type_: str, parameters: Mapping[str, Any] | None = None
    ) -> None:
        """Let an object, named by id or name, move of itself in one more way, from now on."""
        world = self._world
        given: object = {} if parameters is None else parameters
        if not isinstance(given, Mapping) or not isinstance(type_, str):
            accepted = "a type, and a mapping of its parameters"
            raise InvalidRequest("behaviour", (type_, given), accepted)
        body = world.body(world.find(obj))
        running = start_behaviour(
            type_,
            given,
            seed=self._seed,
            object_name=body.placement.name,
            place=len(body.behaviours),
            start_s=world.step_count / STEPS_PER_SECOND,
        )
        body.attach(running)
        self._announce()

    def detach_behaviours(self, obj: int | str) -> None:
        """End everything that makes an object move of itself; its speed remains."""
        body = self._world.body(self._world.find(obj))
        if body.behaviours:
            body.detach()
            self._announce()

    def set_mover_controller(self, mover: str, controller: Controller) -> None:
        """Choose what drives a mover; the empty name means the scene's first."""
        found = self._world.mover(mover)
        before = found.controller
        found.control(controller, self._world.sim_time_ns)
        if found.controller != before:
            self._announce()

    def drive_mover(
        self,
        mover: str = "",
        *,
        linear_m_s: ArrayLike = (0.0, 0.0, 0.0),
        angular_rad_s: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Have a mover walk for half a simulated second, unless another command comes."""
        command: Any = {"linear_m_s": linear_m_s, "angular_rad_s": angular_rad_s}
        self._world.drive(mover, MoverCommand(**command))

    def turn_mover(self, mover: str = "", *, pitch_rad: float = 0.0, yaw_rad: float = 0.0) -> None:
        """Turn a mover at once, as a hand on a mouse does; what it walks by goes on."""
        self._world.mover(mover).turn(pitch_rad, yaw_rad)

    def _confines(self, agent: str, distance_m: float) -> NDArray[np.float64]:
        """Give the planes of an agent's view; none while there is no such agent."""
        for record in self._agents:
            if record.spec.name == agent:
                return view_planes(self._agents.camera(record, self._world), distance_m)
        return np.zeros((0, 4))

    # -- of the simulation -----------------------------------------------------------------

    def _announce(self) -> None:
        raise NotImplementedError
