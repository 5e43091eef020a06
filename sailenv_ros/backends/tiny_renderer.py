"""The fallback renderer: surfaces from PyBullet's TinyRenderer, annotations by the shared walk.

Takes and gives what every `RenderBackend` does. It needs no OpenGL at all, is slow, and draws a
plain picture; its ground truth has the same definition as the other's because it comes out of the
same arithmetic.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RenderError
from sailenv_ros.render.contract import RenderedViews
from sailenv_ros.render.picture.annotate import annotate
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS, checked_views, views_of
from sailenv_ros.world.tiny_rasteriser import TinyRasteriser

__all__ = ["TinyRenderer"]


class TinyRenderer:
    """Draws on the CPU without OpenGL; belongs to the thread that makes it."""

    def __init__(self) -> None:
        self._rasteriser = TinyRasteriser()
        self._closed = False

    @property
    def description(self) -> str:
        """One line: back end, device, driver."""
        return "PyBullet's TinyRenderer, on the CPU without OpenGL"

    @property
    def software(self) -> bool:
        """True: no graphics hardware is used."""
        return True

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make: of a surface it knows depth and instance id, and no more."""
        return views_of("lighting", "annotation")

    def render(
        self,
        snapshot: WorldSnapshot,
        previous: Observation | None,
        camera: Camera,
        views: Iterable[str],
    ) -> RenderedViews:
        """Make the wanted views of one camera; see `RenderBackend.render`.

        Raises
        ------
        InvalidRequest
            If a view is wanted that it cannot make.
        """
        if self._closed:
            raise RenderError("the renderer was closed")
        wanted = frozenset(checked_views(views, supported=self.supported_views))
        specs = [VIEWS[name] for name in wanted]
        needs_depth = any(spec.needs_past_depth for spec in specs)
        if needs_depth and previous is not None and previous.depth is None:
            previous = self._with_depth(previous)
        began = time.perf_counter()
        lit = any(spec.source == "lighting" for spec in specs)
        surface, rgb = self._rasteriser.draw(snapshot, camera, picture=lit)
        drawn = time.perf_counter()
        truth = annotate(surface, snapshot, previous, camera, wanted)
        arrays: dict[str, NDArray[Any]] = dict(truth)
        if rgb is not None:
            arrays["rgb"] = rgb
        depth: NDArray[np.float32] = truth["depth"]
        return RenderedViews(
            views={name: arrays[name] for name in wanted},
            # A caller may write into its own views; the past must stay what it was.
            depth=depth.copy() if "depth" in wanted else depth,
            timings_s={"geometry": drawn - began, "annotate": time.perf_counter() - drawn},
        )

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        self._closed = True
        self._rasteriser.close()

    def _with_depth(self, previous: Observation) -> Observation:
        """Draw the depth that an earlier frame was not asked for: it is a function of its pose."""
        surface, _ = self._rasteriser.draw(previous.snapshot, previous.camera, picture=False)
        truth = annotate(surface, previous.snapshot, None, previous.camera, frozenset())
        return Observation(snapshot=previous.snapshot, camera=previous.camera, depth=truth["depth"])
