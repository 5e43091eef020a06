"""Admission of new connections to a server: so many in all, so many of one address.

One peer can thus neither use up a process's descriptors nor keep all others out, and a storm of
connections makes a line of the log a minute.
"""

from __future__ import annotations

import logging
import resource
import socket
import time
from collections.abc import Sequence

__all__ = ["BACKLOG", "ConnectionGate", "RareWarning", "address_of"]

BACKLOG = 32
"""Connections that wait to be accepted; asyncio accepts as many at once before one is looked at."""

RESERVED_DESCRIPTORS = 3 * BACKLOG
"""Descriptors that connections leave to the rest of the process, and to what waits in backlogs."""

INTERVAL_S = 60.0


class RareWarning:
    """Warns once, then at most once a minute, with the number of those that were not told.

    Parameters
    ----------
    log : logging.Logger
    """

    def __init__(self, log: logging.Logger) -> None:
        self._log = log
        self._next_s = 0.0
        self._untold = 0

    def warn(self, what: str, exception: BaseException | None = None) -> None:
        """Log a warning, or count it."""
        now = time.monotonic()
        if now < self._next_s:
            self._untold += 1
            return
        more = f" ({self._untold} more like it since the last such line)" if self._untold else ""
        self._next_s, self._untold = now + INTERVAL_S, 0
        self._log.warning("%s%s", what, more, exc_info=exception)


class ConnectionGate:
    """Admits connections up to limits.

    Parameters
    ----------
    what : str
        The server, as the log names it: ``"gateway"``.
    connections : int
        Most connections at a time.
    per_address : int
        Most connections of one address at a time.
    """

    def __init__(self, what: str, connections: int, per_address: int) -> None:
        self._what = what
        self._connections = connections
        self._per_address = per_address
        self._warning = RareWarning(logging.getLogger(__name__))

    def admits(self, new: socket.socket, others: Sequence[str]) -> bool:
        """Return whether a connection is taken; the log has the reason where it is not.

        Parameters
        ----------
        new : socket.socket
            The one that has been accepted.
        others : sequence of str
            Addresses of those that are open, one for each.
        """
        reason = self._reason(new, others)
        if reason:
            self._warning.warn(f"the {self._what} refuses a connection: {reason}")
        return not reason

    def _reason(self, new: socket.socket, others: Sequence[str]) -> str:
        # A new descriptor is the lowest that is free: near the limit, few are left.
        limit = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        if limit != resource.RLIM_INFINITY and new.fileno() >= limit - RESERVED_DESCRIPTORS:
            return f"this process may have {limit} descriptors, and needs the rest for itself"
        if len(others) >= self._connections:
            return f"{len(others)} are open, which is the most"
        try:
            address = address_of(new.getpeername())
        except OSError:
            return "it was closed before it began"
        if others.count(address) >= self._per_address:
            return f"{address} has {self._per_address}, which is the most for one address"
        return ""


def address_of(peer: object) -> str:
    """Return the address without the port of what `socket.socket.getpeername` gives."""
    return str(peer[0]) if isinstance(peer, tuple) and peer else str(peer)
