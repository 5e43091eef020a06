"""The requests about motion: behaviours that come and go, movers that are driven.

Part of `SimulationCore`; each method does all of it or raises and leaves everything as it was.
Knows no thread and no renderer.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.mover import Controller, MoverCommand
from sailenv_ros.world.world import World

__all__ = ["MotionRequests"]

MAX_WAYPOINTS = 1000
MAX_TIME_S = 1e6


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

    def set_waypoints(
        self,
        waypoints: Sequence[Pose],
        *,
        mover: str = "",
        append: bool = False,
        total_time_s: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Give a mover another track, or a longer one; without waypoints it stays where it is."""
        found = self._world.mover(mover)
        poses = _checked_waypoints(waypoints)
        poses = (*found.waypoints, *poses) if append else poses
        if len(poses) > MAX_WAYPOINTS:
            accepted = f"at most {MAX_WAYPOINTS}"
            raise InvalidRequest("number of waypoints", len(poses), accepted)
        found.lead(
            poses,
            total_time_s=found.total_time_s
            if total_time_s is None
            else _checked_time(total_time_s),
            loop=found.loop if loop is None else bool(loop),
            time_ns=self._world.sim_time_ns,
        )
        self._announce()

    def mover_pose(self, mover: str = "") -> Pose:
        """Say where a mover is; the empty name means the scene's first."""
        return self._world.mover(mover).pose_at(self._world.sim_time_ns)

    def _confines(self, agent: str, distance_m: float) -> NDArray[np.float64]:
        """Give the planes of an agent's view; none while there is no such agent."""
        for record in self._agents:
            if record.spec.name == agent:
                return view_planes(self._agents.camera(record, self._world), distance_m)
        return np.zeros((0, 4))

    # -- of the simulation -----------------------------------------------------------------

    def _announce(self) -> None:
        raise NotImplementedError


def _checked_waypoints(waypoints: object) -> tuple[Pose, ...]:
    if not isinstance(waypoints, Sequence) or not all(isinstance(p, Pose) for p in waypoints):
        raise InvalidRequest("waypoints", waypoints, "a list of sailenv_ros.geometry.Pose")
    return tuple(waypoints)


def _checked_time(total_time_s: object) -> float:
    is_number = isinstance(total_time_s, int | float) and not isinstance(total_time_s, bool)
    if not is_number or not 0.0 < total_time_s <= MAX_TIME_S:  # type: ignore[operator]  # a number
        accepted = f"a number above 0 and at most {MAX_TIME_S:g} [s]"
        raise InvalidRequest("total_time_s", total_time_s, accepted)
    return float(total_time_s)  # type: ignore[arg-type]  # as above
