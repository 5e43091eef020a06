"""Choice of the Fast DDS profile of our processes: shared memory, as much of it as is free.

The node and the `Agent` call `use_shared_memory_profile` before their first ROS context. It only
sets an environment variable, so it needs no ROS; a profile or middleware of the user's wins.
A process that is killed leaves its segment behind, which the next one of ours removes.
"""

from __future__ import annotations

import contextlib
import fcntl
import logging
import os
import re
import shutil
from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass
from pathlib import Path

from sailenv_ros.errors import InvalidRequest, StorageError
from sailenv_ros.system.files import write_file
from sailenv_ros.system.process_locks import open_private_folder
from sailenv_ros.system.resources import resource_path

__all__ = [
    "NEEDED_BYTES",
    "PROFILES",
    "ProfileChoice",
    "is_local",
    "remove_abandoned_segments",
    "require_shared_memory",
    "stay_local",
    "use_shared_memory_profile",
    "who_may_command",
]

_log = logging.getLogger(__name__)

RANGE_VARIABLE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_RANGE_VARIABLES = (RANGE_VARIABLE, "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS")

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that Fast DDS 2.14 (ROS 2 Jazzy) reads."""

_USERS_OWN = (PROFILE_VARIABLE, "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")

PROFILES = (("fastdds.xml", 256), ("fastdds_small.xml", 48), ("fastdds_udp.xml", 0))
"""Our profiles with the free shared memory that each asks for [MiB]; the first that fits is used.

A segment of 64 or 8 MiB for each of a node, an agent and two more, and some air.
"""

NEEDED_BYTES = PROFILES[0][1] * 2**20
"""Free shared memory that the first profile asks for [B]."""

LEAST_BYTES = 64 * 2**10
"""Free shared memory without which ROS's libraries cannot even be loaded [B]."""

SHARED_MEMORY = Path("/dev/shm")

_SEGMENT_LOCK = re.compile(r"(fastrtps_[0-9a-f]{16})_el")
"""The lock file of a segment; the owner holds a lock on it until it ends, however it ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileChoice:
    """Result of choosing a Fast DDS profile.

    Attributes
    ----------
    profile : Path or None
        The profile that was set; None if an earlier choice is left as it is, be it the user's
        or that of the process which started this one.
    why : str
        One clause that says what and why, for the log.
    """

    profile: Path | None
    why: str


def use_shared_memory_profile(
    folder: Path | None = None,
    *,
    environment: MutableMapping[str, str] = os.environ,
    shared_memory: Path = SHARED_MEMORY,
) -> ProfileChoice:
    """Set one of our Fast DDS profiles for this process and its children, or leave the user's own.

    Parameters
    ----------
    folder : Path or None
        Where our profiles lie, if not where they are installed.
    environment : mutable mapping
    shared_memory : Path
        The folder whose file system holds the segments.

    Returns
    -------
    choice : ProfileChoice
    """
    remove_abandoned_segments(shared_memory)
    own = _users_choice(environment)
    if own:
        return ProfileChoice(profile=None, why=f"transport as {own} says")
    folder = resource_path("config") if folder is None else folder
    free = _free_mib(shared_memory)
    name = next(name for name, needed in PROFILES if free >= needed)
    profile = folder / name
    why = f"transport profile {name}"
    if is_local(environment):
        profile = _local_profile(profile)
        why += ", on this machine alone"
    environment[PROFILE_VARIABLE] = str(profile)
    if name != PROFILES[0][0]:
        why += (
            f", because {shared_memory} has {free} MiB free and pictures want {PROFILES[0][1]}"
            " (docker: --shm-size)"
        )
        _log.warning("%s", why)
    return ProfileChoice(profile=profile, why=why)


def stay_local(environment: MutableMapping[str, str] = os.environ) -> None:
    """Have ROS stay on this machine, unless the environment says anything about that already.

    For what this package starts by itself; who runs a node by ROS's own means has ROS's default.
    """
    if not any(environment.get(name) for name in _RANGE_VARIABLES):
        environment[RANGE_VARIABLE] = "LOCALHOST"


def is_local(environment: Mapping[str, str] = os.environ) -> bool:
    """Return whether ROS stays on this machine, by what the environment says."""
    if environment.get("ROS_LOCALHOST_ONLY"):
        return environment["ROS_LOCALHOST_ONLY"] == "1"
    return environment.get(RANGE_VARIABLE, "").upper() in ("LOCALHOST", "OFF")


def who_may_command(domain_id: int, environment: Mapping[str, str] = os.environ) -> str:
    """Return one sentence: from where a simulator of that ROS domain can be commanded."""
    if environment.get("ROS_SECURITY_ENABLE", "").lower() == "true":
        return "programs with a key of this SROS 2 keystore may command it"
    if is_local(environment):
        return "programs of this machine may command it"
    return (
        f"everybody who reaches ROS domain {domain_id} over the network may command it; for this "
        f"machine alone: {RANGE_VARIABLE}=LOCALHOST"
    )


def _local_profile(profile: Path) -> Path:
    """Return a copy of a profile whose sockets lie on the loopback interface alone.

    ROS's own LOCALHOST says where others are looked for; the sockets listen everywhere all the
    same.
    """
    text = profile.read_text(encoding="utf-8")
    udp = "<type>UDPv4</type>"
    loopback = f"{udp}<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>"
    try:
        with open_private_folder() as folder:
            write_file(folder / f"local_{profile.name}", text.replace(udp, loopback).encode())
            return folder / f"local_{profile.name}"
    except (OSError, InvalidRequest) as problem:
        _log.warning("ROS's sockets listen on every interface of this machine: %s", problem)
        return profile


def require_shared_memory(shared_memory: Path = SHARED_MEMORY) -> None:
    """Make sure that ROS can start: its libraries write to shared memory as they are loaded.

    To be called before rclpy is imported. Where shared memory is full, the kernel would end the
    process with "Bus error", and nobody could say why.

    Raises
    ------
    StorageError
        If there is no room.
    """
    try:
        free = shutil.disk_usage(shared_memory).free
    except OSError:
        return  # there is none, and so nothing is written there
    if free < LEAST_BYTES:
        remove_abandoned_segments(shared_memory)
        free = shutil.disk_usage(shared_memory).free
    if free < LEAST_BYTES:
        why = (
            f"{free >> 10} KiB are free and ROS needs {LEAST_BYTES >> 10} to start; remove files "
            "that nobody uses any more there, or give a container more (docker: --shm-size)"
        )
        raise StorageError("shared memory", str(shared_memory), OSError(0, why))


def _users_choice(environment: MutableMapping[str, str]) -> str:
    """Name what is set already, if anything."""
    middleware = environment.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
    if not middleware.startswith("rmw_fastrtps"):
        return f"RMW_IMPLEMENTATION={middleware}"
    for name in _USERS_OWN:
        if environment.get(name):
            return f"{name}={environment[name]}"
    return ""


def _free_mib(shared_memory: Path) -> int:
    try:
        return shutil.disk_usage(shared_memory).free >> 20
    except OSError:
        return 0


def remove_abandoned_segments(shared_memory: Path = SHARED_MEMORY) -> int:
    """Remove the segments of Fast DDS that processes of this user left behind when they died.

    Returns
    -------
    freed_bytes : int
        Shared memory that is free again [B].
    """
    freed = 0
    for lock_file in sorted(shared_memory.glob("fastrtps_*_el")):
        named = _SEGMENT_LOCK.fullmatch(lock_file.name)
        if named:
            with contextlib.suppress(OSError):  # another's, or removed by another meanwhile
                freed += _remove_if_abandoned(shared_memory / named[1], lock_file)
    if freed:
        _log.info("removed %d MiB of shared memory of processes that had died", freed >> 20)
    return freed


def _remove_if_abandoned(segment: Path, lock_file: Path) -> int:
    fd = os.open(lock_file, os.O_RDONLY)
    try:
        if os.fstat(fd).st_uid != os.getuid():
            return 0
        fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)  # OSError: its owner lives
        size = segment.stat().st_size
        segment.unlink()
        lock_file.unlink()
        return size
    finally:
        os.close(fd)
