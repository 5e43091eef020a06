"""Whether a simulator of some name runs on this host: a lock that ends with its process.

A simulator holds the lock of its ROS domain and namespace while it lives. So a second simulator of
the same name is refused at once, and a client learns of a simulator's death without waiting for
the network. Knows nothing of ROS.
"""

from __future__ import annotations

import re

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.process_locks import ProcessLock, holder_of

__all__ = [
    "ClockLock",
    "SimulatorLock",
    "checked_domain",
    "checked_namespace",
    "clock_publisher",
    "present_simulator",
    "simulator_is_present",
]

MAX_DOMAIN_ID = 232
"""The largest ROS domain whose ports exist."""

_NAMESPACE_PART = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


class SimulatorLock(ProcessLock):
    """The right to be the simulator of that name on this host; a context manager.

    Parameters
    ----------
    domain_id : int
        ROS domain.
    namespace : str
        Full namespace, e.g. ``"/sailenv"``.

    Raises
    ------
    NameTaken
        If another process has it.
    InvalidRequest
        If the folder of locks is not this user's alone, or the lock is not a plain file.
    """

    def __init__(self, domain_id: int, namespace: str) -> None:
        kind = f"simulator (ROS domain {domain_id})"
        super().__init__(_file_of_simulator(domain_id, namespace), kind, namespace)


class ClockLock(ProcessLock):
    """The right to publish ``/clock`` in a ROS domain, of all simulators on this host.

    Parameters
    ----------
    domain_id : int

    Raises
    ------
    NameTaken
        If another process has it.
    InvalidRequest
        As `SimulatorLock`.
    """

    def __init__(self, domain_id: int) -> None:
        super().__init__(_file_of_clock(domain_id), f"clock (ROS domain {domain_id})", "/clock")


def clock_publisher(domain_id: int) -> int | None:
    """Return the process id of the simulator that publishes ``/clock``; None if none does."""
    return holder_of(_file_of_clock(domain_id))


def checked_domain(domain_id: object) -> int:
    """Return the number of a ROS domain, given as a number or as text.

    Raises
    ------
    InvalidRequest
        If it is none, for which Fast DDS would end the process on the spot.
    """
    text = str(domain_id)
    if not text.isascii() or not text.isdecimal() or int(text) > MAX_DOMAIN_ID:
        raise InvalidRequest("ROS_DOMAIN_ID", domain_id, f"an integer from 0 to {MAX_DOMAIN_ID}")
    return int(text)


def checked_namespace(namespace: object) -> str:
    """Return a ROS namespace in full, with a slash before it and none behind it.

    Raises
    ------
    InvalidRequest
        If ROS would not accept it.
    """
    parts = namespace.strip("/").split("/") if isinstance(namespace, str) else ["not a text"]
    whole = "/" + "/".join(parts)
    if whole != "/" and (len(whole) > 200 or not all(map(_NAMESPACE_PART.fullmatch, parts))):
        accepted = (
            "names divided by '/', each a letter or '_', then letters, digits or '_', e.g. /sailenv"
        )
        raise InvalidRequest("namespace", namespace, accepted)
    return whole


def simulator_is_present(domain_id: int, namespace: str) -> bool:
    """Return whether a simulator of that name runs on this host as this user."""
    return present_simulator(domain_id, namespace) is not None


def present_simulator(domain_id: int, namespace: str) -> int | None:
    """Return the process id of the simulator of that name on this host; None if there is none.

    0 is returned for one that has only just begun.

    Raises
    ------
    InvalidRequest
        If the folder of locks is not this user's alone, or the lock is not a plain file.
    """
    return holder_of(_file_of_simulator(domain_id, namespace))


def _file_of_simulator(domain_id: int, namespace: str) -> str:
    name = re.sub(r"[^A-Za-z0-9_]+", "-", namespace.strip("/")) or "root"
    return f"domain_{domain_id}_{name}.lock"


def _file_of_clock(domain_id: int) -> str:
    return f"clock_of_domain_{domain_id}.lock"
