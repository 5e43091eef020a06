"""From what a renderer drew to views: the finished picture and the annotations.

Surfaces and radiance come in, the wanted views go out. Every back end ends with this.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import thread_count
from sailenv_ros.render.contract import RenderedViews
from sailenv_ros.render.picture.annotate import annotate
from sailenv_ros.render.picture.post_pass import PostPass
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS

__all__ = ["Finisher"]


class Finisher:
    """Makes views of what was drawn.

    Parameters
    ----------
    threads : int or None
        How many work on a frame, None for `library.thread_count`. Frames do not depend on it.
    """

    def __init__(self, threads: int | None = None) -> None:
        self._threads = thread_count() if threads is None else threads
        self._post = PostPass(self._threads)

    def finish(
        self,
        arrays: dict[str, NDArray[Any]],
        snapshot: WorldSnapshot,
        previous: Observation | None,
        camera: Camera,
        wanted: frozenset[str],
        still: Callable[[], NDArray[np.bool_]],
        timings: dict[str, float],
    ) -> RenderedViews:
        """Make the wanted views.

        Parameters
        ----------
        arrays : dict of str to array
            ``surface`` (H, W, 2) float32, depth [m] and instance id; with a picture ``rgb``, its
            radiance (see `PostPass.finished`), and with supersampling perhaps ``samples``; other
            views that are made already.
        still : callable
            Says which instances have baked light where they are.
        timings : dict of str to float
            Wall time of each stage [s]; this one's are added.
        """
        began = time.perf_counter()
        surface = arrays.pop("surface")
        if "rgb" in wanted:
            arrays["rgb"] = self._post.finished(
                arrays["rgb"], surface, snapshot, camera, still(), arrays.pop("samples", None)
            )
            timings["post"] = time.perf_counter() - began
            began = time.perf_counter()
        truth = annotate(surface, snapshot, previous, camera, wanted, self._threads)
        timings["annotate"] = time.perf_counter() - began
        arrays.update(truth)
        keeps_depth = any(VIEWS[view].needs_past_depth for view in wanted)
        depth: NDArray[np.float32] = truth["depth"]
        return RenderedViews(
            views={name: arrays[name] for name in wanted},
            # A caller may write into its own views; the past must stay what it was.
            depth=depth if "depth" not in wanted else depth.copy() if keeps_depth else None,
            timings_s=timings,
        )
