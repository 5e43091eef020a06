"""Time what contact shadows, smooth edges and several reflection points cost.

    python benchmarks/picture_costs.py [--frames N] [--size WxH]

Native renderers draw the same views in turn, so that what disturbs the machine disturbs all; the
medians of the processor times are compared. Effects are timed in ``room_01`` on one thread, with
and without baked light; reflections beside one point in the middle of each room, where the first
picture includes the reflection maps of all lights.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import time
from dataclasses import replace
from unittest import mock

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.scene import reflection_points
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot

VIEWS = {
    "room_01": ((2.1, -1.25, 1.55), (-1.2, 0.95, 0.85)),
    "room_02": ((3.2, 2.25, 1.65), (-1.2, -0.7, 0.8)),
    "room_03": ((1.1, -1.25, 1.6), (-0.9, 0.9, 0.75)),
}


def main() -> None:
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--size", default="1024x768")
    arguments = parser.parse_args()
    width, height = (int(number) for number in arguments.size.split("x"))
    _effects(arguments.frames)
    print("room, points: first picture [ms]; a frame [ms CPU]")
    for room, (eye, target) in VIEWS.items():
        snapshot = SceneLibrary().snapshot(room)
        lens = CameraIntrinsics(width=width, height=height, vertical_fov_deg=62.0)
        camera = Camera(intrinsics=lens, pose=look_at(eye, target))
        renderers = {most: NativeRenderer() for most in (1, reflection_points.MOST)}
        first = {}
        for most, renderer in renderers.items():
            with mock.patch.object(reflection_points, "MOST", most):
                first[most] = _cpu(renderer, snapshot, camera)
        times: dict[int, list[float]] = {most: [] for most in renderers}
        for _, most in itertools.product(range(arguments.frames), renderers):
            times[most].append(_cpu(renderers[most], snapshot, camera))
        for most, renderer in renderers.items():
            middle = statistics.median(times[most])
            print(f"{room}, {most}: {1e3 * first[most]:.0f}; {1e3 * middle:.2f}")
            renderer.close()


def _effects(frames: int) -> None:
    baked = SceneLibrary().snapshot("room_01")
    plain = replace(baked, contents=replace(baked.contents, baked=None))
    eye, target = VIEWS["room_01"]
    lens = CameraIntrinsics(width=640, height=480, vertical_fov_deg=62.0)
    whole = Camera(intrinsics=lens, pose=look_at(eye, target))
    without = {
        "occlusion": replace(whole, picture=PictureSettings(occlusion_strength=0.0)),
        "smooth edges": replace(whole, picture=PictureSettings(smooth_edges=False)),
    }
    print("effect, room_01 at 640x480 on one thread [ms CPU]")
    for name, snapshot in (("baked", baked), ("not baked", plain)):
        renderer = NativeRenderer(threads=1)
        _cpu(renderer, snapshot, whole)
        times: dict[str, list[float]] = {effect: [] for effect in ("", *without)}
        for _ in range(frames):
            times[""].append(_cpu(renderer, snapshot, whole))
            for effect, camera in without.items():
                times[effect].append(_cpu(renderer, snapshot, camera))
        full = statistics.median(times.pop(""))
        for effect, spent in times.items():
            print(f"{effect}, {name}: {1e3 * (full - statistics.median(spent)):.2f}")
        renderer.close()


def _cpu(renderer: NativeRenderer, snapshot: WorldSnapshot, camera: Camera) -> float:
    began = time.process_time()
    renderer.render(RenderRequest(snapshot, camera, ("rgb",)))
    return time.process_time() - began


if __name__ == "__main__":
    main()
