"""Simulated time in nanoseconds to and from `builtin_interfaces/Time`."""

from __future__ import annotations

from builtin_interfaces.msg import Time

from sailenv_ros.errors import InvalidRequest

__all__ = ["NS_PER_S", "ns_from_stamp", "stamp_from_ns"]

NS_PER_S = 1_000_000_000
MAX_STAMP_NS = (2**31 - 1) * NS_PER_S + NS_PER_S - 1
"""The latest time that the message can hold (68 years)."""


def stamp_from_ns(time_ns: int) -> Time:
    """Make a stamp from a time [ns].

    Raises
    ------
    InvalidRequest
        If it is negative or later than the message can hold.
    """
    if not 0 <= time_ns <= MAX_STAMP_NS:
        raise InvalidRequest("time", time_ns, f"from 0 to {MAX_STAMP_NS} [ns]")
    seconds, rest = divmod(int(time_ns), NS_PER_S)
    return Time(sec=seconds, nanosec=rest)


def ns_from_stamp(stamp: Time) -> int:
    """Return a stamp's time [ns]."""
    return int(stamp.sec) * NS_PER_S + int(stamp.nanosec)
