"""Time of the ground truth of objects: the table, and drawing each object alone.

    python benchmarks/object_truth.py [--scene room_01] [--size 640x480] [--repeat 30]

Medians of wall time, in one process, with the native renderer.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

from sailenv_ros.frame.truth.frame_objects import objects_of
from sailenv_ros.frame.truth.visible_parts import visible_parts
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

VIEWS = ("depth", "category", "instance", "flow")


def median_ms(call: Callable[[], object], repeat: int) -> float:
    """Return the median time of a call [ms], the first one left out."""
    call()
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return 1e3 * statistics.median(times)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--repeat", type=int, default=30)
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    spec = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=width, height=height))
    with Simulation(args.scene, mode="lockstep", backend="native", agent=spec) as simulation:
        simulation.capture(VIEWS)
        simulation.step(8)
        frame = simulation.capture(VIEWS)
        draw = frame.draw_amodal
        assert draw is not None
        instance, flow = frame["instance"], frame["flow"]
        masks = draw()
        largest = int(masks.ids[masks.pixels.argmax()])
        smallest = int(masks.ids[masks.pixels.argmin()])
        results = {
            "one pass over ids": lambda: visible_parts(instance),
            "one pass over ids, with flow": lambda: visible_parts(instance, flow),
            "table": lambda: objects_of(frame),
            "cloud of points": frame.points,
            "all objects alone": draw,
            "the largest object alone": lambda: draw(largest),
            "the smallest object alone": lambda: draw(smallest),
        }
        print(f"{args.scene}, {width}x{height}, {len(masks)} objects [ms]")
        for what, call in results.items():
            print(f"{what:32} {median_ms(call, args.repeat):8.2f}")


if __name__ == "__main__":
    main()
