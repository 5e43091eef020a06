"""Topics of robots that come and go: a node keeps nothing of those that are gone."""

from __future__ import annotations

from pathlib import Path

import pytest
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from sailenv_ros import Simulation
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.robot_topics import RobotTopics
from tests.support.robot_files import CART
from tests.support.waiting import until

pytestmark = pytest.mark.ros


def test_robots_that_come_and_go_leave_nothing_behind(tmp_path: Path) -> None:
    """A callback group refers for ever to each entity that was ever added to it."""
    cart = tmp_path / "cart.urdf"
    cart.write_text(CART, encoding="utf-8")
    context = Context()
    context.init([])
    node = Node("robots", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def offers(topic: bool) -> bool:
        executor.spin_once(0.05)
        commands = [one.topic_name for one in node.subscriptions]
        return ("/cart/joint_commands" in commands) == topic

    with Simulation("optical", mode="lockstep") as simulation:
        topics = RobotTopics(node, executor, OperationRunner(simulation, executor))
        topics.begin(simulation)
        before = len(node.default_callback_group.entities)
        for _ in range(3):
            simulation.spawn_robot(str(cart), (1.0, 1.0, 0.0))
            until(lambda: offers(True), "a robot's topics")
            simulation.despawn_robot("cart")
            until(lambda: offers(False), "no topics")
        kept = len(node.default_callback_group.entities) - before
        topics.end()
    executor.shutdown(0.0)
    node.destroy_node()
    context.try_shutdown()
    assert kept == 0
