"""One stream → its figures: flow against the pictures, templates, Horn–Schunck."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import cv2 as typed_cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.attention import GravitationalFocus
from sailenv_bench.experiments.horn_schunck import MOVING_PX, MotionScore, horn_schunck_flow
from sailenv_bench.experiments.raw_templates import LabelledFrame, best_f1, draw_templates
from sailenv_bench.experiments.stream_measures import FlowFactor, warp_residual
from sailenv_ros.dataset.streams import StreamJob, StreamKind, stream_pairs
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["PUBLISHED", "bench_stream"]

cv2: Any = typed_cv2  # OpenCV's annotations lack functions of its own

VIEWS = ("rgb", "instance", "flow")

MINUTE_FRAMES = 1500
"""Number of frames that are measured of a stream without laps: its first minute."""

DRAWS = 10
"""Drawings of labels; the figures are their mean and standard deviation."""

PUBLISHED: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "empty_space": {
            "factor": 2.0, "left_stored": 0.62, "left_best": 0.35, "left_dis": 0.37, "f1": 0.45,
        },
        "solid": {
            "factor": 5.4, "left_stored": 0.86, "left_best": 0.22, "left_dis": 0.16, "f1": 0.18,
        },
        "living_room": {
            "factor": 6.0, "left_stored": 0.89, "left_best": 0.3, "left_dis": 0.42, "f1": 0.23,
        },
    }
)  # fmt: skip
"""Figures of the published streams: F1 of the raw image by arXiv:2204.12193; the rest was measured
on the files that are published with it, `left` being what the warp leaves of the difference."""


def bench_stream(
    kind: StreamKind, *, pairs: int, seed: int, on_pair: Callable[[], None] = lambda: None
) -> dict[str, Any]:
    """Measure a stream.

    Parameters
    ----------
    kind : StreamKind
    pairs : int
        Pairs of frames that are looked at, spread over a lap, or over a minute.
    seed : int
        Of the stream and of the labels.
    on_pair : callable
        Called after each pair.
    """
    frames = kind.lap_frames if kind.laps else MINUTE_FRAMES
    job = StreamJob(kind=kind, frames=frames, seed=seed, views=VIEWS)
    factor, score = FlowFactor(), MotionScore()
    left: dict[str, list[float]] = {"ours": [], "dis": []}
    labelled: list[LabelledFrame] = []
    names: list[str] = []
    search = cv2.DISOpticalFlow_create(cv2.DISOPTICAL_FLOW_PRESET_MEDIUM)
    focus: GravitationalFocus | None = None
    for number, before, now, info in stream_pairs(job, pairs):
        backward = np.asarray(-np.nan_to_num(now["flow"]) * now.dt_s, np.float32)
        moves = (backward != 0.0).any(axis=-1)
        factor.add(before["rgb"], now["rgb"], backward, before["instance"], now["instance"])
        grey = [cv2.cvtColor(frame["rgb"], cv2.COLOR_RGB2GRAY) for frame in (before, now)]
        found = search.calc(grey[1], grey[0], None)
        for name, flow in (("ours", backward), ("dis", found)):
            left[name].append(warp_residual(before["rgb"], now["rgb"], flow, moves))
        if kind.laps:
            focus = focus or GravitationalFocus(*moves.shape)
            names, classes = _classes(now, info)
            labelled.append(
                LabelledFrame(
                    number=number, colours=now["rgb"], classes=classes, moves=moves,
                    focus=focus.follow(now["rgb"], moves),
                )
            )  # fmt: skip
        else:
            first, second = (np.asarray(one, np.float32) / np.float32(255.0) for one in grey)
            fast = np.abs(backward).max(axis=-1) > MOVING_PX
            score.add(first, second, horn_schunck_flow(first, second), fast)
        on_pair()
    return {
        "name": kind.name,
        "label": kind.title,
        "pairs": pairs,
        "factor": factor.factor,
        "factor_error": factor.error,
        "factor_pixels": factor.pixels,
        "left": {name: _median(values) for name, values in left.items()},
        "published": dict(PUBLISHED.get(kind.name, {})),
        "templates": _templates(labelled, len(names), seed) if labelled else None,
        "horn_schunck": None if kind.laps else _scores(score),
    }


def _classes(frame: Frame, info: SceneInfo) -> tuple[list[str], NDArray[np.int32]]:
    """Return the categories of what can move, and the class of each pixel; the last is the rest."""
    names = sorted({i.category for i in info.instances if not i.static})
    table = np.full(1 + max(i.id for i in info.instances), len(names), np.int32)
    for instance in info.instances:
        if not instance.static:
            table[instance.id] = names.index(instance.category)
    return names, table[frame["instance"]]


def _templates(frames: list[LabelledFrame], classes: int, seed: int) -> dict[str, float] | None:
    rng = np.random.default_rng([seed, 20])
    drawn = [draw_templates(frames, classes, rng) for _ in range(DRAWS)]
    scores = np.array([best_f1(frames, one, classes) for one in drawn if len(one[1])])
    if not len(scores):
        return None
    whole, focus = scores.mean(axis=0)
    return {
        "whole": float(whole),
        "whole_deviation": float(scores[:, 0].std()),
        "focus": float(focus),
        "focus_deviation": float(scores[:, 1].std()),
    }


def _scores(score: MotionScore) -> dict[str, Any]:
    return {"motion_f1": score.motion_f1, "accuracies": list(score.accuracies)}


def _median(values: list[float]) -> float:
    known = [value for value in values if value == value]
    return float(np.median(known)) if known else float("nan")
