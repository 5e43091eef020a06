"""All that is wrong with a recipe is told before anything is rendered or a folder is made."""

from __future__ import annotations

import ast
import inspect
import sys
from pathlib import Path

import pytest
import yaml

from sailenv_ros.cli.main import main
from sailenv_ros.dataset import RecipeError, load_job
from sailenv_ros.dataset.formats import formats
from tests.unit.dataset.test_recipe_choices import BALLS, CUBES

BAD = """\
version: 1
scenes:
  - scene: cubes.yaml
  - scene: balls.yaml
clips: {train: 1, vall: 2}
randomise:
  - {name: a, type: material, of: one, material: marzipan}
  - {name: b, type: object, of: "chair *", asset: {choice: [cube, cuube]}}
  - {name: c, type: object, of: {category: chairs}, turn: 3}
  - {name: d, type: material, of: two, part: Sit, colour: "#ff0000"}
  - {name: e, type: camera, every: frame, of: tv, exposure: 1}
  - {name: f, type: camera, exposure: 1}
  - {name: g, type: environment, sky_map: moonshine}
  - {name: h, type: material, of: one, picture: none.png}
  - {name: i, type: object, of: {category: chair}, turn: 3}
cameras:
  - {type: orbit, object: "t?bel"}
  - {type: agent, name: eye, agent: walker}
  - {type: rule, name: ruled, rule: object_view, settings: {categories: [couch]}}
views: [rgb, depth, instance, categori]
formats: [coco, parquet]
annotations: {categories: [chair, couhc], stuff: [wal]}
"""


def written(folder: Path, text: str) -> Path:
    (folder / "cubes.yaml").write_text(yaml.safe_dump(CUBES))
    (folder / "balls.yaml").write_text(yaml.safe_dump(BALLS))
    path = folder / "bad.yaml"
    path.write_text(text)
    return path


def test_everything_is_told_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values, names, choices, agents, packages: each with its line, and the scene concerned."""
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    path = written(tmp_path, BAD)
    with pytest.raises(RecipeError) as caught:
        load_job(path)
    found = {(one.line, one.field): one.message for one in caught.value.diagnostics}
    assert set(found) == {
        (5, "clips.vall"),
        (7, "randomise[0].material"),
        (8, "randomise[1].of"),
        (8, "randomise[1].asset"),
        (9, "randomise[2].of"),
        (10, "randomise[3].of"),
        (11, "randomise[4].of"),
        (12, "randomise[5].every"),
        (13, "randomise[6].sky_map"),
        (14, "randomise[7].picture"),
        (17, "cameras[0].object"),
        (18, "cameras[1].agent"),
        (19, "cameras[2].settings.categories"),
        (20, "views[3]"),
        (21, "formats[1]"),
        (22, "annotations.categories[1]"),
        (22, "annotations.stuff[0]"),
    }
    assert all(one.column > 0 for one in caught.value.diagnostics)
    assert "any of the scenes cubes.yaml, balls.yaml" in found[8, "randomise[1].of"]
    assert "did you mean 'chair'" in found[9, "randomise[2].of"]
    assert "material Sit" in found[10, "randomise[3].of"]
    told = [one.message for one in caught.value.diagnostics if "agent" in one.message]
    assert [scene in text for scene, text in zip(("cubes", "balls"), told, strict=True)] == [
        True
    ] * 2
    assert "pip install" in found[21, "formats[1]"]


def test_errors_of_scene_files_come_beside(tmp_path: Path) -> None:
    """A recipe's own errors do not hide those of its scenes."""
    path = written(tmp_path, BAD)
    (tmp_path / "balls.yaml").write_text("version: 1\nobjects: 3\n")
    with pytest.raises(RecipeError) as caught:
        load_job(path)
    assert {Path(one.path).name for one in caught.value.diagnostics} == {"bad.yaml", "balls.yaml"}


def test_choices_are_looked_for_in_generated_rooms(tmp_path: Path) -> None:
    """A sofa is in some living room; a rocket is in none of them."""
    text = """\
version: 1
scenes: [{generate: living_room, seeds: [0, 1]}]
clips: {train: 1}
randomise:
  - {name: a, type: object, of: {category: couch}, turn: 3}
  - {name: b, type: object, of: {category: rocket}, turn: 3}
cameras: [{type: rule, rule: room_view}]
formats: [webdataset]
"""
    with pytest.raises(RecipeError) as caught:
        load_job(written(tmp_path, text))
    (only,) = caught.value.diagnostics
    assert (only.line, only.field) == (6, "randomise[1].of")
    assert "any of the scenes living_room 0, living_room 1" in only.message
    job = load_job(written(tmp_path, "\n".join(x for x in text.split("\n") if "rocket" not in x)))
    assert job.recipe.randomise[0].name == "a"


def test_check_does_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`make --check` says yes or no; neither makes a folder."""
    good = yaml.safe_dump(
        {
            "version": 1,
            "scenes": [{"scene": "cubes.yaml"}],
            "clips": {"train": 1},
            "cameras": [{"type": "orbit", "object": {"category": "chair"}}],
            "formats": ["webdataset"],
        }
    )
    path = written(tmp_path, good)
    before = sorted(tmp_path.iterdir())
    assert main(["dataset", "make", str(path), "-o", str(tmp_path / "out"), "--check"]) == 0
    assert "no errors" in capsys.readouterr().out
    path.write_text(good.replace("chair", "chairs"))
    assert main(["dataset", "make", str(path), "-o", str(tmp_path / "out")]) != 0
    assert "did you mean 'chair'" in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == before


def test_every_format_names_the_optional_packages_that_it_imports() -> None:
    """What the formats' own code imports by `need` as it begins, and that of what they extend."""
    for name in formats.FORMATS:
        made = formats.format_class(name)
        modules = {kind.__module__ for kind in made.__mro__ if "formats" in kind.__module__}
        needed = {
            ast.literal_eval(call.args[0]).partition(".")[0]
            for module in modules
            for call in ast.walk(ast.parse(inspect.getsource(sys.modules[module])))
            if isinstance(call, ast.Call)
            and isinstance(call.func, ast.Name)
            and call.func.id == "need"
        }
        assert needed == set(made.packages), name
