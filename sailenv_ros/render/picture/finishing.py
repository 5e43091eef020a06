"""The work of every renderer around its drawing: checks, the past's depth, finished views.

A renderer draws surfaces and radiance; the wanted views go out.
"""

from __future__ import annotations

import contextlib
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RenderError
from sailenv_ros.frame.lens_rays import reach_view
from sailenv_ros.render.contract import RenderedViews, RenderRequest
from sailenv_ros.render.picture.annotate import annotate, with_depth
from sailenv_ros.render.picture.auto_exposure import with_exposure
from sailenv_ros.render.picture.measured_depth import MEASURED_FROM, measured_depth
from sailenv_ros.render.picture.post_pass import Light, PostPass
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import LIT_VIEWS, VIEWS, checked_views

__all__ = ["Arrays", "Draw", "DrawingRenderer", "Timings", "lacks_depth"]

Arrays: TypeAlias = dict[str, NDArray[Any]]
"""Arrays that were drawn, by the names of views and of what views are made of."""

Timings: TypeAlias = dict[str, float]
"""Wall time of each stage [s]."""

Draw: TypeAlias = Callable[[Observation, frozenset[str], Timings], Arrays]
"""See `DrawingRenderer._draw`."""


class DrawingRenderer(ABC):
    """A renderer without its drawing; see `RenderBackend`.

    Parameters
    ----------
    threads : int or None
        How many work on a frame, None for `threads.thread_count`. Frames do not depend on it.
    """

    def __init__(self, threads: int | None = None) -> None:
        self._threads = thread_count() if threads is None else threads
        self._closed = False

    @property
    @abstractmethod
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""

    def preload(self, contents: SceneContents) -> None:  # noqa: B027  # a context is its thread's
        """Make ready what a first picture needs; see `RenderBackend.preload`. Here nothing."""

    def render(self, request: RenderRequest) -> RenderedViews:
        """Make the wanted views of one camera; see `RenderBackend.render`."""
        return self.render_all([request])[0]

    def render_all(self, requests: Sequence[RenderRequest]) -> list[RenderedViews]:
        """Make the views of several cameras; see `RenderBackend.render_all`."""
        if self._closed:
            raise RenderError("the renderer was closed")
        known = self.supported_views
        return self._rendered(
            [replace(one, views=checked_views(one.views, supported=known)) for one in requests]
        )

    def _rendered(self, requests: Sequence[RenderRequest]) -> list[RenderedViews]:
        """Make the views of requests that were checked, one after another."""
        return [self._finished(request, self._draw, self._threads) for request in requests]

    def _finished(self, request: RenderRequest, draw: Draw, threads: int) -> RenderedViews:
        """Draw and finish what one request asks for, whose views were checked."""
        snapshot, camera, previous = request.snapshot, request.camera, request.previous
        rows, samples = request.rows, request.samples
        post = PostPass(threads)
        drawn = wanted = frozenset(request.views)
        if "measured_depth" in wanted:
            drawn |= MEASURED_FROM
        lit = not wanted.isdisjoint(LIT_VIEWS)
        adapted = None
        if previous is not None and camera.picture.auto_exposure_s:
            adapted = previous.adapted
        if lit:
            drawn |= {"rgb"}
        timings: Timings = {}
        with self._drawing_context():
            if previous is not None and lacks_depth(request):
                past = draw(previous, frozenset({"depth"}), {})["surface"]
                previous = with_depth(previous, past)
            now = Observation(snapshot=snapshot, camera=camera, rows=rows)
            apart = bool(samples) and lit
            arrays = draw(now, drawn - {"rgb"} if apart else drawn, timings)
            light = self._mean_light(samples, draw, post, timings) if apart else None
        began = time.perf_counter()
        surface = arrays.pop("surface")
        if lit:
            if light is None:
                light = self._light_of(now, arrays, surface, post)
            light = post.through_lens(light, camera)
            if camera.picture.auto_exposure_s:
                light = Light(post.at_sensor(light))
                adapted = post.adapted(light, snapshot, camera, surface, adapted)
            taken = with_exposure(camera, adapted)
            if "rgb" in wanted:
                arrays["rgb"] = post.developed(light, snapshot, taken)
            if "raw" in wanted:
                arrays["raw"] = post.raw(light, snapshot, taken)
            timings["post"] = time.perf_counter() - began
            began = time.perf_counter()
        reach = reach_view(camera.intrinsics)
        truth = annotate(
            *(surface, snapshot, previous, camera, wanted | {reach}, threads),
            rows=rows,
            places=arrays.pop("places", None),
        )
        timings["annotate"] = time.perf_counter() - began
        arrays.update(truth)
        depth: NDArray[np.float32] = truth[reach]
        if "measured_depth" in wanted:
            began = time.perf_counter()
            arrays["measured_depth"] = measured_depth(arrays, snapshot, camera)
            timings["measure"] = time.perf_counter() - began
        return RenderedViews(
            views={name: arrays[name] for name in wanted},
            # A caller may write into its own views; the past must stay what it was.
            depth=depth if reach not in wanted else depth.copy() if _keeps_depth(request) else None,
            adapted=adapted,
            timings_s=timings,
        )

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        if not self._closed:
            self._closed = True
            self._release()

    def _light_of(
        self, observed: Observation, arrays: Arrays, surface: NDArray[np.float32], post: PostPass
    ) -> Light:
        """Return the light that reaches the sensor, of what was drawn."""
        return post.gathered(
            arrays.pop("rgb"),
            surface,
            observed.snapshot,
            observed.camera,
            self._at_baked_pose(observed.snapshot),
            arrays.pop("samples", None),
        )

    def _mean_light(
        self, samples: Sequence[Observation], draw: Draw, post: PostPass, timings: Timings
    ) -> Light:
        """Return the mean light of several instants."""
        total: NDArray[np.float32] | None = None
        for sample in samples:
            arrays = draw(sample, frozenset({"rgb"}), timings)
            light = post.at_sensor(self._light_of(sample, arrays, arrays["surface"], post))
            total = light.astype(np.float32) if total is None else total + light
        assert total is not None
        return Light((total / len(samples)).astype(np.float16))

    def _drawing_context(self) -> contextlib.AbstractContextManager[object]:
        """Return what `_draw` runs in."""
        return contextlib.nullcontext()

    @abstractmethod
    def _draw(self, observed: Observation, wanted: frozenset[str], timings: Timings) -> Arrays:
        """Draw surfaces as a camera sees them, and what else is wanted.

        Returns
        -------
        arrays : dict of str to array
            ``surface`` (H, W, 2) float32, depth [m] and instance id; with a picture ``rgb``, its
            radiance (see `PostPass.gathered`), and with supersampling perhaps ``samples``; with
            what deforms perhaps ``places``, see `annotate`; other views that are made already.
            The time of each stage is added to `timings`.
        """

    @abstractmethod
    def _at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        """Tell which instances have baked light where they are."""

    @abstractmethod
    def _release(self) -> None:
        """Free everything."""


def lacks_depth(request: RenderRequest) -> bool:
    """Tell whether the depth of a request's past is needed and has to be drawn again."""
    past = request.previous
    return past is not None and past.depth is None and _keeps_depth(request)


def _keeps_depth(request: RenderRequest) -> bool:
    return any(VIEWS[view].needs_past_depth for view in request.views)
