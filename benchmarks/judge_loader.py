"""Has a data set read by PyTorch's DataLoader with its default collate function, by processes.

    sailenv dataset make benchmarks/judge_loader.yaml -o set
    pip install torch
    python -m benchmarks.judge_loader set --workers 2
    python -m benchmarks.judge_loader set --workers 2 --stream benchmarks/judge_loader.yaml

For both formats, and for workers that are forked and that are spawned, every batch must have the
values of the frames. Then samples a second are measured, and the processor time of all processes
for one: on a machine that is busy otherwise, this says how many two free cores would read. With
`--stream` the recipe's frames come without files instead, each once, equal to those in the files.
"""

from __future__ import annotations

import argparse
import importlib
import multiprocessing
import os
import time
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros import dataset
from sailenv_ros.types.views import VIEWS


def judge(folder: Path, form: str, method: str, workers: int) -> int:
    """Compare all batches with the frames; return how many samples there were."""
    data = importlib.import_module("torch.utils.data")
    frames = dataset.open(folder)
    samples: Any = dataset.open(folder, format=form)
    assert frames[0].number == samples[0]["number"]  # opened before the fork
    seen = 0
    loader = data.DataLoader(
        samples, batch_size=16, num_workers=workers, multiprocessing_context=method, timeout=120
    )
    for batch in loader:
        for row in range(len(batch["number"])):
            check(batch, row, frames[seen], form)
            seen += 1
    assert seen == len(frames), (seen, len(frames))
    return seen


def check(batch: Any, row: int, one: dataset.DatasetFrame, form: str) -> None:
    """Compare a row of a batch with the frame that it stands for."""
    assert one.number == batch["number"][row], (one.number, batch["number"])
    for view, values in one.frame.items():
        read = batch[view][row].numpy()
        if form == "torch" and VIEWS[view].channels > 1:
            read = np.moveaxis(read, 0, -1)
        assert np.array_equal(read, values, equal_nan=values.dtype.kind == "f"), view
    matrix = batch["world_from_camera"][row].numpy()
    assert np.array_equal(matrix, one.frame.camera.world_from_camera)
    assert batch["split"][row] == one.split


def judge_stream(folder: Path, recipe: Path, method: str, workers: int) -> int:
    """Compare what is made as it is taken with the files; return how many samples there were."""
    data = importlib.import_module("torch.utils.data")
    by_number = {one.number: one for one in dataset.open(folder)}
    loader = data.DataLoader(
        dataset.stream(recipe, format="torch"),
        batch_size=16,
        num_workers=workers,
        multiprocessing_context=method,
        timeout=300,
    )
    count, seen = len(by_number), 0
    for batch in loader:
        for row, number in enumerate(batch["number"].tolist()):
            check(batch, row, by_number.pop(number), "torch")
            seen += 1
    assert not by_number, f"{len(by_number)} of {count} frames did not come"
    return seen


def processor_s() -> float:
    """Return the processor time of this process and of its workers so far [s]."""
    ticks = 0
    for process in (os.getpid(), *(one.pid for one in multiprocessing.active_children())):
        told = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        ticks += int(told[11]) + int(told[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def speed(folder: Path, form: str, method: str, workers: int, passes: int) -> tuple[float, float]:
    """Return samples a second of passes in random order, and processor time of a sample [ms].

    The first pass, in which workers start and look for what is where in the files, is not counted.
    """
    data = importlib.import_module("torch.utils.data")
    samples: Any = dataset.open(folder, format=form)
    loader = data.DataLoader(
        samples,
        batch_size=16,
        shuffle=True,
        num_workers=workers,
        multiprocessing_context=method,
        timeout=120,
        persistent_workers=True,
    )
    for batch in loader:
        assert len(batch["number"])
    before, began, seen = processor_s(), time.perf_counter(), 0
    for _ in range(passes):
        for batch in loader:
            seen += len(batch["number"])
    took, used = time.perf_counter() - began, processor_s() - before
    return seen / took, 1e3 * used / seen


def main() -> None:
    """Judge both formats by both methods, then measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--passes", type=int, default=5, help="that are timed")
    parser.add_argument("--stream", type=Path, metavar="RECIPE", help="of the same data set")
    args = parser.parse_args()
    if args.stream is not None:
        for method in ("fork", "spawn"):
            began = time.perf_counter()
            seen = judge_stream(args.folder, args.stream, method, args.workers)
            rate = seen / (time.perf_counter() - began)
            print(f"stream by {method}: {seen} samples equal; {rate:.0f} samples/s with the start")
        return
    for form in ("numpy", "torch"):
        for method in ("fork", "spawn"):
            seen = judge(args.folder, form, method, args.workers)
            rate, cost_ms = speed(args.folder, form, method, args.workers, args.passes)
            print(
                f"{form} by {method}: {seen} samples equal; {rate:.0f} samples/s, "
                f"{cost_ms:.2f} ms of processor time each",
                flush=True,
            )


if __name__ == "__main__":
    main()
