"""Search inputs that reach more of a reader's code, with atheris, and keep the small ones.

    python benchmarks/fuzz_coverage.py TARGET [--seconds S] [--keep]

Needs `pip install atheris`, which nothing else does. The targets are those of `benchmarks/fuzz.py`;
what was kept before is where the search begins. An input that raises something else than an error
of the package's own ends the run and is written to `crash-*`. With `--keep`, a smallest set of
inputs that reaches as much replaces `tests/data/fuzz/TARGET.bin`, which the tests replay.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import logging
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import atheris

with atheris.instrument_imports(include=["sailenv_ros"], enable_loader_override=False):
    from sailenv_ros.errors import SailenvError
    from tests.support.fuzzing import TARGETS, keep, kept

INSIDE = "SAILENV_FUZZ_TARGET"
"""Target and program, set in atheris's own process; its arguments are those of libFuzzer alone."""

KEPT_BYTES = 2**14
"""So much is kept of a target, the shortest inputs first."""

MOST = 60
"""So many inputs are kept of a target."""


def main() -> None:
    """Search in a process of its own, as atheris ends it; then keep."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", choices=[*TARGETS])
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--keep", action="store_true")
    if os.environ.get(INSIDE):
        _search(*os.environ[INSIDE].split(" ", 1))
        return
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found, least = Path(folder) / "found", Path(folder) / "least"
        found.mkdir()
        least.mkdir()
        for number, data in enumerate((*TARGETS[options.target].samples(), *kept(options.target))):
            (found / f"known_{number}").write_bytes(data)
        # libFuzzer begins itself anew to merge, and must find a program.
        program = Path(folder) / "search"
        program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{__file__}" "$@"\n')
        program.chmod(0o700)
        environment = {**os.environ, INSIDE: f"{options.target} {program}"}
        _run([program, f"-max_total_time={options.seconds}", "-max_len=4096", found], environment)
        _run([program, "-merge=1", least, found], environment)
        inputs = sorted({path.read_bytes() for path in least.iterdir()}, key=lambda d: (len(d), d))
        sizes = itertools.accumulate(len(data) for data in inputs[:MOST])
        small = [data for data, size in zip(inputs, sizes, strict=False) if size <= KEPT_BYTES]
        print(f"{options.target}: {len(inputs)} inputs reach all that was reached")
        if options.keep:
            keep(options.target, small)
            print(f"{len(small)} are kept, {sum(map(len, small))} bytes")


def _run(command: Sequence[str | Path], environment: Mapping[str, str]) -> None:
    status = subprocess.run(
        command, stderr=subprocess.PIPE, text=True, check=False, env=environment
    )
    lines = status.stderr.splitlines()
    print("\n".join(lines[-25:] if status.returncode else lines[-1:]), flush=True)
    if status.returncode:
        sys.exit(status.returncode)


def _search(name: str, program: str) -> None:
    target = TARGETS[name]
    logging.disable(logging.WARNING)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SAILENV_CACHE"] = folder

        def read(data: bytes) -> None:
            with contextlib.suppress(SailenvError):
                target.read(data, Path(folder))

        atheris.Setup([program, *sys.argv[1:]], read)
        atheris.Fuzz()


if __name__ == "__main__":
    main()
