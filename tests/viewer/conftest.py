"""A simulation with a web viewer, for tests that open it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sailenv_ros.simulation import Simulation
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.viewer import ViewerServer

SMALL = CameraIntrinsics(width=160, height=120)


@pytest.fixture(scope="module")
def own_scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty folder that scenes are saved into."""
    return tmp_path_factory.mktemp("scenes")


@pytest.fixture(scope="module")
def simulation(own_scenes: Path) -> Iterator[Simulation]:
    """A simulation in real time."""
    with Simulation("optical", scene_paths=[own_scenes]) as simulation:
        yield simulation


@pytest.fixture(scope="module")
def server(simulation: Simulation) -> Iterator[ViewerServer]:
    """Its window, with small pictures."""
    with ViewerServer(simulation, port=0) as server:
        server.set_intrinsics(SMALL)
        yield server
