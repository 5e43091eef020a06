"""Environments as LeRobot calls for them: its names for what our environments observe."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from sailenv_ros.errors import UnknownName
from sailenv_ros.gym import ENVIRONMENTS
from sailenv_ros.gym.lerobot_env import make_env


@pytest.mark.parametrize("apart", [False, True])
def test_vector_environments_come_by_suite_and_task(room: str, apart: bool) -> None:
    """Pictures and positions are those of the environment itself; success has LeRobot's name."""
    settings = {"rooms": [room], "width": 32, "height": 24}
    made = make_env(2, apart, tasks=("sailenv/Track-v0", "sailenv/PointNav-v0"), **settings)
    assert list(made) == ["sailenv"]
    assert list(made["sailenv"]) == [0, 1]
    own = gymnasium.make("sailenv/PointNav-v0", discrete=False, **settings)
    try:
        for vector in made["sailenv"].values():
            observation, _ = vector.reset(seed=[3, 4])
            assert vector.observation_space.contains(observation)
            assert observation["pixels"].shape == (2, 24, 32, 3)
        expected, _ = own.reset(seed=4)
        np.testing.assert_array_equal(observation["pixels"][1], expected["rgb"])
        others = [expected[name].ravel() for name in sorted(expected) if name != "rgb"]
        np.testing.assert_array_equal(observation["agent_pos"][1], np.concatenate(others))
        actions = np.stack([vector.single_action_space.sample() for _ in range(2)])
        observation, rewards, _, _, info = vector.step(actions)
        expected, reward, _, _, told = own.step(actions[1])
        np.testing.assert_array_equal(observation["pixels"][1], expected["rgb"])
        assert rewards[1] == reward
        assert info["is_success"].tolist() == [False, bool(told["success"])]
        assert vector.call("_max_episode_steps") == (200, 200)
    finally:
        own.close()
        for vector in made["sailenv"].values():
            vector.close()


@pytest.mark.parametrize("task", ENVIRONMENTS)
def test_every_task_has_a_space_of_its_own(room: str, task: str) -> None:
    """What is no view is one vector; there may be none."""
    (vector,) = make_env(tasks=[task], rooms=[room], width=24, height=24)["sailenv"].values()
    observation, _ = vector.reset(seed=1)
    assert vector.observation_space.contains(observation)
    observation, *_ = vector.step(vector.action_space.sample())
    assert vector.observation_space.contains(observation)
    assert vector.get_attr("task") == (task,)
    assert len(vector.get_attr("task_description")[0].split()) > 2
    vector.close()


def test_what_cannot_be_is_refused(room: str) -> None:
    """A task that there is not, and eyes without a picture."""
    with pytest.raises(UnknownName, match="task"):
        make_env(tasks=["sailenv/Sleep-v0"])
    with pytest.raises(UnknownName, match="rgb"):
        make_env(rooms=[room], views=("depth",))
