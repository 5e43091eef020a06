"""Baselines on an endless stream → figures: online, at checkpoints, on rooms never visited."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import sailenv_ros.streams as streams
from sailenv_bench.experiments.pixel_learners import LEARNERS
from sailenv_ros.errors import UnknownName
from sailenv_ros.streams import Course, OnlineProtocol, Score

__all__ = ["bench_endless", "frames_shown"]

VIEWS = ("rgb", "category", "instance")


def frames_shown(frames: int, protocol: OnlineProtocol) -> int:
    """Return how many frames are shown, those of tests too."""
    tests = -(-frames // protocol.every) if protocol.every else 0
    return frames + tests * len(protocol.rooms) * protocol.test_frames


def bench_endless(
    course: Course,
    *,
    seed: int,
    begin: int,
    frames: int,
    stride: int,
    learners: Sequence[str],
    protocol: OnlineProtocol,
    on_frame: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Teach baselines.

    Parameters
    ----------
    course : Course
    seed : int
        Of the stream, the choice of pixels and the learners.
    begin, frames, stride : int
        Number of the first frame, how many are shown, and from one to the next.
    learners : sequence of str
        Names in `LEARNERS`.
    protocol : OnlineProtocol
    on_frame : callable
        Called after each frame.

    Returns
    -------
    data : dict
        Of the result file.

    Raises
    ------
    UnknownName
        If there is no such baseline.
    """
    for name in learners:
        if name not in LEARNERS:
            raise UnknownName("learner", name, LEARNERS)
    taught = {name: LEARNERS[name](seed) for name in learners}
    with streams.open(course, seed=seed, views=VIEWS) as whole:
        part = whole[begin : begin + frames * stride : stride]
        with part:
            scores = streams.evaluate(part, taught, protocol, on_frame=on_frame)
    return {
        "course": course.name,
        "seed": seed,
        "begin": begin,
        "frames": len(part),
        "stride": stride,
        "labels": protocol.labels,
        "delay": protocol.delay,
        "learners": [_figures(name, score) for name, score in scores.items()],
    }


def _figures(name: str, score: Score) -> Mapping[str, Any]:
    return {
        "name": name,
        "accuracy": score.online.accuracy,
        "classes": len(score.online.of_classes),
        "checkpoints": [
            {
                "at": point.at,
                "recent": point.recent,
                "forgetting": point.forgetting,
                "tests": dict(point.tests),
            }
            for point in score.checkpoints
        ],
    }
