"""Time a rig of two cameras beside one camera, each capture of a new instant.

    python benchmarks/rig_costs.py [--scene NAME] [--size WxH] [--frames N] [--baseline M]

The five views, by the native renderer, in the thread of the caller. One camera and both are
captured in turn, two physics steps apart, so that what disturbs the machine disturbs both; medians
of wall and of processor time are compared.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import defaultdict

from sailenv_ros import AgentSpec, CameraIntrinsics, Pose, RigCamera, look_at
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation

EYE, TARGET = (2.1, -1.25, 1.55), (-1.2, 0.95, 0.85)
WARM_UP, STEPS = 3, 2


def main() -> None:
    """Measure and print the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--baseline", type=float, default=0.12, metavar="M")
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))
    lens = CameraIntrinsics(width=width, height=height)
    right = Pose((0.0, -arguments.baseline, 0.0))
    cameras = {
        "left": RigCamera(intrinsics=lens),
        "right": RigCamera(intrinsics=lens, extrinsics=right),
    }
    core = SynchronousSimulation(SceneLibrary(drafts=False), arguments.scene, NativeRenderer())
    compared = {"one": {"left": cameras["left"]}, "two": cameras}
    for name, mounted in compared.items():
        core.register_agent(
            AgentSpec(name=name, following=False, pose=look_at(EYE, TARGET), cameras=mounted)
        )
    wall, cpu = defaultdict(list), defaultdict(list)
    for number in range(WARM_UP + arguments.frames):
        for name in compared:
            core.step(STEPS)
            began, used = time.perf_counter(), time.process_time()
            core.capture_rig(agent=name)
            if number >= WARM_UP:
                wall[name].append(time.perf_counter() - began)
                cpu[name].append(time.process_time() - used)
    core.close()
    print(f"{arguments.scene}, {width} x {height}, five views: wall, processor [ms]")
    for name in compared:
        times = (1e3 * statistics.median(one[name]) for one in (wall, cpu))
        print(f"{name} camera{'s' * (name == 'two')}: " + "  ".join(f"{ms:.2f}" for ms in times))
    ratios = [
        statistics.median(b / a for a, b in zip(one["one"], one["two"], strict=True))
        for one in (wall, cpu)
    ]
    print(f"ratio: {ratios[0]:.2f} wall, {ratios[1]:.2f} processor")


if __name__ == "__main__":
    main()
