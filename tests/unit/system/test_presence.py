"""The lock that tells whether a simulator runs here."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sailenv_ros.errors import InvalidRequest, NameTaken
from sailenv_ros.system.presence import (
    SimulatorLock,
    checked_namespace,
    present_simulator,
    simulator_is_present,
)

pytestmark = pytest.mark.usefixtures("own_folders")

HOLD = """
import sys
from sailenv_ros.system.presence import SimulatorLock
with SimulatorLock(7, "/sailenv"):
    print("held", flush=True)
    sys.stdin.read()
"""


def test_one_simulator_of_a_name() -> None:
    """A second one of the same domain and namespace is refused, others are not."""
    with SimulatorLock(7, "/sailenv"):
        with pytest.raises(NameTaken, match="/sailenv"):
            SimulatorLock(7, "/sailenv")
        with SimulatorLock(8, "/sailenv"), SimulatorLock(7, "/other"):
            pass
    with SimulatorLock(7, "/sailenv"):
        pass


def test_presence_is_seen_and_looking_changes_nothing() -> None:
    """A client sees the lock of a simulator, and a simulator can start while clients look."""
    assert not simulator_is_present(7, "/sailenv")
    lock = SimulatorLock(7, "/sailenv")
    assert simulator_is_present(7, "/sailenv")
    assert present_simulator(7, "/sailenv") == os.getpid()
    assert not simulator_is_present(7, "/sailenv/room")
    lock.release()
    lock.release()
    assert not simulator_is_present(7, "/sailenv")


def test_the_lock_ends_with_a_process_that_is_killed() -> None:
    """However a simulator ends, its lock is free at once."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == b"held\n"
        assert present_simulator(7, "/sailenv") == holder.pid
        holder.kill()
        holder.wait(10)
        assert not simulator_is_present(7, "/sailenv")


def test_the_runtime_folder_is_used_where_there_is_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Locks lie in `$XDG_RUNTIME_DIR`, which other users cannot write to."""
    runtime = tmp_path / "runtime"
    runtime.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(runtime))
    with SimulatorLock(7, "/sailenv"):
        assert [path.name for path in (runtime / "sailenv_ros").iterdir()] == [
            "domain_7_sailenv.lock"
        ]
        assert present_simulator(7, "/sailenv") == os.getpid()


def test_a_runtime_folder_that_others_write_to_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A variable that points to a public folder is as good as none."""
    public = tmp_path / "public"
    public.mkdir()
    public.chmod(0o777)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(public))
    with SimulatorLock(7, "/sailenv"):
        assert not list(public.iterdir())


def test_a_folder_that_others_can_write_to_is_refused(tmp_path: Path) -> None:
    """Who can write to the folder could have put anything there: it is not touched."""
    folder = tmp_path / f"sailenv_ros_{os.getuid()}"
    folder.mkdir()
    folder.chmod(0o777)
    with pytest.raises(InvalidRequest, match="mode is 777"):
        SimulatorLock(7, "/sailenv")
    with pytest.raises(InvalidRequest, match="mode is 777"):
        present_simulator(7, "/sailenv")
    assert not list(folder.iterdir())


def test_a_folder_of_another_owner_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Somebody else was there first: a sentence names the owner, and nothing is written."""
    owner, stranger = os.getuid(), os.getuid() + 1
    folder = tmp_path / f"sailenv_ros_{stranger}"
    folder.mkdir(mode=0o700)
    monkeypatch.setattr(os, "getuid", lambda: stranger)
    with pytest.raises(InvalidRequest, match=f"belongs to user {owner}"):
        SimulatorLock(7, "/sailenv")
    assert not list(folder.iterdir())


def test_a_link_in_the_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    """A link is not followed, even to a folder of this user."""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir(mode=0o700)
    (tmp_path / f"sailenv_ros_{os.getuid()}").symlink_to(elsewhere)
    with pytest.raises(InvalidRequest, match="alone"):
        SimulatorLock(7, "/sailenv")
    assert not list(elsewhere.iterdir())


def test_a_link_in_the_place_of_the_lock_is_refused(tmp_path: Path) -> None:
    """The file that a link points to keeps its bytes."""
    victim = tmp_path / "victim"
    victim.write_text("precious")
    folder = tmp_path / f"sailenv_ros_{os.getuid()}"
    folder.mkdir(mode=0o700)
    (folder / "domain_7_sailenv.lock").symlink_to(victim)
    with pytest.raises(InvalidRequest, match="plain file"):
        SimulatorLock(7, "/sailenv")
    with pytest.raises(InvalidRequest, match="plain file"):
        present_simulator(7, "/sailenv")
    assert victim.read_text() == "precious"


@pytest.mark.parametrize(
    ("given", "whole"),
    [("/sailenv", "/sailenv"), ("a/b_2", "/a/b_2"), ("", "/"), ("/", "/"), ("/a/", "/a")],
)
def test_namespaces_are_made_whole(given: str, whole: str) -> None:
    """As ROS writes them."""
    assert checked_namespace(given) == whole


@pytest.mark.parametrize("given", ["a b", "1a", "a//b", "a-b", "a\0b", "ä", "~x", 7, "a" * 300])
def test_namespaces_that_ros_refuses_are_told(given: object) -> None:
    """Before anything is started, and with what would be accepted."""
    with pytest.raises(InvalidRequest, match="namespace must be names divided by '/'"):
        checked_namespace(given)
