"""Time the SAILenv client's `get_frame()` (main and flow), as the paper's experiment did.

    python benchmarks/sailenv_client_speed.py [--scene NAME] [--frames N] [--size WxH] [--json FILE]

The SAILenv client of PyPI runs in a process of its own against a gateway here, raw and gzip; the
mean of its frames with a 95 % interval stands beside the paper's and beside direct captures, which
are taken in turn with the client's frames, so that what disturbs the machine disturbs all alike.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from sailenv_ros import Simulation
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

PAPER_MS = {
    (240, 180): 40,
    (320, 240): 45,
    (640, 480): 70,
    (800, 600): 95,
    (1024, 768): 115,
    (1280, 960): 175,
}
"""Mean time of a frame in the paper's rooms, on an i9-9900K with a GTX 1080."""

WARM_UP = 5
ROUND = 5
"""Frames of each kind in a row, before the next kind has its turn."""

CLIENT = """
import json, sys, time, types, typing, warnings
if sys.version_info >= (3, 13):
    sys.modules["typing.io"] = types.ModuleType("typing.io")
    sys.modules["typing.io"].BinaryIO = typing.BinaryIO
warnings.simplefilter("ignore", DeprecationWarning)
from sailenv.agent import Agent
port, width, height, use_gzip = map(int, sys.argv[1:])
agent = Agent(depth_frame_active=False, object_frame_active=False, category_frame_active=False,
              host="127.0.0.1", port=port, width=width, height=height, use_gzip=bool(use_gzip))
agent.register()
for line in sys.stdin:
    times = []
    for _ in range(int(line)):
        began = time.perf_counter()
        frame = agent.get_frame()
        times.append(time.perf_counter() - began)
    print(json.dumps({"times": times, "bytes": sum(frame["sizes"].values())}), flush=True)
agent.delete()
"""


class Client:
    """The SAILenv client in a process of its own."""

    def __init__(self, port: int, size: tuple[int, int], *, use_gzip: bool) -> None:
        words = [str(int(word)) for word in (port, *size, use_gzip)]
        self._process = subprocess.Popen(
            [sys.executable, "-c", CLIENT, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.times_s: list[float] = []
        self.bytes = 0

    def take(self, frames: int) -> None:
        """Have some frames timed."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{frames}\n")
        self._process.stdin.flush()
        told = json.loads(self._process.stdout.readline())
        self.times_s += told["times"]
        self.bytes = told["bytes"]

    def close(self) -> None:
        """End the process."""
        self._process.communicate(timeout=30)


def measure(
    simulation: Simulation, port: int, size: tuple[int, int], frames: int
) -> dict[str, Any]:
    """Time the client, raw and gzip, and direct captures at one size."""
    intrinsics = CameraIntrinsics(width=size[0], height=size[1])
    simulation.register_agent(AgentSpec(name="direct", intrinsics=intrinsics, rate_hz=0.0))
    clients = {name: Client(port, size, use_gzip=name == "gzip") for name in ("raw", "gzip")}
    direct_s: list[float] = []
    try:
        for client in clients.values():
            client.take(WARM_UP)
            client.times_s.clear()
        while len(direct_s) < frames:
            count = min(ROUND, frames - len(direct_s))
            for client in clients.values():
                client.take(count)
            for _ in range(count):
                began = time.perf_counter()
                simulation.capture(("rgb", "flow"), agent="direct")
                direct_s.append(time.perf_counter() - began)
    finally:
        for client in clients.values():
            client.close()
        simulation.delete_agent("direct")
    result: dict[str, Any] = {"size": size, "paper_ms": PAPER_MS.get(size)}
    for name, times_s in {"direct": direct_s, **{n: c.times_s for n, c in clients.items()}}.items():
        result[name] = mean_ms(times_s)
    return {**result, "bytes": {name: client.bytes for name, client in clients.items()}}


def mean_ms(times_s: list[float]) -> dict[str, float]:
    """Return the mean, half of its 95 % interval (normal), and the median [ms]."""
    half = 1.96 * statistics.stdev(times_s) / math.sqrt(len(times_s))
    return {
        "mean": 1e3 * statistics.fmean(times_s),
        "half_interval": 1e3 * half,
        "median": 1e3 * statistics.median(times_s),
    }


def show(result: dict[str, Any]) -> None:
    """Print one size's line."""
    width, height = result["size"]
    cells = [
        f"{result[name]['mean']:7.1f} ± {result[name]['half_interval']:5.1f}"
        f" ({result[name]['median']:6.1f})"
        for name in ("direct", "raw", "gzip")
    ]
    sent = " / ".join(f"{count / 1e6:.1f}" for count in result["bytes"].values())
    print(f"{width:5}x{height:<5}", *cells, f"{result['paper_ms'] or '-':>6}  {sent:>12} MB")


def main() -> None:
    """Run the benchmark and print its table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--frames", type=int, default=100, help="timed frames of each kind")
    parser.add_argument("--size", action="append", help="WIDTHxHEIGHT; may be given repeatedly")
    parser.add_argument("--json", type=Path, help="write the results here too")
    options = parser.parse_args()
    sizes = [(int(w), int(h)) for w, _, h in (s.partition("x") for s in options.size or ())]
    sizes = sizes or list(PAPER_MS)
    results = []
    with (
        Simulation(options.scene) as simulation,
        GatewayServer(simulation, port=0) as gateway,
    ):
        print(f"{options.scene}, main + flow, mean ± 95 % interval (median) [ms]")
        print(f"{'':11} {'direct capture':>24} {'client, raw':>24} {'client, gzip':>24}  paper")
        for size in sizes:
            results.append(measure(simulation, gateway.port, size, options.frames))
            show(results[-1])
        print(f"{simulation.info.renderer}; {platform.processor() or platform.machine()}, ", end="")
        print(f"{os.cpu_count()} CPUs, Python {platform.python_version()}; load {os.getloadavg()}")
    if options.json:
        options.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
