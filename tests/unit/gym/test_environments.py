"""What all environments have in common: spaces, seeds, refusals, an end."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.gym import ENVIRONMENTS, KINDS, SPLITS, room_names
from sailenv_ros.gym.room_env import RoomEnv
from sailenv_ros.gym.room_store import shared_rooms
from sailenv_ros.types.views import RENDERED_VIEWS

TASKS = [name.removeprefix("sailenv/").removesuffix("-v0") for name in ENVIRONMENTS]

Make = Callable[..., RoomEnv]


def trace(env: RoomEnv, seed: int, steps: int = 12) -> bytes:
    """Return a digest of everything that an environment says in an episode of random actions."""
    digest = hashlib.blake2b()
    random = np.random.default_rng(seed)
    observation, info = env.reset(seed=seed)
    for _ in range(steps):
        for name in sorted(observation):
            digest.update(name.encode() + np.asarray(observation[name]).tobytes())
        digest.update(repr(sorted(info.items())).encode())
        env.action_space.seed(int(random.integers(2**31)))
        observation, reward, over, _, info = env.step(env.action_space.sample())
        digest.update(repr((reward, over)).encode())
        if over:
            observation, info = env.reset()
    return digest.digest()


@pytest.mark.parametrize("discrete", [True, False])
@pytest.mark.parametrize("task", TASKS)
def test_gymnasium_finds_nothing_to_warn_of(make: Make, task: str, discrete: bool) -> None:
    env = make(task, discrete=discrete, render_mode="rgb_array")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env)


@pytest.mark.parametrize("task", TASKS)
def test_equal_seeds_give_equal_bytes_and_others_do_not(make: Make, task: str) -> None:
    first, second = make(task), make(task)
    trace(second, 5)  # what an environment did before does not show
    assert trace(first, 3) == trace(second, 3)
    assert trace(first, 4) != trace(second, 3)


@pytest.mark.parametrize("task", TASKS)
def test_environments_that_share_a_room_do_not_disturb_each_other(make: Make, task: str) -> None:
    alone = trace(make(task), 7)
    first, second = make(task), make(task)
    second.reset(seed=1)
    assert trace(first, 7) == alone
    assert first.room is second.room or task == "Rearrange"


def test_every_view_is_within_its_space(make: Make) -> None:
    env = make("Track", views=RENDERED_VIEWS)
    observation, _ = env.reset(seed=0)
    for _ in range(3):
        assert env.observation_space.contains(observation)
        observation, *_ = env.step(1)
    assert set(RENDERED_VIEWS) <= set(observation)


def test_an_observation_does_not_change_with_the_next_step(make: Make) -> None:
    env = make("Track")
    observation, _ = env.reset(seed=0)
    kept = observation["rgb"].copy()
    after, *_ = env.step(1)
    assert (observation["rgb"] == kept).all()
    assert (after["rgb"] != kept).any()


def test_stacks_come_from_gymnasiums_wrapper(make: Make) -> None:
    env = gymnasium.wrappers.FrameStackObservation(make("Track"), 3)
    observation, _ = env.reset(seed=0)
    assert observation["rgb"].shape == (3, 24, 32, 3)


def test_time_limits_cut_episodes_off(room: str) -> None:
    env = gymnasium.make("sailenv/Track-v0", rooms=[room], width=16, height=16)
    env.reset(seed=0)
    for _ in range(ENVIRONMENTS["sailenv/Track-v0"][1]):
        *_, truncated, _ = env.step(0)
    assert truncated
    env.close()


def test_splits_share_no_room() -> None:
    names = [set(room_names(20, split=split)) for split in SPLITS]
    assert all(len(one) == 20 for one in names)
    assert not names[0] & names[1] | names[1] & names[2] | names[0] & names[2]
    assert room_names(3, split="val")[1] == f"generated:{KINDS[1]}:{SPLITS['val'][1]}"


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"views": "colour"}, UnknownName, "colour"),
        ({"width": 0}, InvalidRequest, "width"),
        ({"height": 0}, InvalidRequest, "height"),
        ({"split": "exam"}, UnknownName, "train"),
        ({"rooms": 0}, InvalidRequest, "rooms"),
        ({"rooms": []}, InvalidRequest, "rooms"),
        ({"most_depth_m": 0.0}, InvalidRequest, "most_depth_m"),
        ({"discrete": 1}, InvalidRequest, "discrete"),
        ({"threads": 0}, InvalidRequest, "threads"),
    ],
)
def test_what_cannot_be_is_refused_in_words(
    room: str, settings: dict[str, Any], error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        gymnasium.make("sailenv/Track-v0", **{"rooms": [room], **settings})


@pytest.mark.parametrize("action", [5, -1, 0.5, None, np.zeros(2, np.float32)])
def test_an_action_outside_of_its_space_is_refused_and_changes_nothing(
    make: Make, action: object
) -> None:
    env, twin = make("Track"), make("Track")
    env.reset(seed=0), twin.reset(seed=0)
    with pytest.raises(InvalidRequest, match="Discrete"):
        env.step(action)
    assert env.step(1)[0]["rgb"].tobytes() == twin.step(1)[0]["rgb"].tobytes()


def test_nothing_moves_before_a_start_or_after_an_end(make: Make) -> None:
    env = make("PointNav")
    with pytest.raises(InvalidState, match="reset"):
        env.step(0)
    env.reset(seed=0)
    assert env.step(0)[2]
    with pytest.raises(InvalidState, match="reset"):
        env.step(1)


def test_rooms_and_options_that_are_not_there_are_refused(make: Make) -> None:
    env = make("Track")
    with pytest.raises(UnknownName, match="attic"):
        env.reset(options={"room": "attic"})
    with pytest.raises(UnknownName, match="floor"):
        env.reset(options={"floor": 1})


def test_the_last_to_close_frees_the_rooms(make: Make) -> None:
    first, second = make("Track"), make("Track")
    first.reset(seed=0), second.reset(seed=0)
    first.close()
    first.close()
    assert second.step(0)
    second.close()
    assert not shared_rooms()._rooms
    with pytest.raises(InvalidState, match="closed"):
        first.reset()
