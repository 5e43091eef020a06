"""Feed every reader of untrusted input with changed samples, for as long as one likes.

    python benchmarks/fuzz.py [--seconds S | --inputs N] [--seed N] [TARGET ...]

Each input is accepted or refused with an error of the package's own; anything else ends the run
with the input. The inputs of a seed are always the same. Prints inputs and accepted ones of each
target.
"""

from __future__ import annotations

import argparse
import logging
import os
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.support.fuzzing import TARGETS, run_target

BATCH = 500


def main() -> None:
    """Run the targets one after the other."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", choices=[*TARGETS, []])
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--seconds", type=float, default=60.0, help="of each target [s]")
    length.add_argument("--inputs", type=int, help="of each target, however long that takes")
    parser.add_argument("--seed", type=int, default=1000)
    options = parser.parse_args()
    logging.disable(logging.WARNING)
    for name in options.targets or TARGETS:
        with tempfile.TemporaryDirectory() as folder:
            os.environ["SAILENV_CACHE"] = folder
            inputs = accepted = 0
            until = time.monotonic() + options.seconds
            while inputs < options.inputs if options.inputs else time.monotonic() < until:
                seed = options.seed + inputs // BATCH
                accepted += run_target(name, seed=seed, count=BATCH, folder=Path(folder))
                inputs += BATCH
        print(f"{name:<10} {inputs:>9} inputs, {accepted:>8} accepted", flush=True)


if __name__ == "__main__":
    main()
