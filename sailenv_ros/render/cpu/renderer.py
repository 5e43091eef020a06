"""The native renderer: draws on the processor, without OpenGL.

A snapshot, a camera and names of views come in, arrays go out. What no wanted view needs is not
drawn.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import native_library
from sailenv_ros.render.contract import RenderedViews, RenderRequest
from sailenv_ros.render.cpu.camera_drawing import CameraDrawing
from sailenv_ros.render.cpu.frame_light import FrameLight
from sailenv_ros.render.cpu.part_table import PartTable
from sailenv_ros.render.picture.finishing import Arrays, DrawingRenderer, Timings, lacks_depth
from sailenv_ros.render.scene.reflection_store import ReflectionStore
from sailenv_ros.render.scene.room_reflections import Share
from sailenv_ros.render.scene.seen_sky import seen_exposure, seen_sky
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import LIT_VIEWS, views_of

__all__ = ["NativeRenderer"]


class NativeRenderer(DrawingRenderer):
    """Draws with the native library; belongs to the thread that makes it.

    Parameters
    ----------
    threads : int or None
        How many threads draw; None for `system.threads.thread_count`. Frames do not depend on it.
    table : PartTable or None
        With stores of meshes and textures that outlive this renderer; None for its own.
    reflections : ReflectionStore or None
        That outlives this renderer; None keeps what the room that is shown mirrors, alone.

    Raises
    ------
    NativeLibraryError
        If there is no native library.
    """

    def __init__(
        self,
        *,
        threads: int | None = None,
        table: PartTable | None = None,
        reflections: ReflectionStore[Share] | None = None,
    ) -> None:
        super().__init__(threads)
        self._table = PartTable() if table is None else table
        self._reflections = reflections
        self._begin()

    def _begin(self) -> None:
        self._drawing = CameraDrawing(self._threads, self._table)
        self._beside: list[CameraDrawing] = []
        self._light = FrameLight(self._drawing.kernels, self._threads, self._reflections)

    @property
    def description(self) -> str:
        """One line: back end, instruction set, threads."""
        threads = "1 thread" if self._threads == 1 else f"{self._threads} threads"
        return f"native renderer on the CPU ({native_library().instruction_set}, {threads})"

    @property
    def part_table(self) -> PartTable:
        """The meshes that are shown; for who draws in the same thread."""
        return self._table

    @property
    def software(self) -> bool:
        """True: no graphics hardware is used."""
        return True

    @property
    def supported_views(self) -> tuple[str, ...]:
        """Views that it can make, in the order of `frame.VIEWS`."""
        return views_of("lighting", "annotation", "geometry", "measurement")

    def preload(self, contents: SceneContents) -> None:
        """Make meshes, textures and the sky ready; see `RenderBackend.preload`."""
        self._table.show(contents)
        environment = contents.environment
        if environment.sky is not None:
            seen_sky(environment.sky, seen_exposure(environment))

    def forget(self) -> None:
        """Free what was made of the scene that was shown; it is made again if that comes again."""
        self._table.forget()
        # What kernels draw in grows to what the largest room needed, and never shrinks.
        self._release()
        self._begin()

    def _at_baked_pose(self, snapshot: WorldSnapshot) -> NDArray[np.bool_]:
        return self._table.at_baked_pose(snapshot)

    def _release(self) -> None:
        for drawing in (self._drawing, *self._beside):
            drawing.close()

    def _rendered(self, requests: Sequence[RenderRequest]) -> list[RenderedViews]:
        """Make the views of requests, side by side where they are of one instant."""
        if len(requests) < 2 or not _of_one_instant(requests):
            return super()._rendered(requests)
        timings: Timings = {}
        lit = not all(LIT_VIEWS.isdisjoint(request.views) for request in requests)
        light = self._take_up(requests[0].snapshot, timings, lit=lit)
        made: list[RenderedViews] = []
        while left := requests[len(made) :]:
            made += self._side_by_side(left[: _cameras_at_once(self._threads, len(left))], light)
        # What was done once for all is told of the first frame.
        return [replace(made[0], timings_s={**timings, **made[0].timings_s}), *made[1:]]

    def _side_by_side(
        self, requests: Sequence[RenderRequest], light: NDArray[np.void] | None
    ) -> list[RenderedViews]:
        """Draw each of some cameras in a thread of its own, with equal shares of all threads."""
        threads, others = self._threads // len(requests), len(requests) - 1
        while len(self._beside) < others:
            self._beside.append(CameraDrawing(threads, self._table))

        def made(drawing: CameraDrawing, request: RenderRequest) -> RenderedViews:
            def draw(observed: Observation, wanted: frozenset[str], timings: Timings) -> Arrays:
                return _drawn(drawing, observed, wanted, light, timings)

            drawing.kernels.threads = threads
            return self._finished(request, draw, threads)

        try:
            # A pool for each call: threads that wait would be missing in a process that is forked.
            with ThreadPoolExecutor(max(others, 1), "camera") as pool:
                beside = pool.map(made, self._beside, requests[1:])
                return [made(self._drawing, requests[0]), *beside]
        finally:
            self._drawing.kernels.threads = self._threads

    def _draw(self, observed: Observation, wanted: frozenset[str], timings: Timings) -> Arrays:
        """Draw surfaces, and what else is wanted."""
        light = self._take_up(observed.snapshot, timings, lit="rgb" in wanted)
        return _drawn(self._drawing, observed, wanted, light, timings)

    def _take_up(
        self, snapshot: WorldSnapshot, timings: Timings, *, lit: bool
    ) -> NDArray[np.void] | None:
        """Bring tables up to date for a snapshot, and return its light if that is needed."""
        began = time.perf_counter()
        self._table.show(snapshot.contents)
        self._table.deform(snapshot)
        timings["upload"] = time.perf_counter() - began
        if not lit:
            return None
        began = time.perf_counter()
        radiance = partial(self._drawing.radiance, snapshot)
        light = self._light.at(snapshot, self._table, radiance)
        timings["shadow"] = time.perf_counter() - began
        return light


def _of_one_instant(requests: Sequence[RenderRequest]) -> bool:
    """Tell whether all that is drawn for some requests is one snapshot."""
    first = requests[0].snapshot
    return all(
        request.snapshot is first and not request.samples and not lacks_depth(request)
        for request in requests
    )


def _cameras_at_once(threads: int, cameras: int) -> int:
    """Return how many cameras are drawn side by side, so that no thread is left over."""
    return max(count for count in range(1, cameras + 1) if threads % count == 0)


def _drawn(
    drawing: CameraDrawing,
    observed: Observation,
    wanted: frozenset[str],
    light: NDArray[np.void] | None,
    timings: Timings,
) -> Arrays:
    began = time.perf_counter()
    arrays = drawing.arrays(observed, wanted, light if "rgb" in wanted else None)
    timings["draw"] = time.perf_counter() - began
    return arrays
