"""Limits for the requests and the delays of the web viewer's clients; numbers alone."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.system.silent_peers import SILENT_S

__all__ = ["ViewerLimits"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewerLimits:
    """Limits of one viewer, and of each window of it.

    Attributes
    ----------
    connections : int
        Connections at a time; a browser keeps up to seven for each window.
    per_address : int
        Connections of one address at a time, so that no peer keeps all others out.
    header_s : float
        From a connection's begin, or its last answer, to a complete request [s].
    clients : int
        Windows at a time.
    message_bytes : int
        Longest message of a client.
    messages_per_s : int
        Most messages of a client in one second; a mouse and all keys make about 100.
    requests : int
        Requests of one client that may be on their way at a time.
    send_s : float
        From the beginning of an answer to its end [s]: who does not read is disconnected.
    silent_s : float
        A client that answers no ping for so long is gone [s].
    request_s : float
        Deadline of a request [s]; loading a scene takes many.
    capture_s : float
        A data set that is captured ends after so long with what was seen until then [s].
    capture_bytes : int
        Most bytes of a data set, which is packed beside itself.
    """

    connections: int = 256
    per_address: int = 192
    header_s: float = 15.0
    clients: int = 24
    message_bytes: int = 64 * 1024
    messages_per_s: int = 400
    requests: int = 16
    send_s: float = 20.0
    silent_s: float = SILENT_S
    request_s: float = 120.0
    capture_s: float = 600.0
    capture_bytes: int = 1_000_000_000
