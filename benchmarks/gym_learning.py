"""Learning curves of stable-baselines3's PPO, beside scripted and random actions, in unseen rooms.

    python -m benchmarks.gym_learning Track [--minutes N] [--seed N] [--rooms N] [--episodes N]
    python -m benchmarks.gym_learning Search

stable-baselines3 and torch are not among the packages of the project: install them beside it. Who
tracks sees maps of 20×20: the pixels of the object, those of the step before, and depth. Who
searches remembers what it saw in such maps, see `gym_searcher.Searcher`. It learns in rooms of the
split `train`, for so many minutes of processor time; every fifth of them it is measured in rooms of
`val`, by which settings were chosen, or with ``--split test`` in rooms that nobody has looked at.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import DummyVecEnv, VecEnv, VecNormalize

import sailenv_ros.gym  # noqa: F401  # registers the environments
from benchmarks.gym_direction_policy import DirectionPolicy
from benchmarks.gym_search_policies import ScriptedSearch, Strider
from benchmarks.gym_searcher import REACH_M, SIDE, Searcher
from sailenv_ros.gym.room_store import shared_rooms

UNSEEN_ROOMS = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How a task is learned.

    Attributes
    ----------
    settings : mapping
        Of PPO; all else is its default.
    envs : int
        That learn side by side.
    rooms : int
        That they are in.
    rate : float
        At which PPO learns.
    wears_off : bool
        Whether this rate and the weight of entropy fall to 0 meanwhile, and rewards are scaled.
    own : mapping
        Further arguments of `make` for the environments that learn.
    episodes : int
        Of a measurement.
    """

    settings: Mapping[str, Any]
    envs: int = 8
    rooms: int = 4
    rate: float = 3e-4
    wears_off: bool = False
    own: Mapping[str, Any]
    episodes: int


PLANS: Mapping[str, Plan] = {
    # Each turn is rewarded at once; a way to something seen takes dozens of steps.
    "Track": Plan(
        settings={
            "policy": "MlpPolicy",
            "policy_kwargs": {"net_arch": [128, 64]},
            "gamma": 0.9,
            "gae_lambda": 0.9,
            "n_steps": 128,
            "batch_size": 256,
            "ent_coef": 0.0,
        },
        wears_off=True,
        own={},
        episodes=20,
    ),
    "Search": Plan(
        settings={
            "policy": DirectionPolicy,
            "gamma": 0.98,
            "n_steps": 32,
            "batch_size": 128,
            "ent_coef": 0.01,
        },
        envs=16,
        rooms=32,
        rate=1e-3,
        wears_off=True,
        own={"most_steps": 100, "curiosity": 0.3},
        episodes=50,
    ),
}

Policy = Callable[[NDArray[np.float32]], int]


class Masked(gymnasium.ObservationWrapper[Any, Any, Any]):
    """Mask of what is wanted, depth / 5 m, and the mask before: (3, 20, 20) from 0 to 1."""

    def __init__(self, env: gymnasium.Env[Any, Any]) -> None:
        super().__init__(env)
        self.observation_space = gymnasium.spaces.Box(0.0, 1.0, (3, SIDE, SIDE), np.float32)
        self._before: NDArray[np.bool_] | None = None

    def reset(self, **settings: Any) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode, in which nothing was seen before."""
        self._before = None
        return super().reset(**settings)

    def observation(self, observation: Any) -> NDArray[np.float32]:
        """Return the maps."""
        base: Any = self.env.unwrapped
        mask = observation["instance"] == base.room.ids[base.room.rows["target"]]
        before, self._before = self._before, mask
        maps = mask, observation["depth"] / REACH_M, mask if before is None else before
        return np.stack(maps).astype(np.float32)


def make(
    task: str, split: str, rooms: int, *, most_steps: int | None = None, curiosity: float = 0.0
) -> gymnasium.Env[Any, Any]:
    """Return an environment whose observations are one array.

    Parameters
    ----------
    task : {'Track', 'Search'}
    split : {'train', 'val', 'test'}
    rooms : int
    most_steps : int or None
        Of an episode; None for as many as the task has.
    curiosity : float
        Of a `Searcher`.
    """
    env = gymnasium.make(
        f"sailenv/{task}-v0",
        max_episode_steps=most_steps,
        width=SIDE,
        height=SIDE,
        views=("depth", "instance" if task == "Track" else "category"),
        most_depth_m=REACH_M,
        split=split,
        rooms=rooms,
    )
    return Masked(env) if task == "Track" else Searcher(env, curiosity)


def decided(env: gymnasium.Env[Any, Any]) -> gymnasium.Env[Any, Any]:
    """Return an environment with the actions of who learns."""
    return Strider(env) if isinstance(env, Searcher) else env


def scripted_track(seen: NDArray[np.float32]) -> int:
    """Turn to the middle of the mask; to the left while nothing is seen."""
    v, u = np.nonzero(seen[0])
    if not len(u):
        return 1
    aside, down = u.mean() - (SIDE - 1) / 2, v.mean() - (SIDE - 1) / 2
    if max(abs(aside), abs(down)) < 0.75:
        return 0
    if abs(aside) >= abs(down):
        return 2 if aside > 0 else 1
    return 4 if down > 0 else 3


def evaluate(
    env: gymnasium.Env[Any, Any], policy: Policy, episodes: int
) -> tuple[float, float, float]:
    """Return mean reward of an episode, share of success, and centred share or SPL."""
    rewards, successes, thirds = [], [], []
    for number in range(episodes):
        seen, info = env.reset(seed=1000 + number)
        total, over = 0.0, False
        while not over:
            seen, reward, terminated, truncated, info = env.step(policy(seen))
            total, over = total + float(reward), terminated or truncated
        rewards.append(total)
        successes.append(float(info["success"]))
        thirds.append(float(info.get("centred_share", info.get("spl", 0.0))))
    return float(np.mean(rewards)), float(np.mean(successes)), float(np.mean(thirds))


class Curve(BaseCallback):
    """Measures the policy in unseen rooms now and then; ends the learning when time is over.

    Attributes
    ----------
    left : float
        Share of the time that is left.
    """

    def __init__(
        self, plan: Plan, env: gymnasium.Env[Any, Any], minutes: float, episodes: int
    ) -> None:
        super().__init__()
        self.left = 1.0
        self._plan, self._env = plan, env
        self._minutes, self._episodes = minutes, episodes
        self._learned_s, self._last, self._points = 0.0, time.process_time(), 0

    def rate(self, _: float) -> float:
        """Return at which rate to learn now."""
        return self._plan.rate * (self.left if self._plan.wears_off else 1.0)

    def _on_rollout_start(self) -> None:
        if self._plan.wears_off:
            model: Any = self.model
            model.ent_coef = self.left * self._plan.settings["ent_coef"]

    def _on_step(self) -> bool:
        now = time.process_time()
        self._learned_s += now - self._last
        self.left = max(0.0, 1.0 - self._learned_s / (60.0 * self._minutes))
        if self._learned_s >= (self._points + 1) * self._minutes * 12.0:
            self._points += 1
            steps = self.num_timesteps
            if isinstance(self._env, Strider):
                steps = sum(self.training_env.get_attr("taken"))
            show(
                f"PPO, {steps} steps, {self._learned_s / 60.0:.1f} processor min",
                evaluate(self._env, lambda seen: int(self.model.predict(seen)[0]), self._episodes),
            )
        self._last = time.process_time()
        return self._points < 5


def show(name: str, figures: tuple[float, float, float]) -> None:
    """Print a line of the table."""
    print(
        "{:36s} reward {:7.2f}   success {:.2f}   third {:.2f}".format(name, *figures), flush=True
    )


def main() -> None:
    """Learn, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("task", choices=tuple(PLANS))
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--split", choices=("val", "test"), default="val")
    parser.add_argument("--episodes", type=int)
    parser.add_argument("--rooms", type=int, help="that it learns in")
    arguments = parser.parse_args()
    task, plan = arguments.task, PLANS[arguments.task]
    rooms, episodes = arguments.rooms or plan.rooms, arguments.episodes or plan.episodes
    shared_rooms().most_rooms = rooms + UNSEEN_ROOMS  # each is entered again and again
    judged = make(task, "train", rooms)
    check_env(judged)
    raw = gymnasium.make(f"sailenv/{task}-v0", rooms=1)
    check_env(raw)
    print("stable_baselines3.common.env_checker.check_env: no errors", flush=True)
    raw.close()
    unseen = make(task, arguments.split, UNSEEN_ROOMS)
    random = np.random.default_rng(arguments.seed)
    script = ScriptedSearch(unseen) if isinstance(unseen, Searcher) else scripted_track
    actions = 5 if task == "Track" else 6
    show("random", evaluate(unseen, lambda seen: int(random.integers(actions)), episodes))
    show("scripted", evaluate(unseen, script, episodes))
    learning: VecEnv = DummyVecEnv(
        [lambda: decided(make(task, "train", rooms, **plan.own)) for _ in range(plan.envs)]
    )
    if plan.wears_off:
        learning = VecNormalize(learning, norm_obs=False, gamma=plan.settings["gamma"])
    # Many small networks' threads would only wait for one another.
    torch.set_num_threads(1)
    curve = Curve(plan, decided(unseen), arguments.minutes, episodes)
    model = PPO(
        env=learning,
        learning_rate=curve.rate,
        seed=arguments.seed,
        device="cpu",
        **plan.settings,
    )
    model.learn(10_000_000, callback=curve)
    for env in (judged, unseen, learning):
        env.close()


if __name__ == "__main__":
    main()
