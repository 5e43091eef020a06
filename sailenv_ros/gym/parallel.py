"""Several agents in one room, for PettingZoo: each walks to a place of its own.

They see one another as coloured cylinders, and stop where they would touch. All act, then all look.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import NDArray
from typing_extensions import Unpack

from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.extras import need
from sailenv_ros.gym.point_nav import PointNavEnv
from sailenv_ros.gym.room import OwnObject
from sailenv_ros.gym.room_env import Arrays, Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.types.validation import Bounds

need("pettingzoo", "several agents in one room")

from pettingzoo import ParallelEnv  # noqa: E402

__all__ = ["PointNavParallelEnv"]

COUNT = Bounds(least=1, most=16, whole=True)
STEPS = Bounds(least=1, most=2**31, whole=True)

COLOURS = ("#d1352b", "#2b59c3", "#2a9d3f", "#f2b705", "#8a3ffc", "#f28c28", "#2ab7ca", "#c4813d")
TALL_M = 0.9
TRIES = 200


class _Member(PointNavEnv):
    """One of several agents in a room."""

    def __init__(self, crowd: list[_Member], count: int, settings: RoomSettings) -> None:
        self._crowd, self._count = crowd, count
        self.is_placed = False
        super().__init__(**settings)

    @property
    def place(self) -> tuple[float, float]:
        """Position of its axis in the world [m]."""
        return self._walker.x_m, self._walker.y_m

    def _own_objects(self, name: str) -> tuple[OwnObject, ...]:
        wide = 2.0 * self.body.radius_m
        return tuple(
            OwnObject(f"walker_{number}", "cylinder", (wide, wide, TALL_M), COLOURS[number % 8])
            for number in range(self._count)
        )

    def _begin(self) -> bool:
        for _ in range(TRIES):
            if not super()._begin():
                return False
            if not self._is_taken(*self.place, going=False):
                self.is_placed = True
                return True
        return False

    def _is_taken(self, x_m: float, y_m: float, *, going: bool = True) -> bool:
        for other in self._crowd:
            if other is not self and other.is_placed:
                apart = math.dist((x_m, y_m), other.place)
                nearer = not going or apart < math.dist(self.place, other.place)
                if nearer and apart < 2.0 * self.body.radius_m:
                    return True
        return False

    def _places(self) -> Mapping[int, NDArray[np.float64]]:
        poses = {}
        for number, other in enumerate(self._crowd):
            pose = np.eye(4)
            pose[:3, 3] = *other.place, self.room.space.body.floor_m + TALL_M / 2.0
            poses[self.room.rows[f"walker_{number}"]] = pose
        return poses

    def _lacking(self) -> str:
        return f"rooms with places for {self._count} agents"


class PointNavParallelEnv(ParallelEnv):  # type: ignore[misc]  # PettingZoo has no types
    """Walk to a point each; spaces, rewards and figures as of `PointNavEnv`.

    Parameters
    ----------
    agents : int
        How many, 1 to 16; they are called ``walker_0``, ``walker_1`` …
    max_cycles : int
        Steps after which an episode is cut off.
    **settings
        See `RoomEnv`.
    """

    metadata: ClassVar[dict[str, Any]] = {
        **RoomEnv.metadata,
        "name": "sailenv_point_nav_v0",
    }

    def __init__(
        self, agents: int = 2, *, max_cycles: int = 200, **settings: Unpack[RoomSettings]
    ) -> None:
        count = COUNT.integer("agents", agents)
        self._most_steps = STEPS.integer("max_cycles", max_cycles)
        self._members: list[_Member] = []
        for _ in range(count):
            self._members.append(_Member(self._members, count, settings))
        self.possible_agents = [f"walker_{number}" for number in range(count)]
        self._member_of = dict(zip(self.possible_agents, self._members, strict=True))
        self.agents: list[str] = []
        self.render_mode = self._members[0].render_mode
        self._steps = 0
        self._random = np.random.default_rng()

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return what an agent observes."""
        return self._member(agent).observation_space

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return what an agent can do."""
        return self._member(agent).action_space

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Arrays], dict[str, Info]]:
        """Begin an episode for all agents in one room; see `RoomEnv.reset`.

        Of the options ``room`` alone counts: PettingZoo lets others be passed to any environment.
        """
        if seed is not None:
            self._random = np.random.default_rng(seed)
        names = self._members[0].room_names
        room = names[int(self._random.integers(len(names)))]
        for member in self._members:
            member.is_placed = False
        for member in self._members:
            own = int(self._random.integers(2**31))
            member.begin(seed=own, options={"room": (options or {}).get("room", room)})
        self.agents, self._steps = list(self.possible_agents), 0
        seen = {agent: self._member_of[agent].observe() for agent in self.agents}
        return (
            {agent: one[0] for agent, one in seen.items()},
            {agent: one[4] for agent, one in seen.items()},
        )

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, Arrays], dict[str, float], dict[str, bool], dict[str, bool], dict[str, Info]
    ]:
        """Let all agents act, one after the other, and then look.

        Raises
        ------
        InvalidState
            If an agent has no action.
        InvalidRequest
            If an action is not in its space; nobody acts then.
        """
        missing = [agent for agent in self.agents if agent not in actions]
        if missing:
            raise InvalidState(f"no action for {', '.join(missing)}; each agent needs one")
        for agent in self.agents:
            self._member(agent).require_action(actions[agent])
        acting = self.agents
        for agent in acting:
            self._member_of[agent].act(actions[agent])
        self._steps += 1
        cut = self._steps >= self._most_steps
        seen = {agent: self._member_of[agent].observe() for agent in acting}
        self.agents = [] if cut else [agent for agent in acting if not seen[agent][2]]
        return (
            {agent: one[0] for agent, one in seen.items()},
            {agent: one[1] for agent, one in seen.items()},
            {agent: one[2] for agent, one in seen.items()},
            {agent: cut and not one[2] for agent, one in seen.items()},
            {agent: one[4] for agent, one in seen.items()},
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Return what the first agent sees; None without a `render_mode`."""
        return self._members[0].render()

    def close(self) -> None:
        """Leave the room; a second call does nothing."""
        for member in self._members:
            member.close()

    def _member(self, agent: str) -> _Member:
        if agent not in self._member_of:
            raise UnknownName("agent", str(agent), self._member_of)
        return self._member_of[agent]
