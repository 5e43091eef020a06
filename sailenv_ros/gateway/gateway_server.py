"""The gateway: clients of SAILenv's protocol on a TCP port, in a thread of this process.

Sockets in, requests to a `Simulation` out. The simulation's rate is its own: here is only waited.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from sailenv_ros.errors import ProtocolError
from sailenv_ros.gateway.client_connection import CHUNK_BYTES, ClientConnection
from sailenv_ros.gateway.codec import Message
from sailenv_ros.gateway.gateway_limits import GatewayLimits
from sailenv_ros.gateway.protocol_commands import commands_of
from sailenv_ros.gateway.session import Session
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.connection_gate import BACKLOG, ConnectionGate, RareWarning
from sailenv_ros.system.loop_server import LoopServer
from sailenv_ros.types.agents import MAX_AGENTS

__all__ = ["DEFAULT_HOST", "DEFAULT_PORT", "GatewayServer"]

_log = logging.getLogger(__name__)

DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 8085

WORKERS = 2
"""Threads that write and compress pictures."""

NUMBERS = 4 * MAX_AGENTS
"""Numbers of clients, which come again: Fast DDS never forgets the topics of a name."""


class GatewayServer(LoopServer):
    """Serves one simulation to clients of SAILenv's protocol; a context manager.

    Parameters
    ----------
    simulation : Simulation
        Stays its owner's; it may end before this does.
    host : str
        Address to listen on; ``127.0.0.1`` for this machine alone, ``0.0.0.0`` for the network.
        There is no password: who can connect can do everything.
    port : int
        0 takes any that is free, see `port`.
    protocol : {'0.5', '0.6'}
        Revision of the clients.
    limits : GatewayLimits

    Raises
    ------
    UnknownName
        If there is no such revision.
    AddressInUse, InvalidRequest
        If another program listens there, or the address is none of this machine's.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        host: str = DEFAULT_HOST,
        port: int = DEFAULT_PORT,
        protocol: str = "0.5",
        limits: GatewayLimits | None = None,
    ) -> None:
        commands_of(protocol)
        super().__init__("gateway", host, port)
        self._simulation = simulation
        self._protocol = protocol
        self._limits = limits or GatewayLimits()
        self._ids = itertools.cycle(range(1, NUMBERS + 1))
        self._gate = ConnectionGate("gateway", self._limits.connections, self._limits.per_address)
        self._silent = RareWarning(_log)
        self._connections: dict[ClientConnection, asyncio.Task[None] | None] = {}
        self._workers = ThreadPoolExecutor(WORKERS, thread_name_prefix="sailenv-gateway-work")
        self._start()
        _log.info("SAILenv clients (protocol %s) connect to %s, port %d", protocol, host, self.port)

    @property
    def clients(self) -> int:
        """Number of peers that are connected now."""
        return len(self._connections)

    def _release(self) -> None:
        self._workers.shutdown(wait=False, cancel_futures=True)

    # -- in the thread ---------------------------------------------------------------------

    async def _serve(self, listening: Callable[[int], None]) -> None:
        server = await asyncio.start_server(
            self._accept, self.host, self.port, limit=CHUNK_BYTES, backlog=BACKLOG
        )
        listening(server.sockets[0].getsockname()[1])
        await self._stop.wait()
        server.close()
        await asyncio.sleep(0)  # those that were accepted just now begin, so as to be known
        # Again and again: until Python 3.12, wait_for loses a cancellation that meets a result.
        while tasks := [task for task in self._connections.values() if task is not None]:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks, timeout=0.1)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        others = [connection.address for connection in self._connections]
        if not self._gate.admits(writer.get_extra_info("socket"), others):
            writer.transport.abort()
            return
        connection = ClientConnection(
            Session(lambda: self._simulation.info, lambda: next(self._ids)),
            reader,
            writer,
            simulation=self._simulation,
            workers=self._workers,
            protocol=self._protocol,
            limits=self._limits,
            admit=self._admit,
            stranger_left=self._silent.warn,
        )
        self._connections[connection] = asyncio.current_task()
        try:
            await connection.serve()
        except asyncio.CancelledError:
            pass  # the gateway ends; asyncio's streams would complain about the cancelled task
        finally:
            del self._connections[connection]

    def _admit(self, connection: ClientConnection, message: Message | None) -> None:
        """Refuse a peer that, with all the others, would fill the memory."""
        if message is None:
            held = sum(other.held_bytes for other in self._connections)
            if held > self._limits.held_bytes:
                raise ProtocolError(
                    f"all clients together may have {self._limits.held_bytes} bytes of commands "
                    f"on their way, and have {held}"
                )
        elif message.name == "register":
            wanted = max(0, message.fields["width"]) * max(0, message.fields["height"])
            pixels = wanted + sum(other.pixels for other in self._connections)
            if pixels > self._limits.pixels:
                raise ProtocolError(
                    f"the pictures of all clients together may have {self._limits.pixels} pixels, "
                    f"and would have {pixels}"
                )
            connection.pixels = wanted
