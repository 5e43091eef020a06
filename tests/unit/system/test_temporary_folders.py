"""Temporary folders: gone with their block, and after a kill with the next of their kind."""

from __future__ import annotations

import os
import signal
from multiprocessing import get_context
from pathlib import Path

import pytest

from sailenv_ros.system.temporary_folders import temporary_folder

PREFIX = "sailenv-test-"


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of temporary files, for this process and its children."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def _killed_inside() -> None:
    with temporary_folder(PREFIX) as folder:
        (folder / "half").write_text("a")
        os.kill(os.getpid(), signal.SIGKILL)


def _leave_one() -> None:
    process = get_context("fork").Process(target=_killed_inside)
    process.start()
    process.join()
    assert process.exitcode == -signal.SIGKILL


def test_it_is_gone_with_its_block(place: Path) -> None:
    """Nobody else can look into it, and its content goes with it."""
    with temporary_folder(PREFIX) as folder:
        assert folder.stat().st_mode & 0o777 == 0o700
        (folder / "file").write_text("a")
    assert not list(place.iterdir())


def test_what_a_killed_process_left_goes_with_the_next(place: Path) -> None:
    """Those in use stay, those of another kind too."""
    with temporary_folder(PREFIX) as used, temporary_folder("other-"):
        _leave_one()
        assert len(list(place.iterdir())) == 3
        with temporary_folder(PREFIX) as folder:
            assert {path.name for path in place.glob(f"{PREFIX}*")} == {used.name, folder.name}
            assert len(list(place.iterdir())) == 3


def test_what_others_made_stays(place: Path) -> None:
    """A link, a file, and a folder whose maker holds no lock are left alone."""
    target = place / "target"
    target.mkdir()
    (target / "kept").write_text("a")
    (place / f"{PREFIX}link.held").symlink_to(target)
    (place / f"{PREFIX}file.held").write_text("a")
    (place / f"{PREFIX}older").mkdir()
    before = sorted(place.rglob("*"))
    with temporary_folder(PREFIX):
        pass
    assert sorted(place.rglob("*")) == before
