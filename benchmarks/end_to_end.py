"""Time a frame's whole way: render, fill messages, publish, and `Agent.get_frame()` end to end.

    python benchmarks/end_to_end.py [--frames N] [--scene NAME] [--json FILE]
    python benchmarks/end_to_end.py --compare [--scene NAME]...

With `--compare`, `Agent.get_frame()` of five views by OpenGL and by the native renderer in turn, at
rest, each in a simulator of its own; the native renderer's through shared memory and by topics.

Without, two simulators of one scene stand side by side in lockstep: one in this process, one as a
node that an Agent asks. Each round times both, so that what disturbs the machine disturbs both
alike. The overhead is what an Agent's frame costs beyond the rendering that its own frame_info
tells of.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image

from sailenv_bench.suite.measurement import Measurement
from sailenv_msgs_py.frame_info import header_of_frame
from sailenv_msgs_py.images import image_from_view
from sailenv_ros import Agent, Simulation
from sailenv_ros.frame.frame import Frame
from sailenv_ros.system.transport import use_shared_memory_profile
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.views import FIVE_VIEWS

SIZES = ((240, 180), (320, 240), (640, 480), (800, 600), (1024, 768), (1280, 960))
STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""

REST_STEPS = 960
"""After so many, objects that fell into place lie still."""

SETTLING = 8
"""Frames of each agent before the timed ones."""

WARM_UP = 5
ANSWER_S = 120.0
"""Time that a simulator may take on a busy machine, where the first frames take long [s]."""

QOS = QoSProfile(depth=3)
NAMESPACE = f"/bench_{os.getpid()}"

READER = """
import sys, threading, rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from sensor_msgs.msg import Image
rclpy.init(args=[])
node = rclpy.create_node("reader")
for topic in sys.argv[1:]:
    node.create_subscription(Image, topic, lambda msg: None, QoSProfile(depth=3))
executor = SingleThreadedExecutor()
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
spinning.start()
sys.stdin.read()  # until the benchmark closes it, or dies
executor.shutdown()
spinning.join()
node.destroy_node()
rclpy.shutdown()
"""


class Stopwatch:
    """Times of each stage, in milliseconds."""

    def __init__(self) -> None:
        self.times: dict[str, list[float]] = defaultdict(list)

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        """Time one run of a stage."""
        began = time.perf_counter()
        yield
        self.times[stage].append((time.perf_counter() - began) * 1e3)

    def summary(self) -> dict[str, dict[str, float]]:
        """Return median, 90th percentile and least of each stage, without the warm-up."""
        result = {}
        for stage, times in self.times.items():
            kept = sorted(times[WARM_UP:])
            p90 = kept[min(len(kept) - 1, int(0.9 * len(kept)))]
            result[stage] = {"median": statistics.median(kept), "p90": p90, "least": kept[0]}
        return result


class Topics:
    """Five image topics with a reader in another process."""

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context)
        self._node = Node("bench", context=self._context, namespace=NAMESPACE)
        names = [f"{NAMESPACE}/bench/{view}" for view in FIVE_VIEWS]
        self._topics = {
            view: self._node.create_publisher(Image, name, QOS)
            for view, name in zip(FIVE_VIEWS, names, strict=True)
        }
        command = [sys.executable, "-c", READER, *names]
        self._reader = subprocess.Popen(command, stdin=subprocess.PIPE)
        await_true(lambda: all(t.get_subscription_count() for t in self._topics.values()))

    def publish(self, images: dict[str, Image]) -> None:
        """Publish an image on each topic."""
        for view, image in images.items():
            self._topics[view].publish(image)

    def close(self) -> None:
        """End the reader and the node."""
        self._reader.communicate(timeout=10)
        self._node.destroy_node()
        self._context.try_shutdown()


def await_true(condition: Callable[[], bool], timeout_s: float = 20.0) -> None:
    """Wait for a condition."""
    deadline = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError("the benchmark's reader was not found in time")
        time.sleep(0.01)


def measure(size: tuple[int, int], frames: int, scene: str, topics: Topics) -> dict[str, Any]:
    """Time every stage at one size of picture."""
    watch = Stopwatch()
    width, height = size
    intrinsics = CameraIntrinsics(width=width, height=height)
    lockstep = {"scene": scene, "mode": "lockstep", "agent.name": ""}
    with (
        Simulation(scene, mode="lockstep") as simulation,
        Agent(width=width, height=height, namespace=NAMESPACE, simulator=lockstep) as agent,
    ):
        simulation.register_agent(AgentSpec(name="bench", intrinsics=intrinsics, rate_hz=0.0))
        for _ in range(WARM_UP + frames):
            with watch("physics step"):
                simulation.step(1)
            simulation.step(STEPS - 1)
            agent.step(STEPS)
            with watch("render, in process"):
                frame = simulation.capture(agent="bench")
            with watch("get_frame, end to end"):
                received = agent.get_frame()
            with watch("fill messages"):
                images = dilated(frame)
            # Last of the round: its reader takes these images while physics goes on.
            with watch("publish"):
                topics.publish(images)
            took_ms = watch.times["get_frame, end to end"][-1]
            watch.times["render, in the node"].append(received["render_s"] * 1e3)
            watch.times["overhead of get_frame"].append(took_ms - received["render_s"] * 1e3)
        return {
            "width": width,
            "height": height,
            "ms": watch.summary(),
            "recaptured": agent.recaptured,
            "node_rss_mib": resident_mib(agent.simulator_pid),
            "renderer": simulation.info.renderer,
        }


WAYS = {
    "OpenGL": ("gl", "1"),
    "native, by topics": ("native", "0"),
    "native": ("native", "1"),
}
"""Back end, and whether frames come through shared memory (`SAILENV_DIRECT_FRAMES`)."""


def compare(size: tuple[int, int], frames: int, scene: str) -> dict[str, Any]:
    """Time `get_frame` of each way in turn; return medians [ms] and their ratios to OpenGL's."""
    watch = Stopwatch()
    width, height = size
    with ExitStack() as opened:
        agents: dict[str, Agent] = {}
        for number, (name, (backend, direct)) in enumerate(WAYS.items()):
            settings = {"scene": scene, "mode": "lockstep", "agent.name": "", "backend": backend}
            os.environ["SAILENV_DIRECT_FRAMES"] = "1"  # read by the simulator at its start
            agents[name] = agent = opened.enter_context(
                Agent(
                    width=width,
                    height=height,
                    namespace=f"{NAMESPACE}_{number}",
                    simulator=settings,
                    timeout_s=ANSWER_S,
                    start_timeout_s=ANSWER_S,
                )
            )
            os.environ["SAILENV_DIRECT_FRAMES"] = direct  # and by an Agent at its second frame
            for _ in range(2):
                agent.get_frame()
            agent.step(REST_STEPS)
        # A scene is made ready for moves in the first frames at rest, in threads beside them.
        for agent in [*agents.values()] * SETTLING:
            agent.step(STEPS)
            agent.get_frame()
        for number in range(WARM_UP + frames):
            # The order changes: a renderer finds the caches that the one before it has filled.
            first = number % len(agents)
            for name, agent in [*agents.items()][first:] + [*agents.items()][:first]:
                agent.step(STEPS)
                with watch(name):
                    received = agent.get_frame()
                beyond_ms = watch.times[name][-1] - 1e3 * received["render_s"]
                watch.times[f"{name}, beyond rendering"].append(beyond_ms)
    times = watch.summary()
    ratios = {
        f"native / {name}": times["native"]["median"] / times[name]["median"]
        for name in WAYS
        if name != "native"
    }
    return {"scene": scene, "width": width, "height": height, "ms": times, "ratios": ratios}


def show_comparison(result: dict[str, Any]) -> None:
    """Print one scene and size."""
    print(f"\n{result['scene']}, {result['width']}x{result['height']}  [ms]")
    for name, times in result["ms"].items():
        print(
            f"  {name:<36} median {times['median']:8.2f}  p90 {times['p90']:8.2f}"
            f"  least {times['least']:8.2f}"
        )
    for name, ratio in result["ratios"].items():
        print(f"  {name:<36} {ratio:.2f}")


def dilated(frame: Frame) -> dict[str, Image]:
    """Make the image messages of a frame."""
    header = header_of_frame(frame)
    return {
        view: image_from_view(view, values, header, copy=False)
        for view, values in frame.views.items()
    }


def resident_mib(pid: int | None) -> float | None:
    """Return the resident memory of a process."""
    if pid is None:
        return None
    status = Path(f"/proc/{pid}/status").read_text()
    line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


def show(result: dict[str, Any]) -> None:
    """Print one size's table."""
    print(f"\n{result['width']}x{result['height']}  [ms]  {'median':>18} {'p90':>8}")
    for stage, times in result["ms"].items():
        print(f"  {stage:<28} {times['median']:8.2f} {times['p90']:8.2f}")
    print(f"  node RSS {result['node_rss_mib']:.0f} MiB, recaptured {result['recaptured']}")


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    use_shared_memory_profile()
    for size in SIZES[:1] if quick else (SIZES[0], SIZES[2], SIZES[5]):
        times = compare(size, 12 if quick else 20, "room_01")["ms"]
        label = f"room_01, {size[0]}×{size[1]}"
        names = {"OpenGL": "OpenGL", "native, by topics": "the same by topics"}
        for key, beyond in itertools.product(names, ("", ", beyond rendering")):
            if beyond and key == "OpenGL":
                continue
            yield Measurement(
                name=f"{label}{beyond}",
                value=times[f"native{beyond}"]["median"],
                unit="ms",
                other=names[key],
                other_value=times[f"{key}{beyond}"]["median"],
            )


def main() -> None:
    """Run the benchmark and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=40, help="timed frames of each size")
    parser.add_argument("--scene", action="append", help="may be given repeatedly")
    parser.add_argument("--compare", action="store_true", help="OpenGL and native in turn")
    parser.add_argument("--size", action="append", help="WIDTHxHEIGHT; may be given repeatedly")
    parser.add_argument("--json", type=Path, help="write the results here too")
    options = parser.parse_args()
    given = [size.partition("x") for size in options.size or ()]
    sizes = [(int(width), int(height)) for width, _, height in given] or SIZES
    scenes = options.scene or ["optical"]
    use_shared_memory_profile()
    results = []
    if options.compare:
        for scene in scenes:
            for size in sizes:
                results.append(compare(size, options.frames, scene))
                show_comparison(results[-1])
        if options.json:
            options.json.write_text(json.dumps(results, indent=1))
        return
    topics = Topics()
    try:
        for size in sizes:
            results.append(measure(size, options.frames, scenes[0], topics))
            show(results[-1])
    finally:
        topics.close()
    print(f"\n{results[0]['renderer']}; {platform.processor() or platform.machine()}, ", end="")
    print(f"{os.cpu_count()} CPUs, Python {platform.python_version()}")
    if options.json:
        options.json.write_text(json.dumps(results, indent=1))


if __name__ == "__main__":
    main()
