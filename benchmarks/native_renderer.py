"""Time the native renderer beside OpenGL in software and TinyRenderer, and compare what they draw.

    python benchmarks/native_renderer.py [--scene NAME]... [--size WxH]... [--threads 1,2,4]
                                         [--frames N] [--changes] [--json FILE]

One simulated world moves on; at each of its instants all take their turn in one process, so that
what disturbs the machine disturbs all alike. Ratios are of medians. ``CPU`` is the processor time
of all threads: it is what a busy machine disturbs least. OpenGL has as many threads as the machine
has processors; the native renderer has those that are told.

`--changes` times the frame after a light was set, an object was spawned and was removed.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import platform
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import render_passes

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.cpu_render.cpu_renderer import NativeRenderer
from sailenv_ros.frame import FIVE_VIEWS
from sailenv_ros.render.backend import RenderBackend
from sailenv_ros.render.renderer import Renderer
from sailenv_ros.snapshot import Observation, SceneContents, WorldSnapshot

SCENES = ("room_01", "room_02", "room_03", "optical")
SIZES = ((240, 180), (640, 480), (1280, 960))
SETS = {
    "five views": FIVE_VIEWS,
    "annotations": tuple(view for view in FIVE_VIEWS if view != "rgb"),
}
WARM_UP = 3
STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""

Times = dict[tuple[str, str], list[float]]


def measure(
    scene: str, size: tuple[int, int], frames: int, threads: Sequence[int], *, tiny: bool
) -> dict[str, Any]:
    """Time one scene at one size; medians [ms], and the greatest differences."""
    world = render_passes.world_maker(scene, 400)()
    camera_of = render_passes._camera_of(world, CameraIntrinsics(width=size[0], height=size[1]))
    renderers: dict[str, RenderBackend] = {"OpenGL": Renderer()}
    renderers |= {f"native {count}": NativeRenderer(threads=count) for count in threads}
    bullet = render_passes.PlainBullet()
    wall: Times = defaultdict(list)
    cpu: Times = defaultdict(list)
    stages: dict[str, list[float]] = defaultdict(list)
    past: dict[tuple[str, str], Observation] = {}
    differences: dict[str, list[float]] = defaultdict(list)
    try:
        for number in range(WARM_UP + frames):
            world.step(STEPS)
            snapshot, camera = world.snapshot(), camera_of(world.sim_time_ns)
            pictures = {}
            turns = list(itertools.product(renderers, SETS))
            for name, views in turns[number % len(turns) :] + turns[: number % len(turns)]:
                began, busy = time.perf_counter(), time.process_time()
                made = renderers[name].render(
                    snapshot, past.get((name, views)), camera, SETS[views]
                )
                took, worked = time.perf_counter() - began, time.process_time() - busy
                past[name, views] = Observation(snapshot=snapshot, camera=camera)
                if views == "five views":
                    pictures[name] = made.views
                if number >= WARM_UP:
                    wall[name, views].append(1e3 * took)
                    cpu[name, views].append(1e3 * worked)
                    if name == f"native {threads[0]}" and views == "five views":
                        for stage, seconds in made.timings_s.items():
                            stages[stage].append(1e3 * seconds)
            if tiny:
                bullet.prepare(snapshot, camera)
                began = time.perf_counter()
                bullet.shoot(camera.intrinsics)
                wall["TinyRenderer", "five views"].append(1e3 * (time.perf_counter() - began))
            if number >= WARM_UP:
                compare(pictures["OpenGL"], pictures[f"native {threads[0]}"], differences)
    finally:
        bullet.close()
        world.close()
        for renderer in renderers.values():
            renderer.close()
    return {
        "wall_ms": {" ".join(key): statistics.median(times) for key, times in wall.items()},
        "cpu_ms": {" ".join(key): statistics.median(times) for key, times in cpu.items()},
        "stages_ms": {stage: statistics.median(times) for stage, times in stages.items()},
        "ids_differ": max(differences["ids"]),
        "depth_off_999": max(differences["depth"]),
        "picture_within_2": min(differences["picture"]),
        "picture_within_2_mean": statistics.mean(differences["picture"]),
    }


def compare(theirs: Any, ours: Any, differences: dict[str, list[float]]) -> None:
    """Note how two frames differ."""
    same = theirs["instance"] == ours["instance"]
    differences["ids"].append(float((~same).mean()))
    depth = theirs["depth"].astype(np.float64)
    both = same & np.isfinite(depth) & np.isfinite(ours["depth"])
    off = np.abs(ours["depth"][both] / depth[both] - 1.0)
    differences["depth"].append(float(np.quantile(off, 0.999)))
    grey = np.abs(theirs["rgb"].astype(int) - ours["rgb"].astype(int)).max(axis=-1)
    differences["picture"].append(float((grey <= 2).mean()))


def show(scene: str, size: tuple[int, int], threads: Sequence[int], found: dict[str, Any]) -> None:
    """Print one table."""
    print(f"\n{scene}, {size[0]} x {size[1]}: median [ms], ratio to OpenGL; CPU [ms], ratio")
    for views in SETS:
        base, busy = found["wall_ms"][f"OpenGL {views}"], found["cpu_ms"][f"OpenGL {views}"]
        print(f"  {views:12} {'OpenGL':12} {base:8.1f}        {busy:8.1f}")
        for count in threads:
            name = f"native {count}"
            wall, cpu = found["wall_ms"][f"{name} {views}"], found["cpu_ms"][f"{name} {views}"]
            print(
                f"  {'':12} {name:12} {wall:8.1f} {wall / base:6.2f} {cpu:8.1f} {cpu / busy:6.2f}"
            )
    tiny = found["wall_ms"].get("TinyRenderer five views")
    if tiny is not None:
        print(f"  {'':12} {'TinyRenderer':12} {tiny:8.1f}")
    print(f"  stages: {', '.join(f'{k} {v:.1f}' for k, v in found['stages_ms'].items())}")
    print(
        f"  ids differ in {found['ids_differ']:.1e} at most, depth by {found['depth_off_999']:.1e} "
        f"at 99.9 %; picture within 2 of 255 at {found['picture_within_2']:.3f} at least, "
        f"{found['picture_within_2_mean']:.3f} on the mean"
    )


def measure_changes(scene: str, size: tuple[int, int], rounds: int) -> dict[str, dict[str, float]]:
    """Time the frame after a change beside a usual one; medians [ms]."""
    world = render_passes.world_maker(scene, 400)()
    camera = render_passes._camera_of(world, CameraIntrinsics(width=size[0], height=size[1]))(
        world.sim_time_ns
    )
    contents = world.contents
    makers: dict[str, Callable[[], RenderBackend]] = {"OpenGL": Renderer, "native": NativeRenderer}
    result: dict[str, dict[str, float]] = {}
    snapshot = world.snapshot()
    light = contents.lights[0]
    brighter = tuple(
        replace(other, intensity=1.1 * other.intensity) if other is light else other
        for other in contents.lights
    )
    fewer = contents.instances[:-1]
    changes: dict[str, SceneContents] = {
        "set_light": replace(contents, lights=brighter),
        "despawn": replace(contents, instances=fewer),
    }
    for name, make in makers.items():
        renderer = make()
        times: dict[str, list[float]] = defaultdict(list)
        timed = partial(_timed, renderer, snapshot, camera, times)
        timed(contents, None)
        for _ in range(rounds):
            for _ in range(3):
                timed(contents, "usual")
            timed(changes["set_light"], "set_light")
            timed(contents, "set_light")
            timed(changes["despawn"], "despawn")
            timed(contents, "spawn")
        renderer.close()
        result[name] = {change: statistics.median(found) for change, found in times.items()}
    world.close()
    return result


def _timed(
    renderer: RenderBackend,
    snapshot: WorldSnapshot,
    camera: Camera,
    times: dict[str, list[float]],
    contents: SceneContents,
    change: str | None,
) -> None:
    began = time.process_time()
    renderer.render(_of(snapshot, contents), None, camera, FIVE_VIEWS)
    if change is not None:
        times[change].append(1e3 * (time.process_time() - began))


def _of(snapshot: WorldSnapshot, contents: SceneContents) -> WorldSnapshot:
    count = len(contents.instances)
    return replace(
        snapshot,
        contents=contents,
        world_from_body=snapshot.world_from_body[:count].copy(),
        histories=snapshot.histories[:count].copy(),
    )


def main() -> None:
    """Measure all scenes and sizes and print them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", action="append", default=None)
    parser.add_argument("--size", action="append", default=None, metavar="WxH")
    parser.add_argument("--threads", default="2,1,4", help="the first one is compared")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--changes", action="store_true")
    parser.add_argument("--json", type=Path, default=None, help="write the figures here too")
    arguments = parser.parse_args()
    threads = [int(count) for count in arguments.threads.split(",")]
    sizes = [tuple(map(int, text.split("x"))) for text in arguments.size or ()] or list(SIZES)
    print(f"{os.cpu_count()} CPUs, {platform.platform()}")
    results: dict[str, Any] = {}
    for scene in arguments.scene or SCENES:
        for width, height in sizes:
            if arguments.changes:
                found: Any = measure_changes(scene, (width, height), max(3, arguments.frames // 4))
                print(f"{scene}, {width} x {height}, CPU [ms]: {found}")
            else:
                found = measure(scene, (width, height), arguments.frames, threads, tiny=True)
                show(scene, (width, height), threads, found)
            results[f"{scene} {width}x{height}"] = found
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(results, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
