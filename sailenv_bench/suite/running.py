"""Parts in, their records out: each in a process of its own, kept for the next run.

A record is a JSON-able dict: ``name``, ``measurements`` or ``failed`` (a sentence), ``seconds``,
``load`` before and after, ``began``.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from sailenv_bench.experiments.results import load_result, save_result
from sailenv_bench.suite.parts import Part

__all__ = ["RESULT", "Record", "kept_records", "measure_part", "run_parts"]

RESULT = "figures"
"""Name of the result, as `results.save_result` takes it."""

PART_TIMEOUT_S = 900.0
END_S = 20.0
"""Time that a part's process has to end after Ctrl-C or its timeout [s]."""

SAME = ("cpu", "cpus", "memory_gib", "commit", "versions")
"""Entries of the provenance that must agree for a record to be kept."""

Record = dict[str, Any]


def kept_records(folder: Path, origin: Mapping[str, Any], *, quick: bool) -> dict[str, Record]:
    """Return the records of an earlier run that hold for this one, by the name of their part.

    They hold for the same commit, machine, versions and extent. A commit with changes of its own
    (``+`` at its end) holds for nothing: nobody knows which changes.
    """
    result = load_result(folder, RESULT)
    if result is None or result["data"]["quick"] != quick or origin["commit"].endswith("+"):
        return {}
    if any(result["provenance"].get(key) != origin[key] for key in SAME):
        return {}
    return {one["name"]: one for one in result["data"]["parts"] if "failed" not in one}


def run_parts(
    parts: Sequence[Part],
    folder: Path,
    origin: Mapping[str, Any],
    *,
    quick: bool,
    measure: Callable[[Part, bool], Record],
    begin: Callable[[Part], None] = lambda part: None,
    done: Callable[[Part, Record], None] = lambda part, record: None,
) -> list[Record]:
    """Measure what is not kept from an earlier run; write the result after each part.

    Parameters
    ----------
    parts : sequence of Part
    folder : Path
        Of ``figures.json``.
    origin : mapping
        As `machine.provenance` returns it.
    quick : bool
    measure : callable
        Measures a part; `measure_part` unless it is a test.
    begin, done : callable
        Called before a part that is measured, and with the record of each part.

    Returns
    -------
    records : list of dict
        Of `parts`, and of others that were kept.
    """
    records = kept_records(folder, origin, quick=quick)
    # The name of a machine on its network says nothing about a figure.
    told = {key: value for key, value in origin.items() if key != "machine"}
    for part in parts:
        if part.name not in records:
            begin(part)
            records[part.name] = measure(part, quick)
            load_end = [round(value, 2) for value in os.getloadavg()]
            data = {"quick": quick, "parts": list(records.values()), "load_end": load_end}
            save_result(folder, RESULT, told, data)
        done(part, records[part.name])
    return list(records.values())


def measure_part(part: Part, quick: bool, timeout_s: float = PART_TIMEOUT_S) -> Record:
    """Measure a part in a process of its own; a failure is told in the record."""
    record: Record = {
        "name": part.name,
        "began": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "load": [round(os.getloadavg()[0], 2)],
    }
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="sailenv-bench-") as name:
        output, log = Path(name, "measurements.json"), Path(name, "log")
        words = [sys.executable, "-m", "sailenv_bench.suite.part_process", part.name, part.module]
        with log.open("wb") as file:
            extent = ["--quick"] if quick else []
            status = _ended([*words, str(output), *extent], file, timeout_s)
        lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
        if status is None:
            record["failed"] = f"it did not end within {timeout_s:.0f} s"
        elif status or not output.exists():
            record["failed"] = lines[-1] if lines else f"it ended with status {status}"
        else:
            record["measurements"] = json.loads(output.read_text(encoding="utf-8"))
    record["seconds"] = round(time.monotonic() - began, 1)
    record["load"].append(round(os.getloadavg()[0], 2))
    return record


def _ended(words: Sequence[str], log: Any, timeout_s: float) -> int | None:
    """Run a process to its end and return its status; None if it took too long.

    Nothing of it is left behind, also not by Ctrl-C.
    """
    process = subprocess.Popen(
        words, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
    )
    try:
        return process.wait(timeout_s)
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(END_S)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
