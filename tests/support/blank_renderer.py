"""A renderer that draws nothing but remembers what it was asked: for tests of scheduling."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailenv_ros.render.contract import RenderedViews, RenderRequest
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import VIEWS, checked_views


class BlankRenderer:
    """Gives zeros of the right shape.

    `calls` holds (snapshot, previous, camera, views), `together` the names of the cameras of each
    call of `render_all`, `preloaded` the contents of `preload`.
    """

    description = "blank"
    software = True
    supported_views: tuple[str, ...] = tuple(VIEWS)

    def __init__(self) -> None:
        self.calls: list[tuple[WorldSnapshot, Observation | None, Camera, tuple[str, ...]]] = []
        self.together: list[tuple[str, ...]] = []
        self.preloaded: list[SceneContents] = []
        self.closed = False

    def preload(self, contents: SceneContents) -> None:
        self.preloaded.append(contents)

    def render(self, request: RenderRequest) -> RenderedViews:
        wanted = checked_views(request.views)
        camera = request.camera
        self.calls.append((request.snapshot, request.previous, camera, wanted))
        height, width = camera.intrinsics.height, camera.intrinsics.width
        arrays = {v: np.zeros(VIEWS[v].shape(height, width), VIEWS[v].dtype) for v in wanted}
        return RenderedViews(views=arrays, depth=arrays.get("depth"), timings_s={})

    def render_all(self, requests: Sequence[RenderRequest]) -> list[RenderedViews]:
        self.together.append(tuple(request.camera.name for request in requests))
        return [self.render(request) for request in requests]

    def close(self) -> None:
        self.closed = True
