"""Speed of making data sets: frames a minute with all views, by 1 and 2 workers, and by Ray.

Run ``python -m benchmarks.dataset_speed [--frames 400] [--folder DIR] [--ray]``. The recipe is
single pictures of room_01 to room_03 at 640 x 480 with every view that is rendered, written as
WebDataset; ``--formats`` names others. Each way makes a data set of its own; their hashes must be
equal. Processor time is that of all threads and processes, the starts among them; of Ray's it is
not known here.

``--costs`` tells instead what one thread needs for a frame and for the begin of a scene, in
processor time, which depends less on what else the machine does.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import yaml

from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.dataset import engine_of, load_job, make_dataset
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.threads import THREADS_VARIABLE
from sailenv_ros.types.views import RENDERED_VIEWS

CLIPS_OF_SHARD = 50
SCENES = ("room_01", "room_02", "room_03")


def main() -> None:
    """Print a row of a table for each way."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=400)
    parser.add_argument("--folder", type=Path, default=None, help="where to write (default: tmp)")
    parser.add_argument("--formats", nargs="+", default=["webdataset"])
    parser.add_argument("--views", nargs="+", default=list(RENDERED_VIEWS))
    parser.add_argument("--ray", action="store_true", help="a local Ray cluster too")
    parser.add_argument("--costs", action="store_true", help="processor time by what it goes into")
    args = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="dataset_", dir=args.folder))
    if args.costs:
        _tell_costs(folder, args.views, args.formats)
        return
    job = _job(folder, SCENES, args.frames, args.views, args.formats)
    ways: dict[str, tuple[int, str | None]] = {"1 worker": (1, None), "2 workers": (2, None)}
    if args.ray:
        ways["Ray, 2 processors"] = (1, "local")
    hashes = set()
    try:
        print("| way | frames a minute | MB/s | processor time a frame [ms] |")
        print("|---|---:|---:|---:|")
        for made in _made(job, folder, ways):
            hashes.add(made.sha256)
            cost = "" if made.way.startswith("Ray") else f"{made.cost_ms:.0f}"
            print(f"| {made.way} | {made.rate:.0f} | {made.speed:.0f} | {cost} |", flush=True)
        print(f"hashes: {'equal' if len(hashes) == 1 else 'DIFFERENT'}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


class Made(NamedTuple):
    """Speed of one way: frames a minute, MB/s, processor time of a frame [ms]."""

    way: str
    rate: float
    speed: float
    cost_ms: float
    sha256: str


def _made(job: Job, folder: Path, ways: dict[str, tuple[int, str | None]]) -> Iterator[Made]:
    """Make the data set in each way, after a first time that is not counted."""
    # Whatever is kept for the next time, such as baked light, is there after this.
    make_dataset(job, folder / "first", engine_of(2, None))
    for way, (workers, ray) in ways.items():
        began, busy = time.monotonic(), _processor_s()
        made = make_dataset(job, folder / way, engine_of(workers, ray))
        seconds = time.monotonic() - began
        yield Made(
            way=way,
            rate=60.0 * made.frames / seconds,
            speed=made.bytes / seconds * 1e-6,
            cost_ms=1e3 * (_processor_s() - busy) / made.frames,
            sha256=made.sha256,
        )
        shutil.rmtree(folder / way)


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    with tempfile.TemporaryDirectory(prefix="dataset_") as name:
        folder = Path(name)
        scenes, frames = (SCENES[:1], 20) if quick else (SCENES, 300)
        job = _job(folder, scenes, frames, RENDERED_VIEWS, ["webdataset"])
        one, two = _made(job, folder, {"1": (1, None), "2": (2, None)})
        assert one.sha256 == two.sha256
        label = f"{frames} pictures 640×480 of {len(scenes)} rooms, every view, WebDataset"
        yield Measurement(
            name=f"{label}: 2 workers",
            value=two.rate,
            unit="frames a minute",
            other="1 worker",
            other_value=one.rate,
        )
        yield Measurement(name=f"{label}: processor time of a frame", value=one.cost_ms, unit="ms")


def _job(
    folder: Path, scenes: Sequence[str], frames: int, views: Sequence[str], formats: Sequence[str]
) -> Job:
    recipe = {
        "version": 1,
        "scenes": [{"scene": scene} for scene in scenes],
        "clips": {"train": frames},
        "clip": {"per_scene": CLIPS_OF_SHARD, "gap": 0.1},
        "cameras": [{"type": "rule", "rule": "free_view"}],
        "views": list(views),
        "formats": list(formats),
        "shard": {"clips": CLIPS_OF_SHARD},
    }
    path = folder / "speed.yaml"
    path.write_text(yaml.safe_dump(recipe))
    return load_job(path)


def _tell_costs(folder: Path, views: Sequence[str], formats: Sequence[str]) -> None:
    """Make three shards of one room: the second and the third differ by their frames alone."""
    os.environ[THREADS_VARIABLE] = "1"
    keep_freed_memory()
    few = 10
    job = _job(folder, ["room_01"], 2 * CLIPS_OF_SHARD + few, views, formats)
    seconds = []
    try:
        with ShardMaker(job, open_storage(folder / "set")) as maker:
            for shard in range(3):
                began = time.process_time()
                maker.make(shard)
                seconds.append(time.process_time() - began)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    frame_s = (seconds[1] - seconds[2]) / (CLIPS_OF_SHARD - few)
    again_s = seconds[2] - few * frame_s
    first_s = seconds[0] - CLIPS_OF_SHARD * frame_s
    print(
        f"processor time: {1e3 * frame_s:.0f} ms a frame, {first_s:.1f} s to begin a scene for the "
        f"first time, {again_s:.1f} s again"
    )


def _processor_s() -> float:
    """Return the processor time of this process and of those that it waited for [s]."""
    return sum(os.times()[:4])


if __name__ == "__main__":
    main()
