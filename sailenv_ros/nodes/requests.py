"""How a service handler asks the simulation without ever holding up the executor.

The simulation answers by futures of its own thread; here they are awaited on rclpy's executor.
`answered` is the one place where an error becomes a refusal in a service's response.
"""

from __future__ import annotations

import logging
from collections.abc import Awaitable, Callable, Coroutine
from concurrent.futures import Future
from typing import Any, Protocol, TypeAlias, TypeVar

from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.service import Service
from rclpy.task import Future as RosFuture

from sailenv_ros.errors import SailenvError
from sailenv_ros.scene_info import SceneInfo
from sailenv_ros.simulation import Simulation

__all__ = ["Requests", "ServiceTable", "answered", "offer"]

_log = logging.getLogger(__name__)

T = TypeVar("T")

ServiceTable: TypeAlias = tuple[tuple[str, type, Callable[[Any, Any], Awaitable[None]]], ...]
"""Name, type and handler of each service."""


class _Response(Protocol):
    success: bool
    message: str


class Requests:
    """Asks one simulation on behalf of handlers that run in one executor."""

    def __init__(self, simulation: Simulation, executor: Executor) -> None:
        self._simulation = simulation
        self._executor = executor

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        return self._simulation.info

    async def __call__(self, name: str, /, *args: Any, **kwargs: Any) -> Any:
        """Ask for something by its name and await the result; raises what the request raised."""
        return await self.settled(self.begin(name, *args, **kwargs))

    def begin(self, name: str, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Queue a request now; the order of these calls is the order of execution."""
        return self._simulation.request(name, *args, **kwargs)

    async def settled(self, future: Future[T]) -> T:
        """Await a future of another thread."""
        waiting: RosFuture = RosFuture()

        def wake(_: Future[T]) -> None:
            waiting.set_result(None)
            self._executor.wake()

        future.add_done_callback(wake)
        await waiting
        return future.result()


def answered(
    handler: Callable[[Any, Any], Awaitable[None]],
) -> Callable[[Any, Any], Coroutine[Any, Any, Any]]:
    """Make a service callback of a handler that fills a response or raises.

    Whatever the handler raises ends here: the response then holds nothing but the error's own
    sentence.
    """

    async def callback(request: Any, response: Any) -> Any:
        try:
            await handler(request, response)
            response.success = True
            return response
        except SailenvError as error:
            return _refusal(type(response)(), str(error))
        except Exception as error:
            _log.exception("a service failed because of a fault in the simulator")
            what = f"{type(error).__name__}: {error}"
            return _refusal(type(response)(), f"a fault in the simulator, see its log: {what}")

    return callback


def offer(
    node: Node, table: ServiceTable, *, group: CallbackGroup | None = None, prefix: str = ""
) -> list[Service]:
    """Serve what a table lists, each service by its handler as `answered` wraps it.

    Parameters
    ----------
    node : Node
    table : ServiceTable
    group : CallbackGroup or None
        None makes one. It must let calls overlap: handlers await, and in a mutually exclusive group
        one that waits would hold up all others.
    prefix : str
        Put before each name.
    """
    group = group or ReentrantCallbackGroup()
    return [
        node.create_service(kind, f"{prefix}{name}", answered(handler), callback_group=group)
        for name, kind, handler in table
    ]


def _refusal(response: _Response, text: str) -> _Response:
    response.success = False
    # Some errors list several faults, each on a line of its own.
    response.message = "; ".join(line.strip() for line in text.splitlines() if line.strip())
    return response
