"""Makes a stream of full length, breaks it off on the way, and counts every frame of what is there.

    python benchmarks/stream_endurance.py make FOLDER --int 0.3 --kill 0.6 -- colof --which a
    python benchmarks/stream_endurance.py check FOLDER

What stands behind ``--`` are arguments of `sailenv stream`, whose process is ended at a share of
the frames by Ctrl-C (``--int``) or by SIGKILL (``--kill``), in the middle of a part, and then begun
again. Tells frames per second, processor time, and the resident memory of each process after its
first 1,000 frames and at its end. ``check`` reads the bag by the library `mcap` alone: each topic
must have every frame exactly once, at the stamps that its rate says. It ends with a SHA-256 of all
messages but ``frame_info``, which says how long rendering took: streams that were interrupted and
those that were not must have the same.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

STEPS_PER_S = 240
"""Of the physics; frames lie on its steps."""

WARM_FRAMES = 1000
"""After so many a process has made all that it keeps."""

WITHIN_A_PART_S = 3.0
"""So long after a part became whole a process is ended: in the middle of the next one."""

POLL_S = 0.2


@dataclass
class Usage:
    """Resources that a process has used so far."""

    rss_mb: float
    cpu_s: float


def main() -> int:
    """Make or check; 0 if every frame is there."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    actions = parser.add_subparsers(dest="action", required=True)
    make = actions.add_parser("make")
    make.add_argument("folder", type=Path)
    make.add_argument("--int", type=float, nargs="*", default=[], metavar="SHARE")
    make.add_argument("--kill", type=float, nargs="*", default=[], metavar="SHARE")
    make.add_argument("stream", nargs="+", help="behind --: what `sailenv stream` is given")
    check = actions.add_parser("check")
    check.add_argument("folder", type=Path)
    options = parser.parse_args()
    if options.action == "check":
        return _check(options.folder)
    # Where it was ignored, as in a shell's background, the processes begun here would ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    breaks = [
        *((share, signal.SIGINT) for share in options.int),
        *((share, signal.SIGKILL) for share in options.kill),
    ]
    return _make(options.folder, options.stream, sorted(breaks))


def _make(
    folder: Path, words: Sequence[str], breaks: Sequence[tuple[float, signal.Signals]]
) -> int:
    command = [sys.executable, "-m", "sailenv_ros.cli.main", "stream", *words]
    command += ["-o", str(folder), "--quiet"]
    for share, by in [*breaks, (1.0, None)]:
        print(f"to {share:.0%}, then {by.name if by else 'done'}:", end=" ", flush=True)
        status = _one_process(command, folder, share, by)
        if by is None and status != 0:
            return 1
    return 0


def _one_process(
    command: Sequence[str], folder: Path, share: float, by: signal.Signals | None
) -> int:
    """Run the command to its end, or to a share of the frames."""
    growing = folder.with_name(f"{folder.name}.unfinished")
    began_s, first, warm, last, ended_by = time.monotonic(), 0, None, Usage(0.0, 0.0), ""
    process = subprocess.Popen(command, start_new_session=True)
    identity: dict[str, Any] | None = None
    done = 0
    try:
        while process.poll() is None:
            time.sleep(POLL_S)
            last = _usage(process.pid) or last
            if identity is None:
                identity = _identity(growing)
                first = done = len(_parts(growing))
                continue
            done = max(done, len(_parts(growing)))
            frames = identity["part_frames"] * (done - first)
            if warm is None and frames >= WARM_FRAMES:
                warm = last
            if by is not None and identity["part_frames"] * done >= share * identity["frames"]:
                time.sleep(WITHIN_A_PART_S)
                process.send_signal(by)
                process.wait(60.0)
    finally:
        process.kill()
        process.wait()
    wall_s = time.monotonic() - began_s
    identity = identity or _identity(folder)
    if identity is None:
        print(f"ended with {process.returncode} before anything was written")
        return 1
    made = min(identity["part_frames"] * done, identity["frames"])
    if process.returncode == 0:
        made = identity["frames"]
    frames = made - identity["part_frames"] * first
    size = sum(path.stat().st_size for path in _parts(folder if folder.exists() else growing))
    print(
        f"{made:,} of {identity['frames']:,} frames, {frames:,} of them now, in {wall_s:.0f} s"
        f" ({frames / wall_s:.1f} a second; {frames / max(last.cpu_s, 1e-9):.1f} a processor"
        f" second), memory {f'{warm.rss_mb:.0f}' if warm else '-'} to {last.rss_mb:.0f} MB,"
        f" {size / 1e9:.2f} GB, exit {process.returncode}{ended_by}",
        flush=True,
    )
    return process.returncode


def _parts(folder: Path) -> list[Path]:
    """Return the whole parts, in order."""
    return sorted(folder.glob("*_*.mcap"), key=lambda path: int(path.stem.rpartition("_")[2]))


def _identity(folder: Path) -> dict[str, Any] | None:
    """Return what a stream's folder says of it, None if there is nothing yet."""
    try:
        found: dict[str, Any] = json.loads((folder / "stream.json").read_text())
    except (OSError, ValueError):
        return None
    return found


def _usage(pid: int) -> Usage | None:
    """Return what a process uses now, None if it is gone."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except (OSError, IndexError):
        return None
    if not pages:
        return None
    return Usage(
        pages * os.sysconf("SC_PAGE_SIZE") / 1e6,
        (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"),
    )


def _check(folder: Path) -> int:
    from mcap.reader import make_reader

    identity = _identity(folder)
    whole = identity is not None
    if identity is None:
        folder = folder.with_name(f"{folder.name}.unfinished")
        identity = _identity(folder)
    if identity is None:
        print(f"{folder} is no stream")
        return 1
    stamps: dict[str, list[int]] = {}
    digest = hashlib.sha256()
    parts = _parts(folder)
    for path in parts:
        with path.open("rb") as file:
            for _, channel, message in make_reader(file).iter_messages(log_time_order=False):
                stamps.setdefault(channel.topic, []).append(message.log_time)
                if not channel.topic.endswith("frame_info"):
                    digest.update(f"{channel.topic} {message.log_time} ".encode())
                    digest.update(message.data)
    count = identity["frames"] if whole else len(parts) * identity["part_frames"]
    due = _due(identity, count)
    endless = "begin" in identity
    faults = 0
    for topic, found in sorted(stamps.items()):
        if topic.endswith("scene_info"):
            print(f"{topic}: {len(found)}, at least one for each of {len(parts)} files")
            faults += len(found) < len(parts) if endless else len(found) != len(parts)
            continue
        right = found == due
        faults += not right
        gaps = sorted({round((after - before) / 1e6, 3) for before, after in pairwise(found)})
        print(
            f"{topic}: {len(found):,} of {count:,}, {len(set(found)):,} stamps, gaps {gaps} ms:"
            f" {'every frame exactly once' if right else 'WRONG'}"
        )
    print(f"sha256 of the messages: {digest.hexdigest()}")
    return 1 if faults or not stamps else 0


def _due(identity: dict[str, Any], count: int) -> list[int]:
    """Return the stamps of so many frames [ns]: on steps of the physics, or at an even rate."""
    rate = identity["rate_hz"]
    if "begin" in identity:
        begin = identity["begin"]
        return [round(number * 1e9 / rate) for number in range(begin, begin + count)]
    return [
        math.ceil(number * STEPS_PER_S / rate - 1e-9) * 1_000_000_000 // STEPS_PER_S
        for number in range(count)
    ]


if __name__ == "__main__":
    raise SystemExit(main())
