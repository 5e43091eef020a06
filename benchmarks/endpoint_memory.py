"""Bytes that stay of each topic's or service's end that comes and goes, by rclpy alone.

    python benchmarks/endpoint_memory.py [--count N]

Makes and destroys ends in one node, each kind with and without a counterpart in it, and prints how
many bytes more are in use for each (mallinfo2 of glibc), and how many more objects of Python.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import sys
from collections.abc import Callable

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from std_msgs.msg import Empty
from std_srvs.srv import Trigger

FIRST = 500
"""Ends before the first measurement: pools and caches fill."""


class _InUse(ctypes.Structure):
    """The answer of mallinfo2."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            *("arena", "ordblks", "smblks", "hblks", "hblkhd"),
            *("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost"),
        )
    ]


def main() -> int:
    """Measure all kinds; 0."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=4000)
    count = parser.parse_args().count
    rclpy.init()
    for matched in (True, False):
        for name, one in (("publisher", _publisher), ("service", _service)):
            # Pools of a node that was there before would hide what the next one takes.
            node = rclpy.create_node(f"{name}_{matched}".lower(), enable_rosout=False)
            if matched:
                node.create_subscription(Empty, "topic", lambda _: None, 1)
                node.create_client(Trigger, "service")
            _repeat(one, node, FIRST)
            before, objects = _in_use(), sys.getallocatedblocks()
            _repeat(one, node, count)
            each = (_in_use() - before) / count
            more = (sys.getallocatedblocks() - objects) / count
            kind = f"{name}, {'matched' if matched else 'alone'}"
            print(f"{kind:20} {each:8.1f} bytes, {more:+.3f} objects of Python", flush=True)
            node.destroy_node()
    rclpy.shutdown()
    return 0


def _publisher(node: Node) -> None:
    # A group of its own: those of rclpy refer to all that they ever had.
    made = node.create_publisher(
        Empty,
        "topic",
        1,
        callback_group=MutuallyExclusiveCallbackGroup(),
        event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
    )
    node.destroy_publisher(made)


def _service(node: Node) -> None:
    group = MutuallyExclusiveCallbackGroup()
    made = node.create_service(Trigger, "service", lambda _, reply: reply, callback_group=group)
    node.destroy_service(made)


def _repeat(one: Callable[[Node], None], node: Node, count: int) -> None:
    for _ in range(count):
        one(node)


def _in_use() -> int:
    gc.collect()
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = _InUse
    info = libc.mallinfo2()
    return int(info.uordblks + info.hblkhd)


if __name__ == "__main__":
    sys.exit(main())
