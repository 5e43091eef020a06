"""Time the baking of light: stages, rays, texels, memory, and loading what was baked.

    python benchmarks/bake_speed.py [--scene NAME ...] [--workers N] [--json FILE]
        [--against CHECKOUT] [--rounds N]

No light is read from the cache or written to it. With `--against` another checkout of the
repository bakes the same scenes in turn with this one, each time in a process of its own, so that
both meet the same load.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.light.bake import light_files as files
from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.static_geometry import static_geometry_of
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.snapshot import WorldSnapshot

RAYS = 1_000_000


class Stages:
    """Notes when each stage begins."""

    def __init__(self) -> None:
        self._begun: list[tuple[str, float, float]] = []

    def __call__(self, stage: str, share: float) -> None:
        """Take note of progress."""
        if not self._begun or self._begun[-1][0] != stage:
            self._begun.append((stage, time.perf_counter(), time.process_time()))

    def seconds(self) -> dict[str, tuple[float, float]]:
        """Return wall and processor seconds of each stage, after the last has ended."""
        marks = [*self._begun, ("", time.perf_counter(), time.process_time())]
        return {
            stage: (after[1] - wall, after[2] - cpu)
            for (stage, wall, cpu), after in itertools.pairwise(marks)
        }


def rays_per_second(snapshot: WorldSnapshot) -> float:
    """Cast rays from one thread, from the scene's middle to everywhere."""
    geometry = static_geometry_of(snapshot)
    scene = RayScene(geometry)
    generator = np.random.default_rng(0)
    low, high = geometry.bounds()
    spread = generator.uniform(-0.3, 0.3, (RAYS, 3)) * (high - low)
    origins = ((low + high) / 2 + spread).astype(np.float32)
    directions = generator.normal(size=(RAYS, 3)).astype(np.float32)
    started = time.perf_counter()
    scene.hits(origins, directions)
    return RAYS / (time.perf_counter() - started)


def never_hashed(snapshot: WorldSnapshot) -> WorldSnapshot:
    """Return the same with copies of the models: hashes of those that were built are kept."""
    contents = snapshot.contents
    copies = {drawn.model: replace(drawn.model) for drawn in contents.instances}
    instances = tuple(replace(drawn, model=copies[drawn.model]) for drawn in contents.instances)
    return replace(snapshot, contents=replace(contents, instances=instances))


def measured(scene: str, snapshot: WorldSnapshot, workers: int) -> dict[str, Any]:
    """Bake a scene and say what it took."""
    stages = Stages()
    started = time.perf_counter()
    previews: list[float] = []
    baked = bake(
        snapshot,
        report=stages,
        workers=workers,
        preview=lambda light: previews.append(time.perf_counter() - started),
    )
    total = time.perf_counter() - started
    seconds = stages.seconds()
    unknown = never_hashed(snapshot)
    started = time.perf_counter()
    fingerprint(unknown)
    named = time.perf_counter() - started
    path = files.store_baked(baked)
    started = time.perf_counter()
    files.load_baked(baked.fingerprint)
    loaded = time.perf_counter() - started
    side = baked.layers[0].direct.shape[0]
    return {
        "scene": scene,
        "total_s": total,
        "previews_s": previews,
        "stages_s": {stage: wall for stage, (wall, _) in seconds.items()},
        "processor_s": sum(cpu for _, cpu in seconds.values()),
        "map": side,
        "texels_lit": int(np.any([y.bounced.any(axis=-1) for y in baked.layers], axis=0).sum()),
        "layers": len(baked.layers),
        "probes": int(np.prod(baked.probes.shape)),
        "rays_per_s": rays_per_second(snapshot),
        "file_mb": path.stat().st_size / 1e6,
        "load_s": loaded,
        "fingerprint_s": named,
        "peak_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def _print(result: dict[str, Any]) -> None:
    previews = ", ".join(f"{seconds:.1f} s" for seconds in result["previews_s"])
    print(f"\n{result['scene']}: {result['total_s']:.1f} s; shown roughly after {previews}")
    for stage, seconds in result["stages_s"].items():
        print(f"  {stage:<24} {seconds:7.1f} s")
    print(
        f"  processor time {result['processor_s']:.0f} s; "
        f"{result['rays_per_s'] / 1e6:.1f} million rays/s from one thread\n"
        f"  map {result['map']} x {result['map']}, {result['texels_lit']:,} texels lit, "
        f"{result['layers']} layers, {result['probes']} probes\n"
        f"  file {result['file_mb']:.0f} MB, loaded in {result['load_s']:.2f} s; "
        f"fingerprint {1000 * result['fingerprint_s']:.0f} ms; peak {result['peak_gb']:.2f} GB"
    )


ALONE = """
import itertools, json, sys, time
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.simulation.scenes import SceneLibrary
times = {}
for scene in sys.argv[1:]:
    world = SceneLibrary().build(scene, seed=0, epoch=0, next_revision=itertools.count().__next__)
    snapshot = world.snapshot()
    world.close()
    wall, processor = time.perf_counter(), time.process_time()
    bake(snapshot)
    times[scene] = time.perf_counter() - wall, time.process_time() - processor
print(json.dumps(times))
"""
"""Bakes without asking for anything that only one of the versions has."""


def in_turn(checkouts: dict[str, Path], scenes: list[str], rounds: int) -> None:
    """Bake in each checkout in turn; print the least of each time. The first round compiles."""
    least: dict[tuple[str, str], tuple[float, float]] = {}
    for number in range(rounds + 1):
        for name, folder in checkouts.items():
            environment = {**os.environ, "PYTHONPATH": str(folder)}
            done = subprocess.run(
                [sys.executable, "-c", ALONE, *scenes],
                env=environment, cwd=folder, capture_output=True, text=True, check=True,
            )  # fmt: skip
            for scene, times in json.loads(done.stdout).items() if number else ():
                before = least.get((scene, name), times)
                least[scene, name] = min(before[0], times[0]), min(before[1], times[1])
    for (scene, name), (wall, processor) in sorted(least.items()):
        print(f"{scene:10} {name:8} {wall:6.1f} s, {processor:6.1f} s of processor")


def baked(scenes: Sequence[str], workers: int) -> Iterator[dict[str, Any]]:
    """Bake scenes into an empty cache, which is deleted."""
    library = SceneLibrary()
    # The furniture is in the user's cache, which is moved afterwards.
    snapshots = {scene: library.snapshot(scene) for scene in scenes}
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SAILENV_CACHE"] = folder
        for scene, snapshot in snapshots.items():
            yield measured(scene, snapshot, workers)


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`; the processor time needs no comparison to be steady."""
    for result in baked(["room_03"] if quick else ["room_01", "room_03"], 0):
        yield Measurement(
            name=f"{result['scene']}, until a draft is shown",
            value=result["previews_s"][0],
            unit="s",
            other="the whole bake",
            other_value=result["total_s"],
        )
        yield Measurement(
            name=f"{result['scene']}, processor time", value=result["processor_s"], unit="s"
        )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", help="default: room_01")
    parser.add_argument("--workers", type=int, default=0, help="threads (default: one a core)")
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--against", type=Path, metavar="CHECKOUT", help="bake with both in turn")
    parser.add_argument("--rounds", type=int, default=2, help="of baking in turn")
    args = parser.parse_args()
    if args.against is not None:
        here = Path(__file__).resolve().parents[1]
        in_turn(
            {"this": here, "other": args.against.resolve()}, args.scene or ["room_01"], args.rounds
        )
        return
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    results = []
    for result in baked(args.scene or ["room_01"], args.workers):
        results.append(result)
        _print(result)
    if args.json:
        args.json.write_text(json.dumps(results, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
