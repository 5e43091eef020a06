"""Rooms and environments of the tests in this folder; each environment is closed afterwards."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

pytest.importorskip("gymnasium")

import gymnasium

import sailenv_ros.gym
from sailenv_ros.gym.room_env import RoomEnv
from tests.support.plain_room import plain_room

Make = Callable[..., Any]


@pytest.fixture(scope="session")
def room(tmp_path_factory: pytest.TempPathFactory) -> str:
    return plain_room(tmp_path_factory.mktemp("rooms"))


@pytest.fixture
def make(room: str) -> Iterator[Make]:
    """`make("Track", **settings)` returns an environment in the plain room, without wrappers."""
    made: list[RoomEnv] = []

    def make_one(task: str, **settings: Any) -> RoomEnv:
        chosen = {"rooms": [room], "width": 32, "height": 24, **settings}
        env = gymnasium.make(f"sailenv/{task}-v0", **chosen).unwrapped
        assert isinstance(env, RoomEnv)
        made.append(env)
        return env

    assert sailenv_ros.gym.ENVIRONMENTS
    yield make_one
    for env in made:
        env.close()
