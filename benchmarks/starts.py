"""Time from the start of a Python process to its first frame of five views.

    python benchmarks/starts.py [--rounds N] [--scene NAME]

Once with a `Simulation` in that process, once with an `Agent` that starts its own simulator, in
turn. Furniture and light must have been built. `first_start.py` times a fresh clone instead.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from sailenv_bench.suite.measurement import Measurement

PROGRAMS = {
    "Simulation": (
        "from sailenv_ros import Simulation\n"
        "from sailenv_ros.types.agents import AgentSpec\n"
        "eye = AgentSpec(name='eye')\n"
        "with Simulation({scene!r}, mode='lockstep', agent=eye) as simulation:\n"
        "    simulation.capture()"
    ),
    "Agent": (
        "from sailenv_ros import Agent\n"
        "with Agent(simulator={{'scene': {scene!r}, 'gateway.port': 0}},\n"
        "           timeout_s=120.0, start_timeout_s=120.0,\n"
        "           namespace='/bench_{pid}') as agent: agent.get_frame()"
    ),
}


def starts_s(scene: str, rounds: int) -> dict[str, float]:
    """Return the median wall time of each program [s], its end included."""
    times: dict[str, list[float]] = {name: [] for name in PROGRAMS}
    for _ in range(rounds):
        for name, program in PROGRAMS.items():
            code = program.format(scene=scene, pid=os.getpid())
            began = time.perf_counter()
            subprocess.run([sys.executable, "-c", code], check=True)
            times[name].append(time.perf_counter() - began)
    return {name: statistics.median(values) for name, values in times.items()}


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    for scene in ("room_01",) if quick else ("room_01", "optical"):
        taken = starts_s(scene, 1 if quick else 3)
        yield Measurement(
            name=f"{scene}, `Agent` with a simulator of its own",
            value=taken["Agent"],
            unit="s",
            other="`Simulation`",
            other_value=taken["Simulation"],
        )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--scene", default="room_01")
    args = parser.parse_args()
    for name, seconds in starts_s(args.scene, args.rounds).items():
        print(f"{args.scene}, {name}: {seconds:.2f} s")


if __name__ == "__main__":
    main()
