"""The flow experiments on small pictures: exact where they say so, every method timed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_bench.experiments.flow_accuracy import OURS, evaluate_scenario, flow_test_scene
from sailenv_bench.experiments.flow_methods import opencv_methods
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_bench.experiments.flow_speed import PICTURE, time_flow
from sailenv_bench.experiments.frame_sources import in_process_source
from sailenv_ros.simulation.simulation import Simulation


@pytest.fixture(scope="module")
def lab() -> Iterator[Simulation]:
    with flow_test_scene(96, 72) as simulation:
        yield simulation


@pytest.mark.parametrize("name", SCENARIOS)
def test_our_flow_is_the_arithmetics_in_every_scenario(lab: Simulation, name: str) -> None:
    """To 1e-4 px per frame nearly everywhere, to 0.05 px on faces seen edge-on; things do move."""
    found = evaluate_scenario(lab, SCENARIOS[name], opencv_methods()[:1], pairs=3)
    assert found.errors[OURS]["p95"] < 1e-4
    assert found.errors[OURS]["max"] < 0.05
    assert found.errors["farneback"]["mean_moving"] > 100 * found.errors[OURS]["mean_moving"]
    assert found.mean_motion_px > 0.01
    assert found.compared > 0.995
    shapes = {picture.shape for picture in found.pictures.values()}
    assert shapes == {(72, 96, 3)}


def test_gaps_and_what_is_hidden_or_leaves_are_told_apart(lab: Simulation) -> None:
    """Over eight frames things come out from behind others and into view; ours stays exact."""
    found = evaluate_scenario(lab, SCENARIOS["both"], opencv_methods()[:1], pairs=2, gap=8)
    near = evaluate_scenario(lab, SCENARIOS["both"], (), pairs=2)
    assert found.mean_motion_px > 4 * near.mean_motion_px
    ours, theirs = found.errors[OURS], found.errors["farneback"]
    for part in ("visible", "hidden", "leaving"):
        assert ours[f"mean_{part}"] < 1e-3
        assert np.isfinite(theirs[f"mean_{part}"])
    assert theirs["mean_hidden"] > theirs["mean_visible"]


def test_the_uniform_cube_has_no_texture_and_the_other_has(lab: Simulation) -> None:
    """What the scenarios differ in is to be seen."""
    pictures = [
        evaluate_scenario(lab, SCENARIOS[name], (), pairs=1).pictures["picture"]
        for name in ("uniform", "textured")
    ]
    flat, busy = (np.abs(np.diff(picture.astype(int), axis=1)).mean() for picture in pictures)
    assert busy > 4 * flat


def test_every_method_takes_its_turn() -> None:
    """Each has as many samples as frames were asked for; an estimate is a part of its frame."""
    methods = opencv_methods()[:2]
    with in_process_source("optical", 32, 24) as source:
        times = time_flow(source, methods, frames=4)
    assert list(times) == [OURS, PICTURE, "farneback", "dis_ultrafast"]
    for name, entry in times.items():
        assert entry["total"]["count"] == 4
        if name in ("farneback", "dis_ultrafast"):
            assert 0.0 < entry["flow"]["mean"] < entry["total"]["mean"]
    beyond = times[OURS]["total"]["mean"] - times[PICTURE]["total"]["mean"]
    assert times[OURS]["flow"]["mean"] == pytest.approx(beyond)
