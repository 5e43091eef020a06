"""Limits of connections: in all, of one address, and of the process's descriptors."""

from __future__ import annotations

import logging
import socket
from collections.abc import Iterator

import pytest

from sailenv_ros.system import connection_gate
from sailenv_ros.system.connection_gate import ConnectionGate, RareWarning, address_of


@pytest.fixture
def new() -> Iterator[socket.socket]:
    """The server's end of a connection."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        with socket.create_connection(server.getsockname()):
            accepted, _ = server.accept()
        with accepted:
            yield accepted


@pytest.mark.parametrize(
    ("others", "reason"),
    [
        (["10.0.0.1"] * 3 + ["127.0.0.1"], ""),
        (["10.0.0.1"] * 5, "5 are open, which is the most"),
        (["127.0.0.1"] * 2, "127.0.0.1 has 2, which is the most for one address"),
    ],
)
def test_connections_are_limited_in_all_and_by_address(
    new: socket.socket, others: list[str], reason: str, caplog: pytest.LogCaptureFixture
) -> None:
    gate = ConnectionGate("gateway", connections=5, per_address=2)
    assert gate.admits(new, others) is not bool(reason)
    assert caplog.messages == ([f"the gateway refuses a connection: {reason}"] if reason else [])


def test_descriptors_are_left_to_the_rest_of_the_process(
    new: socket.socket, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    few = new.fileno() + connection_gate.RESERVED_DESCRIPTORS
    for limit in (few, few + 1):
        monkeypatch.setattr(connection_gate.resource, "getrlimit", lambda _, n=limit: (n, n))
        assert ConnectionGate("viewer", 5, 5).admits(new, []) is (limit > few)
    assert f"this process may have {few} descriptors" in caplog.text


def test_a_storm_makes_a_line_a_minute(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """The first at once; what came after it is counted in the next line."""
    now = 1000.0
    monkeypatch.setattr(connection_gate.time, "monotonic", lambda: now)
    warning = RareWarning(logging.getLogger("storm"))
    for _ in range(5):
        warning.warn("refused")
    now += connection_gate.INTERVAL_S
    warning.warn("refused")
    assert caplog.messages == ["refused", "refused (4 more like it since the last such line)"]


def test_addresses_are_without_ports() -> None:
    assert address_of(("10.0.0.1", 80)) == "10.0.0.1"
    assert address_of(("::1", 80, 0, 0)) == "::1"
    assert address_of("") == ""
