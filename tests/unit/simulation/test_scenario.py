"""Scenarios: SAILenv's words, timings against arithmetic, refusals."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import SailenvError
from sailenv_ros.scene.entries import read_document
from sailenv_ros.simulation.script.scenario import SCENARIO_KEYS, scenario_entries
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from tests.support.lockstep_core import lockstep_core

TRACK = {"waypoints": [{"position": {"x": 0}}, {"position": {"x": 1}}], "total_time": 2.0}


def cube(type_: str = "linear_waypoints", **more: Any) -> dict[str, Any]:
    description = TRACK if "waypoints" in type_ else {"speed": 1.0}
    return {"prefab": "Cube", "dynamic": {"type": type_, "description": description}, **more}


def starts(timings: Any, *objects: dict[str, Any]) -> list[float]:
    entries = scenario_entries({"objects": list(objects), "timings": timings}, viewer="eye")
    return [entry["behaviours"][0].get("start", 0.0) for entry in entries]


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    made = lockstep_core()
    made.register_agent(AgentSpec(name="eye"))
    yield made
    made.close()


def test_the_originals_words_are_understood() -> None:
    """prefab, id, dynamic and {x, y, z} become asset, name, behaviours and lists."""
    given_ = cube(id=7, position={"x": 1, "z": 2}, rotation={"z": 90})
    (entry,) = scenario_entries({"objects": [given_]}, viewer="")
    assert entry["asset"] == "Cube"
    assert entry["name"] == "7"
    assert entry["position"] == [1, 0.0, 2]
    assert entry["rotation"] == [0.0, 0.0, 90]
    assert entry["gravity"] is False
    (behaviour,) = entry["behaviours"]
    assert behaviour["type"] == "linear_waypoints"
    assert [w["position"] for w in behaviour["waypoints"]] == [[0, 0.0, 0.0], [1, 0.0, 0.0]]


def test_timings_say_when_each_begins() -> None:
    """All after a wait; each after the one before; or as a table says, by index."""
    three = (cube(), cube("catmull_waypoints"), cube("uniform_movement_random_bounce"))
    assert starts(None, *three) == [0.0, 0.0, 0.0]
    together = {"type": "all_together", "description": {"wait_time": 1.5}}
    assert starts(together, *three) == [1.5, 1.5, 1.5]
    complete = {"type": "wait_until_complete", "description": {"wait_time": 0.5}}
    assert starts(complete, *three) == [0.0, 2.5, 5.0]
    table = {"type": "dict", "description": {"times": {"0": 4, "2": 1.0}}}
    assert starts(table, *three) == [4.0, 0.0, 1.0]


def test_what_is_limited_to_the_frustum_is_kept_in_the_first_agents_view() -> None:
    """far_clip_plane is how far it may go; without a frustum nothing is limited."""
    bouncing = cube("uniform_movement_random_bounce", frustum_limited=True)
    (entry,) = scenario_entries(
        {"objects": [bouncing], "frustum": {"spawn": True, "far_clip_plane": 6}}, viewer="eye"
    )
    assert entry["behaviours"][0]["keep_in_view"] == "eye"
    assert entry["behaviours"][0]["view_distance"] == 6.0
    (entry,) = scenario_entries({"objects": [bouncing], "frustum": {"spawn": False}}, viewer="eye")
    assert "keep_in_view" not in entry["behaviours"][0]


@pytest.mark.parametrize("as_text", [json.dumps, lambda value: json.dumps(value, indent=2)])
def test_a_scenario_runs_in_its_order(core: SynchronousSimulation, as_text: Any) -> None:
    """The ids are those of its objects; the second moves when the first has arrived; a reset
    begins it anew."""
    document = as_text(
        {
            "scene_name": "solid_benchmark",
            "objects": [cube(position={"z": 5}), cube(position={"y": 2, "z": 5})],
            "timings": {"type": "wait_until_complete", "description": {"wait_time": 0}},
        }
    )
    ids = core.load_scenario(read_document(document))
    assert len(ids) == 2

    def moving() -> list[bool]:
        return [any(core.get_object(id_).linear_velocity) for id_ in ids]

    for _ in range(2):
        core.step(240)
        assert moving() == [True, False]
        core.step(360)
        assert moving()[1]
        core.reset()


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"actors": []}, "actors"),
        ({"objects": {}}, "list"),
        ({"objects": [3]}, "must be a mapping, got 3"),
        ({"objects": [cube(asset="cube")]}, "left out"),
        ({"objects": [cube("levitate")]}, "levitate"),
        ({"objects": [{"prefab": "Cube", "dynamic": 3}]}, "type and description"),
        ({"objects": [cube(frustum_limited=True)]}, "frustum_limited"),
        ({"objects": [cube(frustum_limited="yes")]}, "true or false"),
        ({"objects": [cube()], "timings": {"type": "later"}}, "wait_until_complete"),
        ({"timings": {"type": "all_together", "description": {"wait_time": -1}}}, "from 0"),
        (
            {"objects": [cube()], "timings": {"type": "dict", "description": {"times": {"3": 1}}}},
            "0",
        ),
        (
            {
                "objects": [cube("uniform_movement_random_bounce"), cube()],
                "timings": {"type": "wait_until_complete"},
            },
            "without end",
        ),
        ({"frustum": {"spawn": 1}}, "true or false"),
        ({"frustum": {"far_clip_plane": 0}}, "above 0"),
        ({"scene": "optical", "scene_name": "optical"}, "name of a scene"),
        ({"scene_name": "attic"}, "attic"),
        ({"objects": [{"prefab": "Cube", "mass": 0, "position": [0, 0, 3]}]}, "mass"),
        ({"objects": [cube(static=True)]}, "static"),
    ],
)
def test_a_wrong_scenario_is_refused_and_changes_nothing(
    core: SynchronousSimulation, wrong: dict[str, Any], words: str
) -> None:
    """One sentence that names the place; the present scene goes on."""
    before = core.info
    with pytest.raises(SailenvError, match=words):
        core.load_scenario(wrong)
    after = core.info
    assert (after.epoch, after.instances) == (before.epoch, before.instances)
    core.step(1)


KEYS = st.sampled_from(
    (*SCENARIO_KEYS, "type", "description", "wait_time", "times", "dynamic", "prefab", "behaviours")
)
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=14,
)


@given(st.dictionaries(KEYS, ANYTHING, max_size=4))
def test_any_mapping_gives_entries_or_a_refusal(value: dict[str, Any]) -> None:
    """Whatever is written, there are mappings or one error of ours."""
    try:
        entries = scenario_entries(value, viewer="eye")
    except SailenvError:
        return
    assert all(isinstance(entry, dict) for entry in entries)
