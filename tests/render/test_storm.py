"""Threads that do random things at the same time leave exactly the world that they should.

`benchmarks/storm.py` does it for as long as one likes.
"""

from __future__ import annotations

from pathlib import Path

from sailenv_ros.simulation import Simulation
from tests.support.bystanders import bystanders
from tests.support.random_operations import storm


def test_a_storm_leaves_the_world_as_it_should_be(tmp_path: Path) -> None:
    """Four threads spawn, move, change, remove, look and step; each object is where it must be.

    A recording, a page and a SAILenv client beside miss nothing that they were given.
    """
    with (
        Simulation("optical", mode="lockstep") as simulation,
        bystanders(simulation, tmp_path) as seen,
    ):
        counts = storm(simulation, threads=4, operations=60, seed=1)
    assert counts["refused"] > 5
    assert counts["frames"] > 5
    assert all(count > 0 for count in seen.values()), seen
    assert seen.keys() == {"recorded", "viewed", "asked for"}
