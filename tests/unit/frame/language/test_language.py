"""Truth in words: judged by arithmetic on where things were put, and by the pixels of the frame."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language import (
    RELATIONS,
    SceneGraph,
    caption,
    questions,
    referring_expressions,
    scene_graph,
)
from sailenv_ros.frame.language.wording import counted, listed, metres, named, plural
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

THINGS = """\
  - {name: ground, asset: plane, category: floor, static: true}
  - {name: desk, asset: cube, category: desk, static: true, scale: [0.8, 1.6, 0.7],
     position: [3, 0, 0.35]}
  - {name: mug, asset: cube, category: cup, static: true, scale: 0.12, position: [2.8, 0.5, 0.761]}
  - {name: low mug, asset: cube, category: cup, static: true, scale: 0.12,
     position: [2, -0.9, 0.06]}
  - {name: tome, asset: cube, category: book, static: true, scale: [0.2, 0.15, 0.05],
     position: [2.8, -0.4, 0.726], rotation: [0, 0, 30]}
  - {name: tower, asset: cube, category: shelf, static: true, scale: [0.4, 0.4, 1.8],
     position: [4, 1.5, 0.9]}
  - {name: seat, asset: cube, category: chair, static: true, scale: [0.5, 0.5, 0.9],
     position: [1.8, 1.1, 0.45]}
  - {name: far seat, asset: cube, category: chair, static: true, scale: [0.5, 0.5, 0.9],
     position: [5, -1.4, 0.45]}
  - {name: speck, asset: cube, category: pen, static: true, scale: 0.012, position: [3, 0.1, 0.707]}
  - {name: speck 2, asset: cube, category: pen, static: true, scale: 0.1,
     position: [2.8, 0.2, 0.752]}
"""
EYE = AgentSpec(
    name="eye",
    intrinsics=CameraIntrinsics(width=320, height=240, vertical_fov_deg=60.0),
    views=("rgb", "instance"),
    following=False,
    pose=look_at((0.0, 0.0, 1.6), (3.0, 0.0, 0.6)),
)


@pytest.fixture(scope="module")
def frame(simulation: Simulation) -> Frame:
    return simulation.capture(agent="eye")


@pytest.fixture(scope="module")
def graph(frame: Frame) -> SceneGraph:
    return scene_graph(frame)


def _related(graph: SceneGraph, kind: str) -> set[tuple[str, str]]:
    names = {one.id: one.name for one in graph.objects.values()}
    return {(names[r.subject], names[r.object]) for r in graph.relations if r.kind == kind}


def test_objects_are_those_that_are_seen(graph: SceneGraph, frame: Frame) -> None:
    seen = {one.name: one for one in graph.objects.values()}
    assert set(seen) >= {"desk", "mug", "low mug", "tome", "tower", "seat", "speck 2"}
    assert "ground" not in seen
    for one in graph.objects.values():
        rows, columns = np.nonzero(frame["instance"] == one.id)
        assert one.pixels == len(rows)
        assert one.box == (columns.min(), rows.min(), columns.max(), rows.max())
        assert one.clear == (len(rows) >= 2e-4 * 320 * 240)
    assert seen["mug"].distance_m == pytest.approx(np.hypot(np.hypot(2.8, 0.5), 1.6 - 0.761))
    assert seen["desk"].height_m == pytest.approx(0.7)
    assert not seen["speck"].clear


def test_relations_are_those_of_the_places(graph: SceneGraph) -> None:
    on = _related(graph, "on")
    assert on == {("mug", "desk"), ("tome", "desk"), ("speck 2", "desk")}
    nearer = _related(graph, "nearer than")
    assert ("seat", "tower") in nearer
    assert ("desk", "tome") not in nearer | {(b, a) for a, b in nearer}
    assert ("tower", "desk") in _related(graph, "taller than")
    assert ("seat", "mug") in _related(graph, "left of")  # y is to the left
    assert _related(graph, "right of") == {(b, a) for a, b in _related(graph, "left of")}
    of_facts = {"in", "holds", "touching", "supports", "open"}
    assert {relation.kind for relation in graph.relations} == set(RELATIONS) - of_facts


def test_expressions_are_true_of_one_object(graph: SceneGraph) -> None:
    names = {one.id: one.name for one in graph.objects.values()}
    found = {one.text: names[one.object] for one in referring_expressions(graph)}
    assert found["the desk"] == "desk"
    assert found["the cup on the desk"] == "mug"
    assert found["the chair nearest to the camera"] == "seat"
    assert found["the leftmost cup"] == "mug"
    assert found["the rightmost cup"] == "low mug"
    assert "the cup" not in found
    assert "the pen" not in found  # there is a second one, which is hardly seen
    assert "the leftmost pen" not in found
    assert len(found) == len(referring_expressions(graph))


def test_answers_follow_from_pixels_and_places(graph: SceneGraph, frame: Frame) -> None:
    asked = questions(graph, seed=4, absent=["bed", "couch", "lamp", "toilet"])
    assert {one.kind for one in asked} == {  # without `albedo`, amodal masks and facts
        "existence", "count", "distance", "apart", "height", "nearer", "taller", "side", "support",
        "hidden",
    }  # fmt: skip
    by_id = graph.objects
    for one in asked:
        first = by_id[one.objects[0]] if one.objects else None
        if one.kind == "existence":
            assert (one.answer == "yes") == bool(one.objects)
        elif one.kind == "count":
            assert first is not None
            same = [o for o in frame.objects.ids.tolist()
                    if frame.objects.categories[o - 1] == first.category
                    and (frame["instance"] == o).any()]  # fmt: skip
            assert one.answer == str(len(same)) == str(int(one.value or 0))
            assert first.category != "pen"
        elif one.kind in ("distance", "height"):
            assert first is not None
            exact = first.distance_m if one.kind == "distance" else first.height_m
            assert one.value == exact
            assert one.answer == metres(exact)
        elif one.kind == "support":
            assert one.answer == "the desk"
        elif one.kind == "hidden":
            assert first is not None
            shown = (frame["instance"] == first.id).sum() / frame.amodal.mask(first.id).sum()
            assert one.value == pytest.approx(1.0 - shown)
            assert one.answer == f"{10 * round(10.0 * (1.0 - shown))} %"
        elif one.kind == "apart":
            assert first is not None
            apart = np.linalg.norm(first.middle_m - by_id[one.objects[1]].middle_m)
            assert one.answer == metres(float(apart))
        else:
            second = by_id[one.objects[1]]
            assert first is not None
            if one.kind == "side":
                left = first.box[2] < second.box[0]
                assert one.answer == ("left" if left else "right")
            else:
                wins = (first.distance_m < second.distance_m if one.kind == "nearer"
                        else first.height_m > second.height_m)  # fmt: skip
                winner = first if wins else second
                texts = [r.text for r in referring_expressions(graph) if r.object == winner.id]
                assert one.answer in texts
        assert one.proof


@pytest.mark.parametrize(("lean_deg", "asked"), [(0.2, True), (1.0, False)])
def test_heights_are_asked_where_leaning_leaves_the_answer(
    graph: SceneGraph, lean_deg: float, asked: bool
) -> None:
    """A seat of 0.9 m whose box reaches 1.7 mm, then 9 mm further down and up than it may."""
    seat = next(one for one in graph.objects.values() if one.name == "seat")
    c, s = np.cos(np.radians(lean_deg)), np.sin(np.radians(lean_deg))
    turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    corners = seat.middle_m + (seat.corners_m - seat.middle_m) @ seat.turn @ turn.T
    leaning = dataclasses.replace(seat, turn=turn, corners_m=corners)
    assert leaning.is_upright
    assert leaning.height_m - leaning.least_height_m == pytest.approx(2 * 0.5 * s, abs=1e-9)
    there = {**graph.objects, seat.id: leaning}
    found = questions(dataclasses.replace(graph, objects=there), seed=1, absent=[])
    assert asked == any(one.kind == "height" and one.objects == (seat.id,) for one in found)


def test_answers_are_balanced_and_seeds_ask_differently(graph: SceneGraph) -> None:
    absent = ["bed", "couch", "lamp", "toilet", "stove", "bowl", "vase", "clock"]
    yes_no: Counter[str] = Counter()
    sides: Counter[str] = Counter()
    for seed in range(40):
        for one in questions(graph, seed=seed, absent=absent):
            yes_no.update([one.answer] if one.kind == "existence" else [])
            sides.update([one.answer] if one.kind == "side" else [])
    assert yes_no["yes"] == yes_no["no"]
    assert 0.4 < sides["left"] / sides.total() < 0.6
    assert questions(graph, seed=1) == questions(graph, seed=1) != questions(graph, seed=2)


def test_parts_are_not_counted(graph: SceneGraph) -> None:
    """The books in a bookcase are parts of it: a picture that shows some has no number of books."""
    with_parts = SceneGraph(
        view=graph.view,
        objects=graph.objects,
        relations=graph.relations,
        parts=frozenset({"book", "lamp"}),
    )
    asked = questions(with_parts, absent=["lamp"])
    assert not any("book" in one.text or "lamp" in one.text for one in asked
                   if one.kind in ("count", "distance"))  # fmt: skip
    assert not any(one.answer == "no" for one in asked)
    assert not any(one.category == "book" for one in referring_expressions(with_parts))


def test_a_caption_names_what_is_clear_and_what_lies_on_what(graph: SceneGraph) -> None:
    """The largest first; a pen that is hardly seen leaves their number open."""
    told = caption(graph, place="office")
    first, *rest = told.text.split(". ")
    assert first == ("An office with two chairs, a desk, a shelf, two cups, a book and some pens")
    pixels = Counter[str]()
    for one in graph.objects.values():
        pixels[one.category] += one.pixels
    order = [name for name, _ in pixels.most_common()]
    assert order == ["chair", "desk", "shelf", "cup", "book", "pen"]
    assert set(". ".join(rest).rstrip(".").split(". ")) == {
        "A cup is on the desk", "A book is on the desk", "A pen is on the desk",
    }  # fmt: skip
    assert {graph.objects[id_].clear for id_ in told.objects} == {True}
    assert all(one in graph.relations for one in told.relations)
    assert caption(
        SceneGraph(view=graph.view, objects={}, relations=()), place="attic"
    ).text == "An attic."  # fmt: skip


def test_words() -> None:
    assert [counted("knife", count) for count in (1, 2, 10, 11, None)] == [
        "a knife", "two knives", "ten knives", "many knives", "some knives",
    ]  # fmt: skip
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert [plural(word) for word in ("cup", "wall shelf", "dish", "box", "toy", "battery")] == [
        "cups", "wall shelves", "dishes", "boxes", "toys", "batteries",
    ]  # fmt: skip
    assert named("apple", definite=False) == "an apple"
    assert named("cup", definite=False) == "a cup"
    assert [metres(value) for value in (0.123, 0.999, 2.345)] == ["0.12 m", "1.00 m", "2.3 m"]


def test_without_ids_nothing_can_be_said(simulation: Simulation) -> None:
    with pytest.raises(InvalidRequest, match="instance"):
        scene_graph(simulation.capture(("rgb",), agent="eye"))


def test_a_data_set_has_pictures_questions_and_conversations(
    frame: Frame, graph: SceneGraph, tmp_path: Path
) -> None:
    with DatasetWriter(tmp_path, ["vqa"]) as writer:
        writer.add(frame)
        writer.finish()
    folder = tmp_path
    assert (folder / "images" / "000000.png").is_file()
    lines = [json.loads(line) for line in (folder / "all.jsonl").read_text().splitlines()]
    turns = json.loads((folder / "all_llava.json").read_text())
    assert [line["id"] for line in lines] == [turn["id"] for turn in turns]
    for line, turn in zip(lines, turns, strict=True):
        question, answer = turn["conversations"]
        assert question == {"from": "human", "value": f"<image>\n{line['text']}"}
        assert answer == {"from": "gpt", "value": line["answer"]}
    meant = [json.loads(text) for text in (folder / "all_referring.jsonl").read_text().splitlines()]
    assert {entry["text"] for entry in meant} == {r.text for r in referring_expressions(graph)}
