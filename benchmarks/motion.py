"""Time of motion between frames, and of tracks: python benchmarks/motion.py [--pairs N].

Frames of a furnished room, or of `optical` where the furniture has not been built, from a moving
camera; medians on as many threads as there are processors.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np

from sailenv_bench.suite.measurement import Measurement, median_s
from sailenv_ros import Simulation
from sailenv_ros.errors import SailenvError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import SceneGeometry, motion, track
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

SIZES = ((320, 240), (640, 480), (1280, 960))


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


def pair_ms(width: int, height: int, rounds: int) -> tuple[str, float]:
    """Return the scene, and the median time of a pair's motion [ms]."""
    try:
        one, other = two_frames("room_01", width, height)
    except SailenvError:
        one, other = two_frames("optical", width, height)
    return one.scene, 1e3 * median_s(lambda: motion(one, other), rounds)


def tracks_s(scene: str, rounds: int) -> tuple[float, float, float]:
    """Follow 1,000 points through 100 frames.

    Returns the time [s] with building the trees, the median without, and the visible share.
    """
    frames, geometry = tracked(scene)
    rng = np.random.default_rng(0)
    points = np.stack(
        [rng.integers(0, 100, 1000), rng.uniform(0, 639, 1000), rng.uniform(0, 479, 1000)], axis=1
    )
    began = time.perf_counter()
    tracks = track(points, frames, geometry)
    first_s = time.perf_counter() - began
    return first_s, median_s(lambda: track(points, frames, geometry), rounds), tracks.visible.mean()


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    for width, height in SIZES[:1] if quick else SIZES:
        scene, taken = pair_ms(width, height, 5 if quick else 51)
        yield Measurement(
            name=f"motion of a pair, {scene}, {width}×{height}", value=taken, unit="ms"
        )
    first_s, again_s, _ = tracks_s(scene, 1 if quick else 3)
    yield Measurement(
        name=f"1,000 tracks through 100 frames, {scene}",
        value=again_s,
        unit="s",
        other="the first time, with its trees",
        other_value=first_s,
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=101)
    args = parser.parse_args()
    for width, height in SIZES:
        scene, taken = pair_ms(width, height, args.pairs)
        print(f"motion of a pair, {scene}, {width} x {height}: {taken:.2f} ms")
    first_s, again_s, share = tracks_s(scene, 3)
    print(
        f"1,000 tracks x 100 frames, {scene}: {again_s:.2f} s, the first time {first_s:.2f} s "
        f"(visible {share:.0%})"
    )


if __name__ == "__main__":
    main()
