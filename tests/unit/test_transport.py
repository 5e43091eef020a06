"""When the shared-memory profile is set, and when it is left alone."""

from __future__ import annotations

import fcntl
import shutil
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from sailenv_ros.transport import (
    NEEDED_BYTES,
    PROFILE_VARIABLE,
    remove_abandoned_segments,
    use_shared_memory_profile,
)

PROFILE = Path(__file__).parents[2] / "config" / "fastdds.xml"


@pytest.fixture
def roomy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder that has just enough room."""
    usage = SimpleNamespace(free=NEEDED_BYTES)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage)
    return tmp_path


def test_the_profile_is_set_where_there_is_room(roomy: Path) -> None:
    """Without a word of the user's, ours is used, however often it is asked for."""
    environment: dict[str, str] = {}
    for _ in range(2):
        choice = use_shared_memory_profile(PROFILE, environment=environment, shared_memory=roomy)
        assert choice.used
        assert environment == {PROFILE_VARIABLE: str(PROFILE)}


@pytest.mark.parametrize(
    "environment",
    [
        {PROFILE_VARIABLE: "/home/me/own.xml"},
        {"FASTDDS_DEFAULT_PROFILES_FILE": "/home/me/own.xml"},
        {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"},
        {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"},
    ],
)
def test_the_users_own_choice_wins(environment: dict[str, str], roomy: Path) -> None:
    """A profile, transports or another middleware of the user's are left as they are."""
    before = dict(environment)
    choice = use_shared_memory_profile(PROFILE, environment=environment, shared_memory=roomy)
    assert not choice.used
    assert next(iter(before)) in choice.why
    assert environment == before


def test_a_small_shared_memory_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A container's 64 MiB would not hold the segments; the reason names both numbers."""
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=64 * 2**20))
    environment: dict[str, str] = {}
    choice = use_shared_memory_profile(PROFILE, environment=environment, shared_memory=tmp_path)
    assert not choice.used
    assert "64 MiB free and 256 are needed" in choice.why
    assert environment == {}


def test_what_is_missing_is_said(roomy: Path, tmp_path: Path) -> None:
    """A missing profile or shared memory is a reason, not an error."""
    missing = tmp_path / "none.xml"
    assert "none.xml" in use_shared_memory_profile(missing, environment={}).why


def test_no_shared_memory_is_a_reason(tmp_path: Path) -> None:
    """Where there is no shared memory at all, that is said."""
    gone = tmp_path / "shm"
    choice = use_shared_memory_profile(PROFILE, environment={}, shared_memory=gone)
    assert not choice.used
    assert str(gone) in choice.why


def test_segments_of_the_dead_are_removed_and_of_the_living_kept(tmp_path: Path) -> None:
    """What nobody has locked goes, what is locked or not a segment stays."""
    for name in ("fastrtps_0123456789abcdef", "fastrtps_fedcba9876543210", "fastrtps_port7000"):
        (tmp_path / name).write_bytes(bytes(1000))
        (tmp_path / f"{name}_el").touch()
    (tmp_path / "of_another").write_bytes(bytes(1000))
    with (tmp_path / "fastrtps_fedcba9876543210_el").open() as living:
        fcntl.flock(living, fcntl.LOCK_EX)
        assert remove_abandoned_segments(tmp_path) == 1000
        assert remove_abandoned_segments(tmp_path) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "fastrtps_fedcba9876543210",
        "fastrtps_fedcba9876543210_el",
        "fastrtps_port7000",
        "fastrtps_port7000_el",
        "of_another",
    ]


def test_our_profile_has_the_segment_that_it_promises() -> None:
    """64 MiB of shared memory, and UDP for other hosts, in the default profile."""
    root = ElementTree.parse(PROFILE).getroot()
    assert [e.text for e in root.iterfind(".//{*}segment_size")] == [str(64 * 2**20)]
    assert [e.text for e in root.iterfind(".//{*}type")] == ["SHM", "UDPv4"]
    (participant,) = root.iterfind(".//{*}participant")
    assert participant.get("is_default_profile") == "true"
