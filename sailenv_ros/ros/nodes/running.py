"""Runs a node that has no simulation, from its start to its exit status.

The node's own part is a function that returns when it shall end. Exit status: what that function
gives; 1 after an error, 2 where an argument or a parameter is wrong or the work cannot be done, 3
where another simulator has the namespace already.
"""

from __future__ import annotations

import contextlib
import logging
import sys
from collections.abc import Callable, Iterator, Sequence

from rclpy.context import Context
from rclpy.logging import get_logger
from rclpy.node import Node

from sailenv_ros.errors import InvalidRequest, NameTaken, SailenvError
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.log_bridge import LogBridge
from sailenv_ros.ros.nodes.parameter_table import NAMESPACE
from sailenv_ros.system.memory import keep_freed_memory, no_memory
from sailenv_ros.system.transport import use_shared_memory_profile

__all__ = ["exit_status", "refusing", "run_node"]

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
    context = Context()

    def run() -> int:
        keep_freed_memory()
        use_shared_memory_profile()
        arguments = list(sys.argv if argv is None else argv)
        with refusing(arguments):
            context.init(arguments)
            node = Node(name, namespace=NAMESPACE, context=context)
        try:
            return work(node, stop)
        finally:
            node.destroy_node()

    try:
        return exit_status(name, run)
    finally:
        stop.disarm()
        context.try_shutdown()


def exit_status(name: str, run: Callable[[], int]) -> int:
    """Do the work of the node `name`, its log bridged; return its exit status."""
    logger = get_logger(name)
    bridge = LogBridge(logger)
    try:
        return run()
    except NameTaken as error:
        logger.fatal(_one_line(error))
        return 3
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
        bridge.close()


@contextlib.contextmanager
def refusing(arguments: list[str]) -> Iterator[None]:
    """Blame the arguments for what ROS raises while it is given them.

    Raises
    ------
    InvalidRequest
    """
    try:
        yield
    except SailenvError:
        raise
    except Exception as problem:
        accepted = f"what ROS accepts ({_one_line(problem)})"
        raise InvalidRequest("arguments", " ".join(arguments[1:]), accepted) from None


def _one_line(problem: Exception) -> str:
    """Return what an error says, on one line."""
    return "; ".join(line.strip() for line in str(problem).splitlines() if line.strip())
