"""Scenarios of the later protocol begin to move when their timings say."""

from __future__ import annotations

import json

import pytest

from sailenv_ros.gateway.scenario_json import entries_of_scenario, mapping_of_json
from sailenv_ros.simulation import Simulation

pytestmark = pytest.mark.gl


def test_an_object_waits_for_its_time() -> None:
    """With ``dict`` timings the second cube stands still for a second while the first moves."""
    track = {
        "waypoints": [{"position": {"x": 0, "y": 2}}, {"position": {"x": 3, "y": 2}}],
        "total_time": 4,
    }
    text = json.dumps(
        {
            "objects": [
                {
                    "prefab": "Cube",
                    "position": {"x": 0, "y": 2, "z": 3 * number},
                    "dynamic": {"type": "linear_waypoints", "description": track},
                }
                for number in range(2)
            ]
        }
    )
    entries = entries_of_scenario(mapping_of_json("scenario", text), "eye")
    timings = {"type": "dict", "description": {"times": {"1": 1.0}}}
    with Simulation("object_view", mode="lockstep") as simulation:
        first, second = simulation.load_scenario(
            {"scene": "object_view", "objects": entries, "timings": timings}
        )
        simulation.step(120)
        waiting = simulation.get_object(second).pose.position_m
        assert waiting == pytest.approx((3.0, 0.0, 2.0), abs=1e-6)
        assert simulation.get_object(first).pose.position_m != pytest.approx((0, 0, 2), abs=0.05)
        simulation.step(240)
        assert simulation.get_object(second).pose.position_m != pytest.approx(waiting, abs=0.05)
