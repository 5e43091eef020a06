"""Environments as LeRobot evaluates policies in them: ``env.py`` of a repository for its EnvHub.

The file there is one line: ``from sailenv_ros.gym.lerobot_env import make_env``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv, VectorEnv

from sailenv_ros.errors import UnknownName
from sailenv_ros.gym.registration import ENVIRONMENTS, register_environments
from sailenv_ros.gym.wrappers import room_env, spaces_of

__all__ = ["LeRobotEnv", "make_env"]

SUITE = "sailenv"


class LeRobotEnv(gymnasium.Wrapper[dict[str, Any], Any, Any, Any]):
    """Renames what is observed: ``pixels``, the picture, and ``agent_pos``, all that is no view.

    ``is_success`` in `info` is the task's ``success``.

    Parameters
    ----------
    env : gymnasium.Env
        An environment of this package that observes the view ``rgb``.
    """

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        super().__init__(env)
        told, views = spaces_of(env), room_env(env).eye.views
        if "rgb" not in views:
            env.close()  # nobody else has it
            raise UnknownName("view", "rgb", views)
        self._told = spaces.Dict({name: told[name] for name in told if name not in views})
        inside: dict[str, spaces.Space[Any]] = {"pixels": told["rgb"]}
        if self._told.spaces:
            flat = spaces.flatten_space(self._told)
            assert isinstance(flat, spaces.Box)
            inside["agent_pos"] = spaces.Box(flat.low, flat.high, flat.shape, np.float32)
        self.observation_space = spaces.Dict(inside)

    @property
    def task_description(self) -> str:
        """Task in words, for policies that read it."""
        words = type(self.unwrapped).__doc__ or ""
        return words.partition("\n")[0].rstrip(".").lower()

    @property
    def task(self) -> str:
        """Name of the environment."""
        return "" if self.spec is None else self.spec.id

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode; see the environment."""
        observation, info = self.env.reset(seed=seed, options=options)
        return self._renamed(observation), {**info, "is_success": False}

    def step(self, action: Any) -> tuple[dict[str, Any], Any, bool, bool, dict[str, Any]]:
        """Act; see the environment."""
        observation, reward, ended, cut_off, info = self.env.step(action)
        told = {**info, "is_success": bool(info["success"])}
        return self._renamed(observation), reward, ended, cut_off, told

    def _renamed(self, observation: dict[str, Any]) -> dict[str, Any]:
        renamed = {"pixels": observation["rgb"]}
        if self._told.spaces:
            own = {name: observation[name] for name in self._told.spaces}
            renamed["agent_pos"] = np.asarray(spaces.flatten(self._told, own), np.float32)
        return renamed


def make_env(
    n_envs: int = 1,
    use_async_envs: bool = False,
    cfg: object = None,
    *,
    tasks: Sequence[str] = ("sailenv/PointNav-v0",),
    **settings: Any,
) -> dict[str, dict[int, VectorEnv[Any, Any, Any]]]:
    """Make vector environments as LeRobot's EnvHub calls for them.

    Parameters
    ----------
    n_envs : int
        Of each task.
    use_async_envs : bool
        A process for each, or all in this one.
    cfg : object
        LeRobot's own; not used.
    tasks : sequence of str
        Names of environments.
    **settings
        Of the environments; actions are continuous unless ``discrete=True``.

    Returns
    -------
    environments : dict of str to dict of int to VectorEnv
        ``{"sailenv": {0: first task, 1: second task}}``.

    Raises
    ------
    UnknownName
        If there is no such task.
    """
    for task in tasks:
        if task not in ENVIRONMENTS:
            raise UnknownName("task", task, ENVIRONMENTS)
    kind = AsyncVectorEnv if use_async_envs else SyncVectorEnv
    given = {"discrete": False, "render_mode": "rgb_array", **settings}
    made: dict[int, VectorEnv[Any, Any, Any]] = {}
    for number, task in enumerate(tasks):
        made[number] = kind([partial(_one, task, given)] * n_envs)
    return {SUITE: made}


def _one(task: str, settings: dict[str, Any]) -> LeRobotEnv:
    """Make one environment, perhaps in a process of its own."""
    register_environments()
    return LeRobotEnv(gymnasium.make(task, **settings))
