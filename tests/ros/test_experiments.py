"""Experiments over DDS: frames come through the Agent, and a worker counts them."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_bench.experiments.frame_sources import agent_source
from sailenv_bench.experiments.throughput import Group, measure_group
from sailenv_bench.experiments.workloads import Setting

pytestmark = pytest.mark.ros


def test_an_agent_gives_pictures_with_flow_and_without() -> None:
    """Both of one simulator in lockstep; the flow is that of the steps between."""
    with agent_source("optical", 64, 48) as source:
        source.get_frame(True)
        source.step(8)
        with_flow, without = source.get_frame(True), source.get_frame(False)
        source.step(8)
        later = source.get_frame(True)
    assert "flow" not in without
    assert with_flow["flow"].any()
    assert with_flow["stamp_ns"] == without["stamp_ns"]
    np.testing.assert_array_equal(with_flow["main"], without["main"])
    assert later["stamp_ns"] - without["stamp_ns"] == 8 * 1_000_000_000 // 240


def test_a_worker_counts_frames_over_dds() -> None:
    """The node's memory and time are part of its figures."""
    setting = Setting(
        kind="DDS, our profile", scene="optical", width=64, height=48, views=("rgb", "depth")
    )
    (row,) = measure_group(Group(vary="transport", settings={"dds": setting}), 3)
    assert "problem" not in row
    assert row["frame"]["count"] == 3
    assert 0.0 < row["render"] < row["frame"]["median"]
    assert row["memory_mib"] > 200.0
