"""Ways of searching for `benchmarks.gym_learning`: decisions of who learns, and a script."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from benchmarks.gym_searcher import (
    AHEAD,
    DOWN,
    FOUND,
    LEAST_PX,
    LEFT,
    NEAR_M,
    RIGHT,
    SECTORS,
    STRIDE_M,
    TURN_DEG,
    UP,
    Reals,
    Searcher,
)

__all__ = ["FIRST", "MIRRORED", "TURNS", "ScriptedSearch", "Strider", "steps_of"]

TURNS, STRIDES = 12, 4

MIRRORED = (
    *(-turns % TURNS for turns in range(TURNS)),
    *(TURNS + -turns % TURNS for turns in range(TURNS)),
    *range(2 * TURNS, 2 * TURNS + 3),
)
"""Decision of a `Strider` in the mirrored world instead of each."""

FIRST = (*[0.0] * 2 * TURNS, 0.0, 0.0, -2.0)
"""How likely each is at first, as logarithms: who declares at random ends each episode at once."""


class Strider(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Decides where to walk or look, instead of each step.

    Decisions: 0 to 11 turn so often to the left (more than 6: to the right) and walk 4 strides; 13
    to 23 turn alone, and 12 is one stride; 24 up, 25 down, 26 found. One ends early where the agent
    is stopped, or when what is wanted comes into view or near.

    Attributes
    ----------
    taken : int
        Steps so far, in all episodes.
    """

    def __init__(self, agent: Searcher) -> None:
        super().__init__(agent)
        self.action_space = gymnasium.spaces.Discrete(len(MIRRORED))
        self.taken = 0
        self._agent = agent

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Carry a decision out."""
        agent, total = self._agent, 0.0
        for one in steps_of(int(action)):
            before_m = agent.goal_m
            reward, terminated, truncated, info = agent.act(one)
            self.taken += 1
            total += reward
            found = math.isinf(before_m) and math.isfinite(agent.goal_m)
            near = agent.goal_m < 0.95 * NEAR_M <= before_m
            if terminated or truncated or agent.stopped or found or near:
                break
        return agent.observed(), total, terminated, truncated, info


def steps_of(decision: int) -> list[int]:
    """Return the actions that a decision is made of."""
    if decision >= 2 * TURNS:
        return [(UP, DOWN, FOUND)[decision - 2 * TURNS]]
    left = decision % TURNS
    turns = [LEFT] * left if left <= TURNS // 2 else [RIGHT] * (TURNS - left)
    strides = STRIDES if decision < TURNS else 1 if decision == TURNS else 0
    return turns + [AHEAD] * strides


class ScriptedSearch:
    """Looks around, walks to where much is free, and looks again; goes to what is wanted.

    Where it is stopped on its way, it walks aside first.
    """

    def __init__(self, agent: Searcher) -> None:
        self._agent = agent
        self._looked, self._heading_deg, self._strides = 0, 0.0, 0
        self._random = np.random.default_rng(0)

    def __call__(self, seen: NDArray[np.float32]) -> int:
        """Return an action."""
        agent = self._agent
        if not agent.steps:
            self._looked, self._strides = 0, 0
        known = math.isfinite(agent.goal_m)
        if known and agent.goal_m < 0.95 * NEAR_M:
            return self._declare()
        if agent.stopped:
            self._looked, self._strides = 0, 0
            if known:
                self._walk_aside()
        if self._strides:
            return self._turn(self._heading_deg - agent.turns * TURN_DEG, AHEAD)
        if known:
            return self._turn(math.degrees(agent.goal_angle), AHEAD)
        if self._looked < 12:
            self._looked += 1
            return LEFT
        free_m = self._free_m()
        shares = free_m**2 / np.sum(free_m**2) if free_m.any() else None
        sector = int(self._random.choice(SECTORS, p=shares))
        self._set_out(sector, int(free_m[sector] / STRIDE_M))
        self._looked = 0
        return self._turn(self._heading_deg - agent.turns * TURN_DEG, AHEAD)

    def _free_m(self) -> Reals:
        """Return how far it is free in each direction and those beside it."""
        free_m = self._agent.free_m
        least_m: Reals = np.array([free_m, np.roll(free_m, 1), np.roll(free_m, -1)]).min(axis=0)
        return least_m

    def _set_out(self, sector: int, strides: int) -> None:
        self._heading_deg = self._agent.turns * TURN_DEG + sector * 360.0 / SECTORS
        self._strides = max(1, strides)

    def _walk_aside(self) -> None:
        off_deg = np.abs((np.arange(SECTORS) * 360.0 / SECTORS + 180.0) % 360.0 - 180.0)
        free = np.flatnonzero((off_deg >= 40.0) & (self._free_m() > 0.5))
        self._set_out(int(self._random.choice(free)) if len(free) else SECTORS // 2, 4)

    def _turn(self, left_deg: float, then: int) -> int:
        left_deg = math.remainder(left_deg, 360.0)
        if abs(left_deg) > 16.0:
            return LEFT if left_deg > 0.0 else RIGHT
        self._strides = max(0, self._strides - 1)
        return then

    def _declare(self) -> int:
        agent = self._agent
        if agent.goal_px >= LEAST_PX:
            return FOUND
        down_deg = math.degrees(agent.goal_down) - agent.tilts * TURN_DEG
        if abs(down_deg) > 16.0 and abs(agent.tilts + math.copysign(1, down_deg)) <= 2:
            return DOWN if down_deg > 0.0 else UP
        beside = agent.goal_m > 0.15
        nearer = AHEAD if beside and not agent.stopped else FOUND
        return self._turn(math.degrees(agent.goal_angle) if beside else 0.0, nearer)
