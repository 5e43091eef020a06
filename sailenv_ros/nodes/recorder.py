"""The recorder as a ROS 2 node: `ros2 run sailenv_ros recorder`.

Topics of a simulator in, an MCAP bag out. Finds agents as they come, takes messages as bytes, and
counts what it loses. Exit status: 0 if everything was kept, 1 if something was lost, 2 where a
parameter is wrong or nothing can be written.
"""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import partial
from typing import Any, cast

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from sailenv_ros.errors import RecordingError
from sailenv_ros.frame import FIVE_VIEWS, VIEWS, checked_views
from sailenv_ros.nodes.executor_thread import ExecutorThread
from sailenv_ros.nodes.lifecycle import StopRequest
from sailenv_ros.nodes.parameters import Parameter, declare_table
from sailenv_ros.nodes.running import run_node
from sailenv_ros.recording.channels import AGENT_TOPICS, CLOCK, SCENE_INFO, message_of, topic
from sailenv_ros.recording.progress import progress_line
from sailenv_ros.recording.queue_writer import QueueWriter
from sailenv_ros.recording.schemas import message_class
from sailenv_ros.recording.tally import FrameTally
from sailenv_ros.recording.topics import OfferedQos, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter

__all__ = ["PARAMETERS", "Recorder", "main"]

NODE_NAME = "recorder"

LOOK_INTERVAL_S = 0.1
"""How often it is looked for agents and topics that have come [s]."""

DEPTH = 30
"""How many messages of a topic may wait in the middleware: a second of frames."""

_log = logging.getLogger(f"sailenv_ros.nodes.{NODE_NAME}")  # __name__ may be __main__

PARAMETERS = {
    "output": Parameter("", "Folder of the bag, which must not exist; empty: by the time."),
    "agents": Parameter([""], "Names of the agents; empty: all, also those that come later."),
    "views": Parameter([""], "Views that are recorded, and so rendered; empty: the five."),
    "clock": Parameter(True, "True: record /clock."),
    "compression": Parameter(
        "zstd", "Of the file's chunks.", choices=("zstd", "lz4", "none")
    ),
    "split_bytes": Parameter(0, "A new file begins at this size; 0: one file [B].", 0, 2**62),
    "split_s": Parameter(0.0, "A new file begins after this time; 0: one file [s].", 0.0, 1e9),
    "queue_bytes": Parameter(
        512 * 2**20, "How much may wait for the disk before it is dropped [B].", 2**20, 2**40
    ),
    "progress": Parameter(True, "True: log a line of progress every few seconds."),
    "progress_interval_s": Parameter(2.0, "Time between two such lines [s].", 0.1, 3600.0),
}  # fmt: skip
"""Every parameter of the node by its name."""


class Recorder:
    """Subscribes to a simulator's topics and has every message written.

    Parameters
    ----------
    node : Node
        In the simulator's namespace.
    writer : QueueWriter
    agents, views : sequence of str
        No agents means all.
    clock : bool
        Whether /clock is recorded.
    """

    def __init__(
        self,
        node: Node,
        writer: QueueWriter,
        *,
        agents: Sequence[str],
        views: Sequence[str],
        clock: bool,
    ) -> None:
        self._node = node
        self._writer = writer
        self._agents = tuple(agents)
        self._views = tuple(views)
        self._namespace = node.get_namespace().rstrip("/")
        self._taken: dict[str, int] = {}  # messages of each topic that is subscribed to
        self._tallies: dict[str, FrameTally] = {}
        self.lost_on_the_way = 0
        self._subscribe(f"{self._namespace}/scene_info", SCENE_INFO)
        if clock:
            self._subscribe("/clock", CLOCK)
        for agent in self._agents:
            self._subscribe_agent(agent)

    @property
    def frames(self) -> int:
        """How many frames were announced while this listened."""
        return sum(tally.frames for tally in self._tallies.values())

    @property
    def lost(self) -> int:
        """Messages that are known to have been sent and are not in the recording.

        Images of announced frames that never came count; a loss that the middleware told of as
        well counts once.
        """
        missing = sum(tally.missing for tally in self._tallies.values())
        on_the_way = max(missing, self.lost_on_the_way)
        return on_the_way + self._writer.dropped + self._writer.statistics.lost

    def look(self) -> None:
        """Subscribe to agents that have come since."""
        if self._agents:
            return
        suffix = "/frame_info"
        for name, types in self._node.get_topic_names_and_types():
            if name.endswith(suffix) and AGENT_TOPICS["frame_info"] in types:
                owner, _, agent = name[: -len(suffix)].rpartition("/")
                if owner == self._namespace:
                    self._subscribe_agent(agent)

    def finish(self) -> None:
        """Count what never came; no message may come after this."""
        for tally in self._tallies.values():
            tally.finish()

    # -- inside ----------------------------------------------------------------------------

    def _subscribe_agent(self, agent: str) -> None:
        for name, type_name in AGENT_TOPICS.items():
            if name not in VIEWS or name in self._views:
                self._subscribe(f"{self._namespace}/{agent}/{name}", type_name, agent)

    def _subscribe(self, name: str, type_name: str, agent: str = "") -> None:
        if name in self._taken:
            return
        self._taken[name] = 0
        spec = topic(name, type_name)
        self._writer.add_topic(spec)

        # rclpy tells by the signature whether a callback wants to know when a message was sent.
        def take(data: Any, about: Mapping[str, Any]) -> None:
            self._taken[name] += 1
            sent_ns = self._put(name, data, about)
            if agent:
                self._count(name.rpartition("/")[2], agent, data, sent_ns)

        self._node.create_subscription(
            message_class(type_name),
            name,
            cast(Any, take),  # its types know of no raw messages
            _listening(spec.qos),
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(
                message_lost=partial(self._count_lost, name), use_default_callbacks=False
            ),
        )

    def _count(self, kind: str, agent: str, data: bytes, sent_ns: int) -> None:
        tally = self._tallies.setdefault(agent, FrameTally())
        if kind == "frame_info":
            tally.add_info(message_of(AGENT_TOPICS[kind], data).views, sent_ns)
        elif kind in VIEWS:
            tally.add_image(kind, sent_ns)

    def _put(self, name: str, data: bytes, about: Mapping[str, Any]) -> int:
        # When it was sent, not when it came: that order is the sender's on all of its topics.
        sent_ns = about["source_timestamp"] or about["received_timestamp"]
        self._writer.put(name, data, sent_ns)
        return int(sent_ns)

    def _count_lost(self, name: str, event: Any) -> None:
        # While writer and reader are finding each other, Fast DDS calls what was sent before then
        # lost; it says so until the first message at the latest, which may be handled before.
        if self._taken[name] > 1:
            self.lost_on_the_way += event.total_count_change


def main(argv: Sequence[str] | None = None) -> int:
    """Record until asked to end; give the exit status."""
    return run_node(NODE_NAME, _record, argv)


def _record(node: Node, stop: StopRequest) -> int:
    values = declare_table(node, PARAMETERS)
    options = RecordingOptions(
        compression=values["compression"],
        split_bytes=values["split_bytes"],
        split_s=values["split_s"],
    )
    views = checked_views([view for view in values["views"] if view] or FIVE_VIEWS)
    output = values["output"] or datetime.now().strftime("recording_%Y_%m_%d-%H_%M_%S")
    writer = QueueWriter(RecordingWriter(output, options), values["queue_bytes"])
    executor = SingleThreadedExecutor(context=node.context)
    try:
        recorder = Recorder(
            node,
            writer,
            agents=[agent for agent in values["agents"] if agent],
            views=views,
            clock=values["clock"],
        )
        executor.add_node(node)
        spinning = ExecutorThread(executor)
        spinning.start()
        node.get_logger().info(f"recording {node.get_namespace()} to {output}; Ctrl-C ends it")
        told_s = began_s = time.monotonic()
        while not stop.wait(LOOK_INTERVAL_S) and writer.failure is None:
            recorder.look()
            if values["progress"] and time.monotonic() - told_s >= values["progress_interval_s"]:
                told_s = time.monotonic()
                node.get_logger().info(_progress(recorder, writer, told_s - began_s))
        ended_s = time.monotonic()
        spinning.stop(2.0)
        recorder.finish()
    finally:
        executor.shutdown(0.0)
        problem = _closed(writer)
    line = _progress(recorder, writer, ended_s - began_s)
    node.get_logger().info(f"recorded {output}: {line}")
    if problem is not None:
        raise problem
    return 1 if recorder.lost else 0


def _closed(writer: QueueWriter) -> RecordingError | None:
    try:
        writer.close()
    except RecordingError as problem:
        return problem
    return None


def _progress(recorder: Recorder, writer: QueueWriter, elapsed_s: float) -> str:
    statistics = writer.statistics
    return progress_line(
        frames=recorder.frames,
        message_bytes=statistics.message_bytes,
        file_bytes=statistics.file_bytes,
        elapsed_s=elapsed_s,
        dropped=recorder.lost,
    )


def _listening(qos: OfferedQos) -> QoSProfile:
    best_effort = qos.reliability == "best_effort"
    latched = qos.durability == "transient_local"
    return QoSProfile(
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=DEPTH,
    )


if __name__ == "__main__":
    sys.exit(main())
