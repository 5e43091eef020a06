"""Steps per second of environments, beside `Simulation` and other renderers; bytes; memory.

    python -m benchmarks.gym_speed speed [--steps N] [--rooms N] [--envs N] [--processes N]
    python -m benchmarks.gym_speed bytes [--steps N]      equal in two processes and with 2 workers
    python -m benchmarks.gym_speed memory [--steps N]     of further environments, over many steps

Random actions of `sailenv/PointNav-v0` in generated rooms with plain light, each step with a look.
Steps per second are those of the wall clock and of all processes together; the processor time of a
step counts all processes, and two cores for it give the last column, whatever else the machine did.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import sailenv_ros.gym
from sailenv_bench.experiments.baselines import BASELINES
from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, Simulation
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.picture_settings import PictureSettings

TASK = "sailenv/PointNav-v0"
ANNOTATIONS, ALL = ("depth", "category", "instance"), ("rgb", "depth", "instance")
CASES = (
    ("84×84, depth and ids", 84, ANNOTATIONS, False, 600),
    ("84×84, picture, depth, ids", 84, ALL, False, 300),
    ("84×84, picture with smooth edges, depth, ids", 84, ALL, True, 150),
    ("224×224, picture, depth, ids", 224, ALL, False, 80),
    ("224×224, picture with smooth edges, depth, ids", 224, ALL, True, None),
)
"""Name, side [px], views, smooth edges, steps per second that are aimed at."""

TICKS = os.sysconf("SC_CLK_TCK")


def processor_s(pids: tuple[int, ...]) -> float:
    """Return the processor time of some processes so far [s]."""
    total = 0.0
    for pid in pids:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        total += (int(fields[11]) + int(fields[12])) / TICKS
    return total


def settings_of(side: int, views: tuple[str, ...], smooth: bool, rooms: int) -> dict[str, Any]:
    """Return the settings of environments."""
    picture = PictureSettings(smooth_edges=smooth)
    return {"width": side, "height": side, "views": views, "picture": picture, "rooms": rooms}


def measure_environments(arguments: argparse.Namespace) -> None:
    """Print a line for each case."""
    for name, side, views, smooth, goal in CASES:
        env = gymnasium.make_vec(
            TASK,
            arguments.envs,
            processes=arguments.processes,
            **settings_of(side, views, smooth, arguments.rooms),
        )
        own: tuple[int, ...] = getattr(env, "pids", ())
        pids = (os.getpid(), *own)
        random = np.random.default_rng(0)
        # Each room once, so that none is opened while it is measured.
        for room in sailenv_ros.gym.room_names(arguments.rooms):
            env.reset(seed=0, options={"room": room})
        actions = random.integers(1, 4, (arguments.steps // arguments.envs, arguments.envs))
        for some in actions[:20]:
            env.step(some)
        began, used = time.perf_counter(), processor_s(pids)
        for some in actions:
            env.step(some)
        wall = time.perf_counter() - began
        cpu = processor_s(pids) - used
        env.close()
        report(name, actions.size, wall, cpu, goal)


def measure_simulation(arguments: argparse.Namespace) -> None:
    """Print the same for `Simulation`, in one of the rooms."""
    room = sailenv_ros.gym.room_names(1)[0]
    for name, side, views, smooth, _ in CASES:
        lens = CameraIntrinsics(width=side, height=side, vertical_fov_deg=75.0)
        picture = PictureSettings(smooth_edges=smooth)
        agent = AgentSpec(
            name="eye", intrinsics=lens, picture=picture, following=False, rate_hz=0.0
        )
        with Simulation(
            room, mode="lockstep", light="plain", backend="native", agent=agent
        ) as simulation:
            place = start_of(simulation)
            count = arguments.steps // 4

            def run(
                steps: int,
                simulation: Simulation = simulation,
                place: tuple[float, float, float] = place,
                views: tuple[str, ...] = views,
            ) -> None:
                for number in range(steps):
                    turned = Pose.from_rpy_deg((*place[:2], 1.2), (0.0, 0.0, 15.0 * number))
                    simulation.set_pose(turned)
                    simulation.step(8)
                    simulation.capture(views)

            run(20)
            began, used = time.perf_counter(), time.process_time()
            run(count)
            wall, cpu = time.perf_counter() - began, time.process_time() - used
        report(f"Simulation, {name}", count, wall, cpu, None)


def start_of(simulation: Simulation) -> tuple[float, float, float]:
    """Return a place from which all loops look around [m]."""
    return simulation.random_pose("start", height_m=1.3, radius_m=0.2).position_m


def measure_others(arguments: argparse.Namespace) -> None:
    """Print the same for renderers of PyBullet and MuJoCo: picture, depth, ids; no physics."""
    room = sailenv_ros.gym.room_names(1)[0]
    world = SceneLibrary().build(room)
    snapshot = world.snapshot()
    with Simulation(room, mode="lockstep", light="plain", backend="native") as simulation:
        x_m, y_m, _ = start_of(simulation)
    for side in (84, 224):
        lens = CameraIntrinsics(width=side, height=side, vertical_fov_deg=75.0)
        for name in ("sailenv_ros", "PyBullet TinyRenderer", "MuJoCo"):
            picture = BASELINES[name][1]()
            count = max(20, arguments.steps // 40)
            began = used = 0.0
            for number in range(-3, count):
                if number == 0:
                    began, used = time.perf_counter(), time.process_time()
                pose = Pose.from_rpy_deg((x_m, y_m, 1.2), (0.0, 0.0, 15.0 * number))
                picture.prepare(snapshot, Camera(intrinsics=lens, pose=pose))
                picture.draw()
            wall, cpu = time.perf_counter() - began, time.process_time() - used
            picture.close()
            report(f"renderer alone, {name}, {side}×{side}", count, wall, cpu, None)
    world.close()


def report(name: str, steps: int, wall: float, cpu: float, goal: int | None) -> None:
    """Print a line."""
    aim = "" if goal is None else f"   (aim: {goal})"
    print(
        f"{name:60s} {steps / wall:7.0f} steps/s  {1e3 * cpu / steps:6.2f} ms processor time"
        f"  {2.0 * steps / cpu:7.0f} steps/s of two cores{aim}",
        flush=True,
    )


def digest_of(arguments: argparse.Namespace) -> None:
    """Print a digest of all observations, rewards and figures."""
    env = gymnasium.make_vec(
        TASK, 4, processes=arguments.processes, **settings_of(48, ALL, False, arguments.rooms)
    )
    digest = hashlib.blake2b(digest_size=16)
    random = np.random.default_rng(0)
    observation, info = env.reset(seed=11)
    for _ in range(arguments.steps // 4):
        for _, value in sorted({**observation, **info}.items()):
            digest.update(np.asarray(value).tobytes())
        observation, reward, over, cut, info = env.step(random.integers(0, 4, 4))
        digest.update(reward.tobytes() + over.tobytes() + cut.tobytes())
    env.close()
    print(digest.hexdigest())


def compare_bytes(arguments: argparse.Namespace) -> None:
    """Print the digests of two processes and of two numbers of workers."""
    found = []
    for processes in (1, 1, 2):
        command = [sys.executable, "-m", "benchmarks.gym_speed", "digest"]
        command += ["--steps", str(arguments.steps), "--rooms", str(arguments.rooms)]
        command += ["--processes", str(processes)]
        found.append(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        print(f"{processes} process(es): {found[-1].strip()}", flush=True)
    print("equal" if len(set(found)) == 1 else "NOT EQUAL")


def resident_mb() -> float:
    """Return the memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def measure_memory(arguments: argparse.Namespace) -> None:
    """Print what further environments take, and what many steps add."""
    rooms = sailenv_ros.gym.room_names(6)
    envs = []
    for number, room in enumerate((rooms[0], rooms[0], rooms[0], *rooms[1:])):
        before = resident_mb()
        env = gymnasium.make(TASK, **settings_of(84, ALL, False, 1) | {"rooms": [room]})
        env.reset(seed=number)
        for _ in range(20):
            env.step(2)
        envs.append(env)
        print(f"environment {number + 1}, {room}: {resident_mb() - before:+.0f} MB", flush=True)
    for env in envs:
        env.close()
    env = gymnasium.make("sailenv/Track-v0", **settings_of(16, ("depth",), False, 1))
    env.reset(seed=0)
    begun = math.nan
    for number in range(arguments.steps):
        _, _, over, cut, _ = env.step(number % 5)
        if over or cut:
            env.reset()
        if number == arguments.steps // 10:
            begun = resident_mb()
    grown = 100.0 * (resident_mb() / begun - 1.0)
    print(f"after {arguments.steps // 10} steps {begun:.0f} MB, after all {grown:+.1f} %")
    env.close()


def main() -> None:
    """Measure what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("speed", "bytes", "digest", "memory"))
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--rooms", type=int, default=2)
    parser.add_argument("--envs", type=int, default=8)
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    if arguments.what == "speed":
        measure_environments(arguments)
        measure_simulation(arguments)
        measure_others(arguments)
    else:
        {"bytes": compare_bytes, "digest": digest_of, "memory": measure_memory}[arguments.what](
            arguments
        )


if __name__ == "__main__":
    main()
