"""Let threads do random things to one simulation, and hold the world against a model of it.

    python benchmarks/storm.py [--threads N] [--operations N] [--seed N]

What they do is in `tests/support/random_operations.py`, who looks on beside them (a recording, a
page, a SAILenv client) in `tests/support/bystanders.py`; an object too many, too few or elsewhere,
or a frame that is lost, ends the run.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from sailenv_ros import Simulation
from tests.support.bystanders import bystanders
from tests.support.random_operations import storm


def main() -> None:
    """Run one storm and print what it was."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=4)
    parser.add_argument("--operations", type=int, default=10_000, help="of each thread")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    began = time.monotonic()
    with (
        Simulation("optical", mode="lockstep") as simulation,
        tempfile.TemporaryDirectory() as folder,
        bystanders(simulation, Path(folder)) as seen,
    ):
        counts = storm(
            simulation, threads=options.threads, operations=options.operations, seed=options.seed
        )
    told = ", ".join(f"{count} {what}" for what, count in counts.items())
    told += "".join(f", {count} {what}" for what, count in seen.items())
    print(f"{told} in {time.monotonic() - began:.0f} s: the world is as it should be")


if __name__ == "__main__":
    main()
