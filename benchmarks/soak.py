"""Change scenes, and let agents come and go, for hours; memory and whatever is opened stays flat.

    python benchmarks/soak.py [--minutes M] [--pause S] [--node] [--scenes NAME ...]

Every round changes the scene, registers agents, renders, spawns and removes: in this process, or
with `--node` in a node of its own, through ROS, beside a SAILenv client and a page that come and
go. Prints resident memory, descriptors, threads and mapped shared memory of the process that
simulates after each round in the first scene, and their slope over the second half by least
squares.
Ends with status 1 if memory grows by more than 20 MiB an hour, or if anything else grows.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import aiohttp
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from sailenv_ros import Agent, Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

MOST_MIB_PER_HOUR = 20.0
KINDS = ("memory [MiB]", "descriptors", "threads", "segments")


Round = Callable[[str, int], None]
"""Action in a scene, in the round of that number."""


def main() -> int:
    """Soak; 0 if all stays flat."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=120.0)
    parser.add_argument("--pause", type=float, default=0.0, help="between two rounds [s]")
    parser.add_argument("--node", action="store_true", help="in a node, by way of ROS")
    parser.add_argument("--scenes", nargs="+", default=["optical", "object_view"])
    options = parser.parse_args()
    rows: list[tuple[float, ...]] = []
    began = told = time.monotonic()
    rounds = 0
    with (_node if options.node else _in_process)(options.scenes[0]) as (pid, work):
        while (now := time.monotonic()) - began < 60.0 * options.minutes:
            work(options.scenes[rounds % len(options.scenes)], rounds)
            rounds += 1
            # Scenes differ in size, so each row is of the same one.
            if rounds % len(options.scenes) == 1 or len(options.scenes) == 1:
                rows.append(((now - began) / 3600.0, *_opened(pid)))
                if now - told > 30.0 or len(rows) == 1:
                    told = now
                    minutes = (now - began) / 60
                    print(f"{minutes:6.1f} min  round {rounds:>5}  {_formatted(rows[-1][1:])}")
            time.sleep(options.pause)
    late = np.array(rows[len(rows) // 2 :])
    slopes = [float(np.polyfit(late[:, 0], late[:, 1 + k], 1)[0]) for k in range(len(KINDS))]
    growth = late[-1, 2:] - late[0, 2:]
    print(f"{rounds} rounds; per hour over the second half: {_formatted(slopes)}")
    return int(slopes[0] > MOST_MIB_PER_HOUR or bool((growth > 0).any()))


@contextmanager
def _in_process(scene: str) -> Iterator[tuple[int, Round]]:
    with Simulation(scene, mode="lockstep") as simulation:
        yield os.getpid(), lambda scene, number: _simulate(simulation, scene, number)


def _simulate(simulation: Simulation, scene: str, number: int) -> None:
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


@contextmanager
def _node(scene: str) -> Iterator[tuple[int, Round]]:
    from tests.support.sailenv_client import original_client
    from tests.support.sim_node_process import NodeProcess

    ports = _free_port(), _free_port()
    namespace = f"/soak_{os.getpid()}"
    parameters: dict[str, Any] = {"gateway__port": ports[0], "viewer__port": ports[1]}
    with NodeProcess(namespace, scene=scene, **parameters) as node:

        def work(scene: str, number: int) -> None:
            small: dict[str, Any] = {
                "width": 160,
                "height": 120,
                "namespace": namespace,
                "timeout_s": 60.0,
            }
            with Agent(**small) as agent, Agent(**small) as other:
                agent.change_scene(scene)
                name = agent.spawn_object("cube", (0.0, 0.0, 1.0))
                agent.get_frame()
                next(other.frames(10.0))
                asyncio.run(_look(ports[1]))
                with original_client(ports[0], width=160, height=120) as client:
                    client.get_frame()
                agent.despawn_object(name)

        yield node.pid, work


async def _look(port: int) -> None:
    """Open the page's socket, as a browser does, until a frame has come."""
    page = f"http://127.0.0.1:{port}"
    headers = {"Origin": page}
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(f"{page}/socket", headers=headers) as watching,
    ):
        await watching.send_json({"do": "watch", "id": 1, "agent": "debug_agent", "views": ["rgb"]})
        async with asyncio.timeout(60.0):
            while (await watching.receive()).type != aiohttp.WSMsgType.BINARY:
                pass


def _free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def _opened(pid: int) -> tuple[float, ...]:
    process = Path(f"/proc/{pid}")
    pages = int((process / "statm").read_text().split()[1])
    return (
        pages * os.sysconf("SC_PAGE_SIZE") / 2**20,
        float(len(os.listdir(process / "fd"))),
        float(len(os.listdir(process / "task"))),
        float((process / "maps").read_text().count("/dev/shm/")),
    )


def _formatted(values: tuple[float, ...] | list[float]) -> str:
    return ", ".join(f"{kind} {value:.1f}" for kind, value in zip(KINDS, values, strict=True))


if __name__ == "__main__":
    sys.exit(main())
