"""Thin ROS 2 nodes: they translate between topics or services and the simulation, no more."""

from sailenv_ros.errors import InvalidState, StorageError
from sailenv_ros.system.memory import require_address_space, share_freed_memory
from sailenv_ros.system.transport import require_shared_memory

ADDRESS_SPACE_BYTES = 1400 * 2**20
"""Addresses that a node's libraries, threads and segments of shared memory take [B]."""

try:
    require_address_space(ADDRESS_SPACE_BYTES)
    require_shared_memory()
except (InvalidState, StorageError) as _problem:
    # A node's module is run as a program, which has this one chance to say why it does not start.
    raise SystemExit(f"sailenv_ros: {_problem}") from None

share_freed_memory()  # before rclpy, whose threads would have heaps of their own
