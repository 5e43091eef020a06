"""Thin ROS 2 nodes: they translate between topics or services and the simulation, no more."""

from sailenv_ros.errors import StorageError
from sailenv_ros.system.transport import require_shared_memory

try:
    require_shared_memory()
except StorageError as _problem:
    # A node's module is run as a program, which has this one chance to say why it does not start.
    raise SystemExit(f"sailenv_ros: {_problem}") from None
