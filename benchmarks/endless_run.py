"""Makes a million frames of a stream without an end, keeps their sums alone, and looks at the rest.

    python -m benchmarks.endless_run make FILE [--frames N] [--smooth] [--kills N] [--seed N]
    python -m benchmarks.endless_run check FILE

`make` has two processes make the parts of the stream and writes a line into FILE for each that is
whole: the SHA-256 of its frames, those of some frames of their own, time, and memory: what was the
process's own after the part, and the most that it took meanwhile, mapped files included. All its
processes are ended by SIGKILL at random moments of the first fifth, and begun again; later calls go
on, too. `check` counts the parts, makes 200 random frames by their numbers in processes that have
made none, and tells speed and memory of what ran undisturbed.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import sailenv_ros.streams as streams
from benchmarks.judge_streams import WARM_FRAMES, digest_of, forget_peak, memory_mib
from sailenv_ros.dataset.worker_pool import WorkerPool
from sailenv_ros.streams.course import Course, load_course
from sailenv_ros.system.memory import keep_freed_memory

PART, CHECKED = 500, 200

POLL_S = 0.5
WINDOW = 100_000
"""Frames in which the greatest memory is looked for: all rooms are visited."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """The first frames of `home`."""

    frames: int
    smooth: bool
    seed: int
    kills: int

    @property
    def parts(self) -> int:
        """Number of parts."""
        return -(-self.frames // PART)

    @property
    def course(self) -> Course:
        """The course, with smooth edges or without."""
        home = load_course("home")
        picture = home.eye.picture.model_copy(update={"smooth_edges": self.smooth})
        return home.model_copy(update={"eye": home.eye.model_copy(update={"picture": picture})})

    def open(self) -> streams.Stream:
        """Open the stream."""
        return streams.open(self.course, seed=self.seed, length=self.frames)

    @property
    def checked(self) -> frozenset[int]:
        """Numbers of the frames that are compared with those by number."""
        dice = np.random.default_rng(self.seed)
        return frozenset(
            dice.choice(self.frames, min(CHECKED, self.frames), replace=False).tolist()
        )


def _maker(run: Run, on_frame: Callable[[], None]) -> Callable[[int], dict[str, Any]]:
    """Return what makes a part, and its line, in a worker."""
    keep_freed_memory(many_scenes=True)
    stream, checked = run.open(), run.checked

    def make(part: int) -> dict[str, Any]:
        begin_s, whole, single = time.time(), hashlib.sha256(), {}
        forget_peak()
        for frame in stream[part * PART : (part + 1) * PART]:
            digest = digest_of(frame)
            whole.update(digest.encode())
            if frame.number in checked:
                single[str(frame.number)] = digest
            on_frame()
        return {
            "part": part, "sha256": whole.hexdigest(), "single": single, "process": os.getpid(),
            "begin_s": begin_s, "end_s": time.time(), "own_mib": memory_mib("RssAnon"),
            "most_mib": memory_mib("VmHWM"),
        }  # fmt: skip

    return make


def _seeker(run: Run, on_frame: Callable[[], None]) -> Callable[[int], tuple[int, str]]:
    """Return what makes a frame by its number, in a worker that has made none."""
    stream = run.open()

    def seek(number: int) -> tuple[int, str]:
        digest = digest_of(stream[number])
        on_frame()
        return number, digest

    return seek


def main() -> int:
    """Make or check; 0 if all is as it should be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    actions = parser.add_subparsers(dest="action", required=True)
    make = actions.add_parser("make")
    make.add_argument("--frames", type=int, default=1_000_000)
    make.add_argument("--smooth", action="store_true", help="with smooth edges")
    make.add_argument("--kills", type=int, default=10)
    make.add_argument("--seed", type=int, default=31)
    for action in (make, actions.add_parser("work"), actions.add_parser("check")):
        action.add_argument("file", type=Path)
    options = parser.parse_args()
    if options.action != "make":
        return (_work if options.action == "work" else _check)(options.file, _run_of(options.file))
    run = Run(frames=options.frames, smooth=options.smooth, seed=options.seed, kills=options.kills)
    if not options.file.exists():
        options.file.write_text(json.dumps(asdict(run)) + "\n")
    elif _run_of(options.file) != run:
        parser.error(f"{options.file} is of another run")
    return _make(options.file, run)


def _run_of(file: Path) -> Run:
    return Run(**json.loads(file.read_text().splitlines()[0]))


def _make(file: Path, run: Run) -> int:
    """Have it made, and end all processes at random moments."""
    dice = random.Random(run.seed)
    moments = sorted(dice.sample(range(run.parts // 5 or 1), min(run.kills, run.parts // 5)))
    command = [sys.executable, "-m", "benchmarks.endless_run", "work", str(file)]
    for moment in (*moments, None):
        if moment is not None and len(list(_lines(file))) > moment:
            continue
        process = subprocess.Popen(command, start_new_session=True)
        while process.poll() is None:
            time.sleep(POLL_S)
            if moment is not None and len(list(_lines(file))) > moment:
                time.sleep(dice.uniform(0.0, 5.0))
                os.killpg(process.pid, signal.SIGKILL)
                print(f"killed with {len(list(_lines(file)))} parts", flush=True)
                process.wait()
                break
        if moment is None and process.returncode:
            return process.returncode
    return 0


def _work(file: Path, run: Run) -> int:
    done = {line["part"] for line in _lines(file)}
    missing = [part for part in range(run.parts) if part not in done]
    pool = WorkerPool(workers=2, maker=_maker, arguments=(run,), piece="part")
    with file.open("r+b") as out:
        out.truncate(_whole(file))  # a line that was being written
        out.seek(0, os.SEEK_END)
        for line in pool.run(missing, lambda made: None):
            out.write(json.dumps(line).encode() + b"\n")
            out.flush()
            os.fsync(out.fileno())
    return 0


def _whole(file: Path) -> int:
    return file.read_bytes().rfind(b"\n") + 1


def _lines(file: Path) -> Iterator[dict[str, Any]]:
    for line in file.read_bytes()[: _whole(file)].splitlines()[1:]:
        yield json.loads(line)


def _check(file: Path, run: Run) -> int:
    lines = list(_lines(file))
    parts = sorted(line["part"] for line in lines)
    whole = parts == list(range(run.parts))
    print(f"{run.frames:,} frames: {len(parts)} parts, each once: {whole}")
    single = {int(n): digest for line in lines for n, digest in line["single"].items()}
    pool = WorkerPool(workers=2, maker=_seeker, arguments=(run,), piece="frame")
    found = dict(pool.run(sorted(single), lambda made: None))
    same = sum(found[number] == digest for number, digest in single.items())
    print(f"{same} of {len(single)} random frames are the same by their numbers")
    last = {line["process"] for line in sorted(lines, key=lambda line: line["end_s"])[-2:]}
    undisturbed = [line for line in lines if line["process"] in last]
    _tell_speed(undisturbed)
    _tell_memory(undisturbed)
    return 0 if whole and same == len(single) == min(CHECKED, run.frames) else 1


def _tell_speed(lines: Sequence[dict[str, Any]]) -> None:
    begin_s, end_s = (
        choose(line[key] for line in lines) for choose, key in ((min, "begin_s"), (max, "end_s"))
    )
    made = PART * len(lines)
    print(f"{made:,} undisturbed, {made / (end_s - begin_s):.1f} a second")


def _tell_memory(lines: Sequence[dict[str, Any]]) -> None:
    for process in sorted({line["process"] for line in lines}):
        own = [line for line in lines if line["process"] == process]
        own.sort(key=lambda line: line["part"])
        each = WINDOW // PART  # a process makes parts that follow each other
        for key, words in (("own_mib", "of its own after a part"), ("most_mib", "with files")):
            most = [
                round(max(line[key] for line in own[place : place + each]))
                for place in range(WARM_FRAMES // PART, len(own), each)
            ]
            print(f"process {process}: most in each {WINDOW:,} frames, {words}: {most} MiB")


if __name__ == "__main__":
    sys.exit(main())
