"""What follows from facts beside the frame: judged by where things were put, made of and open."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sailenv_content.families.materials import METAL_NAMES, WOODS, fabric, glass, leather, metal
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language import (
    MATERIAL_WORDS,
    Question,
    SceneFacts,
    SceneGraph,
    balanced,
    questions,
    scene_graph,
)
from sailenv_ros.frame.language.material_words import material_word
from sailenv_ros.frame.language.seen_objects import seen_objects
from sailenv_ros.frame.language.walk_questions import reached_cells
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scene_facts import scene_facts
from sailenv_ros.space.free_space import BodySize, FreeSpace
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

THINGS = """\
  - {name: ground, asset: plane, category: floor, static: true}
  - {name: shelves, asset: "bookcase~tall:7", static: true, position: [3, -1.4, 0],
     rotation: [0, 0, 180]}
  - {name: ball, asset: sphere, category: sports ball, scale: 0.1, position: [2.95, -1.4, 0.9],
     static: true}
  - {name: closet, asset: "wardrobe~hinged:7", static: true, position: [3, 1.2, 0],
     rotation: [0, 0, 180]}
  - {name: block, asset: cube, category: box, scale: 0.4, static: true, position: [2, 0, 0.2]}
  - {name: mug, asset: cube, category: cup, scale: 0.1, static: true, position: [2, 0, 0.4501]}
  - {name: plinth, asset: cube, category: stool, scale: 0.3, static: true,
     position: [2, 0.353, 0.15]}
"""
EYE = AgentSpec(
    name="eye",
    intrinsics=CameraIntrinsics(width=320, height=240, vertical_fov_deg=75.0),
    views=("rgb", "instance"),
    following=False,
    pose=look_at((0.0, 0.0, 1.4), (3.0, 0.0, 0.8)),
)


@pytest.fixture(scope="module")
def seen(simulation: Simulation) -> tuple[Frame, SceneFacts]:
    return simulation.capture(agent="eye"), simulation.read(scene_facts)


@pytest.fixture(scope="module")
def graph(seen: tuple[Frame, SceneFacts]) -> SceneGraph:
    return scene_graph(*seen)


def _related(graph: SceneGraph, kind: str) -> set[tuple[str, str]]:
    names = {one.id: one.name for one in graph.objects.values()}
    return {(names[r.subject], names[r.object]) for r in graph.relations if r.kind == kind}


def _asked(graph: SceneGraph, kind: str) -> list[Question]:
    found = [questions(graph, seed=seed) for seed in range(4)]
    return [one for some in found for one in some if one.kind == kind]


def test_contents_and_contacts_are_those_of_the_places(graph: SceneGraph) -> None:
    assert _related(graph, "in") == {("ball", "shelves")}
    assert _related(graph, "holds") == {("shelves", "ball")}
    assert _related(graph, "supports") == {("block", "mug")}
    assert _related(graph, "touching") == {
        ("block", "mug"), ("mug", "block"), ("block", "plinth"), ("plinth", "block"),
    }  # fmt: skip
    (on,) = (r for r in graph.relations if r.kind == "supports")
    assert on.values["gap_m"] == pytest.approx(1e-4, abs=2e-4)
    assert on.values["rise"] == pytest.approx(1.0)
    (inside,) = (r for r in graph.relations if r.kind == "in")
    assert inside.values["directions"] >= 5.0
    assert ("plinth", "block") in _related(graph, "beside")


def test_what_opens_is_open_or_shut(simulation: Simulation) -> None:
    names = {joint.name: joint for joint in simulation.get_joints()}
    before = scene_graph(simulation.capture(agent="eye"), simulation.read(scene_facts))
    assert _related(before, "open") == set()
    leaf = next(iter(names.values()))
    far = leaf.high if abs(leaf.high) > abs(leaf.low) else leaf.low
    simulation.set_joint_position(leaf.name, 0.5 * far)
    frame = simulation.capture(agent="eye")
    after = scene_graph(frame, simulation.read(scene_facts))
    simulation.set_joint_position(leaf.name, 0.0)
    assert _related(after, "open") == {("closet", "closet")}
    (relation,) = (r for r in after.relations if r.kind == "open")
    assert relation.values["share"] == pytest.approx(0.5)
    assert relation.values["position"] == pytest.approx(0.5 * far)


def test_answers_follow_from_facts(graph: SceneGraph) -> None:
    names = {one.id: one.name for one in graph.objects.values()}
    assert {one.answer for one in _asked(graph, "inside")} == {"the bookcase"}
    for one in _asked(graph, "touch"):
        pair = names[one.objects[0]], names[one.objects[1]]
        assert (one.answer == "yes") == (pair in _related(graph, "touching"))
    assert {one.answer for one in _asked(graph, "touch")} == {"yes", "no"}
    for one in _asked(graph, "material"):
        assert graph.objects[one.objects[0]].materials[one.answer] >= 0.8


def test_ways_begin_where_the_goal_is(graph: SceneGraph) -> None:
    """Nothing stands in the way: ways are straight lines."""
    paths = [one for one in _asked(graph, "path") if one.answer == "ahead"]
    assert {graph.objects[one.objects[0]].name for one in paths} >= {"block"}
    for one in paths:
        (proof,) = one.proof
        corners = np.array(proof["corners_m"])
        np.testing.assert_allclose(corners[0, :2], (0.0, 0.0), atol=1e-9)
        length = float(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum())
        assert proof["length_m"] == pytest.approx(length)
        goal = graph.objects[one.objects[0]]
        flat = corners[-1] + (0.0, 0.0, goal.middle_m[2])
        assert goal.distance_to_box_m(flat) <= 0.5


@pytest.mark.parametrize(
    ("gap", "wider", "narrower"), [(0, False, False), (1, False, True), (3, True, True)]
)
def test_a_gap_of_one_cell_is_not_asked_about(gap: int, wider: bool, narrower: bool) -> None:
    """A wall across a room with a gap of so many cells: what is asked holds for both robots."""
    cells = np.zeros((20, 20), np.int8)
    cells[:, 8:13] = 100
    cells[10 : 10 + gap, 8:13] = 0
    space = FreeSpace(cells=cells, origin_m=(0.0, 0.0), body=BodySize())
    for own, expected in ((True, wider), (False, narrower)):
        found = reached_cells(space, np.array([0.2, 0.5]), wider=own)
        assert found[10, 3]
        assert found[10, 16] == expected
    assert not reached_cells(space, np.array([0.01, 0.5]), wider=True).any()


def test_what_moved_between_pictures_is_told(simulation: Simulation) -> None:
    before = {one.id: one for one in seen_objects(simulation.capture(agent="eye"))}
    simulation.move_object("mug", (2.0, -0.1, 0.4501))
    graph = scene_graph(simulation.capture(agent="eye"))
    simulation.move_object("mug", (2.0, 0.0, 0.4501))
    asked = questions(graph, seed=5, before=before)
    by_kind = {kind: [one for one in asked if one.kind == kind]
               for kind in ("moved", "travel", "change")}  # fmt: skip
    assert [one.answer for one in by_kind["travel"]] == ["0.10 m"]
    assert [one.answer for one in by_kind["change"]] == ["the cup"]
    assert sorted(one.answer for one in by_kind["moved"]) == ["no", "yes"]
    for one in by_kind["moved"]:
        moved = graph.objects[one.objects[0]].name == "mug"
        assert one.answer == ("yes" if moved else "no")
    still = questions(graph, seed=5, before=dict(graph.objects))
    assert not any(one.kind in by_kind for one in still)


def test_sides_are_told_from_a_front(simulation: Simulation, graph: SceneGraph) -> None:
    """The closet looks towards -x: what is at smaller y is on its left."""
    names = {one.id: one for one in graph.objects.values()}
    found = {one.objects: one.answer for seed in range(12)
             for one in questions(graph, seed=seed) if one.kind == "side_from"}  # fmt: skip
    for (first, second), answer in found.items():
        assert names[second].name == "closet"
        offset = names[second].turn.T @ (names[first].middle_m - names[second].middle_m)
        assert answer == ("left" if offset[1] > 0.0 else "right")


def test_facts_of_another_instant_are_refused(seen: tuple[Frame, SceneFacts]) -> None:
    frame, facts = seen
    late = dataclasses.replace(facts, sim_time_ns=facts.sim_time_ns + 1)
    with pytest.raises(InvalidRequest, match="time of the facts"):
        scene_graph(frame, late)


def test_materials_of_all_families_have_words() -> None:
    made = [*(one.surface.name for one in WOODS), *METAL_NAMES,
            fabric("#445566").surface.name,
            leather("#445566").surface.name,
            glass().surface.name]  # fmt: skip
    assert {material_word(name) for name in made} == set(MATERIAL_WORDS)
    assert all(material_word(name) for name in made)
    assert material_word(metal("#112233").surface.name) == material_word("paint #ffffff") == ""


def test_balance_keeps_equally_many_of_each_answer() -> None:
    """The bound has the greatest product: 3 answers of 4 each, not 2 of 5 or 4 of 1."""
    told = [("count", answer) for answer in "1" * 9 + "2" * 5 + "3" * 4 + "4"]
    told += [("open", "open")] * 3 + [("nearer", "the cup")] * 2
    kept = [told[place] for place in balanced(told)]
    counts = {one: kept.count(one) for one in set(kept)}
    assert counts == {("count", "1"): 4, ("count", "2"): 4, ("count", "3"): 4,
                      ("nearer", "the cup"): 2}  # fmt: skip
    assert balanced(told) == balanced(told) == sorted(balanced(told))
