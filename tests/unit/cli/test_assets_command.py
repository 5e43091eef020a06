"""`sailenv assets` and `sailenv scene new` do what they say, and refuse in one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_content.standard.pack_build import build_standard_pack
from sailenv_ros.assets.folders import own_pack_folder
from sailenv_ros.assets.glb import glb_bytes
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.cli.main import main
from sailenv_ros.simulation.scenes import SceneLibrary


@pytest.fixture(autouse=True)
def own_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


@pytest.fixture(scope="module", autouse=True)
def furniture() -> None:
    build_standard_pack()


def test_list_tells_every_object(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "list"]) == 0
    told = capsys.readouterr().out
    assert "chair_01" in told
    assert "61 × 49 × 118 cm" in told


def test_credits_name_authors_and_licences(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "credits"]) == 0
    assert "Laptop 01 (laptop_01):" in capsys.readouterr().out
    assert main(["assets", "credits", "--full"]) == 0
    assert "Creative Commons" in capsys.readouterr().out


def test_build_does_nothing_where_all_is_there(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "build"]) == 0
    assert "up to date" in capsys.readouterr().out


@pytest.mark.gl
def test_add_makes_an_object_that_scenes_can_use(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "My Crate.glb"
    model.write_bytes(glb_bytes(Primitives().load("cube").model.parts, ()))
    assert main(["assets", "add", str(model), "--category", "box", "--height", "0.4"]) == 0
    assert "my_crate: box, 0.4 × 0.4 × 0.4 m" in capsys.readouterr().out
    assert (own_pack_folder() / "my_crate.png").stat().st_size > 1000
    scene = tmp_path / "crate.yaml"
    scene.write_text("version: 1\nobjects: [{name: crate, asset: My Crate}]\n")
    assert SceneLibrary().load(scene).objects[0].asset == "My Crate"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["chair.glb", "--category", "chairs"], "did you mean 'chair'"),
        (["nothing.glb", "--category", "chair"], "no such file"),
        (["nothing.glb", "--category", "chair", "--name", "A b"], "asset name"),
    ],
)
def test_add_refuses_in_one_sentence(
    words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["assets", "add", *words]) == 2
    assert sentence in capsys.readouterr().err
    assert not own_pack_folder().exists()


def test_a_new_scene_has_no_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "my_room.yaml"
    assert main(["scene", "new", str(file)]) == 0
    assert main(["scene", "check", "--physics", str(file)]) == 0
    assert "ok (5 objects" in capsys.readouterr().out
    before = file.read_bytes()
    assert main(["scene", "new", str(file)]) == 2
    assert "does not exist yet" in capsys.readouterr().err
    assert file.read_bytes() == before


def test_what_overlaps_and_falls_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "heap.yaml"
    file.write_text(
        "version: 1\n"
        "objects:\n"
        "  - {name: floor, asset: plane, static: true}\n"
        "  - {name: high, asset: cube, position: [3, 0, 2]}\n"
        "  - {name: one, asset: cube, position: [0, 0, 0.5], static: true}\n"
        "  - {name: other, asset: cube, position: [0.5, 0, 0.5], static: true}\n"
        "mover: {total_time: 4, waypoints: [{position: [-2, 0, 0.5]}, {position: [0, 0, 0.5]}]}\n"
    )
    assert main(["scene", "check", "--physics", str(file)]) == 1
    told = capsys.readouterr().out
    assert "'one' and 'other' overlap by 500 mm" in told
    assert "'high' does not stay in place" in told
    assert "the mover 'mover' passes 'one'" in told
