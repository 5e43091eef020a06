"""Make random calls of ROS's standard interfaces, twice, and compare each answer with a model.

    python benchmarks/standard_storm.py [--calls N] [--seed N]

An answer that is not the model's ends the run; so do two runs whose answers differ in a byte. The
calls are in `tests/support/standard_storm.py`.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.standard_client import StandardClient
from tests.support.standard_storm import storm

NAMESPACE = "/storm"


def main() -> None:
    """Run the same storm in two simulators and print what it was."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    digests = set()
    for _ in range(2):
        began = time.monotonic()
        with (
            NodeProcess(NAMESPACE, mode="lockstep", agent__rate_hz=0.0),
            Probe(NAMESPACE) as probe,
        ):
            digest, counts = storm(StandardClient(probe), seed=options.seed, calls=options.calls)
        digests.add(digest)
        told = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
        print(f"{sum(counts.values())} answers in {time.monotonic() - began:.0f} s: {told}")
    if len(digests) != 1:
        sys.exit("the answers of the two runs differ")
    print("all answers are the model's, and those of both runs are the same")


if __name__ == "__main__":
    main()
