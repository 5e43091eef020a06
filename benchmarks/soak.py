"""Change scenes, and let agents come and go, for hours; memory and whatever is opened stays flat.

    python benchmarks/soak.py [--minutes M] [--scenes NAME ...]

Every round changes the scene, registers agents, renders, spawns and removes. Prints resident
memory, descriptors, threads and mapped shared memory, and their slope over the second half by
least squares.
Ends with status 1 if memory grows by more than 20 MiB an hour, or if anything else grows.
"""

from __future__ import annotations

import argparse
import os
import sys
import threading
import time
from pathlib import Path

import numpy as np

from sailenv_ros import Simulation
from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics

MOST_MIB_PER_HOUR = 20.0
KINDS = ("memory [MiB]", "descriptors", "threads", "segments")


def main() -> int:
    """Soak; 0 if all stays flat."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=120.0)
    parser.add_argument("--scenes", nargs="+", default=["optical", "object_view"])
    options = parser.parse_args()
    rows: list[tuple[float, ...]] = []
    began = told = time.monotonic()
    rounds = 0
    with Simulation(options.scenes[0], mode="lockstep") as simulation:
        while (now := time.monotonic()) - began < 60.0 * options.minutes:
            _round(simulation, options.scenes[rounds % len(options.scenes)], rounds)
            rounds += 1
            rows.append(((now - began) / 3600.0, *_opened()))
            if now - told > 30.0 or len(rows) == 1:
                told = now
                print(
                    f"{(now - began) / 60:6.1f} min  round {rounds:>5}  {_formatted(rows[-1][1:])}"
                )
    late = np.array(rows[len(rows) // 2 :])
    slopes = [float(np.polyfit(late[:, 0], late[:, 1 + k], 1)[0]) for k in range(len(KINDS))]
    growth = late[-1, 2:] - late[0, 2:]
    print(f"{rounds} rounds; per hour over the second half: {_formatted(slopes)}")
    return int(slopes[0] > MOST_MIB_PER_HOUR or bool((growth > 0).any()))


def _round(simulation: Simulation, scene: str, number: int) -> None:
    simulation.change_scene(scene)
    names = [f"soak_{number}_{k}" for k in range(4)]
    for name in names:
        spec = AgentSpec(name=name, intrinsics=CameraIntrinsics(width=160, height=120), rate_hz=0.0)
        simulation.register_agent(spec)
    things = [
        simulation.spawn_object("cube", (0.3 * k, 0.0, 1.0), remove_dynamics=True) for k in range(4)
    ]
    simulation.step(8)
    for name in names:
        simulation.capture(agent=name)
    for thing in things:
        simulation.despawn_object(thing)
    for name in names:
        simulation.delete_agent(name)


def _opened() -> tuple[float, ...]:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return (
        pages * os.sysconf("SC_PAGE_SIZE") / 2**20,
        float(len(os.listdir("/proc/self/fd"))),
        float(threading.active_count()),
        float(Path("/proc/self/maps").read_text().count("/dev/shm/")),
    )


def _formatted(values: tuple[float, ...] | list[float]) -> str:
    return ", ".join(f"{kind} {value:.1f}" for kind, value in zip(KINDS, values, strict=True))


if __name__ == "__main__":
    sys.exit(main())
