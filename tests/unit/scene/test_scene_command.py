"""`sailenv scene` tells errors with their places and ends with status 1."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from sailenv_ros.cli import scene as command
from sailenv_ros.scene import SceneCatalogue


def _run(*words: str) -> int:
    parser = argparse.ArgumentParser(prog="sailenv")
    command.add_parser(parser.add_subparsers(required=True))
    args = parser.parse_args(["scene", *words])
    return int(args.run(args))


def test_a_scene_without_faults_is_counted(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(SceneCatalogue().path("optical"))
    assert _run("check", path, "optical") == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{path}: ok (7 objects, 2 lights, 1 mover, 0 agents)",
        "optical: ok (7 objects, 2 lights, 1 mover, 0 agents)",
    ]


def test_every_fault_is_told_and_the_next_file_is_checked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "attic.yaml"
    path.write_text(
        "version: 1\n"
        "objects:\n"
        "  - {name: ball, asset: sphere, scale: [1, 1, 2]}\n"
        "  - {name: box, asset: cub, category: tabel}\n"
        "  - {name: top, asset: cube, behaviours: [{type: rotate}]}\n"
    )
    assert _run("check", str(path), "optical") == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == (
        f"{path}:3:40: objects[0].scale: must be equal in x, y and z: sphere collides as a ball"
    )
    assert (
        lines[1] == f"{path}:4:24: objects[1].asset: there is no asset 'cub'; did you mean 'cube'?"
    )
    assert lines[2].startswith(f"{path}:4:39: objects[1].category: there is no category 'tabel'; ")
    assert lines[3].startswith(f"{path}:5:50: objects[2].behaviours[0].type: ")
    assert "rotate_rigidbody" in lines[3]
    assert lines[4].startswith("optical: ok")


@pytest.mark.parametrize("name", ["opticle", "none.yaml"])
def test_a_scene_that_is_not_there(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("check", name) == 1
    assert name in capsys.readouterr().out


def test_scenes_are_listed_with_their_titles(capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("list") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(SceneCatalogue().names)
    assert "Optical" in lines[[line.split()[0] for line in lines].index("optical")]


def test_scenes_of_one_s_own_are_listed_and_checked_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a simulator saved is known without a path."""
    monkeypatch.setenv("SAILENV_SCENES", str(tmp_path))
    (tmp_path / "my den.yaml").write_text("version: 1\ntitle: My den\n", encoding="utf-8")
    assert _run("check", "my den") == 0
    assert _run("list") == 0
    assert "my den" in capsys.readouterr().out


def test_the_schema_is_written_and_found_up_to_date(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "schema.json")
    assert _run("schema", "--output", path, "--check") == 1
    assert _run("schema", "--output", path) == 0
    assert _run("schema", "--output", path, "--check") == 0
    assert "up to date" in capsys.readouterr().out


def test_the_schema_can_be_piped(capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("schema", "--output", "-") == 0
    assert "objects" in json.loads(capsys.readouterr().out)["properties"]


def test_a_folder_that_is_not_there_gets_no_schema(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert _run("schema", "--output", str(tmp_path / "none" / "schema.json")) == 1
    assert "cannot be written: No such file or directory" in capsys.readouterr().out
