"""Time of a frame with flow, beside estimators: `sailenv bench flow-speed` as one part."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator

from sailenv_bench.experiments.flow_methods import opencv_methods
from sailenv_bench.experiments.flow_speed import OURS, PICTURE, SIZES, time_flow
from sailenv_bench.experiments.frame_sources import agent_source, in_process_source
from sailenv_bench.suite.measurement import Measurement

__all__ = ["measurements"]

SCENE = "room_01"
ESTIMATES = ("farneback", "dis_medium")
"""The best estimates of OpenCV; `sailenv bench flow-speed` times all of them."""


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure the paper's sizes of pictures, or the smallest one."""
    has_ros = importlib.util.find_spec("rclpy") is not None
    open_source = agent_source if has_ros else in_process_source
    methods = [method for method in opencv_methods() if method.name in ESTIMATES]
    for width, height in SIZES[:1] if quick else SIZES:
        with open_source(SCENE, width, height) as source:
            times = time_flow(source, methods, frames=3 if quick else 15)
        others = {PICTURE: "the picture alone"}
        others |= {method.name: f"picture and {method.label}" for method in methods}
        for name, label in others.items():
            yield Measurement(
                name=f"{SCENE}, {width}×{height}",
                value=times[OURS]["total"]["median"],
                unit="ms",
                other=label,
                other_value=times[name]["total"]["median"],
            )
