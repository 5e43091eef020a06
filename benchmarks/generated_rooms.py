"""Generates rooms by many seeds and checks each file anew: how many have a fault, the times.

    python -m benchmarks.generated_rooms --seeds 0 1000

A fault is a room that cannot be made, a file that is read as another scene, or one in which
something overlaps by more than 2 mm, is in the camera's way, or moves by more than 5 mm in two
seconds of physics. The kind is the one that the seed stands for, unless one is named.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from sailenv_ros.errors import SailenvError
from sailenv_ros.generation import GeneratedScene, Generator, drawn_kind
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.physics_check import obstructions, overlaps, shifts


def main() -> int:
    """Generate, check and report; 1 if any room has a fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 1000), metavar=("FIRST", "END"))
    parser.add_argument("--kind", help="of all rooms; the seeds' own if left out")
    parser.add_argument("--every", type=int, default=1, help="check the files of every so many")
    args = parser.parse_args()
    generator, library = Generator(), SceneLibrary()
    times: dict[str, list[float]] = defaultdict(list)
    attempts: dict[str, list[int]] = defaultdict(list)
    objects: dict[str, list[int]] = defaultdict(list)
    faulty = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(*args.seeds):
            kind = args.kind or drawn_kind(seed, generator.rules)
            start = time.perf_counter()
            try:
                made = generator.generate(kind, seed)
                times[kind].append(time.perf_counter() - start)
                attempts[kind].append(made.attempts)
                objects[kind].append(len(made.spec.objects))
                check = seed % args.every == 0
                faults = list(_faults(made, library, Path(folder))) if check else []
            except SailenvError as problem:
                faults = [str(problem)]
            for fault in faults:
                print(f"{kind} {seed}: {fault}", flush=True)
            faulty += bool(faults)
            if sum(map(len, times.values())) % 10 == 0:
                print(f"{seed + 1 - args.seeds[0]} rooms, {faulty} with a fault", file=sys.stderr)
    print(f"{sum(map(len, times.values()))} rooms, {faulty} with a fault")
    print(f"{'kind':<12} rooms  mean [s]  slowest [s]  objects  drawn")
    for kind, values in sorted(times.items()):
        print(
            f"{kind:<12} {len(values):5d} {sum(values) / len(values):9.1f} {max(values):12.1f} "
            f"{sum(objects[kind]) / len(values):8.0f} {sum(attempts[kind]) / len(values):6.2f}"
        )
    return int(faulty > 0)


def _faults(made: GeneratedScene, library: SceneLibrary, folder: Path) -> Iterator[str]:
    file = folder / f"{made.kind}_{made.seed}.yaml"
    file.write_text(made.text, encoding="utf-8")
    if library.load(file) != made.spec:
        yield "the file is read as another scene"
    world = library.build(file, seed=0, epoch=1, next_revision=itertools.count(1).__next__)
    try:
        for overlap in overlaps(world):
            depth = 1000.0 * overlap.depth_m
            yield f"{overlap.first!r} and {overlap.second!r} overlap by {depth:.1f} mm"
        for way in obstructions(world):
            yield f"{way.name!r} is in the camera's way"
        for shift in shifts(world, distance_m=0.005):
            yield f"{shift.name!r} moves by {1000.0 * shift.distance_m:.1f} mm"
    finally:
        world.close()
        file.unlink()


if __name__ == "__main__":
    raise SystemExit(main())
