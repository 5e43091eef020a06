"""Speed of physics with many moving bodies: simulated seconds per second, in turn.

    python benchmarks/many_bodies.py [--bodies N] [--seconds S] [--rounds N] [--against FOLDER]

Three scenes of N solids in a closed room: pushed by poltergeists, bouncing at random, and standing
in piles. Each is run in a process of its own, round after round; `--against` names the folder of
another version of this repository, which is run in turn with this one. Of each are told

- how much processor time and wall time a simulated second takes (medians of the rounds) and the
  real-time factor that a processor of its own would give,
- how far a body's middle got beyond the walls at most, and how deep bodies stand in walls,
- a digest of all poses at the end: the rounds must agree,
- how far a body that stands in a pile gets from where the scene puts it.

The first simulated second is not counted: solids fall to the floor in it.
"""

from __future__ import annotations

import argparse
import hashlib
import itertools
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_bench.suite.measurement import Measurement

ROOM_M = (6.0, 6.0, 3.0)
SIZE_M = 0.3
ASSETS = ("cube", "sphere", "cylinder")
KINDS = ("poltergeist", "bounce", "piles")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bodies", type=int, default=200)
    parser.add_argument("--seconds", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        print(json.dumps(_measure(options.measure, options.bodies, options.seconds)))
        return
    here = Path(__file__).resolve().parents[1]
    versions = {"this": here} | ({"against": options.against} if options.against else {})
    results: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for _ in range(options.rounds):
        for kind, (label, folder) in itertools.product(options.kinds, versions.items()):
            found = _run(folder, kind, options.bodies, options.seconds)
            results.setdefault((kind, label), []).append(found)
    print(f"{options.bodies} bodies, {options.seconds} simulated seconds, {options.rounds} rounds")
    print(
        "kind         version  cpu [s/s]  wall [s/s]  factor  out [mm]  depth [mm]  moved [mm]"
        "  digests"
    )
    for (kind, label), rounds in results.items():
        cpu, wall = (
            statistics.median(float(r[what]) / options.seconds for r in rounds)
            for what in ("cpu_s", "wall_s")
        )
        print(
            f"{kind:12} {label:8} {cpu:9.3f} {wall:11.3f} "
            f"{1.0 / cpu:7.2f} {1e3 * rounds[0]['out_m']:9.2f} "
            f"{1e3 * rounds[0]['depth_m']:11.2f} {1e3 * rounds[0]['moved_m']:11.2f}  "
            f"{sorted({r['digest'] for r in rounds})}"
        )


def scene_of(kind: str, bodies: int) -> dict[str, Any]:
    """Return the scene as a scene file has it."""
    behaviours: list[dict[str, Any]] = {
        "poltergeist": [{"type": "poltergeist", "mean_interval": 0.5}],
        "bounce": [{"type": "uniform_movement_random_bounce", "speed": 1.0}],
        "piles": [],
    }[kind]
    across, layers = 14, (1 if kind == "poltergeist" else 3)
    objects = []
    for number in range(bodies):
        place, layer = divmod(number, layers)
        row, column = divmod(place, across)
        height = 0.5 * SIZE_M + layer * (SIZE_M if kind == "piles" else 0.9)
        asset = ASSETS[place % 3] if layer == 0 else ASSETS[0]
        objects.append(
            {
                "name": f"solid {number}",
                "asset": "cube" if kind == "piles" else asset,
                "position": [0.4 * (column - 6.5), 0.4 * (row - 6.5), height],
                "scale": SIZE_M,
                "gravity": kind != "bounce",
                "behaviours": behaviours,
            }
        )
    return {"version": 1, "room": {"size": list(ROOM_M), "skirting": False}, "objects": objects}


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    # Here: the version that this one is run against may be without it.
    from sailenv_bench.suite.measurement import Measurement

    bodies, seconds, rounds = (50, 1, 1) if quick else (200, 5, 2)
    here = Path(__file__).resolve().parents[1]
    cpu_s: dict[str, list[float]] = {kind: [] for kind in KINDS}
    for _, kind in itertools.product(range(rounds), KINDS):
        cpu_s[kind].append(float(_run(here, kind, bodies, seconds)["cpu_s"]) / seconds)
    for kind, times in cpu_s.items():
        yield Measurement(
            name=f"{bodies} bodies, {kind}",
            value=statistics.median(times),
            unit="s",
            other="the simulated second",
            other_value=1.0,
        )


def _run(folder: Path, kind: str, bodies: int, seconds: int) -> dict[str, Any]:
    counts = ["--bodies", str(bodies), "--seconds", str(seconds)]
    done = subprocess.run(
        [sys.executable, __file__, "--measure", kind, *counts],
        env={**os.environ, "PYTHONPATH": str(folder), "SAILENV_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=600,
    )
    if done.returncode:
        sys.exit(done.stderr)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def _measure(kind: str, bodies: int, seconds: int) -> dict[str, Any]:
    import numpy as np

    from sailenv_ros.simulation.scenes import SceneLibrary

    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.yaml"
        scene.write_text(json.dumps(scene_of(kind, bodies)))
        world = SceneLibrary().build(scene, seed=3, epoch=1)
    first = world.snapshot().world_from_body
    world.step(240)
    wall_s, cpu_s, out_m, depth_m = 0.0, 0.0, 0.0, 0.0
    high = np.array([ROOM_M[0] / 2, ROOM_M[1] / 2, ROOM_M[2]])
    low = np.array([-ROOM_M[0] / 2, -ROOM_M[1] / 2, 0.0])
    loose = np.array([not body.placement.static for body in world.bodies])
    static = {body.bullet_id for body in world.bodies if body.placement.static}
    for _ in range(10 * seconds):
        began, began_cpu = time.perf_counter(), time.process_time()
        world.step(24)
        wall_s += time.perf_counter() - began
        cpu_s += time.process_time() - began_cpu
        middles = world.snapshot().world_from_body[loose, :3, 3]
        out_m = max(out_m, float((middles - high).max()), float((low - middles).max()))
        for point in world.client.getContactPoints():
            if point[1] in static or point[2] in static:
                depth_m = max(depth_m, -float(point[8]))
    last = world.snapshot().world_from_body
    digest = hashlib.sha256(last.tobytes()).hexdigest()[:12]
    moved_m = float(np.linalg.norm(last[:, :3, 3] - first[:, :3, 3], axis=1).max())
    world.close()
    return {
        "wall_s": wall_s,
        "cpu_s": cpu_s,
        "out_m": out_m,
        "depth_m": depth_m,
        "digest": digest,
        "moved_m": moved_m,
    }


if __name__ == "__main__":
    main()
