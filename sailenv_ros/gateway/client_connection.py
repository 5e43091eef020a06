"""One peer's socket: its bytes to a `Session`, the session's steps to the simulation, and back.

Runs in the gateway's event loop. Every wait has a deadline; whatever happens, the peer's agent is
removed at the end. Knows no other connection.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from typing import Any, TypeVar

from sailenv_ros.errors import DeadlineExceeded, ProtocolError, SailenvError
from sailenv_ros.gateway.codec import Message, MessageReader
from sailenv_ros.gateway.gateway_limits import GatewayLimits
from sailenv_ros.gateway.session import Session
from sailenv_ros.gateway.steps import Request, Response, Step, one_line
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.connection_gate import address_of
from sailenv_ros.system.silent_peers import end_when_silent

__all__ = ["ClientConnection"]

_log = logging.getLogger(__name__)

CHUNK_BYTES = 2**18

T = TypeVar("T")


class ClientConnection:
    """A peer from its first byte to its last.

    Parameters
    ----------
    session : Session
    reader, writer : asyncio streams
    simulation : Simulation
    workers : Executor
        For what takes a while and needs no simulation.
    protocol : str
    limits : GatewayLimits
    admit : callable
        Called with each message before it is answered, and with None whenever bytes have come;
        raises `ProtocolError` where the peers together want too much.
    stranger_left : callable
        Told in words of a peer that is disconnected before its first command was complete.
    """

    def __init__(
        self,
        session: Session,
        reader: asyncio.StreamReader,
        writer: asyncio.StreamWriter,
        *,
        simulation: Simulation,
        workers: Executor,
        protocol: str,
        limits: GatewayLimits,
        admit: Callable[[ClientConnection, Message | None], None],
        stranger_left: Callable[[str], None],
    ) -> None:
        self._session = session
        self._reader = reader
        self._writer = writer
        self._simulation = simulation
        self._workers = workers
        self._messages = MessageReader(protocol)
        self._limits = limits
        self._admit = admit
        self._stranger_left = stranger_left
        self._began_s: float | None = asyncio.get_running_loop().time()
        self._greeted = False
        self.pixels = 0
        address = writer.get_extra_info("peername")
        self.address = address_of(address)
        self.peer = f"client {address[0]}:{address[1]}" if address else "a client that has gone"

    @property
    def held_bytes(self) -> int:
        """Bytes of a command that is not complete yet."""
        return self._messages.held_bytes

    async def serve(self) -> None:
        """Answer until the peer goes, breaks the protocol or takes too long."""
        in_order = False
        try:
            await self._converse()
            in_order = True
        except SailenvError as error:  # first: a deadline is an OSError too
            told = f"{self.peer} is disconnected: {one_line(error)}"
            if self._greeted:
                _log.warning("%s", told)
            else:
                self._stranger_left(told)
        except (OSError, asyncio.IncompleteReadError) as problem:
            self._say_it_went(problem)
        except Exception:
            _log.exception("%s is disconnected because of an internal error", self.peer)
        finally:
            self._remove_agent()
            if in_order:
                self._writer.close()  # after what is still on its way
            else:
                self._writer.transport.abort()

    async def _converse(self) -> None:
        self._end_when_silent()
        # To drain is then to send everything: a view's length goes out in one piece, which the
        # original client takes for granted.
        self._writer.transport.set_write_buffer_limits(high=0)
        while not self._session.ended:
            message = self._messages.take()
            if message is None:
                if not await self._read_on():
                    return
                continue
            self._greeted, self._began_s = True, None
            self._admit(self, message)
            pieces = await self._carried_out(self._session.answer(message))
            what = f"{self.peer} to take an answer"
            await _within(self._sent(pieces), what, self._limits.write_s)

    async def _read_on(self) -> bool:
        """Read what comes; False if the peer has gone in good order."""
        if self._began_s is None and not self._messages.is_idle:
            self._began_s = asyncio.get_running_loop().time()
        data = await _within(self._reader.read(CHUNK_BYTES), *self._patience())
        if not data:
            if not self._messages.is_idle:
                _log.info("%s went away in the middle of a command", self.peer)
            return False
        self._messages.feed(data)
        self._admit(self, None)
        return True

    def _patience(self) -> tuple[str, float]:
        """Return what is waited for, and how much longer [s] from a command's first byte."""
        if self._began_s is None:
            return f"the next command of {self.peer}", self._limits.idle_s
        limit_s = self._limits.command_s if self._greeted else self._limits.hello_s
        spent_s = asyncio.get_running_loop().time() - self._began_s
        what = "rest of a command" if self._greeted else "registration"
        return f"the {what} of {self.peer}", max(0.001, limit_s - spent_s)

    async def _sent(self, pieces: Sequence[bytes]) -> None:
        # Bit by bit: what the system does not take at once is copied, which a frame is too big for.
        for piece in _joined_if_small(pieces):
            for start in range(0, len(piece), CHUNK_BYTES):
                self._writer.write(memoryview(piece)[start : start + CHUNK_BYTES])
                await self._writer.drain()

    async def _carried_out(self, answer: Response) -> Sequence[bytes]:
        """Drive an answer to its end."""
        result: Any = None
        error: SailenvError | None = None
        while True:
            try:
                step = answer.send(result) if error is None else answer.throw(error)
            except StopIteration as done:
                pieces: Sequence[bytes] = done.value
                return pieces
            result = error = None
            try:
                result = await self._done(step)
            except SailenvError as problem:
                error = problem

    async def _done(self, step: Step) -> Any:
        if not isinstance(step, Request):
            return await asyncio.get_running_loop().run_in_executor(self._workers, step.function)
        future = step.operation.submit_to(self._simulation, *step.args, **step.kwargs)
        what = f"the operation {step.operation.name!r} of {self.peer}"
        return await _within(asyncio.wrap_future(future), what, self._limits.request_s)

    def _end_when_silent(self) -> None:
        peer: socket.socket | None = self._writer.get_extra_info("socket")
        if peer is None:
            raise ProtocolError("the connection was closed before it began")
        end_when_silent(peer, self._limits.silent_s)
        # Only so much waits here for a peer that reads no more; what travels is not counted.
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, CHUNK_BYTES)

    def _say_it_went(self, problem: Exception) -> None:
        # Whoever writes is told of a reset alone, whatever it was.
        cause = self._reader.exception() or problem
        if isinstance(cause, ConnectionError | asyncio.IncompleteReadError):
            _log.info("%s went away", self.peer)
        else:
            silent_s = self._limits.silent_s
            why = f"it neither answered nor took anything for {silent_s:g} s ({cause})"
            _log.warning("%s is disconnected: %s", self.peer, why)

    def _remove_agent(self) -> None:
        """Have the agent removed, after all that was asked for it; nobody waits for it."""
        if self._session.agent:
            with contextlib.suppress(SailenvError):  # the simulation has ended, and with it all
                self._simulation.delete_agent.submit(self._session.agent)


def _joined_if_small(pieces: Sequence[bytes]) -> Sequence[bytes]:
    """Make one piece of an answer of many small ones, each of which would be a packet."""
    return [b"".join(pieces)] if sum(map(len, pieces)) <= CHUNK_BYTES else pieces


async def _within(awaitable: Awaitable[T], what: str, timeout_s: float) -> T:
    try:
        return await asyncio.wait_for(awaitable, timeout_s)
    except asyncio.TimeoutError as problem:  # Python 3.10: not the built-in one
        if getattr(problem, "errno", None):
            raise  # of the socket's own
        raise DeadlineExceeded(what, timeout_s) from None
