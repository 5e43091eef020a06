"""The views of flow are the motion to the frame before: two ways to one field."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from sailenv_bench.experiments.flow_accuracy import EYE, STEPS, begin_scenario, flow_test_scene
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_ros.frame.motion import motion, object_coordinates
from sailenv_ros.simulation import Simulation

VIEWS = ("depth", "instance", "flow", "flow_valid", "occlusion", "object_coords")


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with flow_test_scene(96, 72) as opened:
        yield opened


@pytest.mark.parametrize("name", SCENARIOS)
def test_flow_is_the_motion_to_the_frame_before(simulation: Simulation, name: str) -> None:
    """Velocity, where it exists, what was hidden, and places in the objects' own frames."""
    begin_scenario(simulation, SCENARIOS[name])
    before = simulation.capture(VIEWS, agent=EYE)
    simulation.step(STEPS)
    after = simulation.capture(VIEWS, agent=EYE)
    moved = motion(after, before)
    np.testing.assert_array_equal(after["flow_valid"], moved.valid)
    np.testing.assert_allclose(after["flow"], moved.flow / moved.duration_s, rtol=1e-6, atol=1e-9)
    # The motion knows whose pixels the other frame shows, the view of occlusion their depth alone.
    assert not (after["occlusion"] & moved.visible).any()
    assert after["occlusion"][~moved.valid | moved.out_of_view].all()
    np.testing.assert_array_equal(after["object_coords"], object_coordinates(after))
