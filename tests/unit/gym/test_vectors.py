"""Vector environments: the same episodes as alone, in one process and in several."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv

from sailenv_ros.errors import InvalidRequest, InvalidState, SimulationClosed
from sailenv_ros.gym.process_vector import ProcessVectorEnv
from sailenv_ros.gym.shared_vector import SharedVectorEnv

SIZE = {"width": 24, "height": 16, "views": ("rgb", "depth")}
COUNT = 3
ACTIONS = np.random.default_rng(0).integers(0, 4, (14, COUNT))


def make_vec(room: str, **settings: Any) -> Any:
    return gymnasium.make_vec(
        "sailenv/PointNav-v0", COUNT, rooms=[room], max_episode_steps=6, **SIZE, **settings
    )


@pytest.fixture
def shared(room: str) -> Iterator[SharedVectorEnv]:
    env = make_vec(room)
    yield env
    env.close()


@pytest.fixture(scope="module")
def divided(room: str) -> Iterator[ProcessVectorEnv]:
    env = make_vec(room, processes=2)
    yield env
    env.close()


def episodes(env: Any) -> list[dict[str, bytes]]:
    """Return everything that an environment says to `ACTIONS`."""
    observation, info = env.reset(seed=5)
    said = [{**observation, **info}]
    for actions in ACTIONS:
        observation, rewards, terminated, truncated, info = env.step(actions)
        said.append(
            {**observation, **info, "reward": rewards, "over": terminated, "cut": truncated}
        )
    return [
        {key: np.asarray(value).tobytes() for key, value in sorted(one.items())} for one in said
    ]


def test_a_vector_has_the_episodes_of_its_environments(shared: SharedVectorEnv, room: str) -> None:
    observation, _ = shared.reset(seed=5)
    batch, batch_info = [observation], []
    for actions in ACTIONS:
        observation, rewards, *_, info = shared.step(actions)
        batch.append(observation)
        batch_info.append((rewards, info))
    for number in range(COUNT):
        alone = gymnasium.make(
            "sailenv/PointNav-v0",
            rooms=[room],
            max_episode_steps=6,
            disable_env_checker=True,
            **SIZE,
        )
        observation, info = alone.reset(seed=5 + number)
        over = False
        for step, actions in enumerate(ACTIONS):
            for name, value in observation.items():
                assert batch[step][name][number].tobytes() == np.asarray(value).tobytes()
            if over:
                (observation, info), reward, over = alone.reset(), 0.0, False
            else:
                observation, reward, terminated, truncated, info = alone.step(actions[number])
                over = terminated or truncated
            assert batch_info[step][0][number] == reward
            assert batch_info[step][1]["distance_to_goal_m"][number] == info["distance_to_goal_m"]
        alone.close()


def test_the_number_of_processes_does_not_show(
    shared: SharedVectorEnv, divided: ProcessVectorEnv
) -> None:
    assert episodes(shared) == episodes(divided)
    assert len(set(divided.pids)) == 2


def test_observations_do_not_change_with_the_next_step(
    shared: SharedVectorEnv, divided: ProcessVectorEnv
) -> None:
    for env in (shared, divided):
        before, _ = env.reset(seed=1)
        kept = before["depth"].copy()
        env.step(np.full(COUNT, 2))
        assert (before["depth"] == kept).all()


def test_environments_of_a_vector_share_their_room(shared: SharedVectorEnv) -> None:
    shared.reset(seed=0)
    assert len({id(env.room) for env in shared.envs}) == 1


def test_gymnasiums_own_processes_have_the_same_episodes(
    shared: SharedVectorEnv, room: str
) -> None:
    def one() -> gymnasium.Env[Any, Any]:
        import sailenv_ros.gym  # noqa: F401  # registers, in the worker

        return gymnasium.make("sailenv/PointNav-v0", rooms=[room], max_episode_steps=6, **SIZE)

    own = AsyncVectorEnv([one] * 2, context="spawn")
    try:
        observation, _ = own.reset(seed=5)
        ours, _ = shared.reset(seed=5)
        for actions in ACTIONS[:4]:
            for name, value in ours.items():
                assert (observation[name] == value[:2]).all()
            observation, ours = own.step(actions[:2])[0], shared.step(actions)[0]
    finally:
        own.close()


def test_a_process_that_dies_is_told(room: str) -> None:
    env = make_vec(room, processes=2)
    env.reset(seed=0)
    first, second = env.pids
    os.kill(second, signal.SIGKILL)
    told = ""
    for _ in range(3):  # the first request may have been sent before it was gone
        try:
            env.step(np.full(COUNT, 1))
        except SimulationClosed as error:
            told = str(error)
            break
    assert f"process {second} (number 1 of 2, environments 1 to 2) died with exit code -9" in told
    with pytest.raises(ProcessLookupError):
        os.kill(first, 0)  # nothing is left
    with pytest.raises(SimulationClosed, match="closed"):
        env.reset()
    env.close()


def test_what_a_vector_cannot_do_is_refused(
    shared: SharedVectorEnv, divided: ProcessVectorEnv, room: str
) -> None:
    with pytest.raises(InvalidState, match="reset"):
        shared.step(np.zeros(COUNT, np.int64))
    for env in (shared, divided):
        env.reset(seed=0)
        for wrong in (np.full(COUNT, 4), np.zeros(COUNT + 1, np.int64), None):
            with pytest.raises(InvalidRequest, match="actions"):
                env.step(wrong)
        with pytest.raises(InvalidRequest, match="seeds"):
            env.reset(seed=[1, 2])
        with pytest.raises(InvalidRequest, match="attic"):
            env.reset(options={"room": "attic"})
    with pytest.raises(InvalidRequest, match="processes"):
        make_vec(room, processes=COUNT + 1)
    with pytest.raises(InvalidRequest, match="width"):
        gymnasium.make_vec("sailenv/PointNav-v0", 2, processes=2, width=0)
