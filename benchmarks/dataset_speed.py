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
from collections.abc import Sequence
from pathlib import Path

import yaml

from sailenv_ros.dataset import engine_of, load_job, make_dataset
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.native.library import THREADS_VARIABLE
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.views import RENDERED_VIEWS

CLIPS_OF_SHARD = 50


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
    scenes = ("room_01", "room_02", "room_03")
    job = _job(folder, scenes, args.frames, args.views, args.formats)
    ways: dict[str, tuple[int, str | None]] = {"1 worker": (1, None), "2 workers": (2, None)}
    if args.ray:
        ways["Ray, 2 processors"] = (1, "local")
    hashes = set()
    try:
        # Whatever is kept for the next time, such as baked light, is there after this.
        make_dataset(job, folder / "first", engine_of(2, None))
        print("| way | frames a minute | MB/s | processor time a frame [ms] |")
        print("|---|---:|---:|---:|")
        for name, (workers, ray) in ways.items():
            began, busy = time.monotonic(), _processor_s()
            made = make_dataset(job, folder / name, engine_of(workers, ray))
            seconds = time.monotonic() - began
            hashes.add(made.sha256)
            rate, speed = 60.0 * made.frames / seconds, made.bytes / seconds * 1e-6
            cost = "" if ray else f"{1e3 * (_processor_s() - busy) / made.frames:.0f}"
            print(f"| {name} | {rate:.0f} | {speed:.0f} | {cost} |", flush=True)
            shutil.rmtree(folder / name)
        print(f"hashes: {'equal' if len(hashes) == 1 else 'DIFFERENT'}")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


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
