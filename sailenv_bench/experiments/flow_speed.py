"""Time per frame: pictures with our flow, and pictures with the flow of estimators.

Frame sources and methods in, times by method out. All methods take turns on one simulator, so that
what disturbs the machine disturbs all alike.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from sailenv_bench.experiments.flow_methods import FlowMethod
from sailenv_bench.experiments.frame_sources import FrameSource
from sailenv_bench.experiments.statistics import Summary, summary_ms

__all__ = ["OURS", "PICTURE", "SIZES", "time_flow"]

SIZES = ((240, 180), (320, 240), (640, 480), (800, 600), (1024, 768), (1280, 960))
"""The paper's sizes of pictures [px]."""

OURS = "sailenv"
PICTURE = "picture"
"""The frame without any flow: what every method needs besides."""

STEPS = 8
"""Physics steps of a round: 1/30 s."""

WARM_UP = 3


def time_flow(
    source: FrameSource,
    methods: Sequence[FlowMethod],
    *,
    frames: int,
    on_frame: Callable[[], None] = lambda: None,
) -> dict[str, dict[str, Summary]]:
    """Time frames with flow.

    Parameters
    ----------
    source : FrameSource
    methods : sequence of FlowMethod
    frames : int
        Of each method, at least 1.
    on_frame : callable
        Called after each round of all methods.

    Returns
    -------
    times : dict of str to dict
        By method, `OURS` and `PICTURE` first: ``total``, the frame with its flow, and ``flow``, the
        part that an estimate takes. Ours has no such part of its own: its ``flow`` is what its
        frames took beyond those of `PICTURE` in the same round.
    """
    runs: dict[str, Callable[[], float]] = {
        OURS: lambda: _drop(source.get_frame(True)),
        PICTURE: lambda: _drop(source.get_frame(False)),
        **{method.name: _Estimated(source, method) for method in methods},
    }
    totals: dict[str, list[float]] = {name: [] for name in runs}
    parts: dict[str, list[float]] = {name: [] for name in runs}
    names = list(runs)
    share = max(1, STEPS // len(names))
    for number in range(WARM_UP + frames):
        first = number % len(names)
        for name in names[first:] + names[:first]:
            # Time moves on before each, so that nobody finds the shadows that another has drawn.
            source.step(share)
            began = time.perf_counter()
            part = runs[name]()
            totals[name].append(time.perf_counter() - began)
            parts[name].append(part)
        on_frame()
    pairs = zip(totals[OURS], totals[PICTURE], strict=True)
    parts[OURS] = [with_flow - without for with_flow, without in pairs]
    return {
        name: {
            "total": summary_ms(totals[name][WARM_UP:]),
            "flow": summary_ms(parts[name][WARM_UP:]),
        }
        for name in names
    }


def _drop(_: Any) -> float:
    return 0.0


class _Estimated:
    """A frame's picture, and the flow from the picture before it."""

    def __init__(self, source: FrameSource, method: FlowMethod) -> None:
        self._source = source
        self._method = method
        self._last: Any = None

    def __call__(self) -> float:
        picture = self._source.get_frame(False)["main"]
        last = picture if self._last is None else self._last
        began = time.perf_counter()
        self._method.compute(last, picture)
        took = time.perf_counter() - began
        self._last = picture
        return took
