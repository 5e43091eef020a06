"""Scenarios and dynamics of clients' JSON, in our axes; refused where they are malformed."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gateway.scenario_json import (
    behaviours_of_dynamic,
    entries_of_scenario,
    mapping_of_json,
)

KEYS = st.sampled_from(
    (
        *("objects", "prefab", "position", "rotation", "dynamic", "type", "description"),
        *("timings", "x", "y", "z", "waypoints", "start_direction", "wait_time", "id"),
    )
)
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=12,
)


def scenario(**entry: Any) -> dict[str, Any]:
    return {"objects": [{"prefab": "Cube", **entry}]}


def test_an_object_stands_where_unity_says() -> None:
    """Position and rotation are turned; what is left out is 0; without a dynamic it is static."""
    entry = scenario(position={"x": 1, "y": 2, "z": 3}, rotation={"y": 90})
    (made,) = entries_of_scenario(entry, "eye")
    assert made["asset"] == "Cube"
    assert made["position"] == [3.0, -1.0, 2.0]
    assert made["orientation"] == pytest.approx([0.0, 0.0, -(0.5**0.5), 0.5**0.5])
    assert made["static"] is True


def test_vectors_of_a_dynamic_are_turned_too() -> None:
    """Directions and waypoints change axes, numbers pass."""
    (bounce,) = behaviours_of_dynamic(
        "uniform_movement_random_bounce",
        {"start_direction": {"x": 0, "y": 0, "z": 1}, "speed": 2.0, "seed": 7},
    )
    assert bounce == {
        "type": "uniform_movement_random_bounce",
        "start_direction": [1.0, -0.0, 0.0],
        "speed": 2.0,
        "seed": 7,
    }
    way = {"waypoints": [{"position": {"x": 1}, "rotation": {"y": -90}}], "total_time": 5}
    (linear,) = behaviours_of_dynamic("linear_waypoints", way)
    assert linear["waypoints"][0]["position"] == [0.0, -1.0, 0.0]
    assert linear["waypoints"][0]["rotation"] == pytest.approx([0.0, 0.0, 90.0])
    assert linear["total_time"] == 5
    assert behaviours_of_dynamic("", {"speed": 1}) == []


def test_what_is_limited_to_the_frustum_stays_in_the_clients_view() -> None:
    """Of what bounces, that is: other dynamics know no view."""
    for type_, kept in (("uniform_movement_random_bounce", "eye"), ("linear_waypoints", None)):
        entry = scenario(dynamic={"type": type_, "description": {}}, frustum_limited=True)
        (made,) = entries_of_scenario(entry, "eye")
        assert made["behaviours"][0].get("keep_in_view") == kept
        assert made["static"] is False


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        ({"objects": {}}, "objects of the scenario must be a list"),
        ({"objects": [{}]}, "object 0 of the scenario must be a JSON object with prefab"),
        (scenario(colour="red"), "key of object 0"),
        (scenario(position={"w": 1}), "position of object 0 of the scenario must be three numbers"),
        (scenario(position=[1, 2]), "must be three numbers"),
        (scenario(position=[1, 2, 10**400]), "must be three numbers"),
        (scenario(rotation={"x": True}), "must be three numbers"),
    ],
)
def test_a_malformed_scenario_is_refused(wrong: dict[str, Any], match: str) -> None:
    """The sentence names the place."""
    with pytest.raises(InvalidRequest, match=match):
        entries_of_scenario(wrong, "eye")


@given(ANYTHING)
def test_any_json_gives_entries_or_a_refusal(value: Any) -> None:
    """Whatever a client writes, there is nothing but objects or one error of ours."""
    try:
        entries = entries_of_scenario(mapping_of_json("scenario", json.dumps(value)), "eye")
    except InvalidRequest:
        return
    assert all(isinstance(entry["asset"], str) for entry in entries)


@pytest.mark.parametrize("text", ["", "{", "[]", "1", "[" * 100_000, "\0"])
def test_what_is_no_json_object_is_refused(text: str) -> None:
    """However deep it is nested."""
    with pytest.raises(InvalidRequest, match="scenario must be"):
        mapping_of_json("scenario", text)
