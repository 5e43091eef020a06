"""Speed of `sailenv stream`: frames a second with all of its views, in lockstep."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.dataset.streams import StreamJob, make_stream, stream_named

__all__ = ["measurements"]


def measurements(quick: bool) -> Iterator[Measurement]:
    """Make the beginning of a stream; the time to open its scene counts."""
    for name in ("solid",) if quick else ("solid", "living_room"):
        frames = 20 if quick else 300
        job = StreamJob(kind=stream_named(name), frames=frames, seed=0, light="plain")
        with tempfile.TemporaryDirectory(prefix="stream_") as folder:
            began = time.perf_counter()
            make_stream(job, Path(folder) / "bag", on_frame=lambda done: None)
            rate = frames / (time.perf_counter() - began)
        yield Measurement(
            name=f"{name}, {frames} frames",
            value=rate,
            unit="frames/s",
            other="frames of a second of the stream",
            other_value=job.kind.rate_hz,
        )
