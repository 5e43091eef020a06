"""Limits for the requests and the delays of a gateway's peers; numbers alone."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.system.silent_peers import SILENT_S
from sailenv_ros.types.camera import MAX_SIZE_PX

__all__ = ["GatewayLimits"]


@dataclass(frozen=True, slots=True, kw_only=True)
class GatewayLimits:
    """Limits of one gateway.

    Attributes
    ----------
    connections : int
        Peers at a time. Each that registers is an agent, of which the simulator has a limit too.
    per_address : int
        Peers of one address at a time, so that none keeps all others out.
    pixels : int
        Of the pictures of all peers together: at most so many are held in memory.
    held_bytes : int
        What all peers together may have sent of commands that are not complete yet.
    hello_s : float
        From the connection to the complete registration [s].
    command_s : float
        From a command's first byte to its last [s].
    idle_s : float
        From one command to the next [s].
    write_s : float
        For an answer to be taken by its peer [s].
    silent_s : float
        A peer that neither answers its system's probes nor takes anything for so long is gone [s].
    request_s : float
        For the simulation to do what a command asks for [s]; loading a scene takes many.
    """

    connections: int = 96
    per_address: int = 64
    pixels: int = 4 * MAX_SIZE_PX**2
    held_bytes: int = 256 * 2**20
    hello_s: float = 10.0
    command_s: float = 120.0
    idle_s: float = 3600.0
    write_s: float = 30.0
    silent_s: float = SILENT_S
    request_s: float = 120.0
