"""`kill -9` of works while they are at it; `benchmarks/kills.py` does it at random moments."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from sailenv_ros.gateway import GatewayServer
from sailenv_ros.simulation import Simulation
from tests.support.kill_trials import (
    WORKS,
    Work,
    WorkProcess,
    files_whole,
    prepared,
    run_to_its_end,
)
from tests.support.killed_client import ClientProcess
from tests.support.waiting import until

MOMENTS: dict[str, Callable[[Path], bool]] = {
    "stream": lambda folder: any(folder.glob("made.unfinished/*.mcap")),
    "dataset": lambda folder: any(folder.glob("made/shards/*")),
    "bake": lambda folder: any(folder.glob("cache/light/*")),
    "furniture": lambda folder: any(folder.glob("cache/packs/.standard.*/*.glb")),
}
"""Conditions under which a work is killed: some of it is there, and more is to come."""


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKS)
def test_a_killed_work_is_done_again(name: str, tmp_path: Path) -> None:
    """What has a final name is whole, nothing stays, and the next run ends with the same bytes."""
    work: Work = WORKS[name]
    wanted = run_to_its_end(work, prepared(work, tmp_path / "undisturbed"))
    folder = prepared(work, tmp_path / "killed")
    with WorkProcess(work, folder) as process:
        until(lambda: MOMENTS[name](folder) or process.ended, f"{name} to be on its way", 120.0)
        assert not process.ended
        process.kill()
        assert process.lasting() == []
        whole = files_whole(work, folder)
    assert whole.items() <= wanted.items()
    assert run_to_its_end(work, folder) == wanted


def test_a_killed_client_gives_its_place_back() -> None:
    """Its agent is gone, and the next client sees what it would have seen."""
    with (
        Simulation("optical", mode="lockstep") as simulation,
        GatewayServer(simulation, port=0) as gateway,
    ):
        agents = simulation.info.agents
        with ClientProcess(gateway.port, 2) as undisturbed:
            wanted = undisturbed.digest()
        with ClientProcess(gateway.port, 1000) as client:
            client.await_frame()
            assert len(simulation.info.agents) == len(agents) + 1
            client.kill()
            until(lambda: not gateway.clients, "the peer to be gone")
            until(lambda: simulation.info.agents == agents, "its place to be free")
        with ClientProcess(gateway.port, 2) as after:
            assert after.digest() == wanted
