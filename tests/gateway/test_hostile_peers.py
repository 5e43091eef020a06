"""Peers that break the protocol, stop, vanish or come in crowds: the simulator is not harmed.

Every test ends by looking that no agent is left, that simulated time goes on by itself, and that a
well-behaved client is served.
"""

from __future__ import annotations

import random
import socket
import struct
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import pytest

from sailenv_ros.gateway import GatewayServer
from sailenv_ros.gateway.gateway_limits import GatewayLimits
from sailenv_ros.simulation import Simulation
from tests.support.sailenv_client import clients_of, original_client
from tests.support.waiting import until

RANDOM_BYTES = 1_000_000
CONNECTIONS = 200

LIMITS = GatewayLimits(
    hello_s=1.0, command_s=1.0, write_s=1.0, pixels=1024 * 1024 + 640 * 480, held_bytes=2**20
)
"""Short enough for a test to wait for."""


@contextmanager
def unharmed(simulation: Simulation, limits: GatewayLimits) -> Iterator[GatewayServer]:
    """Serve, and look at the end that nothing is left and that a client is served."""
    with GatewayServer(simulation, port=0, limits=limits) as server:
        yield server
        until(lambda: server.clients == 0, "every peer to be gone", 20.0)
        until(lambda: not clients_of(simulation), "the agents to be gone", 10.0)
        goal = simulation.sim_time_ns + 100_000_000
        until(lambda: simulation.sim_time_ns > goal, "simulated time to go on", 20.0)
        with original_client(server.port, width=32, height=24) as client:
            assert client.get_frame()["main"].shape == (24, 32, 3)


@pytest.fixture
def gateway(blank_simulation: Simulation) -> Iterator[GatewayServer]:
    with unharmed(blank_simulation, LIMITS) as server:
        yield server


def connected(gateway: GatewayServer, hello: bytes = b"") -> socket.socket:
    peer = socket.create_connection(("127.0.0.1", gateway.port), 20.0)
    peer.sendall(hello)
    return peer


def hello(width: int = 32, height: int = 24) -> bytes:
    return struct.pack("<iiB", width, height, 0)


def is_disconnected(peer: socket.socket) -> bool:
    """Read on until the other side has closed; raises TimeoutError where it does not."""
    try:
        while peer.recv(2**16):
            pass
    except ConnectionError:
        pass
    return True


@pytest.mark.parametrize(
    "sent",
    [b"", b"\x20", hello()[:5], hello() + b"\x05\0\0", hello() + b"\x0c\x01\0\0\0a\xff\xff\0\0x"],
    ids=["nothing", "a byte", "half a registration", "half a vector", "half a file"],
)
@pytest.mark.parametrize("then", ["closes", "waits"])
def test_half_a_command(
    gateway: GatewayServer, sent: bytes, then: str, caplog: pytest.LogCaptureFixture
) -> None:
    """Whether the peer goes or lets us wait, the conversation is over soon."""
    with connected(gateway, sent) as peer:
        if then == "closes":
            peer.shutdown(socket.SHUT_WR)
        assert is_disconnected(peer)
    assert "neither answered" not in caplog.text
    if then == "waits":
        waited_for = "the rest of a command" if sent.startswith(hello()) else "the registration"
        assert waited_for in caplog.text


@pytest.mark.parametrize("length", [2**31 - 1, -(2**31), -1, 64 * 2**20 + 1])
def test_lengths_that_no_memory_holds(gateway: GatewayServer, length: int) -> None:
    """Names and files of two billion bytes are refused by their length alone."""
    for command in (b"\x02", b"\x0c\x01\0\0\0a", b"\x0e"):
        with connected(gateway, hello() + command + struct.pack("<i", length)) as peer:
            assert is_disconnected(peer)


@pytest.mark.parametrize("size", [(2**31 - 1, 2**31 - 1), (-5, 100), (0, 0), (5000, 5000)])
def test_pictures_of_impossible_size(gateway: GatewayServer, size: tuple[int, int]) -> None:
    """No agent is made, the peer is disconnected."""
    with connected(gateway, hello(*size)) as peer:
        assert is_disconnected(peer)


def test_pictures_of_all_peers_together_are_bounded(gateway: GatewayServer) -> None:
    """Who would exceed the limit is refused; who was there before stays."""
    with connected(gateway, hello(1024, 1024)) as first:
        assert first.recv(4)
        with connected(gateway, hello(1024, 1024)) as second:
            assert is_disconnected(second)
        with connected(gateway, hello(64, 48)) as third:
            assert third.recv(4)


def test_files_of_all_peers_together_are_bounded(gateway: GatewayServer) -> None:
    """Uploads that are never finished do not fill the memory."""
    with connected(gateway, hello()) as peer:
        peer.sendall(b"\x0c\x01\0\0\0a" + struct.pack("<i", 32 * 2**20))
        with pytest.raises(ConnectionError):  # noqa: PT012 the system may take some of it
            for _ in range(1024):
                peer.sendall(bytes(2**16))
            assert is_disconnected(peer)
            raise ConnectionResetError


def test_a_peer_that_stops_reading(gateway: GatewayServer) -> None:
    """It asks for frames and takes none: it is disconnected, and others are served meanwhile."""
    with connected(gateway) as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        peer.sendall(hello(1024, 1024) + b"\x00\x3d" * 500)
        with original_client(gateway.port, width=32, height=24) as client:
            for _ in range(5):
                assert client.get_frame()["depth"].shape == (24, 32)
        until(lambda: gateway.clients == 0, "it to be disconnected", 30.0)


def test_a_peer_that_takes_nothing_is_gone_before_its_answer_is_due(
    blank_simulation: Simulation, caplog: pytest.LogCaptureFixture
) -> None:
    """As one whose machine was switched off: the system finds out, long before `write_s`."""
    limits = GatewayLimits(silent_s=1.0)
    with (
        GatewayServer(blank_simulation, port=0, limits=limits) as gateway,
        connected(gateway) as peer,
    ):
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        peer.sendall(hello(1024, 1024) + b"\x00\x3d" * 500)
        until(lambda: clients_of(blank_simulation), "it to be registered")
        until(lambda: not gateway.clients, "it to be disconnected", 10.0)
        until(lambda: not clients_of(blank_simulation), "its agent to be gone")
    assert "neither answered nor took anything for 1 s" in caplog.text


def test_a_peer_that_vanishes_in_the_middle_of_a_frame(gateway: GatewayServer) -> None:
    """The connection is reset with most of the frame on its way."""
    for _ in range(5):
        with connected(gateway, hello(512, 512) + b"\x00\x3d") as peer:
            assert peer.recv(1000)
            peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def test_a_crowd(blank_simulation: Simulation, caplog: pytest.LogCaptureFixture) -> None:
    """Of 200 connections of one address few are kept, and others are served; the log is short."""
    patient = replace(LIMITS, hello_s=60.0)  # the first are still there when the last has come
    with unharmed(blank_simulation, patient) as gateway, ExitStack() as crowd:
        peers = [crowd.enter_context(connected(gateway)) for _ in range(CONNECTIONS)]
        until(lambda: gateway.clients == LIMITS.per_address, "the rest to be refused")
        with socket.create_connection(
            ("127.0.0.1", gateway.port), 20.0, source_address=("127.0.0.2", 0)
        ) as other:
            other.sendall(hello())
            assert other.recv(4)
        for peer in peers:
            try:
                peer.sendall(hello())
            except ConnectionError:
                continue
        until(
            lambda: 0 < len(clients_of(blank_simulation)) <= LIMITS.per_address, "some to register"
        )
        # The one of the other address counts until the gateway has read that it went.
        until(lambda: gateway.clients <= LIMITS.per_address, "the other to be seen to have gone")
    assert sum("refuses a connection" in message for message in caplog.messages) == 1


def test_random_bytes(gateway: GatewayServer) -> None:
    """A million of them, in pieces, from peers that have registered and from some that have not."""
    chance = random.Random(7)
    left = RANDOM_BYTES
    while left > 0:
        size = min(left, chance.choice((40, 1_000, 60_000)))
        left -= size
        with connected(gateway, hello() if chance.random() < 0.7 else b"") as peer:
            try:
                peer.sendall(chance.randbytes(size))
                peer.shutdown(socket.SHUT_WR)
            except ConnectionError:
                continue
            assert is_disconnected(peer)
