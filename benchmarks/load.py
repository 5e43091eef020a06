"""Cost of stalled, idle and working clients for others: frames per second beside them.

    python benchmarks/load.py [--seconds S] [--rounds N] [--agents N] [--peers N] [--pages N]
                              [--begun N] [--realtime HZ]

Agents stream in process all the time: as fast as the machine can, in lockstep, or with `--realtime`
so many frames a second each, in real time. In each round they do so alone, then beside stalled
clients, then beside clients half of which are stalled, then in a storm of `--begun` connections to
each server that send one byte of a request. The clients are a process of their own:

- peers at the gateway: all connect, as many as fit register (16 agents are the most). A stalled one
  asks for frames and never reads, a working one reads `--peer-hz` frames a second.
- pages at the window that watch the first agent. Stalled ones never say that they have shown a
  frame; half of them do not read either. Working ones show all that they are sent.

Prints the medians of the frame rate and of the processor time per frame of this process, and their
ratios to those alone. The second does not depend on what else the machine does. The aim is 0.95 of
the rate beside stalled clients.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import logging
import os
import resource
import socket
import statistics
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

import aiohttp

from sailenv_ros import Simulation
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.types.agents import MAX_AGENTS, AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import FIVE_VIEWS
from sailenv_ros.viewer import ViewerServer
from sailenv_ros.viewer.viewer_limits import ViewerLimits

FRAME = b"\0\x3d"
"""The command for a frame with five views."""

SIZE = (160, 120)

SWITCH_INTERVAL_S = 0.0005
"""As in `sailenv_ros/ros/nodes/sim_node.py`, which this stands for [s]."""

SETTLE_S = 2.0
"""Until the buffers of those who do not read are full [s]."""

STALLED, HALF_STALLED, STORM = KINDS = "stalled", "half stalled", "one byte"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--agents", type=int, default=8)
    parser.add_argument("--peers", type=int, default=64)
    parser.add_argument("--pages", type=int, default=20)
    parser.add_argument("--peer-hz", type=float, default=5.0)
    parser.add_argument("--realtime", type=float, default=0.0, metavar="HZ")
    parser.add_argument("--clients-of", nargs=2, type=int, help=argparse.SUPPRESS)
    parser.add_argument("--begun", type=int, default=1100)
    parser.add_argument("--kind", choices=KINDS, default=STALLED, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.clients_of:
        asyncio.run(_Clients(options).live(*options.clients_of))
    else:
        _measure(options)


# -- the simulator -------------------------------------------------------------------------


@dataclass
class _Rate:
    frames_per_s: list[float] = field(default_factory=list)
    cpu_ms_per_frame: list[float] = field(default_factory=list)
    simulated_s_per_s: list[float] = field(default_factory=list)


def _measure(options: argparse.Namespace) -> None:
    logging.disable(logging.WARNING)
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    rates = {what: _Rate() for what in ("alone", *KINDS)}
    with (
        Simulation("optical", mode="realtime" if options.realtime else "lockstep") as simulation,
        GatewayServer(simulation, port=0) as gateway,
        ViewerServer(simulation, port=0, limits=ViewerLimits(clients=options.pages)) as viewer,
    ):
        names = [f"load_{number}" for number in range(options.agents)]
        lens = CameraIntrinsics(width=SIZE[0], height=SIZE[1])
        for name in names:
            simulation.register_agent(
                AgentSpec(name=name, intrinsics=lens, rate_hz=options.realtime)
            )
        _run(simulation, names, 1.0)
        ports = (gateway.port, viewer.port)
        for _ in range(options.rounds):
            _run(simulation, names, options.seconds, rates["alone"])
            for what in KINDS:
                with _clients(options, ports, what):
                    _run(simulation, names, SETTLE_S)
                    _run(simulation, names, options.seconds, rates[what])
    _print(options, rates)


def _run(
    simulation: Simulation, names: list[str], seconds: float, rate: _Rate | None = None
) -> None:
    """Have frames made for so long; take the rates down."""
    realtime = simulation.info.mode == "realtime"
    cpu = time.process_time()
    count, took_s, simulated_s = (_stream if realtime else _step)(simulation, names, seconds)
    if rate is not None:
        rate.frames_per_s.append(count / took_s)
        rate.cpu_ms_per_frame.append(1e3 * (time.process_time() - cpu) / count)
        rate.simulated_s_per_s.append(simulated_s / took_s)


def _step(simulation: Simulation, names: list[str], seconds: float) -> tuple[int, float, float]:
    """Step and capture as fast as it goes; return frames, time taken and simulated time [s]."""
    began, count = time.monotonic(), 0
    began_ns = now_ns = simulation.step(1)
    while time.monotonic() - began < seconds:
        now_ns = simulation.step(8)
        for name in names:
            simulation.capture(agent=name)
            count += 1
    return count, time.monotonic() - began, (now_ns - began_ns) * 1e-9


def _stream(simulation: Simulation, names: list[str], seconds: float) -> tuple[int, float, float]:
    """Let frames be made at their rate, and count them by their numbers."""
    with contextlib.ExitStack() as opened:
        streams = [opened.enter_context(simulation.stream(name, FIVE_VIEWS)) for name in names]
        first, began = [stream.get(10.0) for stream in streams], time.monotonic()
        time.sleep(seconds)
        last, took_s = [stream.get(10.0) for stream in streams], time.monotonic() - began
    count = sum(end.sequence - start.sequence for start, end in zip(first, last, strict=True))
    return count, took_s, (last[0].stamp_ns - first[0].stamp_ns) * 1e-9


def _print(options: argparse.Namespace, rates: dict[str, _Rate]) -> None:
    print(f"{options.agents} agents, {options.peers} peers, {options.pages} pages")
    speed, cost = (
        statistics.median(rates["alone"].frames_per_s),
        statistics.median(rates["alone"].cpu_ms_per_frame),
    )
    for what, rate in rates.items():
        now, ms = statistics.median(rate.frames_per_s), statistics.median(rate.cpu_ms_per_frame)
        print(
            f"{what:<13} {now:6.1f} frames/s, ratio {now / speed:.3f}; "
            f"{ms:5.2f} ms of processor time per frame, ratio {ms / cost:.3f}; "
            f"{statistics.median(rate.simulated_s_per_s):.3f} s simulated per second"
        )


@contextlib.contextmanager
def _clients(options: argparse.Namespace, ports: tuple[int, int], kind: str) -> Iterator[None]:
    """Have the clients there, in another process, until the end of the block."""
    command = [sys.executable, __file__, "--clients-of", *map(str, ports)]
    for name in ("agents", "peers", "pages", "peer_hz", "begun"):
        command += [f"--{name.replace('_', '-')}", str(getattr(options, name))]
    command += ["--kind", kind]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=os.environ
    ) as clients:
        assert clients.stdout is not None
        assert clients.stdin is not None
        try:
            assert clients.stdout.readline() == b"there\n"
            yield
        finally:
            clients.stdin.close()
            clients.wait(20.0)


# -- the clients ---------------------------------------------------------------------------


class _Clients:
    """All clients, in one event loop."""

    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._tasks: list[asyncio.Task[None]] = []

    async def live(self, gateway: int, viewer: int) -> None:
        """Connect all, say so, and live until standard input ends."""
        options = self._options
        with contextlib.ExitStack() as sockets:
            if options.kind == STORM:
                hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
                resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
                for port in (gateway, viewer) * options.begun:
                    peer = sockets.enter_context(socket.create_connection(("127.0.0.1", port), 5.0))
                    peer.sendall(b"G")
                print("there", flush=True)
                await asyncio.to_thread(sys.stdin.read)
                return
            async with aiohttp.ClientSession() as session:
                for number in range(options.peers):
                    await self._peer(gateway, number, sockets)
                for number in range(options.pages):
                    await self._page(viewer, number, session)
                print("there", flush=True)
                await asyncio.to_thread(sys.stdin.read)
                for task in self._tasks:
                    task.cancel()

    async def _peer(self, port: int, number: int, sockets: contextlib.ExitStack) -> None:
        peer = sockets.enter_context(socket.create_connection(("127.0.0.1", port), 5.0))
        if number >= MAX_AGENTS - self._options.agents:
            return  # it would be refused
        peer.sendall(struct.pack("<iiB", *SIZE, 0))
        peer.recv(2**16)
        if self._options.kind == HALF_STALLED and number % 2:
            self._tasks.append(asyncio.create_task(asyncio.to_thread(self._ask, peer)))
        else:
            peer.sendall(FRAME * 20)

    def _ask(self, peer: socket.socket) -> None:
        """Ask for a frame and read it, again and again."""
        with contextlib.suppress(OSError):
            while True:
                due = time.monotonic() + 1.0 / self._options.peer_hz
                peer.sendall(FRAME)
                for _ in range(5):
                    (left,) = struct.unpack("<i", _received(peer, 4))
                    _received(peer, left)
                _received(peer, 4)
                time.sleep(max(0.0, due - time.monotonic()))

    async def _page(self, port: int, number: int, session: aiohttp.ClientSession) -> None:
        address = f"http://127.0.0.1:{port}"
        page = await session.ws_connect(f"{address}/socket", headers={"Origin": address})
        watch = {"do": "watch", "id": 1, "agent": "load_0", "views": ["rgb", "depth", "flow"]}
        await page.send_json(watch)
        works = self._options.kind == HALF_STALLED and number % 2 == 1
        if works or number % 4 == 0:
            self._tasks.append(asyncio.create_task(_look(page, shows=works)))


async def _look(page: aiohttp.ClientWebSocketResponse, *, shows: bool) -> None:
    async for message in page:
        if shows and message.type == aiohttp.WSMsgType.BINARY:
            size = int.from_bytes(message.data[:4], "little")
            number = json.loads(message.data[4 : 4 + size])["number"]
            await page.send_json({"do": "shown", "number": number})


def _received(peer: socket.socket, size: int) -> bytes:
    data = bytearray()
    while len(data) < size:
        piece = peer.recv(size - len(data))
        if not piece:
            raise ConnectionResetError
        data += piece
    return bytes(data)


if __name__ == "__main__":
    main()
