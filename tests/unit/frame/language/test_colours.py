"""Words for colours: clear cases, gaps, shares of pixels, questions and expressions by colour."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.dataset.formats import DatasetWriter
from sailenv_ros.extras import need
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language import (
    COLOUR_WORDS,
    questions,
    referring_expressions,
    scene_graph,
)
from sailenv_ros.frame.language.colour_words import colour_words
from sailenv_ros.frame.pictures.codecs import decode_picture
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import look_at

THINGS = """\
  - {name: red cup, asset: cube, category: cup, static: true, scale: 0.3, position: [2, 1, 0.15],
     materials: [{colour: "#c41e1e"}]}
  - {name: blue cup, asset: cube, category: cup, static: true, scale: 0.3, position: [2, 0.5, 0.15],
     materials: [{colour: "#2850b4"}]}
  - {name: dull cup, asset: cube, category: cup, static: true, scale: 0.3, position: [2, 0, 0.15],
     materials: [{colour: "#cfc0a0"}]}
  - {name: first, asset: cube, category: book, static: true, scale: 0.3, position: [2, -0.5, 0.15],
     materials: [{colour: "#28803a"}]}
  - {name: second, asset: cube, category: book, static: true, scale: 0.3, position: [2, -1, 0.15],
     materials: [{colour: "#28803a"}]}
"""
EYE = AgentSpec(
    name="eye",
    intrinsics=CameraIntrinsics(width=320, height=240, vertical_fov_deg=60.0),
    views=("rgb", "instance", "albedo"),
    following=False,
    pose=look_at((0.0, 0.0, 0.9), (2.0, 0.0, 0.1)),
)

CLEAR = {
    "red": (200, 30, 30), "orange": (240, 140, 30), "yellow": (240, 220, 40),
    "green": (40, 140, 50), "blue": (40, 80, 180), "purple": (110, 40, 140),
    "pink": (240, 160, 190), "brown": (110, 70, 40), "white": (245, 245, 240),
    "grey": (128, 128, 128), "black": (20, 20, 20),
}  # fmt: skip


def word(srgb: tuple[int, int, int]) -> str:
    linear = linear_from_srgb(np.array(srgb) / 255.0).astype(np.float32)
    return COLOUR_WORDS[int(colour_words(linear))]


@pytest.fixture(scope="module")
def frame(simulation: Simulation) -> Frame:
    return simulation.capture(agent="eye")


def test_clear_cases_have_their_word_and_others_none() -> None:
    assert {name: word(srgb) for name, srgb in CLEAR.items()} == {name: name for name in CLEAR}
    assert set(CLEAR) == set(COLOUR_WORDS) - {""}
    for unclear in ((0, 128, 128), (220, 205, 180), (250, 120, 90), (110, 20, 60), (60, 60, 60)):
        assert word(unclear) == ""


def test_shares_are_those_of_pixels(frame: Frame) -> None:
    by_name = {one.name: one for one in scene_graph(frame).objects.values()}
    for one in by_name.values():
        assert sum(one.colours.values()) == pytest.approx(1.0)
    assert by_name["red cup"].colours["red"] == 1.0
    assert (by_name["blue cup"].colour, by_name["dull cup"].colour) == ("blue", "")
    assert by_name["second"].colours["green"] == 1.0


def test_expressions_by_colour_are_true_of_one(frame: Frame) -> None:
    graph = scene_graph(frame)
    names = {one.id: one.name for one in graph.objects.values()}
    found = {one.text: names[one.object] for one in referring_expressions(graph)}
    assert found["the red cup"] == "red cup"
    assert found["the blue cup"] == "blue cup"
    assert "the green book" not in found  # there are two
    (red,) = (one for one in referring_expressions(graph) if one.text == "the red cup")
    assert {names[id_]: one["share"] for id_, one in red.values.items()} == {
        "red cup": 1.0, "blue cup": 0.0, "dull cup": 0.0,
    }  # fmt: skip


def test_colours_are_asked_for_where_they_are_not_told(frame: Frame) -> None:
    graph = scene_graph(frame)
    asked = [one for one in questions(graph, seed=3) if one.kind == "colour"]
    by_id = graph.objects
    assert {by_id[one.objects[0]].category for one in asked} >= {"book"}
    for one in asked:
        assert one.answer == by_id[one.objects[0]].colour
        assert one.answer not in one.text
        assert one.proof[0]["share"] == 1.0


def test_without_albedo_no_colour_is_told(frame: Frame) -> None:
    plain = Frame(**{
        **frame.field_values(), "views": {name: frame[name] for name in ("rgb", "instance")}
    })  # fmt: skip
    graph = scene_graph(plain)
    assert all(one.colour == "" and not one.colours for one in graph.objects.values())
    assert not any(one.kind == "colour" for one in questions(graph))
    assert len(referring_expressions(graph)) < len(referring_expressions(scene_graph(frame)))


def test_a_table_has_a_row_for_each_question(frame: Frame, tmp_path: Path) -> None:
    """And a conversation for each picture, in the order of the questions."""
    with DatasetWriter(tmp_path, ["vqa", "vqa_parquet"]) as writer:
        writer.add(frame)
        writer.finish()
    lines = (tmp_path / "vqa" / "all.jsonl").read_text().splitlines()
    asked = [json.loads(line) for line in lines]
    table = need("pyarrow.parquet", "a test").read_table(
        tmp_path / "vqa_parquet" / "data" / "train-00000.parquet"
    )
    rows = table.to_pylist()
    assert [(row["question"], row["answer"]) for row in rows] == [
        (one["text"], one["answer"]) for one in asked
    ]
    assert [json.loads(row["proof"]) for row in rows] == [one["proof"] for one in asked]
    np.testing.assert_array_equal(decode_picture(rows[0]["image"]["bytes"]), frame["rgb"])
    features = json.loads(table.schema.metadata[b"huggingface"])["info"]["features"]
    assert features["image"] == {"_type": "Image"}
    (talk,) = json.loads((tmp_path / "vqa" / "all_sharegpt.json").read_text())
    assert talk["images"] == ["images/000000.png"]
    said = [turn["value"] for turn in talk["conversations"]]
    assert said[0] == f"<image>\n{asked[0]['text']}"
    assert said[1::2] == [one["answer"] for one in asked]
    assert said[2::2] == [one["text"] for one in asked[1:]]
    assert {turn["from"] for turn in talk["conversations"]} == {"human", "gpt"}


def test_a_pixel_without_a_colour_has_no_word() -> None:
    """Recordings of noise have NaN there."""
    assert COLOUR_WORDS[int(colour_words(np.full(3, np.nan, np.float32)))] in ("", "black")
