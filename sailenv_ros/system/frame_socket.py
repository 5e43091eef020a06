"""A Unix socket over which processes of one user on one machine hand over frames.

It lies in the folder that nobody else can write to, beside the simulator's lock. Packets are a
header of JSON, raw parts, and descriptors. Knows nothing of ROS or of frames.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import socket
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.process_locks import open_private_folder

__all__ = [
    "DIRECT_FRAMES",
    "connect",
    "is_wanted",
    "listen",
    "peer_is_same_user",
    "receive",
    "send",
]

DIRECT_FRAMES = "SAILENV_DIRECT_FRAMES"
"""The variable that turns this off with the value 0: frames then come by topics alone."""

_MAX_PACKET = 160 * 1024
_MAX_DESCRIPTORS = 4


def is_wanted() -> bool:
    """Return whether frames may be handed over beside ROS.

    Not where SROS 2 is set up: whom its keys keep out shall not come in here.
    """
    secured = os.environ.get("ROS_SECURITY_ENABLE", "").lower() == "true"
    return not secured and os.environ.get(DIRECT_FRAMES, "1") != "0"


def listen(domain_id: int, namespace: str) -> tuple[socket.socket, Path]:
    """Listen for a simulator, which holds the lock of its name.

    Raises
    ------
    OSError, InvalidRequest
        If it cannot be opened.
    """
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        with open_private_folder() as folder:
            path = folder / _file(domain_id, namespace)
            with contextlib.suppress(FileNotFoundError):
                path.unlink()  # of a simulator that was killed
            listener.bind(str(path))
        listener.listen(32)
    except BaseException:
        listener.close()
        raise
    return listener, path


def connect(domain_id: int, namespace: str) -> socket.socket | None:
    """Connect to a simulator; None if there is none on this machine."""
    sock = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    try:
        with open_private_folder() as folder:
            sock.connect(str(folder / _file(domain_id, namespace)))
    except (OSError, InvalidRequest):
        sock.close()
        return None
    return sock


def peer_is_same_user(sock: socket.socket) -> bool:
    """Return whether the process at the other end is of this user."""
    credentials = sock.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i"))
    _, user, _ = struct.unpack("3i", credentials)
    return bool(user == os.getuid())


def send(
    sock: socket.socket,
    header: dict[str, Any],
    parts: Sequence[bytes] = (),
    descriptors: Sequence[int] = (),
) -> None:
    """Send one packet.

    Raises
    ------
    OSError
        If the other end is gone, or the packet is too long.
    """
    text = json.dumps({**header, "parts": [len(part) for part in parts]}).encode()
    packet = [struct.pack("<I", len(text)), text, *parts]
    if descriptors:
        socket.send_fds(sock, packet, descriptors)
    else:
        sock.sendmsg(packet)


def receive(sock: socket.socket) -> tuple[dict[str, Any], list[bytes], list[int]] | None:
    """Wait for a packet; None at the end of the connection. The descriptors are the caller's.

    Raises
    ------
    OSError
        If the connection broke.
    InvalidRequest
        If it is no packet of this kind.
    """
    packet, descriptors, flags, _ = socket.recv_fds(sock, _MAX_PACKET, _MAX_DESCRIPTORS)
    if not packet and not descriptors:
        return None
    try:
        if flags & (socket.MSG_TRUNC | socket.MSG_CTRUNC):
            raise ValueError("it was cut off")
        (size,) = struct.unpack_from("<I", packet)
        header = json.loads(packet[4 : 4 + size])
        parts, begin = [], 4 + size
        for length in header["parts"]:
            parts.append(packet[begin : begin + length])
            begin += length
        if begin != len(packet) or any(length < 0 for length in header["parts"]):
            raise ValueError("its parts do not fit its length")
    except (ValueError, TypeError, KeyError, struct.error, RecursionError) as problem:
        for fd in descriptors:
            os.close(fd)
        raise InvalidRequest("packet", f"{len(packet)} bytes", f"a whole one ({problem})") from None
    return header, parts, descriptors


def _file(domain_id: int, namespace: str) -> str:
    # A socket's path may have 107 bytes.
    name = hashlib.sha256(namespace.encode()).hexdigest()[:12]
    return f"frames_{domain_id}_{name}"
