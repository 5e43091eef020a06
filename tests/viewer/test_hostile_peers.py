"""Connections to the web viewer that are not those of a browser."""

from __future__ import annotations

import logging
import socket
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer
from sailenv_ros.viewer.viewer_limits import ViewerLimits
from tests.support.waiting import until

LIMITS = ViewerLimits(connections=40, per_address=30, header_s=1.0)
STORM = 300


@pytest.fixture
def short(simulation: Simulation) -> Iterator[ViewerServer]:
    """A viewer with limits that a test can wait for."""
    with ViewerServer(simulation, port=0, limits=LIMITS) as server:
        yield server


def is_open(peer: socket.socket) -> bool:
    """Return whether the other side has not closed yet."""
    peer.setblocking(False)
    try:
        return bool(peer.recv(2**16))
    except BlockingIOError:
        return True
    except ConnectionError:
        return False


@pytest.mark.parametrize(
    "begun", [b"", b"G", b"GET / HTTP/1.1\r\nHost: loc", b"GET / HTTP/1.1\r\nHost: localhost\r\n"]
)
def test_who_sends_no_whole_request_is_disconnected(short: ViewerServer, begun: bytes) -> None:
    """Whether it says nothing, a byte, or all but the last line of a header."""
    with socket.create_connection((short.host, short.port)) as peer:
        peer.sendall(begun)
        until(lambda: not is_open(peer), "it to be disconnected", 10.0)


def test_a_storm_of_half_requests_keeps_nobody_out(
    short: ViewerServer, caplog: pytest.LogCaptureFixture
) -> None:
    """Of one address few are kept; others are served; the log has a line for all of them."""
    caplog.set_level(logging.WARNING)
    with ExitStack() as crowd:
        peers = []
        for _ in range(STORM):
            peer = crowd.enter_context(socket.create_connection((short.host, short.port)))
            peer.sendall(b"G")
            peers.append(peer)
        until(
            lambda: sum(is_open(peer) for peer in peers) <= LIMITS.per_address,
            "most of them to be refused",
        )
        page = urllib.request.Request(f"http://{short.host}:{short.port}/", method="GET")
        with socket.create_connection(
            (short.host, short.port), source_address=("127.0.0.2", 0)
        ) as other:
            other.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            assert b"200 OK" in other.recv(2**16)
        until(lambda: not any(map(is_open, peers)), "all to be disconnected", 10.0)
    with urllib.request.urlopen(page, timeout=10.0) as answer:
        assert answer.status == 200
    assert len(caplog.messages) == 1
    assert "127.0.0.1 has 30, which is the most for one address" in caplog.text
