"""Time of the ground truth of objects: the table, and drawing each object alone.

    python benchmarks/object_truth.py [--scene room_01] [--size 640x480] [--repeat 30]

Medians of wall time, in one process, with the native renderer.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator

from sailenv_bench.suite.measurement import Measurement, median_s
from sailenv_ros.frame.truth.frame_objects import objects_of
from sailenv_ros.frame.truth.visible_parts import visible_parts
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

VIEWS = ("depth", "category", "instance", "flow")


WHOLE = "the frame with these views"


def times_ms(scene: str, width: int, height: int, repeat: int) -> Iterator[tuple[str, float]]:
    """Yield each thing and its median time [ms], the first call left out; the frame comes first."""
    spec = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=width, height=height))
    with Simulation(scene, mode="lockstep", backend="native", agent=spec) as simulation:
        simulation.capture(VIEWS)
        simulation.step(8)
        frame = simulation.capture(VIEWS)
        draw = frame.draw_amodal
        assert draw is not None
        instance, flow = frame["instance"], frame["flow"]
        masks = draw()
        largest = int(masks.ids[masks.pixels.argmax()])
        smallest = int(masks.ids[masks.pixels.argmin()])
        works: dict[str, Callable[[], object]] = {
            WHOLE: lambda: simulation.capture(VIEWS),
            "one pass over ids": lambda: visible_parts(instance),
            "one pass over ids, with flow": lambda: visible_parts(instance, flow),
            "table": lambda: objects_of(frame),
            "cloud of points": frame.points,
            f"all {len(masks)} objects alone": draw,
            "the largest object alone": lambda: draw(largest),
            "the smallest object alone": lambda: draw(smallest),
        }
        for name, work in works.items():
            work()
            yield name, 1e3 * median_s(work, repeat)


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    times = dict(times_ms("room_01", 640, 480, 5 if quick else 30))
    whole = times.pop(WHOLE)
    for name, value in times.items():
        yield Measurement(
            name=f"room_01, 640×480, {name}",
            value=value,
            unit="ms",
            other=WHOLE,
            other_value=whole,
        )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--repeat", type=int, default=30)
    args = parser.parse_args()
    width, height = map(int, args.size.split("x"))
    print(f"{args.scene}, {width}x{height} [ms]")
    for what, taken in times_ms(args.scene, width, height, args.repeat):
        print(f"{what:32} {taken:8.2f}")


if __name__ == "__main__":
    main()
