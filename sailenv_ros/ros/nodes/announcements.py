"""Publishes the state of the simulation: `scene_info` (latched) and `/clock`.

Called from the simulation's loop thread, so that a frame's scene_info is always out before the
frame; each call is one small message.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from sailenv_msgs.msg import SceneInfo as SceneInfoMsg
from sailenv_msgs_py.scene_msgs import scene_info_to_msg
from sailenv_msgs_py.stamps import stamp_from_ns
from sailenv_ros.ros.nodes.qos import clock_qos, latched_qos, no_events
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["Announcements"]


class Announcements:
    """Publishes the state of a simulation.

    Parameters
    ----------
    node : Node
    publish_clock : bool
        False leaves /clock to somebody else.
    on_info : callable
        Called after each new scene_info, in the simulation's thread: must be quick.
    """

    def __init__(
        self, node: Node, *, publish_clock: bool, on_info: Callable[[SceneInfo], None]
    ) -> None:
        self._info = node.create_publisher(SceneInfoMsg, "scene_info", latched_qos())
        self._clock = (
            node.create_publisher(Clock, "/clock", clock_qos(), event_callbacks=no_events())
            if publish_clock
            else None
        )
        self._on_info = on_info
        self._unsubscribe: list[Callable[[], None]] = []
        self._publishing = threading.Lock()
        self._ended = False

    def begin(self, simulation: Simulation) -> None:
        """Follow a simulation from now on."""
        self._unsubscribe.append(simulation.on_info(self._publish_info))
        if self._clock is not None:
            self._publish_clock(simulation.sim_time_ns)
            self._unsubscribe.append(simulation.on_step(self._publish_clock))

    def end(self) -> None:
        """Stop following; nothing is published after this returns."""
        with self._publishing:
            self._ended = True
        while self._unsubscribe:
            self._unsubscribe.pop()()

    def _publish_info(self, info: SceneInfo) -> None:
        with self._publishing:
            if not self._ended:
                self._info.publish(scene_info_to_msg(info))
                self._on_info(info)

    def _publish_clock(self, sim_time_ns: int) -> None:
        with self._publishing:
            if self._clock is not None and not self._ended:
                self._clock.publish(Clock(clock=stamp_from_ns(sim_time_ns)))
