"""Wrappers of observations: a retina, and motion in the picture."""

from __future__ import annotations

from typing import Any, cast

import gymnasium
import numpy as np
from gymnasium import spaces

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.gym.retina import Retina
from sailenv_ros.gym.room_env import Arrays, RoomEnv
from sailenv_ros.gym.room_settings import STEP_NS

__all__ = ["LogPolarRetina", "Motion", "room_env", "spaces_of"]


class LogPolarRetina(gymnasium.ObservationWrapper[Arrays, Any, Arrays]):
    """Views seen by a `Retina`: (rings, wedges, …) instead of (H, W, …); pictures are averaged.

    The same as the setting ``retina`` of an environment, for one that was made without.

    Parameters
    ----------
    env : gymnasium.Env
        An environment of this package.
    rings, wedges : int
    """

    def __init__(self, env: gymnasium.Env[Arrays, Any], rings: int = 20, wedges: int = 32) -> None:
        super().__init__(env)
        eye = room_env(env).eye
        self._views = eye.views
        self._retina = Retina(eye.intrinsics.width, eye.intrinsics.height, rings, wedges)
        inside = spaces_of(env)
        for name in self._views:
            box = inside[name]
            assert isinstance(box, spaces.Box)
            shape = (rings, wedges, *box.shape[2:])
            inside[name] = spaces.Box(box.low.min(), box.high.max(), shape, box.dtype.type)
        self.observation_space = _dict_space(inside)

    def observation(self, observation: Arrays) -> Arrays:
        """Return an observation whose views are seen by the retina."""
        seen = {
            name: self._retina.sample(observation[name], mean=name == "rgb") for name in self._views
        }
        return {**observation, **seen}


class Motion(gymnasium.ObservationWrapper[Arrays, Any, Arrays]):
    """Adds ``motion``, (H, W) float32: how far each pixel moved since the last step [px].

    It is the length of the exact optical flow; 0 where there is none.

    Parameters
    ----------
    env : gymnasium.Env
        An environment of this package that observes the view ``flow``.

    Raises
    ------
    InvalidState
        If it does not.
    """

    def __init__(self, env: gymnasium.Env[Arrays, Any]) -> None:
        super().__init__(env)
        inside = spaces_of(env)
        if "flow" not in room_env(env).eye.views:
            raise InvalidState('motion is that of the view "flow"; add it to the views')
        flow = inside["flow"]
        assert isinstance(flow, spaces.Box)
        self._step_s = STEP_NS * 1e-9
        most = 1.5 * float(flow.high.max()) * self._step_s
        motion = spaces.Box(0.0, most, flow.shape[:2], np.float32)
        self.observation_space = _dict_space({**inside, "motion": motion})

    def observation(self, observation: Arrays) -> Arrays:
        """Return an observation with the motion added."""
        length = np.linalg.norm(observation["flow"], axis=2) * self._step_s
        return {**observation, "motion": length.astype(np.float32)}


def spaces_of(env: gymnasium.Env[Any, Any]) -> dict[str, spaces.Space[Any]]:
    """Return the spaces of what an environment observes, by name; a new mapping."""
    space: Any = env.observation_space
    return dict(space.spaces)


def _dict_space(inside: dict[str, spaces.Space[Any]]) -> spaces.Space[Arrays]:
    # Declared as the space of a mapping, which Dict is not in the types of Gymnasium.
    return cast("spaces.Space[Arrays]", spaces.Dict(inside))


def room_env(env: gymnasium.Env[Any, Any]) -> RoomEnv:
    """Return the environment of this package inside of wrappers.

    Raises
    ------
    InvalidRequest
        If there is none.
    """
    inner = env.unwrapped
    if not isinstance(inner, RoomEnv):
        raise InvalidRequest("env", type(inner).__name__, "an environment of sailenv_ros.gym")
    return inner
