"""The socket for frames on one machine: whole packets, and nobody who should not come in."""

from __future__ import annotations

import json
import os
import socket
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.frame_socket import (
    connect,
    is_wanted,
    listen,
    peer_is_same_user,
    receive,
    send,
)


@pytest.fixture
def ends() -> Iterator[tuple[socket.socket, socket.socket]]:
    """Both ends of a connection."""
    pair = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    yield pair
    for end in pair:
        end.close()


def test_packets_come_whole(ends: tuple[socket.socket, socket.socket]) -> None:
    """Header, parts and descriptors as they were sent; then the end of the connection."""
    read_end, write_end = os.pipe()
    send(ends[0], {"views": ["rgb"]}, [b"", b"abc"], [write_end])
    os.close(write_end)
    received = receive(ends[1])
    assert received is not None
    header, parts, descriptors = received
    assert (header["views"], parts) == (["rgb"], [b"", b"abc"])
    os.write(descriptors[0], b"same pipe")
    os.close(descriptors[0])
    assert os.read(read_end, 20) == b"same pipe"
    os.close(read_end)
    ends[0].close()
    assert receive(ends[1]) is None


@pytest.mark.parametrize(
    "packet",
    [
        b"x",
        struct.pack("<I", 99) + b"{}",
        struct.pack("<I", 2) + b"[]",
        struct.pack("<I", 2) + b"{}",
        struct.pack("<I", 13) + json.dumps({"parts": [7]}).encode() + b"short",
        struct.pack("<I", 16) + json.dumps({"parts": [9, -9]}).encode(),
        struct.pack("<I", 60_000) + b"[" * 60_000,
        bytes(170_000),
    ],
)
def test_what_is_no_packet_is_refused(
    ends: tuple[socket.socket, socket.socket], packet: bytes
) -> None:
    """In words, whatever was sent."""
    ends[0].send(packet)
    with pytest.raises(InvalidRequest, match="a whole one"):
        receive(ends[1])


def test_the_door_is_found_by_its_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """In the private folder, also after one that was left behind; none where nobody listens."""
    tmp_path.chmod(0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert connect(7, "/here") is None
    listen(7, "/here")[0].close()  # leaves its file, as a process does that is killed
    assert connect(7, "/here") is None
    listener, path = listen(7, "/here")
    assert path.parent.parent == tmp_path
    sock = connect(7, "/here")
    assert sock is not None
    assert peer_is_same_user(sock)
    assert connect(7, "/there") is None
    assert connect(8, "/here") is None
    sock.close()
    listener.close()


@pytest.mark.parametrize(
    ("name", "value", "wanted"),
    [
        ("SAILENV_DIRECT_FRAMES", "0", False),
        ("SAILENV_DIRECT_FRAMES", "1", True),
        ("ROS_SECURITY_ENABLE", "true", False),
    ],
)
def test_the_door_can_be_closed(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str, wanted: bool
) -> None:
    """By its variable, and wherever SROS 2 says who may come in."""
    monkeypatch.setenv(name, value)
    assert is_wanted() is wanted
