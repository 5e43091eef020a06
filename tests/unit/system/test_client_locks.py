"""The lock that tells whether a client lives."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from sailenv_ros.system import client_locks
from sailenv_ros.system.client_locks import AgentName, ClientLock, client_lives
from sailenv_ros.system.process_locks import private_folder
from tests.support.waiting import until

HOLD = """
import os, sys
from sailenv_ros.system.client_locks import ClientLock
lock = ClientLock("client_1_abcdef")
child = os.fork() if "fork" in sys.argv else 1
if child:
    print(child, flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def _own_folder(own_folders: None, tmp_path: Path) -> None:
    (tmp_path / f"sailenv_ros_{os.getuid()}").mkdir(mode=0o700)


def test_a_client_lives_until_it_lets_go() -> None:
    """Who ended in order leaves nothing, and nothing is known of who never was."""
    assert client_lives("a") is None
    with ClientLock("a") as lock:
        assert client_lives("a") is True
        assert client_lives("b") is None
    lock.release()
    assert client_lives("a") is None
    assert not list(private_folder().iterdir())


@pytest.mark.parametrize("arguments", [(), ("fork",)])
def test_a_killed_client_is_dead_and_a_stopped_one_is_not(arguments: tuple[str, ...]) -> None:
    """A process that was forked of it does not count for it."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as holder:
        assert holder.stdout is not None
        assert holder.stdin is not None
        child = int(holder.stdout.readline())
        holder.send_signal(signal.SIGSTOP)
        assert client_lives("client_1_abcdef") is True
        holder.kill()
        holder.wait(10.0)
        # The fork may have begun just now.
        until(lambda: client_lives("client_1_abcdef") is False, "the lock to be free", 5.0)
        if arguments:
            os.kill(child, signal.SIGKILL)


def test_what_a_killed_client_leaves_is_removed_by_a_later_one() -> None:
    """Not at once: a simulator must find that it was killed."""
    left = private_folder() / "left.client"
    left.write_text("1")
    with ClientLock("a"):
        assert client_lives("left") is False
    os.utime(left, (0, 0))
    with ClientLock("b"):
        assert not left.exists()


TAKE = """
import os, sys
from sailenv_ros.system.client_locks import AgentName
name = AgentName()
if "fork" in sys.argv:
    begun, begins = os.pipe()
    if not os.fork():
        os.write(begins, b".")
        sys.stdin.read()
        os._exit(0)
    os.read(begun, 1)  # before it begins a fork holds what its parent does
print(name.text, flush=True)
sys.stdin.read()
"""


@pytest.fixture
def own_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder of locks that other tests do not take names in."""
    tmp_path.chmod(0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


@pytest.mark.usefixtures("own_locks")
def test_names_of_agents_come_again_but_not_soon() -> None:
    """The one that was let go of longest ago is next."""
    held = AgentName()
    found = []
    for _ in range(3 * client_locks.MOST_NAMES):
        name = AgentName()
        found.append(name.text)
        name.release()
    around = client_locks.MOST_NAMES - 1
    assert len(set(found)) == around
    assert held.text not in found
    assert found[around:] == found[:-around]


@pytest.mark.usefixtures("own_locks")
def test_where_all_names_are_in_use_there_are_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_locks, "MOST_NAMES", 2)
    held = [AgentName() for _ in range(4)]
    assert len({name.text for name in held}) == 4
    held[1].release()
    assert AgentName().text == held[1].text


@pytest.mark.usefixtures("own_locks")
@pytest.mark.parametrize("arguments", [(), ("fork",)])
def test_a_name_is_one_process_s_and_free_when_that_was_killed(
    arguments: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A process that was forked of it does not hold it."""
    monkeypatch.setattr(client_locks, "MOST_NAMES", 1)
    with subprocess.Popen(
        [sys.executable, "-c", TAKE, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as holder:
        assert holder.stdout is not None
        taken = holder.stdout.readline().strip()
        assert taken.endswith("_0")
        assert AgentName().text != taken
        holder.kill()
        until(lambda: holder.poll() is not None, "the end of the process", 10.0)
        assert AgentName().text == taken
