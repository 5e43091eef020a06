"""Which transport profile is set, and when the user's own is left alone."""

from __future__ import annotations

import fcntl
import shutil
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from sailenv_ros.errors import StorageError
from sailenv_ros.system.resources import resource_path
from sailenv_ros.system.transport import (
    PROFILE_VARIABLE,
    PROFILES,
    RANGE_VARIABLE,
    is_local,
    remove_abandoned_segments,
    require_shared_memory,
    stay_local,
    use_shared_memory_profile,
    who_may_command,
)


@pytest.mark.parametrize(
    ("free_mib", "profile"),
    [
        (100_000, "fastdds.xml"),
        (256, "fastdds.xml"),
        (255, "fastdds_small.xml"),
        (48, "fastdds_small.xml"),
        (47, "fastdds_udp.xml"),
        (0, "fastdds_udp.xml"),
    ],
)
def test_the_profile_fits_the_shared_memory(
    free_mib: int, profile: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The biggest segment that there is room for, and a word where it is not the biggest."""
    usage = SimpleNamespace(free=free_mib * 2**20)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage)
    environment: dict[str, str] = {}
    choice = use_shared_memory_profile(environment=environment, shared_memory=tmp_path)
    assert choice.profile == resource_path("config") / profile
    assert environment == {PROFILE_VARIABLE: str(choice.profile)}
    assert profile in choice.why
    assert (f"has {free_mib} MiB free" in choice.why) == (profile != "fastdds.xml")


@pytest.mark.parametrize(
    "environment",
    [
        {PROFILE_VARIABLE: "/home/me/own.xml"},
        {"FASTDDS_DEFAULT_PROFILES_FILE": "/home/me/own.xml"},
        {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"},
        {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"},
        {PROFILE_VARIABLE: str(resource_path("config", "fastdds_udp.xml"))},
    ],
)
def test_the_users_own_choice_wins(environment: dict[str, str], tmp_path: Path) -> None:
    """A profile, transports or another middleware of the user's are left as they are."""
    before = dict(environment)
    choice = use_shared_memory_profile(environment=environment, shared_memory=tmp_path)
    assert choice.profile is None
    assert next(iter(before)) in choice.why
    assert environment == before


def test_where_there_is_no_shared_memory_none_is_used(tmp_path: Path) -> None:
    """A system without /dev/shm gets sockets, and a reason."""
    gone = tmp_path / "shm"
    choice = use_shared_memory_profile(environment={}, shared_memory=gone)
    assert choice.profile is not None
    assert choice.profile.name == "fastdds_udp.xml"
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


@pytest.mark.parametrize(
    ("name", "segment_mib"), [(PROFILES[0][0], 64), (PROFILES[1][0], 8), (PROFILES[2][0], 0)]
)
def test_the_profiles_are_what_they_promise(name: str, segment_mib: int) -> None:
    """The segment's size, UDP for other hosts, quick finding and mending; for every participant."""
    root = ElementTree.parse(resource_path("config", name)).getroot()

    def texts(tag: str) -> list[str | None]:
        return [element.text for element in root.iterfind(f".//{{*}}{tag}")]

    assert texts("segment_size") == [str(segment_mib << 20)] * bool(segment_mib)
    assert texts("type") == ["SHM"] * bool(segment_mib) + ["UDPv4"]
    assert set(texts("maxInitialPeersRange")) == {"64"}
    assert texts("leaseAnnouncement/{*}nanosec") == ["250000000"]
    assert texts("heartbeatPeriod/{*}nanosec") == ["20000000"]
    for kind in ("participant", "data_writer"):
        (entry,) = root.iterfind(f".//{{*}}{kind}")
        assert entry.get("is_default_profile") == "true"


def test_full_shared_memory_is_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without room ROS's libraries would end the process with a bus error while they are loaded."""
    free = {"bytes": 64 * 2**10}
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=free["bytes"]))
    require_shared_memory(tmp_path)
    free["bytes"] -= 1
    with pytest.raises(StorageError, match="63 KiB are free and ROS needs 64 to start; remove"):
        require_shared_memory(tmp_path)


def test_a_machine_without_shared_memory_starts(tmp_path: Path) -> None:
    """Nothing is written where there is nothing."""
    require_shared_memory(tmp_path / "none")


@pytest.mark.parametrize(
    ("environment", "local"),
    [
        ({}, True),
        ({RANGE_VARIABLE: "SUBNET"}, False),
        ({RANGE_VARIABLE: "LOCALHOST"}, True),
        ({"ROS_LOCALHOST_ONLY": "0"}, False),
        ({"ROS_LOCALHOST_ONLY": "1", RANGE_VARIABLE: "SUBNET"}, True),
        ({"ROS_STATIC_PEERS": "192.168.0.7"}, False),
    ],
)
def test_what_we_start_stays_on_this_machine(environment: dict[str, str], local: bool) -> None:
    """Unless the environment says anything about that already."""
    given = dict(environment)
    assert not is_local({})
    stay_local(environment)
    assert is_local(environment) == local
    assert given == environment or given == {}


def test_on_this_machine_alone_the_sockets_are_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The profile names the loopback interface; without a safe folder there is a warning."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "none"))
    environment = {RANGE_VARIABLE: "LOCALHOST"}
    choice = use_shared_memory_profile(environment=environment, shared_memory=tmp_path)
    assert "on this machine alone" in choice.why
    profile = Path(environment[PROFILE_VARIABLE])
    tree = ElementTree.parse(profile)
    space = "{http://www.eprosima.com}"
    for transport in tree.iter(f"{space}transport_descriptor"):
        found = [entry.text for entry in transport.iter(f"{space}address")]
        udp = transport.findtext(f"{space}type") == "UDPv4"
        assert found == (["127.0.0.1"] if udp else [])
    profile.parent.chmod(0o777)
    environment = {RANGE_VARIABLE: "LOCALHOST"}
    use_shared_memory_profile(environment=environment, shared_memory=tmp_path)
    assert Path(environment[PROFILE_VARIABLE]).parent == resource_path("config")


def test_the_log_says_who_may_command() -> None:
    """By the range of discovery, or by SROS 2."""
    assert "everybody who reaches ROS domain 7" in who_may_command(7, {})
    assert "this machine" in who_may_command(7, {RANGE_VARIABLE: "LOCALHOST"})
    assert "keystore" in who_may_command(7, {"ROS_SECURITY_ENABLE": "true"})
