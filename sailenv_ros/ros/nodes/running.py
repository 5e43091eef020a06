"""Runs a node that has no simulation, from its start to its exit status.

The node's own part is a function that returns when it shall end. Exit status: what that function
gives; 1 after an error, 2 where an argument or a parameter is wrong or the work cannot be done.
"""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Sequence

from rclpy.context import Context
from rclpy.logging import get_logger
from rclpy.node import Node

from sailenv_ros.errors import InvalidRequest, SailenvError
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.log_bridge import LogBridge
from sailenv_ros.system.memory import keep_freed_memory, no_memory
from sailenv_ros.system.transport import use_shared_memory_profile

__all__ = ["run_node"]

NAMESPACE = "/sailenv"

_log = logging.getLogger(__name__)


def run_node(
    name: str, work: Callable[[Node, StopRequest], int], argv: Sequence[str] | None = None
) -> int:
    """Make a node of that name and have it work until it is asked to end.

    Parameters
    ----------
    name : str
    work : callable
        Takes the node and the request to end, gives the exit status.
    argv : sequence of str or None
        Arguments; None means those of the process.

    Returns
    -------
    status : int
    """
    stop = StopRequest()
    stop.install()
    logger = get_logger(name)
    bridge = LogBridge(logger)
    context = Context()
    try:
        node = _make_node(name, context, list(sys.argv if argv is None else argv))
        try:
            return work(node, stop)
        finally:
            node.destroy_node()
    except SailenvError as error:
        logger.fatal(str(error))
        return 2
    except MemoryError:
        logger.fatal(no_memory())
        return 2
    except Exception:
        _log.exception("the node ends because of an internal error")
        return 1
    finally:
        stop.disarm()
        bridge.close()
        context.try_shutdown()


def _make_node(name: str, context: Context, arguments: list[str]) -> Node:
    keep_freed_memory()
    use_shared_memory_profile()
    try:
        context.init(arguments)
        return Node(name, namespace=NAMESPACE, context=context)
    except Exception as problem:
        told = "; ".join(line.strip() for line in str(problem).splitlines() if line.strip())
        accepted = f"what ROS accepts ({told})"
        raise InvalidRequest("arguments", " ".join(arguments[1:]), accepted) from None
