"""The thread that serves rclpy: nothing that happens to one entity ends it for all others."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

from sailenv_ros.ros.executor_thread import ExecutorThread
from tests.support.waiting import until


class FailingExecutor(SingleThreadedExecutor):
    """Raises what is waiting in `faults` before its next turns."""

    def __init__(self, context: Context) -> None:
        super().__init__(context=context)
        self.faults: list[Exception] = []

    def spin_once(self, timeout_sec: float | None = None) -> None:
        if self.faults:
            raise self.faults.pop()
        super().spin_once(timeout_sec)


@pytest.fixture
def context() -> Iterator[Context]:
    made = Context()
    made.init([])
    yield made
    made.try_shutdown()


def test_an_entity_destroyed_meanwhile_ends_nothing(context: Context) -> None:
    """Neither a subscription that goes while the thread prepares to wait nor a callback's fault."""
    executor = FailingExecutor(context)
    node = Node("spun", context=context)
    executor.add_node(node)
    executor.faults = [InvalidHandle("destroyed"), RuntimeError("a fault of its own")]
    spinning = ExecutorThread(executor)
    spinning.start()
    for _ in range(100):
        node.destroy_subscription(node.create_subscription(String, "word", lambda _: None, 1))
    heard: list[String] = []
    node.create_subscription(String, "word", heard.append, 1)
    publisher = node.create_publisher(String, "word", 1)
    until(lambda: publisher.get_subscription_count() or heard, "the subscription to be known")
    publisher.publish(String(data="here"))
    until(lambda: heard, "the message")
    assert not executor.faults
    assert spinning.stop(5.0)
    executor.shutdown(0.0)
    node.destroy_node()


def test_it_ends_with_its_context(context: Context) -> None:
    executor = SingleThreadedExecutor(context=context)
    spinning = ExecutorThread(executor)
    spinning.start()
    context.try_shutdown()
    assert spinning.stop(5.0)
    executor.shutdown(0.0)
