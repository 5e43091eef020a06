"""A ROS participant of a test's own: calls services, keeps what arrives on topics."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from rcl_interfaces.srv import GetParameterTypes
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CameraInfo, Image

from sailenv_msgs.msg import AgentInfo, FrameInfo
from sailenv_msgs.srv import Capture, DeleteAgent, RegisterAgent
from sailenv_msgs_py.images import view_from_image
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.ros.executor_thread import ExecutorThread
from tests.support.waiting import until

RELIABLE = QoSProfile(depth=100, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)
BEST_EFFORT = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)

ASKED_AGAIN_S = 0.2
"""After which a question that may not have been heard is asked once more [s]."""

ANSWER_S = 30.0
"""That an answer may take [s]."""


class Topic:
    """Messages that arrived on one topic, in order."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.messages: list[Any] = []

    @property
    def last(self) -> Any:
        return self.messages[-1]

    def stamps(self) -> list[int]:
        return [ns_from_stamp(message.header.stamp) for message in self.messages]


class Probe:
    """A node below a namespace, spun in a thread; a context manager."""

    def __init__(self, namespace: str) -> None:
        self.namespace = namespace
        self._context = Context()
        self._context.init([])
        self.node = Node("probe", namespace=namespace, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._clients: dict[str, Any] = {}
        self._subscriptions: list[Any] = []
        self._spinning = ExecutorThread(self._executor, "probe")
        self._spinning.start()

    def close(self) -> None:
        self._spinning.stop(5.0)
        self._context.try_shutdown()
        self._executor.shutdown(0.0)
        self.node.destroy_node()

    def __enter__(self) -> Probe:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def begin(self, kind: Any, service: str, request: Any = None) -> Any:
        """Call a service; return rclpy's future of the answer."""
        self.discover({service: kind})
        client = self._clients[service]
        until(client.service_is_ready, f"the service {service}")
        return client.call_async(kind.Request() if request is None else request)

    def discover(self, services: Mapping[str, Any]) -> None:
        """Become known to services, by name with their types; those called before are known."""
        new = {name: kind for name, kind in services.items() if name not in self._clients}
        for name, kind in new.items():
            self._clients[name] = self.node.create_client(kind, name)
        for name in new:
            until(self._clients[name].service_is_ready, f"the service {name}")
        if new:
            self._become_known({self._clients[name].service_name for name in new})

    def _become_known(self, services: set[str]) -> None:
        """Return when the servers know the clients that were made so far.

        Fast DDS drops an answer to a reader that its server does not know yet, and nothing tells
        when it does. But a participant hears of readers in the order in which they were made: one
        that answers a newer client knows the older ones. Harmless questions are asked until then.
        """
        until(lambda: self._servers(services), f"nodes with {services}")
        for server in self._servers(services):
            client = self.node.create_client(GetParameterTypes, f"{server}/get_parameter_types")
            answered = threading.Event()

            def asked(client: Any = client, answered: threading.Event = answered) -> bool:
                if client.service_is_ready():
                    future = client.call_async(GetParameterTypes.Request())
                    future.add_done_callback(lambda _: answered.set())
                return answered.wait(ASKED_AGAIN_S)

            until(asked, f"an answer of {server}")
            self.node.destroy_client(client)

    def _servers(self, services: set[str]) -> set[str]:
        """Return the nodes that have services and can be asked; else those beside them."""
        found: dict[str, set[str]] = {}
        for name, namespace in self.node.get_node_names_and_namespaces():
            # One that has just gone has none.
            with suppress(NodeNameNonExistentError):
                node = f"{namespace.rstrip('/')}/{name}"
                offered = self.node.get_service_names_and_types_by_node(name, namespace)
                found[node] = {service for service, _ in offered}
        asked = {
            node: offers
            for node, offers in found.items()
            if f"{node}/get_parameter_types" in offers
        }
        return {node for node, offers in asked.items() if offers & services} or {
            node for node in asked if node.startswith(self.namespace)
        } - {self.node.get_fully_qualified_name()}

    def call(self, kind: Any, service: str, request: Any = None) -> Any:
        """Call a service and return its answer."""
        future = self.begin(kind, service, request)
        answered = threading.Event()
        future.add_done_callback(lambda _: answered.set())
        assert answered.wait(ANSWER_S), f"{service} did not answer in {ANSWER_S:g} s"
        return future.result()

    def done(self, kind: Any, service: str, request: Any = None) -> Any:
        """Call a service that has to succeed."""
        answer = self.call(kind, service, request)
        assert answer.success, answer.message
        return answer

    def ask(self, send: Callable[[], Any], what: str, timeout_s: float = 20.0) -> Any:
        """Send a request of an action by its client's method; return the answer.

        In the executor's thread: rclpy notes the request's number after sending it, and an answer
        that another thread takes before is dropped ("unexpected goal response").
        """
        sending = self._executor.create_task(send)
        until(sending.done, f"{what} to be sent", timeout_s)
        answering = sending.result()
        until(answering.done, what, timeout_s)
        return answering.result()

    def listen(self, kind: Any, topic: str, qos: QoSProfile = RELIABLE) -> Topic:
        """Keep what arrives on a topic from now on."""
        heard = Topic(topic)
        self._subscriptions.append(
            self.node.create_subscription(kind, topic, heard.messages.append, qos)
        )
        return heard

    def listen_no_more(self) -> None:
        """Return up every topic."""
        while self._subscriptions:
            self.node.destroy_subscription(self._subscriptions.pop())


class Eye:
    """An agent on request of a test's own: registers itself, gives its frames as arrays."""

    def __init__(
        self, probe: Probe, seen: Iterable[str], /, *, name: str = "eye", **fields: Any
    ) -> None:
        self._probe = probe
        self.name = name
        self.views = tuple(seen)
        wanted = AgentInfo(
            **{
                "name": name,
                "width": 160,
                "height": 120,
                "rate_hz": 0.0,
                "following": False,
                **fields,
            }
        )
        probe.done(RegisterAgent, "register_agent", RegisterAgent.Request(agent=wanted))
        self.frame_info = probe.listen(FrameInfo, f"{name}/frame_info")
        self.camera_info = probe.listen(CameraInfo, f"{name}/camera_info")
        self.images = {view: probe.listen(Image, f"{name}/{view}") for view in self.views}

    def capture(self) -> dict[str, np.ndarray[Any, Any]]:
        """Capture the views and wait until all that belongs to the frame is there."""
        topics = (self.frame_info, self.camera_info, *self.images.values())
        for topic in topics:
            topic.messages.clear()
        request = Capture.Request(views=list(self.views))
        answer = self._probe.done(Capture, f"{self.name}/capture", request)
        assert set(answer.views_published) == set(self.views)
        until(lambda: all(topic.messages for topic in topics), "the frame captured")
        assert self.frame_info.last.sequence == answer.sequence
        assert {stamp for topic in topics for stamp in topic.stamps()} == {
            ns_from_stamp(answer.stamp)
        }
        return {view: view_from_image(view, topic.last) for view, topic in self.images.items()}

    def close(self) -> None:
        self._probe.done(DeleteAgent, "delete_agent", DeleteAgent.Request(name=self.name))

    def __enter__(self) -> Eye:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()
