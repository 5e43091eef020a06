"""Files are whole or not there, and of those who write one waits for the other."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from sailenv_ros.errors import DeadlineExceeded, StorageError
from sailenv_ros.system import files

HOLD = """
import sys
from pathlib import Path
from sailenv_ros.system.files import file_lock, written_file
with file_lock(Path(sys.argv[1]) / ".lock", "the folder"), written_file(Path(sys.argv[1]) / "a"):
    print("held", flush=True)
    sys.stdin.read()
"""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_file_is_written_and_written_over(tmp_path: Path) -> None:
    """Nothing else is left in the folder; rights that a user gave stay."""
    file = tmp_path / "a"
    files.write_file(file, b"one")
    file.chmod(0o640)
    files.write_file(file, b"two")
    assert file.read_bytes() == b"two"
    assert file.stat().st_mode & 0o777 == 0o640
    assert names(tmp_path) == ["a"]


def test_new_files_have_the_rights_that_the_user_wants(tmp_path: Path) -> None:
    """As with any other program's files the umask decides."""
    before = os.umask(0o027)
    try:
        files.write_file(tmp_path / "a", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize("supported", [True, False])
def test_a_file_that_is_there_is_left_if_it_must_be_new(
    tmp_path: Path, supported: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where the kernel cannot rename without replacing."""
    if not supported:
        monkeypatch.setattr(files, "_renameat2", lambda *_: False)
    files.write_file(tmp_path / "a", b"one", overwrite=False)
    with pytest.raises(FileExistsError):
        files.write_file(tmp_path / "a", b"two", overwrite=False)
    assert (tmp_path / "a").read_bytes() == b"one"
    assert names(tmp_path) == ["a"]


def test_what_fails_leaves_what_was_there(tmp_path: Path) -> None:
    """An error between the first byte and the last changes nothing."""
    files.write_file(tmp_path / "a", b"one")

    def fail() -> None:
        with files.written_file(tmp_path / "a") as file:
            file.write(b"tw")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert (tmp_path / "a").read_bytes() == b"one"
    assert names(tmp_path) == ["a"]


@pytest.mark.parametrize("supported", [True, False])
def test_a_folder_is_replaced_as_a_whole(
    tmp_path: Path, supported: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The new one has nothing of the old one; a failed one changes nothing."""
    if not supported:
        monkeypatch.setattr(files, "_renameat2", lambda *_: False)
    place = tmp_path / "deep" / "pack"
    with files.replaced_folder(place) as draft:
        (draft / "old").write_bytes(b"1")

    def fail() -> None:
        with files.replaced_folder(place) as draft:
            (draft / "half").write_bytes(b"2")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert names(place) == ["old"]
    with files.replaced_folder(place) as draft:
        (draft / "new").write_bytes(b"3")
    assert names(place) == ["new"]
    assert names(place.parent) == ["pack"]


def test_one_writer_at_a_time(tmp_path: Path) -> None:
    """Of threads that read, change and write a number none is lost."""
    number = tmp_path / "number"
    number.write_text("0")

    def count() -> None:
        for _ in range(25):
            with files.file_lock(tmp_path / ".lock", "the number"):
                files.write_file(number, str(int(number.read_text()) + 1).encode())

    threads = [threading.Thread(target=count) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert number.read_text() == "100"


def test_a_killed_writer_holds_nobody_up_and_leaves_nothing(tmp_path: Path) -> None:
    """While it lives others are told for what they waited; then its lock and its draft are gone."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        told: list[bool] = []
        with (
            pytest.raises(DeadlineExceeded, match="the folder, which another process writes to"),
            files.file_lock(
                tmp_path / ".lock", "the folder", timeout_s=0.1, waiting=lambda: told.append(True)
            ),
        ):
            pass
        assert told == [True]
        holder.kill()
        holder.wait(10)
    assert len(names(tmp_path)) == 2
    with files.file_lock(tmp_path / ".lock", "the folder", timeout_s=10.0):
        assert files.remove_unfinished(tmp_path) == 1
    assert names(tmp_path) == [".lock"]


def test_errors_of_the_disk_are_sentences(tmp_path: Path) -> None:
    """A full disk is called so, anything else as the system calls it."""
    with (
        pytest.raises(StorageError, match=r"the light cannot be written to .*: the disk is full"),
        files.storage_errors("the light", tmp_path),
    ):
        raise OSError(errno.ENOSPC, "No space left on device")
    with (
        pytest.raises(StorageError, match=r"the light cannot be written to .*: No such file"),
        files.storage_errors("the light", tmp_path / "none"),
    ):
        files.write_file(tmp_path / "none" / "light", b"")


def test_folders_are_made_with_those_above_them(tmp_path: Path) -> None:
    """A second time nothing happens; a file in the way is an error."""
    files.make_folder(tmp_path / "a" / "b" / "c")
    files.make_folder(tmp_path / "a" / "b" / "c")
    assert (tmp_path / "a" / "b" / "c").is_dir()
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(OSError, match="Not a directory"):
        files.make_folder(tmp_path / "file" / "a")
    files.sync_file_system(tmp_path)
