"""Several agents in one room: PettingZoo's rules, and bodies that see and stop one another."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator

import pytest

pytest.importorskip("pettingzoo")

from pettingzoo.test import parallel_api_test

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.gym.parallel import PointNavParallelEnv
from sailenv_ros.gym.room_store import shared_rooms


@pytest.fixture
def pair(room: str) -> Iterator[PointNavParallelEnv]:
    env = PointNavParallelEnv(2, rooms=[room], width=32, height=24, views=("instance", "rgb"))
    yield env
    env.close()


def test_pettingzoo_accepts_it(pair: PointNavParallelEnv) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(pair, num_cycles=30)


def test_equal_seeds_give_equal_bytes(pair: PointNavParallelEnv) -> None:
    found = []
    for _ in range(2):
        observations, _ = pair.reset(seed=4)
        said = [observations]
        for number in range(6):
            said.append(pair.step({agent: 1 + number % 3 for agent in pair.agents})[0])
        found.append(
            [one[agent][view].tobytes() for one in said for agent in one for view in one[agent]]
        )
    assert found[0] == found[1]


def test_agents_see_each_other(pair: PointNavParallelEnv) -> None:
    pair.reset(seed=0)
    first, second = pair._members
    first._walker.x_m, first._walker.y_m, first._walker.yaw_deg = -0.5, -1.5, 0.0
    second._walker.x_m, second._walker.y_m, second._walker.yaw_deg = 1.5, -1.5, 180.0
    observations, *_ = pair.step({"walker_0": 2, "walker_1": 3})
    rows, ids = first.room.rows, first.room.ids
    for own, other in ((0, 1), (1, 0)):
        seen = observations[f"walker_{own}"]["instance"]
        assert (seen == ids[rows[f"walker_{other}"]]).any()
        assert not (seen == ids[rows[f"walker_{own}"]]).any()


def test_agents_stop_where_they_would_touch(pair: PointNavParallelEnv) -> None:
    pair.reset(seed=0)
    first, second = pair._members
    first._walker.x_m, first._walker.y_m, first._walker.yaw_deg = -0.5, -1.5, 0.0
    second._walker.x_m, second._walker.y_m, second._walker.yaw_deg = 0.5, -1.5, 180.0
    for _ in range(4):
        *_, infos = pair.step({"walker_0": 1, "walker_1": 1})
    assert math.dist(first.place, second.place) == pytest.approx(0.4, abs=0.03)
    assert math.dist(first.place, second.place) >= 0.4
    assert min(info["bumps"] for info in infos.values()) > 0


def test_who_stops_is_done_and_the_others_walk_on(pair: PointNavParallelEnv) -> None:
    pair.reset(seed=0)
    _, _, over, _, _ = pair.step({"walker_0": 0, "walker_1": 1})
    assert over == {"walker_0": True, "walker_1": False}
    assert pair.agents == ["walker_1"]
    observations, *_ = pair.step({"walker_1": 2})
    assert set(observations) == {"walker_1"}


def test_time_limits_cut_off(room: str) -> None:
    env = PointNavParallelEnv(1, max_cycles=2, rooms=[room], width=16, height=16)
    env.reset(seed=0)
    assert not env.step({"walker_0": 1})[3]["walker_0"]
    assert env.step({"walker_0": 1})[3]["walker_0"]
    assert not env.agents
    env.close()
    assert not shared_rooms()._rooms


def test_bad_requests_are_refused_and_nobody_acts(pair: PointNavParallelEnv) -> None:
    pair.reset(seed=0)
    before = [member.place for member in pair._members]
    with pytest.raises(InvalidState, match="walker_1"):
        pair.step({"walker_0": 1})
    with pytest.raises(InvalidRequest, match="action"):
        pair.step({"walker_0": 1, "walker_1": 9})
    assert [member.place for member in pair._members] == before
    with pytest.raises(UnknownName, match="walker_0"):
        pair.action_space("driver")
    with pytest.raises(InvalidRequest, match="agents"):
        PointNavParallelEnv(0)
