"""Which Fast DDS profile our own processes use: a big shared-memory segment where it fits.

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
    "ProfileChoice",
    "remove_abandoned_segments",
    "use_shared_memory_profile",
]

_log = logging.getLogger(__name__)

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that Fast DDS 2.14 (ROS 2 Jazzy) reads."""

_USERS_OWN = (PROFILE_VARIABLE, "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")

NEEDED_BYTES = 256 * 2**20
"""Free shared memory that is asked for: segments of a node and two clients, and some air."""

SHARED_MEMORY = Path("/dev/shm")

_SEGMENT_LOCK = re.compile(r"(fastrtps_[0-9a-f]{16})_el")
"""The lock file of a segment; the owner holds a lock on it until it ends, however it ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileChoice:
    """What was decided.

    Attributes
    ----------
    used : bool
        True if our profile is set.
    why : str
        One clause that says why, for the log.
    """

    used: bool
    why: str


def use_shared_memory_profile(
    profile: Path | None = None,
    *,
    environment: MutableMapping[str, str] = os.environ,
    shared_memory: Path = SHARED_MEMORY,
) -> ProfileChoice:
    """Set our Fast DDS profile for this process and its children, unless there is a reason not to.

    Parameters
    ----------
    profile : Path or None
        Our profile file, if not the installed one.
    environment : mutable mapping
    shared_memory : Path
        The folder whose file system holds the segments.

    Returns
    -------
    choice : ProfileChoice
    """
    remove_abandoned_segments(shared_memory)
    profile = resource_path("config", "fastdds.xml") if profile is None else profile
    why_not = _reason_against(profile, environment, shared_memory)
    if why_not:
        _log.info("without the shared-memory profile, as %s", why_not)
        return ProfileChoice(used=False, why=why_not)
    environment[PROFILE_VARIABLE] = str(profile)
    return ProfileChoice(used=True, why=f"profile {profile}")


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


def _reason_against(
    profile: Path, environment: MutableMapping[str, str], shared_memory: Path
) -> str:
    middleware = environment.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
    if not middleware.startswith("rmw_fastrtps"):
        return f"RMW_IMPLEMENTATION is {middleware}"
    own = next((name for name in _USERS_OWN if environment.get(name)), None)
    if own is not None and environment[own] != str(profile):
        return f"{own} is set to {environment[own]}"
    if not profile.is_file():
        return f"there is no file {profile}"
    try:
        free = shutil.disk_usage(shared_memory).free
    except OSError as problem:
        return f"{shared_memory} cannot be used ({problem.strerror})"
    if free < NEEDED_BYTES:
        mib = 2**20
        return f"{shared_memory} has {free // mib} MiB free and {NEEDED_BYTES // mib} are needed"
    return ""
