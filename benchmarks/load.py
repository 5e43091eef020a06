"""How much stalled and idle peers cost those who work: frames per second with and without them.

    python benchmarks/load.py [--seconds S] [--rounds N] [--agents N] [--peers N] [--pages N]

Agents stream in process all the time. Alone and loaded take turns: loaded means as many peers at
the gateway as it takes, half of which ask for frames and never read, half of which say nothing; and
pages at the window that never read. Prints medians and their ratio; the aim is 0.95.
"""

from __future__ import annotations

import argparse
import contextlib
import socket
import statistics
import struct
import time
from collections.abc import Iterator

from sailenv_ros import Simulation
from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.viewer import ViewerServer

FRAME = b"\0\x3d"
"""The command for a frame with five views."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--agents", type=int, default=8)
    parser.add_argument("--peers", type=int, default=64)
    parser.add_argument("--pages", type=int, default=20)
    options = parser.parse_args()
    alone, loaded = [], []
    with (
        Simulation("optical", mode="lockstep") as simulation,
        GatewayServer(simulation, port=0) as gateway,
        ViewerServer(simulation, port=0) as viewer,
    ):
        names = [f"load_{number}" for number in range(options.agents)]
        for name in names:
            spec = AgentSpec(
                name=name, intrinsics=CameraIntrinsics(width=160, height=120), rate_hz=0.0
            )
            simulation.register_agent(spec)
        _rate(simulation, names, 1.0)
        for _ in range(options.rounds):
            alone.append(_rate(simulation, names, options.seconds))
            with _peers(gateway.port, options.peers), _pages(viewer.port, options.pages):
                time.sleep(1.0)
                loaded.append(_rate(simulation, names, options.seconds))
    one, other = statistics.median(alone), statistics.median(loaded)
    print(
        f"{options.agents} agents: {one:.1f} frames/s alone, {other:.1f} beside {options.peers} "
        f"peers and {options.pages} pages that do not read: {other / one:.3f}"
    )


def _rate(simulation: Simulation, names: list[str], seconds: float) -> float:
    began, count = time.monotonic(), 0
    while time.monotonic() - began < seconds:
        simulation.step(8)
        for name in names:
            simulation.capture(agent=name)
            count += 1
    return count / (time.monotonic() - began)


@contextlib.contextmanager
def _peers(port: int, count: int) -> Iterator[None]:
    with contextlib.ExitStack() as stack:
        for number in range(count):
            peer = stack.enter_context(socket.create_connection(("127.0.0.1", port), 5.0))
            peer.setblocking(False)
            if number % 2:
                with contextlib.suppress(OSError):  # it takes no more
                    peer.sendall(struct.pack("<iiB", 160, 120, 0) + FRAME * 20)
        yield


@contextlib.contextmanager
def _pages(port: int, count: int) -> Iterator[None]:
    key = "GET /socket HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nOrigin: http://127.0.0.1:{0}\r\n"
    key += "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    key += "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    with contextlib.ExitStack() as stack:
        for _ in range(count):
            page = stack.enter_context(socket.create_connection(("127.0.0.1", port), 5.0))
            page.sendall(key.format(port).encode())
        yield


if __name__ == "__main__":
    main()
