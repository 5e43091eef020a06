"""The services of one agent: `/<namespace>/<agent>/…`.

All but `capture` and `capture_rig` are operations as they are; the images of a captured frame go to
its topics.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node

from sailenv_msgs.srv import Capture, CaptureRig
from sailenv_msgs_py.services import AGENT_SERVICES, SERVICES
from sailenv_ros.errors import SimulationClosed
from sailenv_ros.frame.frame import Frame
from sailenv_ros.ros.nodes.publishers import AgentPublisher
from sailenv_ros.ros.nodes.requests import OperationRunner, answered, offer_services
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.views import checked_views

__all__ = ["AgentServices"]

AWAIT_SUBSCRIBERS_S = 0.5
"""Time that a capture waits for subscribers of its views that are just being matched [s]."""

_CAPTURE = SERVICES[Operations.capture.name]
_CAPTURE_RIG = SERVICES[Operations.capture_rig.name]


class AgentServices:
    """Serves one agent.

    Parameters
    ----------
    node : Node
    runner : OperationRunner
    publisher : AgentPublisher
        Where captured frames go.
    spec : AgentSpec
    publisher_of : callable
        Returns the publisher of another agent, a camera of this one; None if it has none yet.
    """

    def __init__(
        self,
        node: Node,
        runner: OperationRunner,
        publisher: AgentPublisher,
        spec: AgentSpec,
        publisher_of: Callable[[str], AgentPublisher | None],
    ) -> None:
        self._publisher_of = publisher_of
        self._node = node
        self._runner = runner
        self._publisher = publisher
        self._spec = spec
        # Waits and publishes, so that the executor does neither; one thread keeps their order.
        self._worker = ThreadPoolExecutor(1, thread_name_prefix=f"{spec.name}-capture")
        group = ReentrantCallbackGroup()
        own = {_CAPTURE: self._capture, _CAPTURE_RIG: self._capture_rig}
        plain = [service for service in AGENT_SERVICES if service not in own]
        self._services = offer_services(node, runner, plain, group=group, agent=spec.name)
        for service, handler in own.items():
            name = f"{spec.name}/{service.name}"
            self._services.append(
                node.create_service(service.type, name, answered(handler), callback_group=group)
            )

    def close(self) -> None:
        """Remove the services; called in the executor's thread, or after it has ended."""
        for service in self._services:
            self._node.destroy_service(service)
        self._services.clear()
        self._worker.shutdown(wait=False, cancel_futures=True)

    async def _capture(self, request: Capture.Request, response: Capture.Response) -> None:
        views = checked_views(request.views) if request.views else self._spec.views
        if not self._publisher.subscribed(views):
            await self._runner.settled(
                self._submit(self._publisher.await_subscribed, views, AWAIT_SUBSCRIBERS_S)
            )
        # Queued at once: what was asked before is in the picture, what comes later is not.
        rendering = self._runner.submit(Operations.capture, views, agent=self._spec.name)
        frame, published = await self._runner.settled(self._submit(self._publish, rendering))
        _CAPTURE.respond(response, frame, self._runner.info)
        response.views_published = list(published)

    async def _capture_rig(
        self, request: CaptureRig.Request, response: CaptureRig.Response
    ) -> None:
        views = checked_views(request.views) if request.views else None
        wanted = [
            (publisher, views or spec.views)
            for spec in self._runner.info.agents
            if spec.body == self._spec.name
            if (publisher := self._publisher_of(spec.name)) is not None
        ]
        if not all(publisher.subscribed(those) for publisher, those in wanted):
            await self._runner.settled(self._submit(_await_subscribed, wanted))
        rendering = self._runner.submit(Operations.capture_rig, views, agent=self._spec.name)
        frames = await self._runner.settled(self._submit(self._publish_rig, rendering))
        _CAPTURE_RIG.respond(response, frames, self._runner.info)

    def _publish_rig(self, rendering: Future[dict[str, Frame]]) -> dict[str, Frame]:
        frames = rendering.result()
        for frame in frames.values():
            publisher = self._publisher_of(frame.agent)
            if publisher is not None:
                publisher.publish(frame)
        return frames

    def _publish(self, rendering: Future[Frame]) -> tuple[Frame, tuple[str, ...]]:
        frame = rendering.result()
        return frame, self._publisher.publish(frame)

    def _submit(self, work: Callable[..., Any], *args: Any) -> Future[Any]:
        try:
            return self._worker.submit(work, *args)
        except RuntimeError:
            raise SimulationClosed(f"agent {self._spec.name!r} was deleted") from None


def _await_subscribed(wanted: Iterable[tuple[AgentPublisher, tuple[str, ...]]]) -> None:
    """Wait a little until somebody subscribes to the views of several agents."""
    deadline = time.monotonic() + AWAIT_SUBSCRIBERS_S
    for publisher, views in wanted:
        publisher.await_subscribed(views, max(0.0, deadline - time.monotonic()))
