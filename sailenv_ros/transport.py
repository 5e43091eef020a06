"""Which Fast DDS profile our own processes use: shared memory, as much of it as there is.

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
from collections.abc import MutableMapping
from dataclasses import dataclass
from pathlib import Path

from sailenv_ros.resources import resource_path

__all__ = [
    "NEEDED_BYTES",
    "PROFILES",
    "ProfileChoice",
    "remove_abandoned_segments",
    "use_shared_memory_profile",
]

_log = logging.getLogger(__name__)

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that Fast DDS 2.14 (ROS 2 Jazzy) reads."""

_USERS_OWN = (PROFILE_VARIABLE, "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")

PROFILES = (("fastdds.xml", 256), ("fastdds_small.xml", 48), ("fastdds_udp.xml", 0))
"""Our profiles with the free shared memory that each asks for [MiB]; the first that fits is used.

A segment of 64 or 8 MiB for each of a node, an agent and two more, and some air.
"""

NEEDED_BYTES = PROFILES[0][1] * 2**20
"""Free shared memory that the first profile asks for [B]."""

SHARED_MEMORY = Path("/dev/shm")

_SEGMENT_LOCK = re.compile(r"(fastrtps_[0-9a-f]{16})_el")
"""The lock file of a segment; the owner holds a lock on it until it ends, however it ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileChoice:
    """What was decided.

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
    environment[PROFILE_VARIABLE] = str(profile)
    why = f"transport profile {name}"
    if name != PROFILES[0][0]:
        why += (
            f", because {shared_memory} has {free} MiB free and pictures want {PROFILES[0][1]}"
            " (docker: --shm-size)"
        )
        _log.warning("%s", why)
    return ProfileChoice(profile=profile, why=why)


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
