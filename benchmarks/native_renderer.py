"""Time the native renderer beside OpenGL in software and others, and compare what they draw.

    python benchmarks/native_renderer.py [--scene NAME]... [--size WxH]... [--threads 2,1,4]
                                         [--frames N] [--changes] [--agents] [--json FILE]

One simulated world moves on; at each of its instants all take their turn in one process, so that
what disturbs the machine disturbs all alike. Ratios are of medians. ``CPU`` is the processor time
of all threads: it is what a busy machine disturbs least. OpenGL has as many threads as the machine
has processors; the native renderer has those that are told. PyBullet's two renderers and MuJoCo's
(where they are available) draw at every fourth instant.

`--changes` times the frame after a light was set, an object was spawned and was removed. `--agents`
times five views of 1, 4 and 16 cameras at 320 x 240.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import multiprocessing
import os
import platform
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import render_passes  # type: ignore[import-not-found]  # beside this file

from sailenv_bench.experiments.baselines import BASELINES, BaselineScene
from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.errors import SailenvError
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import FIVE_VIEWS

SCENES = ("room_01", "room_02", "room_03", "optical")
SIZES = ((240, 180), (640, 480), (1280, 960))
SETS = {
    "five views": FIVE_VIEWS,
    "annotations": tuple(view for view in FIVE_VIEWS if view != "rgb"),
}
OTHERS = ("PyBullet TinyRenderer", "PyBullet OpenGL", "MuJoCo")
OTHERS_EACH = 4
"""They draw at each so many instants: some take a second."""

ANSWER_S = 60.0
"""Time that another process may take to draw, or to begin [s]."""

AGENTS = (1, 4, 16)
WARM_UP = 3
STEPS = 8
"""Physics steps between two frames: 30 frames per simulated second."""

Times = dict[tuple[str, str], list[float]]


def measure(
    scene: str,
    size: tuple[int, int],
    frames: int,
    threads: Sequence[int],
    others_named: Sequence[str] = OTHERS,
) -> dict[str, Any]:
    """Time one scene at one size; medians [ms], and the greatest differences."""
    world = render_passes.world_maker(scene, 400)()
    camera_of = render_passes._camera_of(world, CameraIntrinsics(width=size[0], height=size[1]))
    renderers: dict[str, RenderBackend] = {"OpenGL": Renderer()}
    renderers |= {f"native {count}": NativeRenderer(threads=count) for count in threads}
    others = _others(scene, size, others_named)
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
                    RenderRequest(snapshot, camera, SETS[views], past.get((name, views)))
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
            for name, other in others.items() if number % OTHERS_EACH == 0 else ():
                wall[name, "five views"].append(other.draw())
            if number >= WARM_UP:
                compare(pictures["OpenGL"], pictures[f"native {threads[0]}"], differences)
    finally:
        for other in others.values():
            other.close()
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


class Elsewhere:
    """Another renderer in a process of its own, with a world of its own at the same instants.

    PyBullet's and MuJoCo's OpenGL do not get along with ours in one process.

    Raises
    ------
    RuntimeError
        If it is not available; the text says why.
    """

    def __init__(self, name: str, scene: str, size: tuple[int, int]) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_draw_elsewhere, args=(theirs, name, scene, size))
        self._process.start()
        theirs.close()
        if answer := self._ask():
            self.close()
            raise RuntimeError(answer)

    def draw(self) -> float:
        """Advance and draw once; return how long that took [ms]."""
        self._pipe.send(True)
        return float(self._ask())

    def close(self) -> None:
        """End the process."""
        self._pipe.close()
        self._process.join(10.0)
        self._process.kill()

    def _ask(self) -> Any:
        try:
            return self._pipe.recv() if self._pipe.poll(ANSWER_S) else "no answer"
        except EOFError:
            return "the process ended"


def _draw_elsewhere(pipe: Any, name: str, scene: str, size: tuple[int, int]) -> None:
    """Draw when told to, in a process of its own."""
    try:
        world = BaselineScene(scene, *size)
        picture = BASELINES[name][1]()
        picture.prepare(*world.advance(400))
        picture.draw()
    except (SailenvError, ImportError, OSError) as problem:
        pipe.send(str(problem))
        return
    pipe.send("")
    with contextlib.suppress(EOFError):
        while pipe.recv():
            picture.prepare(*world.advance(OTHERS_EACH * STEPS))
            began = time.perf_counter()
            picture.draw()
            pipe.send(1e3 * (time.perf_counter() - began))
    os._exit(0)


def _others(
    scene: str, size: tuple[int, int], names: Sequence[str] = OTHERS
) -> dict[str, Elsewhere]:
    """Start the other renderers that are available here."""
    made = {}
    for name in names:
        try:
            made[name] = Elsewhere(name, scene, size)
        except RuntimeError as problem:
            print(f"without {name}: {problem}")
    return made


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
    base = found["wall_ms"]["OpenGL five views"]
    for name in OTHERS:
        took = found["wall_ms"].get(f"{name} five views")
        if took is not None:
            print(f"  {'':12} {name:22} {took:8.1f} {took / base:6.2f}")
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


def measure_agents(scene: str, threads: int, frames: int) -> dict[str, dict[str, float]]:
    """Time an instant of several cameras; medians [ms] of processor time and wall time."""
    world = render_passes.world_maker(scene, 400)()
    camera_of = render_passes._camera_of(world, CameraIntrinsics(width=320, height=240))
    renderers: dict[str, RenderBackend] = {
        "OpenGL": Renderer(),
        f"native {threads}": NativeRenderer(threads=threads),
    }
    wall: dict[str, list[float]] = defaultdict(list)
    cpu: dict[str, list[float]] = defaultdict(list)
    for number in range(WARM_UP + frames):
        world.step(STEPS)
        snapshot = world.snapshot()
        # Cameras follow each other on their rails, a second apart.
        cameras = [camera_of(world.sim_time_ns + k * 10**9) for k in range(max(AGENTS))]
        for name, renderer in renderers.items():
            for agents in AGENTS:
                began, busy = time.perf_counter(), time.process_time()
                for camera in cameras[:agents]:
                    renderer.render(RenderRequest(snapshot, camera, FIVE_VIEWS))
                if number >= WARM_UP:
                    wall[f"{name}, {agents} agents"].append(1e3 * (time.perf_counter() - began))
                    cpu[f"{name}, {agents} agents"].append(1e3 * (time.process_time() - busy))
    world.close()
    for renderer in renderers.values():
        renderer.close()
    return {
        "wall_ms": {name: statistics.median(times) for name, times in wall.items()},
        "cpu_ms": {name: statistics.median(times) for name, times in cpu.items()},
    }


def _timed(
    renderer: RenderBackend,
    snapshot: WorldSnapshot,
    camera: Camera,
    times: dict[str, list[float]],
    contents: SceneContents,
    change: str | None,
) -> None:
    began = time.process_time()
    renderer.render(RenderRequest(_of(snapshot, contents), camera, FIVE_VIEWS))
    if change is not None:
        times[change].append(1e3 * (time.process_time() - began))


def _of(snapshot: WorldSnapshot, contents: SceneContents) -> WorldSnapshot:
    fewer = snapshot.of_rows(np.arange(len(contents.instances)))
    return replace(fewer, contents=contents)


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    threads = len(os.sched_getaffinity(0))
    ours = f"native {threads}"
    scenes, sizes = (SCENES[:1], SIZES[:1]) if quick else (SCENES, SIZES)
    for scene, size in itertools.product(scenes, sizes):
        others = OTHERS[::2] if scene == SCENES[0] else ()
        wall = measure(scene, size, 2 if quick else 8, [threads], others)["wall_ms"]
        label = f"{scene}, {size[0]}×{size[1]}"
        compared = [(views, "OpenGL") for views in SETS] + [("five views", one) for one in others]
        for views, other in compared:
            yield Measurement(
                name=f"{label}, {views}",
                value=wall[f"{ours} {views}"],
                unit="ms",
                other=other.replace("PyBullet TinyRenderer", "PyBullet's `getCameraImage`"),
                other_value=wall.get(f"{other} {views}"),
            )
    found = measure_agents(SCENES[0], threads, 2 if quick else 6)["wall_ms"]
    for agents in AGENTS:
        yield Measurement(
            name=f"{SCENES[0]}, 320×240, five views, cameras: {agents}",
            value=found[f"{ours}, {agents} agents"],
            unit="ms",
            other="OpenGL",
            other_value=found[f"OpenGL, {agents} agents"],
        )


def main() -> None:
    """Measure all scenes and sizes and print them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", action="append", default=None)
    parser.add_argument("--size", action="append", default=None, metavar="WxH")
    parser.add_argument("--threads", default="2,1,4", help="the first one is compared")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--changes", action="store_true")
    parser.add_argument("--agents", action="store_true")
    parser.add_argument("--json", type=Path, default=None, help="write the figures here too")
    arguments = parser.parse_args()
    threads = [int(count) for count in arguments.threads.split(",")]
    sizes = [tuple(map(int, text.split("x"))) for text in arguments.size or ()] or list(SIZES)
    print(f"{os.cpu_count()} CPUs, {platform.platform()}")
    results: dict[str, Any] = {}
    found: Any
    for scene in arguments.scene or SCENES if arguments.agents else ():
        results[f"{scene} agents"] = found = measure_agents(scene, threads[0], arguments.frames)
        print(f"{scene}, 320 x 240, five views of several cameras: {found}")
    for scene in () if arguments.agents else arguments.scene or SCENES:
        for width, height in sizes:
            if arguments.changes:
                found = measure_changes(scene, (width, height), max(3, arguments.frames // 4))
                print(f"{scene}, {width} x {height}, CPU [ms]: {found}")
            else:
                found = measure(scene, (width, height), arguments.frames, threads)
                show(scene, (width, height), threads, found)
            results[f"{scene} {width}x{height}"] = found
    if arguments.json is not None:
        arguments.json.write_text(json.dumps(results, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
