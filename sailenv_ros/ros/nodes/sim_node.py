"""The simulator as a ROS 2 node: `ros2 run sailenv_ros sim_node`.

Parameters in; hosts a `Simulation` and joins it to topics and services, which are other modules.
Exit status: 0 after SIGINT or SIGTERM, 1 after an error, 2 where an argument, a parameter or the
scene is wrong, 3 where another simulator has the namespace already.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import sys
from collections.abc import Callable, Sequence

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import remove_ros_args

from sailenv_ros.errors import (
    NameTaken,
    SimulationClosed,
)
from sailenv_ros.ros.executor_thread import ExecutorThread
from sailenv_ros.ros.nodes.agent_endpoints import AgentEndpoints
from sailenv_ros.ros.nodes.agent_leases import AgentLeases
from sailenv_ros.ros.nodes.announcements import Announcements
from sailenv_ros.ros.nodes.capture_server import CaptureServer
from sailenv_ros.ros.nodes.contact_topic import ContactTopic
from sailenv_ros.ros.nodes.diagnostics import Diagnostics
from sailenv_ros.ros.nodes.free_space_topic import FreeSpaceTopic
from sailenv_ros.ros.nodes.hosting import Hosted, load_simulation
from sailenv_ros.ros.nodes.joint_topic import JointTopic
from sailenv_ros.ros.nodes.lesson_topic import LessonTopic
from sailenv_ros.ros.nodes.lifecycle import StopRequest, stop_at_end_of
from sailenv_ros.ros.nodes.live_parameters import LiveParameters
from sailenv_ros.ros.nodes.parameter_table import NAMESPACE
from sailenv_ros.ros.nodes.parameters import declare_parameters
from sailenv_ros.ros.nodes.requests import OperationRunner
from sailenv_ros.ros.nodes.robot_topics import RobotTopics
from sailenv_ros.ros.nodes.running import exit_status, refusing
from sailenv_ros.ros.nodes.services import SimulatorServices
from sailenv_ros.ros.nodes.simulation_interfaces import standard_interfaces
from sailenv_ros.ros.nodes.tf_tree import TfTree
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.presence import (
    ClockLock,
    SimulatorLock,
    checked_domain,
    clock_publisher,
)
from sailenv_ros.system.transport import use_shared_memory_profile, who_may_command
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["SimNode", "main", "run"]

NODE_NAME = "sim_node"

SWITCH_INTERVAL_S = 0.0005
"""Switch interval of Python's threads [s]; Python's default of 5 ms delays every frame."""

_log = logging.getLogger(f"sailenv_ros.ros.nodes.{NODE_NAME}")  # __name__ may be __main__


class SimNode:
    """A simulation joined to a node's topics and services.

    Parameters
    ----------
    node : Node
    executor : SingleThreadedExecutor
        Spins the node once `start` was called.
    hosted : Hosted
        The simulation with its servers; owned from now on.
    publish_clock : bool
    quit_process : callable
        Asks the process to end.
    """

    def __init__(
        self,
        node: Node,
        executor: SingleThreadedExecutor,
        hosted: Hosted,
        *,
        publish_clock: bool,
        quit_process: Callable[[], None],
    ) -> None:
        self._node = node
        self._executor = executor
        self._hosted = hosted
        simulation = self._simulation = hosted.simulation
        runner = OperationRunner(simulation, executor)
        self._tf = TfTree(node, instances=hosted.parameters.publish_instance_tf)
        self._endpoints = AgentEndpoints(node, simulation, runner, self._tf)
        self._announcements = Announcements(
            node, publish_clock=publish_clock, on_info=self._scene_changed
        )
        self._contacts, self._lessons = ContactTopic(node), LessonTopic(node)
        self._joints = JointTopic(node)
        self._robots = RobotTopics(node, executor, runner)
        self._stop_maps = simulation.on_free_space(FreeSpaceTopic(node).publish)
        self._leases = AgentLeases(node, runner)
        self._services = SimulatorServices(
            node, runner, self._reconcile, before_registration=self._forget_ended_clients
        )
        self._diagnostics = Diagnostics(node, simulation, self._endpoints.counts)
        agent = "" if hosted.parameters.agent is None else hosted.parameters.agent.name
        self._live_parameters = LiveParameters(node, simulation, agent)
        self._interfaces = standard_interfaces(node, simulation, quit_process)
        self._spinning = ExecutorThread(executor)
        self._capture_server = CaptureServer(
            simulation,
            node.context.get_domain_id(),
            node.get_namespace(),
            self._endpoints.publisher_of,
        )

    @property
    def simulation(self) -> Simulation:
        """The simulation that is hosted."""
        return self._simulation

    def start(self) -> None:
        """Begin to publish and to serve."""
        self._reconcile()
        self._announcements.begin(self._simulation)
        self._contacts.begin(self._simulation)
        self._lessons.begin(self._simulation)
        self._joints.begin(self._simulation)
        self._robots.begin(self._simulation)
        self._executor.add_node(self._node)
        self._spinning.start()
        if self._interfaces is not None:
            self._interfaces.start()

    def close(self, timeout_s: float) -> bool:
        """End everything but the node; False if the simulation did not end in time."""
        self._hosted.close_servers()
        self._capture_server.close()
        if self._interfaces is not None:
            self._interfaces.close()
        self._spinning.stop(0.5)
        self._announcements.end()
        self._contacts.end()
        self._lessons.end()
        self._joints.end()
        self._robots.end()
        self._stop_maps()
        self._endpoints.close()
        return self._hosted.close_simulation(timeout_s)

    def _reconcile(self) -> None:
        info = self._simulation.info
        self._endpoints.reconcile(info)
        self._leases.take_note(info)

    async def _forget_ended_clients(self) -> None:
        # Their topics and services go before others of the same name come.
        if await self._leases.settle():
            self._reconcile()

    def _scene_changed(self, info: SceneInfo) -> None:
        self._executor.create_task(self._reconcile)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the node until it is asked to end; return the exit status."""
    stop = StopRequest()
    stop.install()
    try:
        return run(list(sys.argv if argv is None else argv), stop)
    finally:
        stop.disarm()


def run(arguments: list[str], stop: StopRequest, hosted: Hosted | None = None) -> int:
    """Run the node until the end is asked for; return the exit status.

    Parameters
    ----------
    arguments : list of str
        As `sys.argv` has them.
    stop : StopRequest
    hosted : Hosted or None
        A simulation that runs already, in a process that has the lock of its name. Owned from
        when the node is there; if the node cannot be made, it continues as it was. None starts one.
    """
    return exit_status(NODE_NAME, lambda: _run(arguments, stop, hosted))


def _run(arguments: list[str], stop: StopRequest, hosted: Hosted | None) -> int:
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    keep_freed_memory()
    transport = use_shared_memory_profile()
    context = Context()
    try:
        with refusing(arguments):
            options = _parsed(remove_ros_args(arguments))
            context.init(arguments)
            checked_domain(context.get_domain_id())
            node = Node(NODE_NAME, namespace=NAMESPACE, context=context)
        if options.end_with_fd is not None:
            stop_at_end_of(options.end_with_fd, stop)
        try:
            return _run_node(node, context, transport.why, stop, hosted)
        finally:
            node.destroy_node()
    finally:
        context.try_shutdown()


def _run_node(
    node: Node, context: Context, transport: str, stop: StopRequest, hosted: Hosted | None
) -> int:
    parameters = declare_parameters(node)
    domain_id = context.get_domain_id()
    with contextlib.ExitStack() as held:
        if hosted is None:
            held.enter_context(SimulatorLock(domain_id, node.get_namespace()))
        publish_clock = parameters.publish_clock and _takes_clock(domain_id, held)
        if hosted is None:
            simulation = load_simulation(parameters, stop)
            if simulation is None:
                return 0
            hosted = Hosted(simulation, parameters)
        executor = SingleThreadedExecutor(context=context)
        sim_node = SimNode(
            node, executor, hosted, publish_clock=publish_clock, quit_process=stop.set
        )
        try:
            sim_node.start()
            _greet(node, hosted.simulation.info, transport, hosted.viewer_url)
            node.get_logger().info(who_may_command(domain_id))
            while not stop.wait(0.25):
                if hosted.simulation.closed:
                    raise SimulationClosed("of an internal error, which the log shows")
            status = 0
        finally:
            ended = sim_node.close(1.0)
            executor.shutdown(0.0)
        if not ended:
            _leave_at_once(node, context, status)
        return status


def _takes_clock(domain_id: int, held: contextlib.ExitStack) -> bool:
    """Take the right to publish /clock until the end; say so if another simulator has it."""
    try:
        held.enter_context(ClockLock(domain_id))
    except NameTaken:
        _log.warning(
            "the simulator of process %s publishes /clock in ROS domain %d, so this one does not; "
            "to have this one's time there: end the other, or start the other with -p "
            "publish_clock:=false, or start this one in a domain of its own (ROS_DOMAIN_ID)",
            clock_publisher(domain_id),
            domain_id,
        )
        return False
    return True


def _greet(node: Node, info: SceneInfo, transport: str, url: str) -> None:
    namespace = node.get_namespace().rstrip("/")
    agents = [spec.name for spec in info.agents]
    window = f"{url} in a browser, or " if url else ""
    see = f"ros2 run rqt_image_view rqt_image_view {namespace}/{agents[0]}/rgb" if agents else "-"
    node.get_logger().info(
        f"scene {info.scene!r} in {namespace or '/'}; renderer: {info.renderer}; {transport}; "
        f"agents: {', '.join(agents) or 'none'}; to see: {window}{see}"
    )


def _parsed(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog=NODE_NAME, description="The simulator.", epilog="Then: --ros-args -p scene:=optical …"
    )
    parser.add_argument(
        "--end-with-fd",
        type=int,
        metavar="N",
        help="end when the other end of this pipe is closed, so that no parent is outlived",
    )
    return parser.parse_args(list(arguments)[1:])


def _leave_at_once(node: Node, context: Context, status: int) -> None:
    """End although a request is still being worked on: the process takes it along."""
    node.destroy_node()
    context.try_shutdown()
    logging.shutdown()
    os._exit(status)


if __name__ == "__main__":
    sys.exit(main())
