"""The lock that tells whether a simulator runs here."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from sailenv_ros.errors import NameTaken
from sailenv_ros.presence import SimulatorLock, present_simulator, simulator_is_present

HOLD = """
import sys
from sailenv_ros.presence import SimulatorLock
with SimulatorLock(7, "/sailenv"):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def _own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))


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
