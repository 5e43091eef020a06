"""One renderer of each kind for all tests of a process: contexts are slow to make."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import Observation, WorldSnapshot

Render = Callable[..., dict[str, NDArray[Any]]]


@pytest.fixture(scope="session", params=[NativeRenderer, Renderer], ids=["native", "gl"])
def make_renderer(request: pytest.FixtureRequest) -> Callable[[], RenderBackend]:
    """Make a renderer of the kind under test: what a test promises holds for each kind."""
    make: Callable[[], RenderBackend] = request.param
    return make


@pytest.fixture(scope="session")
def renderer(make_renderer: Callable[[], RenderBackend]) -> Iterator[RenderBackend]:
    """The renderer under test."""
    made = make_renderer()
    yield made
    made.close()


@pytest.fixture
def render(renderer: RenderBackend) -> Render:
    """Render views of a snapshot: ``render(snapshot, camera, *views, past=(snapshot, camera))``."""

    def call(
        snapshot: WorldSnapshot,
        camera: Camera,
        *views: str,
        past: tuple[WorldSnapshot, Camera] | None = None,
    ) -> dict[str, NDArray[Any]]:
        previous = None if past is None else Observation(snapshot=past[0], camera=past[1])
        return dict(renderer.render(RenderRequest(snapshot, camera, views, previous)).views)

    return call


@pytest.fixture(scope="module")
def native() -> Iterator[NativeRenderer]:
    """A native renderer."""
    made = NativeRenderer()
    yield made
    made.close()


@pytest.fixture(scope="module")
def room_01() -> Iterator[WorldSnapshot]:
    """A furnished room after a second, when things have moved."""
    world = SceneLibrary().build("room_01")
    world.step(240)
    yield world.snapshot()
    world.close()
