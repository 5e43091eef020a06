"""Which views each renderer makes: what it declares, what it draws and what the page says agree."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.views import RENDERED_VIEWS, VIEWS
from tests.support.tiny_scenes import Thing, box_mesh, camera_at, model_of, snapshot_of

PAGE = Path(__file__).parents[2] / "docs" / "conventions.md"
SCENE = snapshot_of([Thing(model_of(box_mesh(0.6)), Pose((2.0, 0.0, 0.0)))])


@pytest.fixture(scope="module")
def backends() -> Iterator[dict[str, RenderBackend]]:
    """Every renderer there is, by its name."""
    made: dict[str, RenderBackend] = {
        "gl": Renderer(),
        "native": NativeRenderer(),
    }
    yield made
    for backend in made.values():
        backend.close()


def test_views_that_are_declared_are_drawn(backends: dict[str, RenderBackend]) -> None:
    """All at once, each as its entry says, and the box is in every one of them."""
    for backend in backends.values():
        camera = camera_at()
        drawn = backend.render(RenderRequest(SCENE, camera, backend.supported_views)).views
        assert tuple(view for view in VIEWS if view in drawn) == backend.supported_views
        for view, values in drawn.items():
            spec = VIEWS[view]
            assert values.shape == spec.shape(camera.intrinsics.height, camera.intrinsics.width)
            assert values.dtype == spec.dtype
            if view == "lens_valid":
                # Through a pin-hole every pixel sees something.
                assert values.all()
                continue
            assert spec.needs_past or not np.array_equal(values[36, 48], values[0, 0]), view


def test_views_that_are_not_declared_are_refused(backends: dict[str, RenderBackend]) -> None:
    """With the names of those that are; so is a view that nobody knows."""
    for backend in backends.values():
        for view in VIEWS.keys() - set(backend.supported_views):
            late = VIEWS[view].needs_next
            why = "known with the next one" if late else "that this renderer makes: rgb, depth"
            with pytest.raises(InvalidRequest, match=why):
                backend.render(RenderRequest(SCENE, camera_at(), ["depth", view]))
        with pytest.raises(UnknownName, match="view must be one of: rgb, depth"):
            backend.render(RenderRequest(SCENE, camera_at(), ["heat"]))


def test_every_renderer_makes_every_view(backends: dict[str, RenderBackend]) -> None:
    """All but those that only the next frame tells."""
    for backend in backends.values():
        assert backend.supported_views == RENDERED_VIEWS


def test_the_page_has_every_view(backends: dict[str, RenderBackend]) -> None:
    """Array, encoding and renderers are those of the entry and of what is declared."""
    section = PAGE.read_text(encoding="utf-8").split("\n## Views\n")[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|`")]
    shown = [[cell.strip() for cell in line[1:-1].split("|")] for line in lines]
    expected = []
    for spec in VIEWS.values():
        axes = "(H, W)" if spec.channels == 1 else f"(H, W, {spec.channels})"
        makers = [name for name, made in backends.items() if spec.name in made.supported_views]
        coded = f"`{spec.encoding}`" + (", 255 true" if spec.dtype == np.bool_ else "")
        expected.append(
            [f"`{spec.name}`", f"{axes} {spec.dtype}", coded, ", ".join(makers) or "the next frame"]
        )
    assert [row[:4] for row in shown] == expected
    assert all(row[4] for row in shown)
