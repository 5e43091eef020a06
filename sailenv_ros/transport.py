"""Which Fast DDS profile our own processes use: a big shared-memory segment where it fits.

The node and the `Agent` call `use_shared_memory_profile` before their first ROS context. It only
sets an environment variable, so it needs no ROS; a profile or middleware of the user's wins.
"""

from __future__ import annotations

import logging
import os
import shutil
from collections.abc import MutableMapping
from dataclasses import dataclass
from pathlib import Path

__all__ = ["NEEDED_BYTES", "ProfileChoice", "use_shared_memory_profile"]

_log = logging.getLogger(__name__)

PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The variable that Fast DDS 2.14 (ROS 2 Jazzy) reads."""

_USERS_OWN = (PROFILE_VARIABLE, "FASTDDS_DEFAULT_PROFILES_FILE", "FASTDDS_BUILTIN_TRANSPORTS")

NEEDED_BYTES = 256 * 2**20
"""Free shared memory that is asked for: segments of a node and two clients, and some air."""

SHARED_MEMORY = Path("/dev/shm")


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
    profile = _own_profile() if profile is None else profile
    why_not = _reason_against(profile, environment, shared_memory)
    if why_not:
        _log.info("without the shared-memory profile, as %s", why_not)
        return ProfileChoice(used=False, why=why_not)
    environment[PROFILE_VARIABLE] = str(profile)
    return ProfileChoice(used=True, why=f"profile {profile}")


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


def _own_profile() -> Path:
    return Path(__file__).resolve().parents[1] / "config" / "fastdds.xml"
