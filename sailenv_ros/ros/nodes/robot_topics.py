"""Topics of robots, under the name of each: those that Nav2, MoveIt and ros2_control read.

Followed from the simulation's loop thread; commands go to it as operations.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import Executor
from rclpy.node import Node
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from sailenv_msgs_py.robot_msgs import (
    imu_to_msg,
    odometry_to_msg,
    robot_joints_to_msg,
    scan_to_msg,
)
from sailenv_msgs_py.space_msgs import occupancy_grid_to_msg
from sailenv_msgs_py.transforms import twist_from_msg
from sailenv_ros.errors import InvalidState, SailenvError, SimulationClosed
from sailenv_ros.ros.nodes.qos import (
    command_qos,
    frame_qos,
    latched_qos,
    no_events,
    transform_publishers,
)
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.robot_frames import MAP, RobotFrames, map_transform, ros_name
from sailenv_ros.ros.nodes.simulation_topic import SimulationTopic
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.core import SimulationCore
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.world.robot import Robot

__all__ = ["RobotTopics"]

WARN_INTERVAL_S = 2.0

CELL_M, STEP_M = 0.05, 0.02
"""Side of a map's cells, and height of what a robot drives over [m]."""

LEAST_HEIGHT_M = 0.3
"""Of what a robot's map takes for an obstacle, above the floor [m]."""


class RobotTopics(SimulationTopic):
    """Publishes what robots do, and takes commands for them.

    Parameters
    ----------
    node : Node
    executor : Executor
        Makes topics in its own thread.
    runner : OperationRunner
    """

    def __init__(self, node: Node, executor: Executor, runner: OperationRunner) -> None:
        super().__init__()
        self._node, self._executor, self._runner = node, executor, runner
        self._endpoints: dict[str, _Endpoints] = {}
        self._wanted: tuple[Robot, ...] = ()
        self._moving, self._fixed = transform_publishers(node)

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on: its steps, and what is changed between them."""
        super().begin(simulation)

        def changed(info: SceneInfo) -> None:
            # As a listener is added it is called in another thread, and steps follow.
            with suppress(InvalidState):
                self._follow(simulation, simulation.sim_time_ns)

        self._stops.append(simulation.on_info(changed))

    def _publish(self, simulation: Simulation, now_ns: int) -> None:
        core = simulation.core_now()
        robots = tuple(core.world.robots)
        if robots != self._wanted:
            self._wanted = robots
            self._executor.create_task(self._reconcile, robots)
        transforms: list[TransformStamped] = []
        wanted = bool(self._moving.get_subscription_count())
        for robot in robots:
            endpoints = self._endpoints.get(robot.name)
            if endpoints is None or endpoints.robot is not robot:
                continue  # its topics are being made
            endpoints.publish(core, now_ns)
            if wanted:
                transforms += endpoints.frames.moving(robot, now_ns)
        if transforms:
            self._moving.publish(TFMessage(transforms=transforms))

    def _reconcile(self, robots: tuple[Robot, ...]) -> None:
        """Have topics for these robots and no others; in the executor's thread."""
        with self._publishing:
            if self._ended:
                return
            for name, endpoints in list(self._endpoints.items()):
                if endpoints.robot not in robots:
                    endpoints.close(self._node)
                    del self._endpoints[name]
            for robot in robots:
                if robot.name not in self._endpoints:
                    self._endpoints[robot.name] = _Endpoints(self._node, robot, self._runner)
            fixed = [map_transform()]
            for endpoints in self._endpoints.values():
                fixed += endpoints.frames.fixed()
                fixed += endpoints.frames.sensors(endpoints.robot)
            self._fixed.publish(TFMessage(transforms=fixed if robots else []))


class _Endpoints:
    """The topics of one robot in one world."""

    def __init__(self, node: Node, robot: Robot, runner: OperationRunner) -> None:
        self.robot = robot
        self.frames = RobotFrames(robot)
        self._runner, self._log = runner, node.get_logger()
        self._warned_s = -WARN_INTERVAL_S
        self._prefix = ros_name(robot.name)
        self._due: dict[str, int] = {}
        self._map_told = False
        # rclpy's groups refer to all that they ever had; the node's own one outlives the robot.
        group = MutuallyExclusiveCallbackGroup()

        def publisher(kind: Any, topic: str, *, latched: bool = False) -> Any:
            quality = latched_qos() if latched else frame_qos()
            return node.create_publisher(
                kind, f"{self._prefix}/{topic}", quality, event_callbacks=no_events()
            )

        def subscription(kind: Any, topic: str, callback: Callable[[Any], None]) -> Any:
            return node.create_subscription(
                kind, f"{self._prefix}/{topic}", callback, command_qos(), callback_group=group
            )

        self._joints = publisher(JointState, "joint_states")
        self._description = publisher(String, "robot_description", latched=True)
        self._map = publisher(OccupancyGrid, "map", latched=True)
        self._odom = publisher(Odometry, "odom")
        self._sensors = {
            spec.name: publisher(LaserScan if spec.type == "lidar" else Imu, spec.name)
            for spec in robot.placement.spec.sensors
        }
        self._commands = [subscription(JointState, "joint_commands", self._drive_joints)]
        if robot.wheels is not None:
            self._commands.append(subscription(Twist, "cmd_vel", self._drive))
        self._description.publish(String(data=robot.model.description))

    def close(self, node: Node) -> None:
        """Take the topics away."""
        for topic in (self._joints, self._description, self._map, self._odom):
            node.destroy_publisher(topic)
        for topic in self._sensors.values():
            node.destroy_publisher(topic)
        for command in self._commands:
            node.destroy_subscription(command)

    def publish(self, core: SimulationCore, now_ns: int) -> None:
        """Publish what somebody subscribes to; in the simulation's thread."""
        robot, world = self.robot, core.world
        if self._joints.get_subscription_count() or self._odom.get_subscription_count():
            state = world.robot_state(robot.name)
            self._joints.publish(robot_joints_to_msg(state))
            place = self.frames.odom_from_base(robot)
            frames = self.frames.odom, self.frames.base
            self._odom.publish(odometry_to_msg(state, place, frames))
        if not self._map_told and self._map.get_subscription_count():
            self._map_told = True
            self._publish_map(core)
        for spec in robot.placement.spec.sensors:
            topic = self._sensors[spec.name]
            period_ns = 1e9 / spec.rate
            due = math.floor(now_ns / period_ns + 1e-6)
            if due == self._due.get(spec.name) or not topic.get_subscription_count():
                continue
            self._due[spec.name] = due
            frame = self.frames.named(spec.name)
            if spec.type == "lidar":
                scan = world.robot_scan(robot.name, spec.name, core.space.cast_rays)
                topic.publish(scan_to_msg(scan, frame, period_ns * 1e-9))
            else:
                topic.publish(imu_to_msg(world.robot_inertial(robot.name, spec.name), frame))

    def _publish_map(self, core: SimulationCore) -> None:
        boxes = [link.asset.model.bounds()[1, 2] for link in self.robot.model.links]
        # Whatever reaches into a cell occupies it, thin legs of chairs too.
        body = BodySize(
            height_m=max(LEAST_HEIGHT_M, *map(float, boxes)),
            radius_m=CELL_M * math.sqrt(0.5),
            step_m=STEP_M,
            resolution_m=CELL_M,
        )
        message = occupancy_grid_to_msg(core.space.without_robots(body))
        message.header.frame_id = MAP
        self._map.publish(message)

    def _drive(self, command: Twist) -> None:
        (forward, left, _), (_, _, turn) = twist_from_msg(command)
        self._submit(
            "cmd_vel",
            lambda: self._runner.submit(
                Operations.drive_robot, forward, turn, left, robot=self.robot.name
            ),
        )

    def _drive_joints(self, command: JointState) -> None:
        """Follow a command as ros2_control's topic-based interface sends it; NaN says nothing."""
        for mode in ("position", "velocity", "effort"):
            numbers = list(getattr(command, mode))
            if len(numbers) == len(command.name):
                told = zip(command.name, numbers, strict=True)
                targets = {name: number for name, number in told if not math.isnan(number)}
                if targets:
                    self._submit("joint_commands", self._drives(targets, mode))

    def _drives(self, targets: dict[str, float], mode: Any) -> Callable[[], Future[None]]:
        name = self.robot.name
        return lambda: self._runner.submit(Operations.drive_joints, targets, mode, robot=name)

    def _submit(self, topic: str, begin: Callable[[], Future[None]]) -> None:
        """Ask for an operation; what is refused is logged, as nobody waits for its answer."""
        try:
            driving = begin()
        except SimulationClosed:
            return
        except SailenvError as problem:
            self._warn(topic, problem)
            return
        driving.add_done_callback(lambda done: self._report(topic, done))

    def _report(self, topic: str, driving: Future[None]) -> None:
        problem = None if driving.cancelled() else driving.exception()
        if isinstance(problem, SailenvError):
            self._warn(topic, problem)

    def _warn(self, topic: str, problem: SailenvError) -> None:
        now_s = time.monotonic()
        if now_s - self._warned_s >= WARN_INTERVAL_S:
            self._warned_s = now_s
            self._log.warning(f"{self._prefix}/{topic}: {problem}")
