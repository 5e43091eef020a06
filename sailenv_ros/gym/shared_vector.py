"""Several environments of a task in one process, as Gymnasium's vector environments.

They share rooms, assets, light and textures. Observations are written straight into one batch.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, cast

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, iterate
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.gym.room_env import Arrays, Info, RoomEnv
from sailenv_ros.types.validation import Bounds

__all__ = ["COUNT", "SharedVectorEnv", "Step", "empty_batch", "env_class", "listed_seeds"]

COUNT = Bounds(least=1, most=4096, whole=True)
"""Environments of one vector environment."""

STEPS = Bounds(least=1, most=2**31, whole=True)

Step = tuple[Arrays, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], Info]


class SharedVectorEnv(VectorEnv[Arrays, Any, Any]):
    """Environments side by side; used by one thread.

    An environment whose episode is over begins another one in the next step, whatever its action
    is then (`AutoresetMode.NEXT_STEP`).

    Parameters
    ----------
    task : str
        Module and class of the environments, as in ``track:TrackEnv``.
    num_envs : int
    max_episode_steps : int or None
        Steps after which an episode is cut off.
    copy : bool
        True returns new arrays from each step; False the same ones, which the next step
        overwrites.
    out : mapping of str to (N, …) array or None
        Arrays to use with ``copy=False``; None makes them.
    **settings
        Of each environment.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        **RoomEnv.metadata,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        task: str,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        copy: bool = True,
        out: Mapping[str, NDArray[Any]] | None = None,
        **settings: Any,
    ) -> None:
        self.num_envs = COUNT.integer("num_envs", num_envs)
        if max_episode_steps is not None:
            STEPS.integer("max_episode_steps", max_episode_steps)
        self._most_steps = max_episode_steps
        self._copies = copy and out is None
        self.envs: list[RoomEnv] = []
        try:
            for _ in range(self.num_envs):
                self.envs.append(env_class(task)(**settings))
        except BaseException:
            self.close_extras()
            raise
        first = self.envs[0]
        self.render_mode = first.render_mode
        self.single_observation_space = first.observation_space
        self.single_action_space = first.action_space
        self.observation_space = batch_space(first.observation_space, self.num_envs)
        self.action_space = batch_space(first.action_space, self.num_envs)
        self._out = empty_batch(self.observation_space) if out is None else dict(out)
        self._over = np.zeros(self.num_envs, bool)
        self._taken = np.zeros(self.num_envs, np.int64)
        self._begun = False

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: Mapping[str, Any] | None = None,
    ) -> tuple[Arrays, Info]:
        """Begin an episode in each environment; environment k has the seed ``seed + k``."""
        seeds = listed_seeds(seed, self.num_envs)
        batch = self._batch()
        infos: Info = {}
        for number, env in enumerate(self.envs):
            _, info = env.reset(seed=seeds[number], options=options, out=_row(batch, number))
            infos = self._add_info(infos, info, number)
        self._over[:], self._taken[:], self._begun = False, 0, True
        return batch, infos

    def step(self, actions: Any) -> Step:
        """Carry out one action in each environment.

        Raises
        ------
        InvalidRequest
            If one of them is not in `single_action_space`; nothing is carried out then.
        """
        if not self._begun:
            raise InvalidState("no episode has begun; call reset first")
        if not self.action_space.contains(actions):
            raise InvalidRequest("actions", actions, f"one of {self.action_space}")
        batch = self._batch()
        rewards = np.zeros(self.num_envs)
        terminated = np.zeros(self.num_envs, bool)
        truncated = np.zeros(self.num_envs, bool)
        infos: Info = {}
        for number, action in enumerate(iterate(self.action_space, actions)):
            env, row = self.envs[number], _row(batch, number)
            if self._over[number]:
                self._taken[number] = 0
                _, info = env.reset(out=row)
            else:
                self._taken[number] += 1
                _, reward, terminated[number], _, info = env.step(action, out=row)
                rewards[number] = reward
                if self._most_steps is not None:
                    truncated[number] = self._taken[number] >= self._most_steps
            infos = self._add_info(infos, info, number)
        self._over = terminated | truncated
        return batch, rewards, terminated, truncated, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return the picture of each environment; None without a `render_mode`."""
        if self.render_mode is None:
            return None
        return tuple(cast("NDArray[np.uint8]", env.render()) for env in self.envs)

    def close_extras(self, **kwargs: Any) -> None:
        """Close all environments."""
        for env in self.envs:
            env.close()

    def _batch(self) -> Arrays:
        return empty_batch(self.observation_space) if self._copies else self._out


def env_class(task: str) -> type[RoomEnv]:
    """Return the class of ``module:Class`` in this package."""
    module, _, name = task.partition(":")
    found: type[RoomEnv] = getattr(importlib.import_module(f"sailenv_ros.gym.{module}"), name)
    return found


def empty_batch(space: spaces.Space[Any]) -> Arrays:
    """Return arrays for a batch of observations."""
    assert isinstance(space, spaces.Dict)
    return {name: np.empty(one.shape or (), one.dtype) for name, one in space.spaces.items()}


def listed_seeds(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return the seed of each environment.

    Raises
    ------
    InvalidRequest
        If there are not as many as environments.
    """
    if seed is None:
        return [None] * count
    if isinstance(seed, int | np.integer):
        return [int(seed) + number for number in range(count)]
    if len(seed) != count:
        raise InvalidRequest("seeds", len(seed), f"as many as there are environments, {count}")
    return list(seed)


def _row(batch: Mapping[str, NDArray[Any]], number: int) -> Arrays:
    """Return the arrays of one environment of a batch; they share its memory."""
    return {name: one[number : number + 1].reshape(one.shape[1:]) for name, one in batch.items()}
