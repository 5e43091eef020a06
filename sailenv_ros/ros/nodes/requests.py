"""Operations of a simulation as services of a node, which never hold up the executor.

The simulation answers by futures of its own thread; here they are awaited on rclpy's executor.
`answered` is the one place where an error becomes a refusal in a service's response.
"""

from __future__ import annotations

import logging
from collections.abc import Awaitable, Callable, Coroutine, Iterable
from concurrent.futures import Future
from typing import Any, ParamSpec, TypeVar

from rclpy.callback_groups import CallbackGroup
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.service import Service as RosService
from rclpy.task import Future as RosFuture

from sailenv_msgs_py.error_codes import error_to_response
from sailenv_msgs_py.services import Service
from sailenv_ros.errors import InternalFault, SailenvError
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["OperationRunner", "answered", "offer_services"]

_log = logging.getLogger(__name__)

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")


class OperationRunner:
    """Runs operations of one simulation for handlers in one executor."""

    def __init__(self, simulation: Simulation, executor: Executor) -> None:
        self._simulation = simulation
        self._executor = executor

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""
        return self._simulation.info

    def submit(self, operation: Operation[P, R], /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Queue an operation now; the order of these calls is the order of execution."""
        return operation.submit_to(self._simulation, *args, **kwargs)

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
    tell: Callable[[SailenvError, Any], None] = error_to_response,
) -> Callable[[Any, Any], Coroutine[Any, Any, Any]]:
    """Make a service callback of a handler that fills a response or raises.

    Whatever the handler raises ends here: the response then holds nothing but the error, as
    ``tell(error, response)`` writes it.
    """

    async def callback(request: Any, response: Any) -> Any:
        try:
            await handler(request, response)
            return response
        except SailenvError as error:
            refusal = error
        except Exception as error:
            _log.exception("a service failed because of an internal error in the simulator")
            refusal = InternalFault.of(error)
        # A fresh response: what the handler filled in before it failed is not told.
        response = type(response)()
        tell(refusal, response)
        return response

    return callback


def offer_services(
    node: Node,
    runner: OperationRunner,
    services: Iterable[Service],
    *,
    group: CallbackGroup,
    agent: str = "",
    before_request: Callable[[], Awaitable[None]] | None = None,
    before_response: Callable[[], None] = lambda: None,
) -> list[RosService]:
    """Serve operations.

    Parameters
    ----------
    node : Node
    runner : OperationRunner
    services : iterable of Service
    group : CallbackGroup
        It must let calls overlap: handlers await, and in a mutually exclusive group one that waits
        would hold up all others.
    agent : str
        The agent whose services they are; empty for those of the simulator.
    before_request : callable or None
        Awaited before an operation is queued.
    before_response : callable
        Called in the executor's thread when an operation was done, before it is answered.
    """

    def handler(service: Service) -> Callable[[Any, Any], Awaitable[None]]:
        async def handle(request: Any, response: Any) -> None:
            args, kwargs = service.arguments(request)
            if before_request is not None:
                await before_request()
            if agent:
                kwargs["agent"] = agent
            result = await runner.settled(runner.submit(service.operation, *args, **kwargs))
            before_response()
            service.respond(response, result, runner.info)

        return handle

    prefix = f"{agent}/" if agent else ""
    return [
        node.create_service(
            service.type,
            f"{prefix}{service.name}",
            answered(handler(service)),
            callback_group=group,
        )
        for service in services
    ]
