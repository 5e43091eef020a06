"""A scripted agent keeps a moving object centred; its figures in rooms that no training saw.

It turns towards the object's pixels in the view `instance`, one direction at a time, and to the
left while it sees none. Replace `policy` by what you have trained. With `--watch` the web viewer
shows what happens, 30 steps a second: choose `agent` in its list to look through the agent's eye.

    python examples/18_acting.py [--rooms SCENE ...] [--episodes N] [--picture FILE.png] [--watch]
"""

import argparse
import time
from contextlib import ExitStack
from typing import Any

import cv2
import gymnasium
import numpy as np

import sailenv_ros.gym
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.gym.room_env import RoomEnv
from sailenv_ros.viewer import ViewerServer

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


class Watched:
    """Room of an environment in the web viewer, with what an agent does there."""

    def __init__(self, env: RoomEnv, port: int) -> None:
        self._open, self._port = ExitStack(), port
        self.simulation: Simulation | None = None
        self._next_s = 0.0
        self.show(env)

    def show(self, env: RoomEnv) -> None:
        """Show the present step, a thirtieth of a second after the last one."""
        if self.simulation is None or self.simulation.info.scene != env.room.name:
            self.close()
            self.simulation = self._opened(env)
        self.simulation.set_pose(env.eye_pose)
        for name, pose in env.moved.items():
            self.simulation.move_object(name, pose=pose)
        time.sleep(max(0.0, self._next_s - time.monotonic()))
        self._next_s = time.monotonic() + 1.0 / 30.0

    def close(self) -> None:
        """End the viewer."""
        self._open.close()

    def _opened(self, env: RoomEnv) -> Simulation:
        fov_deg = env.eye.intrinsics.vertical_fov_deg
        lens = CameraIntrinsics(width=480, height=480, vertical_fov_deg=fov_deg)
        agent = AgentSpec(name="agent", intrinsics=lens, following=False, rate_hz=30.0)
        simulation = Simulation(env.room.name, light="plain", agent=agent)
        self._open.enter_context(simulation)
        for thing in env.room.order.own:
            simulation.spawn_object(thing.asset, scale=thing.scale, object_name=thing.name)
            simulation.set_material(thing.name, colour=thing.colour)
        viewer = self._open.enter_context(ViewerServer(simulation, port=self._port))
        print(f"open {viewer.url} in a browser to watch", flush=True)
        return simulation


def main() -> None:
    """Evaluate the agent."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rooms", nargs="*", help="scenes; left out: four of the split test")
    parser.add_argument("--episodes", type=int, default=8)
    parser.add_argument("--picture", help="the last picture is written there")
    parser.add_argument("--watch", action="store_true", help="in the web viewer")
    arguments = parser.parse_args()
    rooms = arguments.rooms or sailenv_ros.gym.room_names(4, split="test")
    env = gymnasium.make(
        "sailenv/Track-v0", rooms=rooms, views=("rgb", "instance"), render_mode="rgb_array"
    )
    room_env = env.unwrapped
    assert isinstance(room_env, RoomEnv)
    watched: Watched | None = None
    for number in range(arguments.episodes):
        observation, info = env.reset(seed=number)
        target = room_env.room.ids[room_env.room.rows["target"]]
        total, over = 0.0, False
        if arguments.watch and watched is None:
            watched = Watched(room_env, 8090)
        while not over:
            if watched is not None:
                watched.show(room_env)
            action = policy(observation["instance"] == target)
            observation, reward, terminated, truncated, info = env.step(action)
            total, over = total + float(reward), terminated or truncated
        print(
            f"{room_env.room.name}: reward {total:.0f}, centred in "
            f"{info['centred_share']:.0%} of the steps"
        )
    if arguments.picture:
        cv2.imwrite(arguments.picture, cv2.cvtColor(observation["rgb"], cv2.COLOR_RGB2BGR))
    if watched is not None:
        watched.close()
    env.close()


if __name__ == "__main__":
    main()
