"""Recipes are checked as scenes are: all errors at once, each with its place."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.dataset import RecipeError, load_job, load_recipe
from tests.unit.dataset.conftest import written_recipe

BAD = """\
version: 1
seeds: 3
scenes:
  - scene: no_such_room
  - generate: kitchen
    seeds: [9, 2]
  - {}
clips: {train: 0, val: 0}
cameras:
  - type: rule
    rule: free_view
    settings: {height: 3}
  - type: orbit
    distance: [3, 1]
    width: 100000
  - type: tripod
views: [rgb]
formats: [coco, sintel, cocoa]
"""


def test_all_errors_are_told_with_their_places(tmp_path: Path) -> None:
    """Each line names file, line, column, field, and what is accepted."""
    path = tmp_path / "bad.yaml"
    path.write_text(BAD)
    with pytest.raises(RecipeError) as caught:
        load_recipe(path)
    told = [(one.line, one.field) for one in caught.value.diagnostics]
    assert told == [
        (2, "seeds"),
        (4, "scenes[0].scene"),
        (6, "scenes[1].seeds"),
        (7, "scenes[2]"),
        (8, "clips"),
        (12, "cameras[0].settings.height"),
        (14, "cameras[1].distance"),
        (15, "cameras[1].width"),
        (16, "cameras[2].type"),
        (18, "formats[0]"),
        (18, "formats[1]"),
        (18, "formats[2]"),
    ]
    text = str(caught.value)
    assert f"{path}:14:" in text
    assert "did you mean 'seed'?" in text
    assert "sintel needs the views depth, instance, too" in text
    assert "did you mean 'coco'?" in text


LENSES = """\
version: 1
scenes: [{scene: optical}]
clips: {train: 1, val: 0}
cameras:
  - {type: agent, name: a, distortion_model: plumb_bob, distortion: [0.1]}
  - {type: agent, name: b, distortion_model: fisheye}
  - {type: agent, name: c, fx: 300}
  - type: agent
    name: d
    distortion_model: equidistant
    distortion: [-0.1, 0, 0, 0]
    vertical_fov: 210
"""


def test_a_lens_that_is_none_is_told(tmp_path: Path) -> None:
    """Too few coefficients, no such model, half a focal length, an angle beyond the model's."""
    path = tmp_path / "bad.yaml"
    path.write_text(LENSES)
    with pytest.raises(RecipeError) as caught:
        load_recipe(path)
    told = {(one.line, one.field): one.message for one in caught.value.diagnostics}
    assert told[5, "cameras[0].distortion"].startswith("must be 4 or 5 finite numbers, the coeff")
    assert "did you mean" not in told[6, "cameras[1].distortion_model"]
    assert "equidistant" in told[6, "cameras[1].distortion_model"]
    assert told[7, "cameras[2].fx"].startswith("does not fit: fy must be above 0 [px]")
    assert (
        told[12, "cameras[3].vertical_fov"] == "must be a number from 1 to 209.2146 [deg], got 210"
    )


def test_a_scene_that_is_not_there_is_told(tmp_path: Path) -> None:
    """By the entry that names it."""
    path = written_recipe(tmp_path, scenes=[{"scene": "optikal"}, {"scene": "mine.yaml"}])
    (tmp_path / "mine.yaml").write_text("version: 1\nobjects: 3\n")
    with pytest.raises(RecipeError) as caught:
        load_job(path)
    first, second = caught.value.diagnostics
    assert first.field == "scenes[0].scene"
    assert "did you mean 'optical'?" in first.message
    assert second.path.endswith("mine.yaml")
    assert second.field == "objects"


def test_splits_need_scenes(tmp_path: Path) -> None:
    """A split that no scene is for is told before anything is made."""
    path = written_recipe(tmp_path, scenes=[{"scene": "optical", "splits": ["train"]}])
    with pytest.raises(RecipeError, match="there is none for the split val"):
        load_recipe(path)


def test_annotations_are_chosen_by_the_recipe(tmp_path: Path) -> None:
    """What is both wanted and stuff is told; what is chosen reaches the formats."""
    chosen = {"least_pixels": 30, "categories": ["cube", "wall"], "stuff": ["floor", "wall"]}
    with pytest.raises(RecipeError, match="wall is stuff") as caught:
        load_recipe(written_recipe(tmp_path, annotations=chosen))
    assert [one.field for one in caught.value.diagnostics] == ["annotations.categories[1]"]
    recipe = load_recipe(written_recipe(tmp_path, annotations={**chosen, "stuff": ["floor"]}))
    rules = recipe.annotation_rules
    assert (rules.least_pixels, rules.has("cube"), rules.has("floor"), rules.has("chair")) == (
        30, True, False, False,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("carrier", "words"),
    [
        ("nobody", "cameras[1].on: must be a camera that is not mounted itself; there are: left"),
        ("right", "cameras[1].on: must be a camera that is not mounted itself; there are: left"),
    ],
)
def test_a_mounted_camera_has_a_carrier(tmp_path: Path, carrier: str, words: str) -> None:
    """Another camera of the recipe, which stands or goes by itself."""
    path = tmp_path / "rig.yaml"
    path.write_text(
        "version: 1\nscenes: [{scene: optical}]\nclips: {train: 1}\nviews: [rgb]\n"
        "formats: [images]\n"
        "cameras:\n  - {name: left, type: fixed, position: [0, 0, 1]}\n"
        f"  - {{name: right, type: mounted, on: {carrier}, position: [0, -0.1, 0]}}\n"
    )
    with pytest.raises(RecipeError) as caught:
        load_recipe(path)
    assert f"{path}:8:38: {words}" in str(caught.value)
