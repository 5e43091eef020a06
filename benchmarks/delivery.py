"""Time the delivery of frames to an `Agent`, beside the ways that would be faster.

    python benchmarks/delivery.py [--frames N] [--seconds S] [--size WxH] [--scene NAME]

What `get_frame()` costs above the rendering that the frame itself tells of (least, median, 90th and
99th percentile; through shared memory, and by topics), how many frames of a 30 Hz stream are lost
in a minute and how late they come, and for comparison the same frame without any transport (a
`Simulation` in this process) and the copy alone.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing.shared_memory
import os
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros import Agent, Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

NAMESPACE = f"/delivery_{os.getpid()}"
STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""

WARM_UP = 10


def percentiles(times_s: Iterable[float]) -> dict[str, float]:
    """Return the least, median, 90th and 99th percentile [ms]."""
    values = 1e3 * np.asarray(list(times_s))
    p50, p90, p99 = np.percentile(values, (50, 90, 99))
    return {"least": values.min(), "p50": p50, "p90": p90, "p99": p99}


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Do something; return how long it took [s], and its result."""
    began = time.perf_counter()
    result = work()
    return time.perf_counter() - began, result


def on_request(size: tuple[int, int], frames: int, scene: str) -> dict[str, dict[str, float]]:
    """Time frames on request above their rendering: by an Agent, in process, the copy alone."""
    width, height = size
    names = ("Agent.get_frame", "by topics", "in process", "one copy")
    times: dict[str, list[float]] = {name: [] for name in names}
    lockstep = {"scene": scene, "mode": "lockstep", "agent.name": ""}
    with (
        Simulation(scene, mode="lockstep") as simulation,
        Agent(width=width, height=height, namespace=NAMESPACE, simulator=lockstep) as agent,
        Agent(width=width, height=height, namespace=NAMESPACE) as other,
    ):
        agents = {"by topics": other, "Agent.get_frame": agent}
        for one in agents.values():
            os.environ["SAILENV_DIRECT_FRAMES"] = str(int(one is agent))  # read at the second frame
            one.get_frame()
            one.get_frame()
        intrinsics = CameraIntrinsics(width=width, height=height)
        simulation.register_agent(AgentSpec(name="bench", intrinsics=intrinsics, rate_hz=0.0))
        for _ in range(WARM_UP + frames):
            agent.step(STEPS)
            for name, one in agents.items():
                took_s, received = timed(one.get_frame)
                times[name].append(took_s - received["render_s"])
            simulation.step(STEPS)
            took_s, render_s = timed(lambda: in_process(simulation))
            times["in process"].append(took_s - render_s)
        size_bytes = sum(received["sizes"].values())
        times["one copy"] = copies(size_bytes, WARM_UP + frames)
    return {name: percentiles(values[WARM_UP:]) for name, values in times.items()}


def in_process(simulation: Simulation) -> float:
    """Make the same dict as an Agent's without any transport; return the time of rendering [s]."""
    frame = simulation.capture(agent="bench")
    frame.to_dict()
    return frame.timings_s["render"]


def copies(size_bytes: int, count: int) -> list[float]:
    """Time one copy of a frame's bytes into shared memory: what no transport can undercut."""
    source = np.ones(size_bytes, np.uint8).data
    memory = multiprocessing.shared_memory.SharedMemory(create=True, size=size_bytes)
    try:
        target = memory.buf
        assert target is not None
        return [timed(lambda: copy_into(target, source))[0] for _ in range(count)]
    finally:
        memory.close()
        memory.unlink()


def copy_into(target: memoryview, source: memoryview) -> None:
    """Copy all bytes."""
    target[: len(source)] = source


def stream(size: tuple[int, int], seconds: float, scene: str) -> dict[str, Any]:
    """Follow a 30 Hz stream in real time; count the frames that never came."""
    width, height = size
    settings = {"scene": scene, "agent.name": ""}
    with Agent(width=width, height=height, namespace=NAMESPACE, simulator=settings) as agent:
        arrivals, numbers, stamps, render = [], [], [], []
        for frame in agent.frames(30.0):
            arrivals.append(time.perf_counter())
            numbers.append(frame["sequence"])
            stamps.append(frame["stamp_ns"])
            render.append(frame["render_s"])
            if arrivals[-1] - arrivals[0] > seconds:
                break
    made = numbers[-1] - numbers[0] + 1
    due = round((stamps[-1] - stamps[0]) * 30e-9) + 1
    return {
        "received": len(numbers),
        "lost on the way": made - len(numbers),
        "never rendered, as the machine was late": due - made,
        "interval [ms]": percentiles(np.diff(arrivals)),
        "render [ms]": percentiles(render),
    }


def main() -> None:
    """Run the benchmark and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=300, help="frames on request")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of the stream")
    parser.add_argument("--size", default="640x480", help="WIDTHxHEIGHT")
    parser.add_argument("--scene", default="optical")
    parser.add_argument("--json", type=Path, help="write the results here too")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    results: dict[str, Any] = {
        "on request, above rendering [ms]": on_request(
            (width, height), options.frames, options.scene
        )
    }
    for name, row in results["on request, above rendering [ms]"].items():
        print(f"{name:<20}" + "".join(f"  {key} {value:7.2f}" for key, value in row.items()))
    results["stream of 30 Hz"] = stream((width, height), options.seconds, options.scene)
    for name, value in results["stream of 30 Hz"].items():
        row = value if isinstance(value, dict) else {"": value}
        print(f"{name:<40}" + "".join(f"  {key} {number:7.2f}" for key, number in row.items()))
    if options.json:
        options.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
