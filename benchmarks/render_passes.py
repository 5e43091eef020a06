"""Time what the renderer does: each pass, readback, annotations, at the paper's picture sizes.

    python benchmarks/render_passes.py [--frames N] [--scene NAME] [--skip-steps N] [--device N]
                                       [--json FILE]

One simulated world moves on, from when its things have come to rest and in its baked light where
that is in the cache; at each of its instants every set of views is rendered by OpenGL, and
PyBullet's own `getCameraImage` draws the same bodies from the same camera at the same size (colour,
depth and segmentation, without shadows; no flow, which it does not know). They take turns in one
run, so that what disturbs the machine disturbs all alike, and the ratio of medians is robust. Each
set has a renderer of its own: none finds the shadow map that another has just drawn.

``annotate`` runs in a thread beside the passes of the picture where there is one.
"""

from __future__ import annotations

import argparse
import itertools
import json
import logging
import os
import platform
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Mapping
from pathlib import Path

from sailenv_bench.experiments.bullet_bodies import BulletBodies
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS
from sailenv_ros.world.bullet import BulletClient
from sailenv_ros.world.world import World

SIZES = ((240, 180), (320, 240), (640, 480), (800, 600), (1024, 768), (1280, 960))

SETS = {
    "five views": FIVE_VIEWS,
    "without flow": tuple(view for view in FIVE_VIEWS if view != "flow"),
    "annotations": tuple(view for view in FIVE_VIEWS if view != "rgb"),
    "rgb": ("rgb",),
    "every view": tuple(VIEWS),
}

STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""

WARM_UP = 4

Times = dict[str, list[float]]


class PlainBullet:
    """PyBullet's own way to a picture with depth and segmentation, of the same bodies."""

    def __init__(self) -> None:
        self._client = BulletClient()
        self._bodies = BulletBodies(self._client)

    def prepare(self, snapshot: WorldSnapshot, camera: Camera) -> None:
        """Put the bodies where the camera sees them."""
        self._bodies.show(snapshot.contents)
        self._bodies.place(snapshot, camera.camera_from_world)

    def shoot(self, intrinsics: CameraIntrinsics) -> None:
        """Draw once."""
        projection = self._client.constants.computeProjectionMatrixFOV(
            intrinsics.vertical_fov_deg,
            intrinsics.width / intrinsics.height,
            intrinsics.near_m,
            intrinsics.far_m,
        )
        self._client.getCameraImage(
            intrinsics.width,
            intrinsics.height,
            viewMatrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1),
            projectionMatrix=projection,
            renderer=self._client.constants.ER_TINY_RENDERER,
            shadow=0,
        )

    def close(self) -> None:
        """Free it."""
        self._client.close()


def measure(
    size: tuple[int, int],
    frames: int,
    make_world: Callable[[], World],
    renderers: Mapping[str, Renderer],
    bullet: PlainBullet,
) -> dict[str, dict[str, dict[str, float]]]:
    """Time every set of views at one size: stage by stage, median and 90th percentile [ms]."""
    world = make_world()
    camera_of = _camera_of(world, CameraIntrinsics(width=size[0], height=size[1]))
    times: dict[str, Times] = defaultdict(lambda: defaultdict(list))
    past: dict[str, Observation | None] = dict.fromkeys(SETS)
    try:
        for number in range(WARM_UP + frames):
            world.step(STEPS)
            snapshot, camera = world.snapshot(), camera_of(world.sim_time_ns)
            # Who follows PyBullet finds cold caches: each in its turn.
            first = number % len(SETS)
            for name, views in [*SETS.items()][first:] + [*SETS.items()][:first]:
                began = time.perf_counter()
                rendered = renderers[name].render(
                    RenderRequest(snapshot, camera, views, past[name])
                )
                times[name]["whole"].append(time.perf_counter() - began)
                for stage, seconds in rendered.timings_s.items():
                    times[name][stage].append(seconds)
                depth = rendered.depth if rendered.depth is not None else rendered.views["depth"]
                past[name] = Observation(snapshot=snapshot, camera=camera, depth=depth)
            bullet.prepare(snapshot, camera)
            began = time.perf_counter()
            bullet.shoot(camera.intrinsics)
            times["getCameraImage"]["whole"].append(time.perf_counter() - began)
    finally:
        world.close()
    return {
        name: {stage: _summary(seconds) for stage, seconds in stages.items()}
        for name, stages in times.items()
    }


def world_maker(scene: str, skip_steps: int) -> Callable[[], World]:
    """Return what builds a scene's world, as a simulator does, and lets it run for some steps."""
    library, next_revision = SceneLibrary(), itertools.count(1).__next__

    def make() -> World:
        world = library.build(scene, seed=0, epoch=1, next_revision=next_revision)
        world.step(skip_steps)
        return world

    return make


def _is_baked(make_world: Callable[[], World]) -> bool:
    world = make_world()
    try:
        return world.contents.baked is not None
    finally:
        world.close()


def _camera_of(world: World, intrinsics: CameraIntrinsics) -> Callable[[int], Camera]:
    mover = next(iter(world.movers.values()))
    return lambda time_ns: Camera(intrinsics=intrinsics, pose=mover.pose_at(time_ns))


def _summary(seconds: list[float]) -> dict[str, float]:
    kept = sorted(1e3 * second for second in seconds[WARM_UP:])
    return {
        "median": statistics.median(kept),
        "p90": kept[min(len(kept) - 1, int(0.9 * len(kept)))],
    }


def show(size: tuple[int, int], result: dict[str, dict[str, dict[str, float]]]) -> None:
    """Print one size's table."""
    stages = list(dict.fromkeys(stage for by in result.values() for stage in by))
    print(f"\n{size[0]} x {size[1]}: median / 90th percentile [ms]")
    print(f"{'':16}" + "".join(f"{stage:>15}" for stage in stages))
    for name, by in result.items():
        cells = (
            f"{by[stage]['median']:.2f} / {by[stage]['p90']:.2f}" if stage in by else ""
            for stage in stages
        )
        print(f"{name:16}" + "".join(f"{cell:>15}" for cell in cells))
    whole = {name: by["whole"]["median"] for name, by in result.items()}
    ratio = whole["five views"] / whole["getCameraImage"]
    flow = whole["five views"] / whole["without flow"] - 1.0
    print(f"five views / getCameraImage = {ratio:.2f}; flow adds {100 * flow:.0f} %")


def main() -> None:
    """Measure all sizes and print them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--scene", default="optical")
    parser.add_argument(
        "--skip-steps",
        type=int,
        default=400,
        metavar="N",
        help="physics steps before the first frame (default: %(default)s, things are at rest)",
    )
    parser.add_argument("--device", type=int, default=None, help="EGL's number of the device")
    parser.add_argument("--json", type=Path, default=None, help="write the figures here too")
    arguments = parser.parse_args()
    # Says how to have the light baked where it is not.
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    make_world = world_maker(arguments.scene, arguments.skip_steps)
    is_baked = _is_baked(make_world)
    renderers = {name: Renderer(device=arguments.device) for name in SETS}
    description = renderers["rgb"].description
    bullet = PlainBullet()
    light = "baked light" if is_baked else "no baked light"
    print(f"{arguments.scene} with {light}, from step {arguments.skip_steps} on")
    print(f"{description}; {os.cpu_count()} CPUs, {platform.platform()}")
    results = {}
    try:
        for size in SIZES:
            result = measure(size, arguments.frames, make_world, renderers, bullet)
            show(size, result)
            results[f"{size[0]}x{size[1]}"] = result
    finally:
        bullet.close()
        for renderer in renderers.values():
            renderer.close()
    if arguments.json is not None:
        report = {
            "renderer": description,
            "scene": arguments.scene,
            "baked": is_baked,
            "skip_steps": arguments.skip_steps,
            "sizes": results,
        }
        arguments.json.write_text(json.dumps(report, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
