"""Sockets whose other end has vanished without a word, or takes nothing: the system ends them.

A killed process says goodbye through its kernel; a machine that was switched off, or a cut cable,
does not, and Linux would wait for two hours.
"""

from __future__ import annotations

import socket

__all__ = ["SILENT_S", "end_when_silent"]

SILENT_S = 9.0
"""A peer that neither answers nor accepts data for this long is considered gone [s]."""


def end_when_silent(peer: socket.socket, silent_s: float) -> None:
    """Have a TCP socket fail when its peer has been silent for so long.

    That is: no answer to the probes of a connection at rest, or nothing taken of what was sent. A
    slow peer that takes something now and then stays. See TCP_USER_TIMEOUT in `man 7 tcp`.

    Parameters
    ----------
    peer : socket.socket
    silent_s : float
        At least 1 [s]; a connection at rest is probed each second from its half on.
    """
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    idle_s = max(1, int(silent_s / 2))
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, idle_s)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 1)
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, max(1, int(silent_s) - idle_s))
    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, int(silent_s * 1000))
