"""Time of motion between frames, and of tracks: python benchmarks/motion.py [--pairs N].

Frames of a furnished room, or of `optical` where the furniture has not been built, from a moving
camera; medians on as many threads as there are processors.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

from sailenv_ros import Simulation
from sailenv_ros.errors import SailenvError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import SceneGeometry, motion, track
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics


def median_ms(work: Callable[[], object], rounds: int) -> float:
    """Return the median wall time of a call [ms]."""
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        times.append(1e3 * (time.perf_counter() - began))
    return statistics.median(times)


def two_frames(scene: str, width: int, height: int) -> list[Frame]:
    """Return two frames half a second apart."""
    lens = CameraIntrinsics(width=width, height=height)
    spec = AgentSpec(name="eye", intrinsics=lens, rate_hz=0.0)
    with Simulation(scene, mode="lockstep", agent=spec) as simulation:
        frames = []
        for _ in range(2):
            simulation.step(120)
            frames.append(simulation.capture(("depth", "instance"), agent="eye"))
        return frames


def tracked(scene: str) -> tuple[list[Frame], SceneGeometry]:
    """Return 100 frames of a scene, 1/30 s apart, and its geometry."""
    lens = CameraIntrinsics(width=640, height=480)
    spec = AgentSpec(name="eye", intrinsics=lens, rate_hz=0.0)
    with Simulation(scene, mode="lockstep", agent=spec) as simulation:
        frames = []
        for _ in range(100):
            simulation.step(8)
            frames.append(simulation.capture(("depth",), agent="eye"))
        return frames, SceneGeometry.of_contents(simulation.contents)


def measure_tracks(scene: str) -> None:
    """Follow 1,000 points through 100 frames, with and without building the trees."""
    frames, geometry = tracked(scene)
    rng = np.random.default_rng(0)
    points = np.stack(
        [rng.integers(0, 100, 1000), rng.uniform(0, 639, 1000), rng.uniform(0, 479, 1000)], axis=1
    )
    began = time.perf_counter()
    tracks = track(points, frames, geometry)
    first_s = time.perf_counter() - began
    again_s = 1e-3 * median_ms(lambda: track(points, frames, geometry), 3)
    share = tracks.visible.mean()
    print(
        f"1,000 tracks x 100 frames, {scene}: {again_s:.2f} s, the first time {first_s:.2f} s "
        f"(visible {share:.0%})"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=101)
    args = parser.parse_args()
    for width, height in ((320, 240), (640, 480), (1280, 960)):
        try:
            one, other = two_frames("room_01", width, height)
        except SailenvError:
            one, other = two_frames("optical", width, height)
        taken = median_ms(lambda one=one, other=other: motion(one, other), args.pairs)  # type: ignore[misc]
        print(f"motion of a pair, {one.scene}, {width} x {height}: {taken:.2f} ms")
    measure_tracks(one.scene)


if __name__ == "__main__":
    main()
