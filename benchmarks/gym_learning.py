"""Learning curves of stable-baselines3's PPO, beside scripted and random actions, in unseen rooms.

    python -m benchmarks.gym_learning Track [--minutes N] [--seed N] [--rooms N] [--episodes N]
    python -m benchmarks.gym_learning Search

stable-baselines3 and torch are not among the packages of the project: install them beside it. The
agent sees maps of 20×20: the pixels of the object that is wanted, those of the step before, and
depth. It learns in rooms of the split `train`, for so many minutes of processor time; every fifth
of them it is measured in rooms of `val`.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import DummyVecEnv

import sailenv_ros.gym  # noqa: F401  # registers the environments

SIDE, REACH_M = 20, 5.0

SETTINGS: dict[str, dict[str, Any]] = {
    # Each turn is rewarded at once; a way to something seen takes dozens of steps.
    "Track": {"gamma": 0.9, "gae_lambda": 0.9, "n_steps": 128, "batch_size": 256},
    "Search": {"gamma": 0.98, "n_steps": 256, "batch_size": 256, "ent_coef": 0.01},
}
"""Of PPO; all else is its default."""

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
        if "goal" in observation:
            mask = observation["category"] == observation["goal"]
        else:
            mask = observation["instance"] == base.room.ids[base.room.rows["target"]]
        before, self._before = self._before, mask
        maps = mask, observation["depth"] / REACH_M, mask if before is None else before
        return np.stack(maps).astype(np.float32)


def make(task: str, split: str, rooms: int) -> gymnasium.Env[Any, Any]:
    """Return an environment with masks."""
    settings: dict[str, Any] = {"views": ("depth", "category", "instance"), "most_depth_m": REACH_M}
    env = gymnasium.make(
        f"sailenv/{task}-v0", width=SIDE, height=SIDE, split=split, rooms=rooms, **settings
    )
    return Masked(env)


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


def scripted_search(seen: NDArray[np.float32]) -> int:
    """Turn until the mask is seen, walk to it, and declare it where it is near."""
    mask = seen[0] > 0
    if not mask.any():
        return 2
    aside = np.nonzero(mask)[1].mean() - (SIDE - 1) / 2
    if abs(aside) > SIDE / 4:
        return 3 if aside > 0 else 2
    return 0 if np.median(seen[1][mask]) * REACH_M < 1.0 and mask.sum() >= 4 else 1


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
    """Measures the policy in unseen rooms now and then; ends the learning when time is over."""

    def __init__(self, env: gymnasium.Env[Any, Any], minutes: float, episodes: int) -> None:
        super().__init__()
        self._env, self._minutes, self._episodes = env, minutes, episodes
        self._learned_s, self._last, self._points = 0.0, time.process_time(), 0

    def _on_step(self) -> bool:
        now = time.process_time()
        self._learned_s += now - self._last
        if self._learned_s >= (self._points + 1) * self._minutes * 12.0:
            self._points += 1
            show(
                f"PPO, {self.num_timesteps} steps, {self._learned_s / 60.0:.1f} processor min",
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
    parser.add_argument("task", choices=("Track", "Search"))
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--episodes", type=int, default=20)
    parser.add_argument("--rooms", type=int, default=4)
    arguments = parser.parse_args()
    task, rooms = arguments.task, arguments.rooms
    judged = make(task, "train", rooms)
    check_env(judged)
    raw = gymnasium.make(f"sailenv/{task}-v0", rooms=1)
    check_env(raw)
    print("stable_baselines3.common.env_checker.check_env: no errors", flush=True)
    raw.close()
    unseen = make(task, "val", rooms)
    random, episodes = np.random.default_rng(arguments.seed), arguments.episodes
    script = scripted_track if task == "Track" else scripted_search
    actions = 5 if task == "Track" else 6
    show("random", evaluate(unseen, lambda seen: int(random.integers(actions)), episodes))
    show("scripted", evaluate(unseen, script, episodes))
    learning = DummyVecEnv([lambda: make(task, "train", rooms) for _ in range(8)])
    # Many small networks' threads would only wait for one another.
    torch.set_num_threads(1)
    model = PPO(
        "MlpPolicy",
        learning,
        **SETTINGS[task],
        seed=arguments.seed,
        device="cpu",
        policy_kwargs={"net_arch": [128, 64]},
    )
    model.learn(10_000_000, callback=Curve(unseen, arguments.minutes, episodes))
    for env in (judged, unseen, learning):
        env.close()


if __name__ == "__main__":
    main()
