"""Time pictures through lenses that are no pin-holes beside those of one.

    python benchmarks/lens_costs.py [--scene NAME] [--size WxH] [--frames N] [--threads N]
                                    [--no-smooth-edges]

The five views of an agent from one place, by the native renderer, each lens in turn, so that what
disturbs the machine disturbs all; the medians of wall and of processor time are compared, and what
each stage takes. The pin-hole shows 60 degrees from top to bottom, parallel rays as much around the
middle, the others what they are made for.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation
from sailenv_ros.types.views import FIVE_VIEWS

EYE, TARGET = (2.1, -1.25, 1.55), (-1.2, 0.95, 0.85)
WARM_UP = 3


def lenses(width: int, height: int) -> Mapping[str, CameraIntrinsics]:
    """Return the lenses that are compared; the first one is the pin-hole."""
    pinhole = CameraIntrinsics(width=width, height=height)
    focal, wide = pinhole.fy, 0.5 * height / np.radians(95.0)
    distance_m = float(np.linalg.norm(np.subtract(EYE, TARGET)))
    return {
        "pin-hole": pinhole,
        "plumb_bob": CameraIntrinsics(
            width=width,
            height=height,
            distortion_model="plumb_bob",
            distortion=(-0.28, 0.07, 1e-3, -1e-3, 0.0),
            fx_px=focal,
            fy_px=focal,
        ),
        "fisheye 190": CameraIntrinsics(
            width=width,
            height=height,
            distortion_model="equidistant",
            distortion=(0.0, 0.0, 0.0, 0.0),
            fx_px=wide,
            fy_px=wide,
            max_angle_deg=95.0,
        ),
        "equirectangular": CameraIntrinsics(
            width=width,
            height=height,
            distortion_model="equirectangular",
            fx_px=width / (2.0 * np.pi),
            fy_px=height / np.pi,
        ),
        "orthographic": CameraIntrinsics(
            width=width,
            height=height,
            distortion_model="orthographic",
            fx_px=focal / distance_m,
            fy_px=focal / distance_m,
        ),
    }


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="room_01")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--no-smooth-edges", action="store_true")
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))
    world = SceneLibrary().build(arguments.scene)
    world.step(8)
    before = world.snapshot()
    world.step(8)
    snapshot = world.snapshot()
    world.close()
    renderer = NativeRenderer(threads=arguments.threads)
    picture = PictureSettings(smooth_edges=not arguments.no_smooth_edges)
    compared = lenses(width, height)
    wall, cpu = defaultdict(list), defaultdict(list)
    stages: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for number in range(WARM_UP + arguments.frames):
        for name, lens in compared.items():
            now = Camera(intrinsics=lens, pose=look_at(EYE, TARGET), picture=picture)
            then = replace(now, pose=look_at(np.add(EYE, 0.01), TARGET))
            past = Observation(snapshot=before, camera=then)
            began, used = time.perf_counter(), time.process_time()
            rendered = renderer.render(RenderRequest(snapshot, now, FIVE_VIEWS, past))
            if number < WARM_UP:
                continue
            wall[name].append(time.perf_counter() - began)
            cpu[name].append(time.process_time() - used)
            for stage, seconds in rendered.timings_s.items():
                stages[name][stage].append(seconds)
    renderer.close()
    base_wall, base_cpu = (statistics.median(t["pin-hole"]) for t in (wall, cpu))
    print(
        f"{arguments.scene}, {width} x {height}, five views: wall, processor [ms], ratios; stages"
    )
    for name in compared:
        own_wall, own_cpu = statistics.median(wall[name]), statistics.median(cpu[name])
        parts = ", ".join(
            f"{stage} {1e3 * statistics.median(times):.1f}" for stage, times in stages[name].items()
        )
        print(
            f"{name:16s} {1e3 * own_wall:7.2f} {1e3 * own_cpu:7.2f}"
            f"  x {own_wall / base_wall:.2f}  x {own_cpu / base_cpu:.2f}  {parts}"
        )


if __name__ == "__main__":
    main()
