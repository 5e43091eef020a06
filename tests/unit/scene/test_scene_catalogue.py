"""Scenes are found by name in folders, or by the path of a file."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sailenv_ros.errors import UnknownName
from sailenv_ros.scene import SceneCatalogue


@pytest.fixture
def folders(tmp_path: Path) -> tuple[Path, Path]:
    own, other = tmp_path / "own", tmp_path / "other"
    for folder, names in ((own, ["hall.yaml", "attic.yml"]), (other, ["hall.yaml", "cave.yaml"])):
        folder.mkdir()
        for name in (*names, "scene.schema.json", "notes.txt"):
            (folder / name).write_text("")
        (folder / "drafts.yaml").mkdir()
    return own, other


def test_names_are_those_of_yaml_files_in_order(folders: tuple[Path, Path]) -> None:
    own, other = folders
    assert SceneCatalogue(own=own).names == ("attic", "hall")
    assert SceneCatalogue([other], own=own).names == ("attic", "cave", "hall")


def test_a_further_folder_hides_the_package_s_own_scene(folders: tuple[Path, Path]) -> None:
    own, other = folders
    catalogue = SceneCatalogue([other], own=own)
    assert catalogue.path("hall") == other / "hall.yaml"
    assert catalogue.path("attic") == own / "attic.yml"


def test_a_file_s_path_is_a_scene_too(folders: tuple[Path, Path]) -> None:
    own, other = folders
    catalogue = SceneCatalogue(own=own)
    assert catalogue.path(other / "cave.yaml") == other / "cave.yaml"
    assert catalogue.path(str(other / "cave.yaml")) == other / "cave.yaml"


@pytest.mark.parametrize(
    "name", ["hal", "notes.txt", "none.yaml", "", "a\x00b.yaml", "x" * 5000 + ".yaml", "drafts"]
)
def test_an_unknown_scene_is_answered_with_the_known_ones(
    folders: tuple[Path, Path], name: str
) -> None:
    with pytest.raises(UnknownName, match="attic, hall"):
        SceneCatalogue(own=folders[0]).path(name)


def test_a_scene_that_is_added_later_is_found(folders: tuple[Path, Path]) -> None:
    own, _ = folders
    catalogue = SceneCatalogue(own=own)
    (own / "new.yaml").write_text("")
    assert "new" in catalogue.names


def test_a_folder_that_is_not_there_holds_no_scenes(tmp_path: Path) -> None:
    assert SceneCatalogue([tmp_path / "none"], own=tmp_path).names == ()


def test_what_comes_and_goes_is_known_at_once(tmp_path: Path) -> None:
    """Though a folder that has not changed for long is not read again."""
    (tmp_path / "hall.yaml").touch()
    os.utime(tmp_path, (1.0, 1.0))
    catalogue = SceneCatalogue(own=tmp_path)
    for _ in range(2):
        assert catalogue.names == ("hall",)
    for names in (("attic", "hall"), ("attic", "cave", "hall")):
        (tmp_path / f"{names[-2]}.yaml").touch()
        assert catalogue.names == names
    (tmp_path / "hall.yaml").unlink()
    assert catalogue.names == ("attic", "cave")
