"""A scripted agent keeps a moving object centred; its figures in rooms that no training saw.

It turns towards the object's pixels in the view `instance`, one direction at a time, and to the
left while it sees none. Replace `policy` by what you have trained.

    python examples/18_acting.py [--rooms SCENE ...] [--episodes N] [--picture FILE.png]
"""

import argparse
from typing import Any

import cv2
import gymnasium
import numpy as np

import sailenv_ros.gym
from sailenv_ros.gym.room_env import RoomEnv

STAY, LEFT, RIGHT, UP, DOWN = range(5)


def policy(mask: Any) -> int:
    """Return the action for a mask (H, W) of the object's pixels."""
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return LEFT
    height, width = mask.shape
    aside, down = columns.mean() - (width - 1) / 2, rows.mean() - (height - 1) / 2
    if max(abs(aside), abs(down)) < 2.0:
        return STAY
    if abs(aside) > abs(down):
        return RIGHT if aside > 0 else LEFT
    return DOWN if down > 0 else UP


def main() -> None:
    """Evaluate the agent."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rooms", nargs="*", help="scenes; left out: four of the split test")
    parser.add_argument("--episodes", type=int, default=8)
    parser.add_argument("--picture", help="the last picture is written there")
    arguments = parser.parse_args()
    rooms = arguments.rooms or sailenv_ros.gym.room_names(4, split="test")
    env = gymnasium.make(
        "sailenv/Track-v0", rooms=rooms, views=("rgb", "instance"), render_mode="rgb_array"
    )
    room_env = env.unwrapped
    assert isinstance(room_env, RoomEnv)
    for number in range(arguments.episodes):
        observation, info = env.reset(seed=number)
        target = room_env.room.ids[room_env.room.rows["target"]]
        total, over = 0.0, False
        while not over:
            action = policy(observation["instance"] == target)
            observation, reward, terminated, truncated, info = env.step(action)
            total, over = total + float(reward), terminated or truncated
        print(
            f"{room_env.room.name}: reward {total:.0f}, centred in "
            f"{info['centred_share']:.0%} of the steps"
        )
    if arguments.picture:
        cv2.imwrite(arguments.picture, cv2.cvtColor(observation["rgb"], cv2.COLOR_RGB2BGR))
    env.close()


if __name__ == "__main__":
    main()
