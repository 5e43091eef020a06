"""What a searcher remembers, told by rooms of one wall."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gymnasium")

import gymnasium

from benchmarks.gym_search_policies import MIRRORED, TURNS, Strider, steps_of
from benchmarks.gym_searcher import AHEAD, LEFT, ORDER, RIGHT, SIDE, SIGNS, Searcher

STRIDE_M, WALL_M = 0.25, 2.0


class Looks(gymnasium.Env[Any, Any]):
    """Shows the same picture always, and walks freely but for the third stride."""

    def __init__(self, depth_m: np.ndarray, wanted: np.ndarray) -> None:
        self.observation_space = gymnasium.spaces.Discrete(2)
        self.action_space = gymnasium.spaces.Discrete(6)
        self._seen = {"depth": depth_m, "category": np.where(wanted, 5, 1), "goal": 5}
        self._strides, self._walked_m = 0, 0.0

    def reset(self, **settings: Any) -> tuple[Any, dict[str, Any]]:
        self._strides, self._walked_m = 0, 0.0
        return self._seen, {}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        if action == AHEAD:
            self._strides += 1
            self._walked_m += 0.1 if self._strides == 3 else STRIDE_M
        return self._seen, -0.01, False, False, {"path_length_m": self._walked_m}


def wall(wanted: bool = False) -> Searcher:
    """Return a searcher before a wall, with two pixels of what is wanted on its left, or none."""
    mask = np.zeros((SIDE, SIDE), bool)
    mask[SIDE // 2, :2] = wanted
    return Searcher(Looks(np.full((SIDE, SIDE), WALL_M, np.float32), mask))


def test_a_searcher_knows_its_place_by_its_actions() -> None:
    agent = wall()
    agent.reset()
    for action in (AHEAD, LEFT, LEFT, LEFT, AHEAD):
        agent.step(action)
    assert agent.place == pytest.approx([STRIDE_M, STRIDE_M])
    assert not agent.stopped
    agent.step(AHEAD)
    assert agent.place == pytest.approx([STRIDE_M, STRIDE_M + 0.1])
    assert agent.stopped


def test_a_searcher_knows_where_what_is_wanted_is() -> None:
    agent = wall(wanted=True)
    agent.reset()
    left_m = WALL_M * math.tan(math.radians(37.5)) * (1.0 - 3.0 / SIDE)
    assert agent.goal_px == 2
    assert agent.goal_m == pytest.approx(math.hypot(WALL_M, left_m))
    assert agent.goal_angle == pytest.approx(math.atan2(left_m, WALL_M))


def test_curiosity_rewards_what_is_seen_from_nearby_once() -> None:
    agent = wall()
    agent.reset()
    assert Searcher(agent.env, curiosity=1.0).step(LEFT)[1] == pytest.approx(-0.01)  # too far away
    near = Searcher(
        Looks(np.full((SIDE, SIDE), 1.0, np.float32), np.zeros((SIDE, SIDE), bool)), 1.0
    )
    near.reset()
    assert near.step(LEFT)[1] > 0.0
    assert near.step(RIGHT)[1] == pytest.approx(-0.01)


def test_a_mirrored_world_is_observed_mirrored() -> None:
    random = np.random.default_rng(0)
    depth_m = random.uniform(0.5, 4.0, (SIDE, SIDE)).astype(np.float32)
    wanted = random.random((SIDE, SIDE)) < 0.02
    agent = Searcher(Looks(depth_m, wanted))
    other = Searcher(Looks(depth_m[:, ::-1], wanted[:, ::-1]))
    seen, _ = agent.reset()
    mirrored, _ = other.reset()
    for action in random.integers(1, 6, 20).tolist():
        assert mirrored == pytest.approx(seen[ORDER] * SIGNS, abs=1e-5)
        seen, *_ = agent.step(action)
        mirrored, *_ = other.step({LEFT: RIGHT, RIGHT: LEFT}.get(action, action))


def test_a_strider_stops_where_the_agent_is_stopped() -> None:
    agent = wall()
    strider = Strider(agent)
    strider.reset()
    strider.step(TURNS - 1)  # once to the right, and 4 strides, of which the third is stopped
    assert (agent.turns, agent.steps, strider.taken) == (-1, 4, 4)
    assert agent.stopped


def test_a_strider_stops_where_what_is_wanted_comes_into_view() -> None:
    agent = wall(wanted=True)
    strider = Strider(agent)
    strider.reset()
    strider.step(3 + TURNS)
    assert agent.turns == 3  # it was in view from the start
    agent.goal_m = math.inf
    strider.step(3 + TURNS)
    assert agent.turns == 4


def test_decisions_are_mirrored() -> None:
    other = {LEFT: RIGHT, RIGHT: LEFT}
    for decision, mirrored in enumerate(MIRRORED):
        if decision % TURNS != TURNS // 2 or decision >= 2 * TURNS:  # half a turn is one either way
            assert steps_of(mirrored) == [other.get(one, one) for one in steps_of(decision)]
