"""Generates rooms by many seeds and checks each file again: how many have a fault, the times.

    python -m benchmarks.generated_rooms --seeds 0 1000 --results rooms.jsonl --workers 2

A fault is a room that cannot be made, a file that is read as another scene, or one in which
something overlaps by more than 2 mm, is in the camera's way, or moves by more than 5 mm in two
seconds of physics. The kind is the one that the seed stands for, unless one is named. With
`--results` each room becomes a line of a file, and rooms that are in it are not made again as long
as rules, furniture and generator are the same, but for those with a fault.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from statistics import median
from typing import Any

from sailenv_content.generation.generator import GeneratedScene, Generator
from sailenv_ros.authoring.room_rules.names import drawn_kind
from sailenv_ros.errors import SailenvError
from sailenv_ros.simulation.generated_scenes import generation_state
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.physics_check import obstructions, overlaps, shifts

Row = dict[str, Any]
"""Kind, seed, state, objects, assets, attempts, taken_out, checked, faults, wall_s, cpu_s."""


class Judge:
    """Generates rooms and checks them; keeps what it has loaded.

    Parameters
    ----------
    kind : str or None
        Of all rooms; None takes the seeds' own.
    every : int
        The files of every so many seeds are checked again.
    """

    def __init__(self, kind: str | None, every: int) -> None:
        self._kind, self._every = kind, every
        self._generator, self._library = Generator(), SceneLibrary()
        self._state = generation_state()

    def row(self, seed: int) -> Row:
        """Make one room and return what was found."""
        kind = self._kind or drawn_kind(seed, self._generator.rules)
        row: Row = {"kind": kind, "seed": seed, "state": self._state, "checked": False}
        wall, cpu = time.perf_counter(), time.process_time()
        try:
            made = self._generator.generate(kind, seed)
        except SailenvError as problem:
            return {**row, "faults": [str(problem)]}
        row["wall_s"] = round(time.perf_counter() - wall, 3)
        row["cpu_s"] = round(time.process_time() - cpu, 3)
        row["objects"], row["attempts"] = len(made.spec.objects), made.attempts
        row["assets"] = sorted({entry.asset for entry in made.spec.objects})
        row["taken_out"] = [fault.why for fault in made.taken_out]
        row["checked"] = seed % self._every == 0
        try:
            row["faults"] = list(self._faults(made)) if row["checked"] else []
        except SailenvError as problem:
            row["faults"] = [str(problem)]
        return row

    def _faults(self, made: GeneratedScene) -> Iterator[str]:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / f"{made.kind}_{made.seed}.yaml"
            file.write_text(made.text, encoding="utf-8")
            if self._library.load(file) != made.spec:
                yield "the file is read as another scene"
            world = self._library.build(file)
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


_judge: Judge | None = None
"""Of a worker process."""


def _begin(kind: str | None, every: int) -> None:
    global _judge
    _judge = Judge(kind, every)


def _row(seed: int) -> Row:
    assert _judge is not None
    return _judge.row(seed)


def main() -> int:
    """Generate, check and report; 1 if any room has a fault."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs=2, default=(0, 1000), metavar=("FIRST", "END"))
    parser.add_argument("--kind", help="of all rooms; the seeds' own if left out")
    parser.add_argument("--every", type=int, default=1, help="check the files of every so many")
    parser.add_argument("--results", type=Path, help="file of lines of JSON, to go on with")
    parser.add_argument("--workers", type=int, default=1)
    args = parser.parse_args()
    known = _known(args.results, args.kind)
    wanted = range(*args.seeds)
    rows = [known[seed] for seed in wanted if seed in known]
    waiting = [seed for seed in wanted if seed not in known]
    with multiprocessing.get_context("spawn").Pool(
        args.workers, _begin, (args.kind, args.every)
    ) as pool:
        for row in pool.imap_unordered(_row, waiting):
            rows.append(row)
            _keep(args.results, row)
            for fault in row["faults"]:
                print(f"{row['kind']} {row['seed']}: {fault}", flush=True)
            if len(rows) % 10 == 0:
                faulty = sum(bool(each["faults"]) for each in rows)
                print(f"{len(rows)} of {len(wanted)} rooms, {faulty} with a fault", file=sys.stderr)
    return _report(rows)


def _known(results: Path | None, kind: str | None) -> dict[int, Row]:
    """Return the rooms of a file that are as they would be made now, and have no fault."""
    if results is None or not results.is_file():
        return {}
    state, wanted = generation_state(), kind
    found = map(json.loads, results.read_text(encoding="utf-8").splitlines())
    return {
        row["seed"]: row
        for row in found
        if row["state"] == state and not row["faults"] and wanted in (None, row["kind"])
    }


def _keep(results: Path | None, row: Row) -> None:
    if results is not None:
        with results.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")


def _report(rows: list[Row]) -> int:
    faulty = sum(bool(row["faults"]) for row in rows)
    checked = sum(row["checked"] for row in rows)
    print(f"{len(rows)} rooms, {checked} checked anew, {faulty} with a fault")
    print(f"{'kind':<12} rooms  median [s]  slowest [s]  processor [s]  objects  drawn  different")
    for kind in (*sorted({row["kind"] for row in rows}), "all"):
        made = [r for r in rows if kind in (r["kind"], "all") and "wall_s" in r]
        if made:
            print(
                f"{kind:<12} {len(made):5d} {_middle(made, 'wall_s'):11.1f} "
                f"{max(r['wall_s'] for r in made):12.1f} {_middle(made, 'cpu_s'):14.1f} "
                f"{_middle(made, 'objects'):8.0f} {sum(_of(made, 'attempts')) / len(made):6.2f} "
                f"{len({asset for r in made for asset in r['assets']}):10d}"
            )
    return int(faulty > 0)


def _of(rows: Iterable[Row], key: str) -> list[float]:
    return [row[key] for row in rows]


def _middle(rows: Iterable[Row], key: str) -> float:
    return float(median(_of(rows, key)))


if __name__ == "__main__":
    raise SystemExit(main())
