"""Change scenes, and let agents come and go, for hours; memory and whatever is opened stays flat.

    python benchmarks/soak.py [--minutes M] [--pause S] [--node] [--scenes NAME ...]
    python benchmarks/soak.py --rooms 0 50      # each generated room once, the first scene between

Every round changes the scene, registers agents, renders, spawns and removes: in this process, or
with `--node` in a node of its own, through ROS, beside a SAILenv client and a page that come and
go. Prints once a minute resident memory, its part that is not of files, descriptors, threads and
mapped shared memory of the process that simulates: means of the rounds of that minute in the first
scene. Ends with status 1 if after 20 minutes, or half of a shorter run, memory of its own rises by
more than 3 % in any minute above that of the first one, or anything else grows; with `--rooms` if
memory grows by more than 1 MiB a room over the second half, by least squares.
"""

from __future__ import annotations

import argparse
import asyncio
import itertools
import os
import socket
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import aiohttp
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from sailenv_ros import Agent, Simulation
from sailenv_ros.authoring.room_rules.names import drawn_kind
from sailenv_ros.authoring.room_rules.rule_files import rules_of
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

MOST_RISE, MOST_MIB_PER_ROOM = 0.03, 1.0
SETTLED_MIN = 20.0
KINDS = ("memory [MiB]", "own memory [MiB]", "descriptors", "threads", "segments")


Round = Callable[[str, int], None]
"""Action in a scene, in the round of that number."""


def main() -> int:
    """Soak; 0 if all stays flat."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=120.0)
    parser.add_argument("--pause", type=float, default=0.0, help="between two rounds [s]")
    parser.add_argument("--node", action="store_true", help="in a node, by way of ROS")
    parser.add_argument("--scenes", nargs="+", default=["optical", "object_view"])
    parser.add_argument("--rooms", nargs=2, type=int, metavar=("FIRST", "END"), help="seeds")
    options = parser.parse_args()
    scenes = _with_rooms(options.scenes[0], range(*options.rooms)) if options.rooms else None
    endless = itertools.cycle(options.scenes) if scenes is None else iter(scenes)
    rows: list[tuple[float, ...]] = []
    told = 0
    began = time.monotonic()
    with (_node if options.node else _in_process)(options.scenes[0]) as (pid, work):
        for rounds, scene in enumerate(endless):
            minutes = (time.monotonic() - began) / 60.0
            if minutes >= options.minutes:
                break
            if scenes is None and int(minutes) > told:
                told = int(minutes)
                _tell(told, rounds, _of_minute(rows, told - 1))
            work(scene, rounds)
            opened = _opened(pid)
            # Scenes differ in size, so each row is of the same one.
            if scene == options.scenes[0]:
                rows.append((minutes if scenes is None else rounds / 2.0, *opened))
            if scenes is not None:
                _tell(minutes, rounds, opened, scene)
            time.sleep(options.pause)
    print(f"{rounds + 1} rounds")
    return _judge_rooms(rows) if scenes is not None else _judge_minutes(rows, options.minutes)


def _tell(minutes: float, rounds: int, opened: Sequence[float], scene: str = "") -> None:
    print(f"{minutes:6.1f} min  round {rounds:>5}  {scene} {_formatted(opened)}", flush=True)


def _of_minute(rows: list[tuple[float, ...]], minute: int) -> list[float]:
    """Return the means of a minute; of the row before where a round took longer."""
    within = [row for row in rows if int(row[0]) == minute] or rows[-1:]
    return [float(mean) for mean in np.mean([row[1:] for row in within], axis=0)]


def _judge_rooms(rows: list[tuple[float, ...]]) -> int:
    late = np.array(rows[len(rows) // 2 :])
    slopes = [float(np.polyfit(late[:, 0], late[:, 1 + k], 1)[0]) for k in range(len(KINDS))]
    print(f"per room over the second half: {_formatted(slopes)}")
    return int(slopes[0] > MOST_MIB_PER_ROOM or bool((late[-1, 3:] > late[0, 3:]).any()))


def _judge_minutes(rows: list[tuple[float, ...]], minutes: float) -> int:
    first = int(min(SETTLED_MIN, minutes / 2.0))
    late = np.array([_of_minute(rows, n) for n in range(first, max(first + 1, int(minutes)))])
    own = late[:, 1]
    rise, grown = float(own.max() / own[0] - 1.0), late[-1, 2:] > late[0, 2:] + 1.0
    least, most = own.min(), own.max()
    print(
        f"from minute {first}: own memory {least:.1f} to {most:.1f} MiB, at most {rise:+.1%} "
        f"above the first; grown: {', '.join(np.array(KINDS[2:])[grown]) or 'nothing else'}"
    )
    return int(rise > MOST_RISE or bool(grown.any()))


def _with_rooms(first: str, seeds: range) -> list[str]:
    """Return the generated rooms of seeds, each between two rounds of the first scene."""
    rules = rules_of()
    rooms = (f"generated:{drawn_kind(seed, rules)}:{seed}" for seed in seeds)
    return [first, *(scene for room in rooms for scene in (room, first))]


@contextmanager
def _in_process(scene: str) -> Iterator[tuple[int, Round]]:
    with Simulation(scene, mode="lockstep") as simulation:
        yield os.getpid(), lambda scene, number: _simulate(simulation, scene, number)


def _simulate(simulation: Simulation, scene: str, number: int) -> None:
    simulation.change_scene.submit(scene).result()  # a busy machine may need long for an apartment
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
    status = dict(
        line.split(":", 1) for line in (process / "status").read_text().splitlines() if ":" in line
    )
    return (
        *(int(status[key].split()[0]) / 1024.0 for key in ("VmRSS", "RssAnon")),
        float(len(os.listdir(process / "fd"))),
        float(len(os.listdir(process / "task"))),
        float((process / "maps").read_text().count("/dev/shm/")),
    )


def _formatted(values: Sequence[float]) -> str:
    return ", ".join(f"{kind} {value:.1f}" for kind, value in zip(KINDS, values, strict=True))


if __name__ == "__main__":
    sys.exit(main())
