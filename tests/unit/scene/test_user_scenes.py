"""Scenes of one's own: where they lie, and that a file is written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.user_scenes import user_scene_folder, write_scene


def test_the_folder_is_the_user_s(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """`$SAILENV_SCENES`, else below the XDG data folder; relative ones are ignored."""
    monkeypatch.setenv("SAILENV_SCENES", str(tmp_path))
    assert user_scene_folder() == tmp_path
    monkeypatch.delenv("SAILENV_SCENES")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert user_scene_folder() == tmp_path / "sailenv_ros" / "scenes"
    monkeypatch.setenv("XDG_DATA_HOME", "here")
    assert user_scene_folder() == Path.home() / ".local" / "share" / "sailenv_ros" / "scenes"


def test_a_folder_that_is_missing_is_made(tmp_path: Path) -> None:
    path = write_scene(tmp_path / "a" / "b", "den", "version: 1\n", overwrite=False)
    assert path == tmp_path / "a" / "b" / "den.yaml"
    assert path.read_text(encoding="utf-8") == "version: 1\n"


def test_nothing_is_left_of_what_could_not_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that is full in the middle leaves the old file, or none."""
    old = write_scene(tmp_path, "old", "version: 1\n", overwrite=False)

    def full(fd: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    for name in ("old", "new"):
        with pytest.raises(InvalidRequest, match="No space left"):
            write_scene(tmp_path, name, "version: 2\n", overwrite=name == "old")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock", "old.yaml"]
    assert old.read_text(encoding="utf-8") == "version: 1\n"


def test_a_folder_that_is_none_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidRequest, match="can be written in"):
        write_scene(tmp_path / "file", "den", "version: 1\n", overwrite=False)
