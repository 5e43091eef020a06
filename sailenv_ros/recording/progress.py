"""Numbers of a recording that is being made → the line that tells how it goes."""

from __future__ import annotations

from sailenv_ros.errors import InvalidRequest

__all__ = ["progress_line", "size_in_bytes"]

_UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9}


def progress_line(
    *, frames: int, message_bytes: int, file_bytes: int, elapsed_s: float, dropped: int
) -> str:
    """Return one line that says how a recording goes.

    Parameters
    ----------
    frames : int
    message_bytes, file_bytes : int
        Taken, and written after compression [B].
    elapsed_s : float
        Wall time since the beginning [s].
    dropped : int
        Messages that were lost, for whatever reason.
    """
    rate = message_bytes / elapsed_s * 1e-6 if elapsed_s > 0.0 else 0.0
    speed = frames / elapsed_s if elapsed_s > 0.0 else 0.0
    return (
        f"{frames} frames ({speed:.1f}/s), {message_bytes * 1e-6:.1f} MB ({rate:.1f} MB/s), "
        f"{file_bytes * 1e-6:.1f} MB on disk, dropped {dropped}"
    )


def size_in_bytes(text: str) -> int:
    """Read a size such as ``500M`` or ``2G`` (powers of ten) [B].

    Raises
    ------
    InvalidRequest
        If it is no such size.
    """
    number, unit = text.strip().rstrip("bB"), ""
    if number and number[-1].lower() in "kmg":
        number, unit = number[:-1], number[-1].lower()
    try:
        value = float(number)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < float("inf"):
        raise InvalidRequest("size", text, "a number of bytes, or one with K, M or G: 500M")
    return round(value * _UNITS[unit])
