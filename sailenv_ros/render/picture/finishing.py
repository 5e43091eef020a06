"""The work of every renderer around its drawing: checks, the past's depth, finished views.

A renderer draws surfaces and radiance; the wanted views go out.
"""

from __future__ import annotations

import contextlib
import time
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RenderError
from sailenv_ros.frame.lens_rays import reach_view
from sailenv_ros.native.library import thread_count
from sailenv_ros.render.contract import RenderedViews
from sailenv_ros.render.picture.annotate import annotate, with_depth
from sailenv_ros.render.picture.auto_exposure import with_exposure
from sailenv_ros.render.picture.measured_depth import MEASURED_FROM, measured_depth
from sailenv_ros.render.picture.post_pass import Light, PostPass
from sailenv_ros.render.scene.flat_mirrors import FlatMirrors
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import LIT_VIEWS, VIEWS, checked_views

__all__ = ["Arrays", "DrawingRenderer", "Timings"]

Arrays: TypeAlias = dict[str, NDArray[Any]]
"""Arrays that were drawn, by the names of views and of what views are made of."""

Timings: TypeAlias = dict[str, float]
"""Wall time of each stage [s]."""


class DrawingRenderer(ABC):
    """A renderer without its drawing; see `RenderBackend`.

    Parameters
    ----------
    threads : int or None
        How many work on a frame, None for `library.thread_count`. Frames do not depend on it.
    """

    def __init__(self, threads: int | None = None) -> None:
        self._threads = thread_count() if threads is None else threads
        self._post = PostPass(self._threads)
        self._mirrors = FlatMirrors()
        self._closed = False

    @property
    @abstractmethod
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""

    def preload(self, contents: SceneContents) -> None:  # noqa: B027  # a context is its thread's
        """Make ready what a first picture needs; see `RenderBackend.preload`. Here nothing."""

    def render(
        self,
        snapshot: WorldSnapshot,
        previous: Observation | None,
        camera: Camera,
        views: Iterable[str],
        *,
        rows: RowPoses | None = None,
        samples: Sequence[Observation] = (),
    ) -> RenderedViews:
        """Make the wanted views of one camera; see `RenderBackend.render`."""
        if self._closed:
            raise RenderError("the renderer was closed")
        wanted = frozenset(checked_views(views, supported=self.supported_views))
        drawn = wanted
        if "measured_depth" in wanted:
            drawn |= MEASURED_FROM
        lit = not wanted.isdisjoint(LIT_VIEWS)
        adapted = None
        if previous is not None and camera.picture.auto_exposure_s:
            adapted = previous.adapted
        if lit:
            drawn |= {"rgb"}
        keeps_depth = any(VIEWS[view].needs_past_depth for view in wanted)
        timings: Timings = {}
        with self._drawing_context():
            if keeps_depth and previous is not None and previous.depth is None:
                past = self._draw(previous, frozenset({"depth"}), {})["surface"]
                previous = with_depth(previous, past)
            now = Observation(snapshot=snapshot, camera=camera, rows=rows)
            apart = bool(samples) and lit
            arrays = self._draw(now, drawn - {"rgb"} if apart else drawn, timings)
            light = self._mean_light(samples, timings) if apart else None
        began = time.perf_counter()
        surface = arrays.pop("surface")
        if lit:
            if light is None:
                light = self._light_of(now, arrays, surface)
            light = self._post.through_lens(light, camera)
            if camera.picture.auto_exposure_s:
                light = Light(self._post.at_sensor(light))
                adapted = self._post.adapted(light, snapshot, camera, surface, adapted)
            taken = with_exposure(camera, adapted)
            if "rgb" in wanted:
                arrays["rgb"] = self._post.developed(light, snapshot, taken)
            if "raw" in wanted:
                arrays["raw"] = self._post.raw(light, snapshot, taken)
            timings["post"] = time.perf_counter() - began
            began = time.perf_counter()
        reach = reach_view(camera.intrinsics)
        truth = annotate(
            *(surface, snapshot, previous, camera, wanted | {reach}, self._threads),
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
            depth=depth if reach not in wanted else depth.copy() if keeps_depth else None,
            adapted=adapted,
            timings_s=timings,
        )

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        if not self._closed:
            self._closed = True
            self._release()

    def _light_of(
        self, observed: Observation, arrays: Arrays, surface: NDArray[np.float32]
    ) -> Light:
        """Return the light that reaches the sensor, of what was drawn."""
        return self._post.gathered(
            arrays.pop("rgb"),
            surface,
            observed.snapshot,
            observed.camera,
            self._at_baked_pose(observed.snapshot),
            arrays.pop("samples", None),
        )

    def _mean_light(self, samples: Sequence[Observation], timings: Timings) -> Light:
        """Return the mean light of several instants."""
        total: NDArray[np.float32] | None = None
        for sample in samples:
            arrays = self._draw(sample, frozenset({"rgb"}), timings)
            light = self._post.at_sensor(self._light_of(sample, arrays, arrays["surface"]))
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
