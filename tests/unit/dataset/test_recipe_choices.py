"""Objects are chosen by name, pattern or category; what one scene lacks is told, not fatal."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset
from sailenv_ros.dataset.recipe_choices import choices_of
from sailenv_ros.errors import SceneError
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.simulation.scenes import SceneLibrary
from tests.unit.dataset.conftest import written_recipe

CUBES = {
    "version": 1,
    "lights": [{"name": "sun", "type": "directional", "direction": [0.3, 0.2, -1]}],
    "objects": [
        {"name": "one", "asset": "cube", "position": [0, 0, 0.5], "static": True},
        {"name": "two", "asset": "cube", "position": [0, 2, 0.5], "static": True,
         "category": "chair"},
    ],
}  # fmt: skip
BALLS = {
    **CUBES,
    "objects": [{"name": "one", "asset": "sphere", "position": [0, 0, 0.5], "static": True}],
}
RANDOM = [
    {"name": "paint", "type": "material", "of": {"category": "chair"}, "colour": "#ff0000"},
    {"name": "both", "type": "object", "of": ["o?e", {"category": ["chair", "sphere"]}],
     "scale": {"times": 0.5}},
    {"name": "lamp", "type": "light", "of": "moon*", "intensity": 1},
]  # fmt: skip
CAMERAS = [
    {"type": "orbit", "name": "around", "object": {"category": "chair"}, "width": 48, "height": 48,
     "distance": [3.0, 3.5]},
    {"type": "fixed", "name": "still", "position": [5, 0, 2], "look_at": [0, 0, 0], "width": 48,
     "height": 48},
]  # fmt: skip


def recipe(folder: Path, **changes: Any) -> Path:
    """Write a recipe of two scenes that stand beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    moon = {**CUBES["lights"][0], "name": "moon 1"}  # type: ignore[index]
    (folder / "cubes.yaml").write_text(yaml.safe_dump({**CUBES, "lights": [moon]}))
    (folder / "balls.yaml").write_text(yaml.safe_dump(BALLS))
    given = {
        "scenes": [{"scene": "cubes.yaml"}, {"scene": "balls.yaml"}],
        "randomise": RANDOM,
        "cameras": CAMERAS[1:],
        "clips": {"train": 4},
        "clip": {"per_scene": 1},
        "formats": ["webdataset"],
        "views": ["rgb", "instance"],
        "light": "plain",
        **changes,
    }
    return written_recipe(folder, **given)


@pytest.mark.parametrize("workers", [1, 2])
def test_choices_that_one_scene_lacks_are_counted(tmp_path: Path, workers: int) -> None:
    """The card names the choice and the scene; all others are drawn."""
    job = load_job(recipe(tmp_path))
    made = make_dataset(job, tmp_path / "made", engine_of(workers, None))
    assert made.frames == 4
    missed = {key: value for key, value in made.findings.items() if key.startswith("nothing")}
    assert missed == {
        "nothing was met by `paint: category chair`": {"balls.yaml": 2},
        "nothing was met by `both: category chair`": {"balls.yaml": 2},
        "nothing was met by `both: category sphere`": {"cubes.yaml": 2},
        "nothing was met by `lamp: moon*`": {"balls.yaml": 2},
    }
    card = (tmp_path / "made" / "README.md").read_text()
    assert "- **nothing was met by `lamp: moon*`**: 2, in balls.yaml (2)" in card
    with open_dataset(tmp_path / "made") as frames:
        records = {one.frame.scene: one.frame.randomised for one in frames}
    assert set(records["cubes"]["epoch"]["materials"]) == {"two"}  # type: ignore[index]
    assert set(records["cubes"]["epoch"]["objects"]) == {"one", "two"}  # type: ignore[index]
    assert set(records["balls"]["epoch"]) == {"objects", "relative"}  # type: ignore[index]


def test_cameras_look_at_categories(tmp_path: Path) -> None:
    """Clips in a scene without are left out and told with the choice."""
    path = recipe(tmp_path, cameras=CAMERAS[:1], randomise=[])
    made = make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    assert made.frames == 2
    assert list(made.skipped.values()) == [2]
    assert made.findings["nothing was met by `camera around: category chair`"] == {"balls.yaml": 2}
    with open_dataset(tmp_path / "made") as frames:
        for one in frames:
            assert one.frame["instance"][24, 24] == 2  # the second object, in the middle


def test_rules_look_at_what_there_is(tmp_path: Path) -> None:
    """A target that a scene lacks does not end the work; patterns are targets, too."""
    rule = {"type": "rule", "rule": "object_view", "width": 64, "height": 48}
    near = {"cover": [0.01, 0.6], "visible": 0.1, "objects": ["t?o", "one"]}
    path = recipe(tmp_path, cameras=[{**rule, "settings": near}], randomise=[])
    made = make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    assert made.frames == 4
    assert made.findings["nothing was met by `camera camera: t?o`"] == {"balls.yaml": 2}


def test_rules_look_at_what_a_recipe_brings_wherever_it_goes(tmp_path: Path) -> None:
    """A ball that comes at random and circles is seen in each clip, not in the first alone."""
    ball = {
        "name": "ball", "type": "spawn", "assets": ["sphere"], "scale": 0.4, "gravity": False,
        "within": [[2, 0, 0.5], [2, 0, 0.5]],
        "behaviours": [{"type": "linear_waypoints", "total_time": 6, "loop": True, "waypoints": [
            {"position": [2, 0, 0.5]}, {"position": [-2, 0, 0.5]}, {"position": [0, -2, 0.5]}]}],
    }  # fmt: skip
    look = {
        "type": "rule", "rule": "object_view", "settings": {"categories": ["sphere"]},
        "width": 64, "height": 48,
    }  # fmt: skip
    path = recipe(
        tmp_path, scenes=[{"scene": "cubes.yaml"}], randomise=[ball], cameras=[look],
        clips={"train": 6}, clip={"per_scene": 6, "gap": 2.0},
    )  # fmt: skip
    made = make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    assert made.frames == 6
    with open_dataset(tmp_path / "made") as frames:
        seen = [float((one.frame["instance"] == _id_of(one, "ball 1")).mean()) for one in frames]
    assert min(seen) >= 0.02  # the least that the rule asks for


def _id_of(frame: Any, name: str) -> int:
    return next(int(one["id"]) for one in frame.objects if one["name"] == name)


def test_a_scene_file_chooses_by_category(tmp_path: Path) -> None:
    """It is checked with the file, and written as it was read."""
    entry = {"name": "a", "type": "object", "of": {"category": ["couch", "bed"]}, "turn": 3}
    spec = SceneSpec.model_validate({**CUBES, "randomise": [entry]})
    (thing,) = spec.model_dump(mode="json", exclude_unset=True)["randomise"]
    assert thing["of"] == [{"category": "couch"}, {"category": "bed"}]
    assert SceneSpec.model_validate({**CUBES, "randomise": [thing]}) == spec
    bad = {**CUBES, "randomise": [{**entry, "of": {"category": "chairs"}}]}
    (tmp_path / "bad.yaml").write_text(yaml.safe_dump(bad))
    with pytest.raises(SceneError, match="nothing of the category 'chairs'; did you mean 'chair'"):
        SceneLibrary([tmp_path]).load("bad")
    for wrong in ({"category": []}, {"kind": "chair"}, [], {"category": 3}):
        with pytest.raises(ValueError, match="randomise"):
            SceneSpec.model_validate({**CUBES, "randomise": [{**entry, "of": wrong}]})
    lamp = {"name": "l", "type": "light", "of": {"category": "lamp"}, "intensity": 1}
    with pytest.raises(ValueError, match="name or a list of names"):
        SceneSpec.model_validate({**CUBES, "randomise": [lamp]})


def test_an_orbits_text_is_a_name_first_and_a_category_then() -> None:
    """As it was before categories could be told."""
    (choice,) = choices_of({"cameras": [{"type": "orbit", "object": "chair"}]})
    assert [str(one) for one in choice.selectors] == ["chair", "category chair"]
