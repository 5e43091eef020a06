"""A simulation with a web viewer, for tests that open it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser

from sailenv_ros.simulation import Simulation
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.viewer import ViewerServer
from tests.support.browser import OpenPage, chromium

SMALL = CameraIntrinsics(width=160, height=120)


@pytest.fixture(scope="module")
def own_scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty folder that scenes are saved into."""
    return tmp_path_factory.mktemp("scenes")


@pytest.fixture(scope="module")
def simulation(request: pytest.FixtureRequest, own_scenes: Path) -> Iterator[Simulation]:
    """A simulation in real time, of what the module describes as `SCENE`, or else of optical."""
    text = getattr(request.module, "SCENE", None)
    if text is not None:
        (own_scenes / "own.yaml").write_text(text, encoding="utf-8")
    name = "optical" if text is None else "own"
    with Simulation(name, scene_paths=[own_scenes]) as simulation:
        yield simulation


@pytest.fixture(scope="module")
def server(simulation: Simulation) -> Iterator[ViewerServer]:
    """Its window, with small pictures."""
    with ViewerServer(simulation, port=0) as server:
        server.set_intrinsics(SMALL)
        yield server


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """The browser of a module's tests."""
    with chromium() as browser:
        yield browser


@pytest.fixture
def opened(browser: Browser, server: ViewerServer, simulation: Simulation) -> Iterator[OpenPage]:
    """The page on the scene at its start, with a first picture; nothing goes wrong in it."""
    simulation.change_scene("own" if "own" in simulation.info.scenes else "optical")
    opened = OpenPage(browser, server.url)
    opened.wait_for_frames()
    yield opened
    simulation.resume()  # also after a test that failed while time stood
    opened.close()
