"""The recorder as a ROS 2 node: `ros2 run sailenv_ros recorder`.

Topics of a simulator in, an MCAP bag out. Finds agents as they come, takes messages as bytes, and
counts what it loses. In snapshot mode it keeps the last seconds in memory and writes them when the
service `~/snapshot` is called or the process gets SIGUSR1.

Exit status: 0 if everything was kept; 1 if something was lost, if no simulator was heard, or if the
simulator was killed; 2 where a parameter is wrong or nothing can be written.
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any, cast

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger

from sailenv_ros.errors import RecordingError
from sailenv_ros.frame import FIVE_VIEWS, VIEWS, checked_views
from sailenv_ros.nodes.executor_thread import ExecutorThread
from sailenv_ros.nodes.lifecycle import StopRequest
from sailenv_ros.nodes.parameter_table import Parameter
from sailenv_ros.nodes.parameters import declare_table
from sailenv_ros.nodes.running import run_node
from sailenv_ros.recording.channels import (
    AGENT_TOPICS,
    CLOCK,
    ON_REQUEST,
    SCENE_INFO,
    message_of,
    topic,
)
from sailenv_ros.recording.completeness import CompletenessCounter
from sailenv_ros.recording.progress import progress_line
from sailenv_ros.recording.queue_writer import QueueWriter
from sailenv_ros.recording.schemas import message_class
from sailenv_ros.recording.snapshot_buffer import SnapshotBuffer
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.system.presence import present_simulator
from sailenv_ros.validation import Bounds

__all__ = ["PARAMETERS", "Recorder", "main"]

NODE_NAME = "recorder"

LOOK_INTERVAL_S = 0.1
"""How often it is looked for agents and topics that have come [s]."""

CLEAN_END_S = 1.5
"""How long a simulator that ends by itself may take from its lock to its topics [s]."""

DEPTH = 30
"""How many messages of a topic may wait in the middleware: a second of frames."""

_log = logging.getLogger(f"sailenv_ros.nodes.{NODE_NAME}")  # __name__ may be __main__

PARAMETERS = {
    "output": Parameter("", "Folder of the bag, which must not exist; empty: by the time."),
    "agents": Parameter([""], "Names of the agents; empty: all, also those that come later."),
    "views": Parameter([""], "Views that are recorded, and so rendered; empty: the five."),
    "amodal": Parameter(False, "True: draw each object alone and record amodal masks too."),
    "clock": Parameter(True, "True: record /clock."),
    "compression": Parameter(
        "zstd", "Of the file's chunks.", choices=("zstd", "lz4", "none")
    ),
    "split_bytes": Parameter(
        0,
        "A new file begins at this size; 0: one file [B].",
        Bounds(least=0, most=2**62, whole=True),
    ),
    "split_s": Parameter(
        0.0, "A new file begins after this time; 0: one file [s].", Bounds(least=0.0, most=1e9)
    ),
    "queue_bytes": Parameter(
        512 * 2**20,
        "How much may wait for the disk before it is dropped, or is kept for a snapshot [B].",
        Bounds(least=2**20, most=2**40, whole=True),
    ),
    "snapshot_s": Parameter(
        0.0,
        "Keep the last so many seconds in memory and write them when ~/snapshot is called; 0: "
        "write everything at once [s].",
        Bounds(least=0.0, most=1e6),
    ),
    "progress": Parameter(True, "True: log a line of progress every few seconds."),
    "progress_interval_s": Parameter(
        2.0, "Time between two such lines [s].", Bounds(least=0.1, most=3600.0)
    ),
}  # fmt: skip
"""Every parameter of the node by its name."""


class Recorder:
    """Subscribes to a simulator's topics and has every message written.

    Parameters
    ----------
    node : Node
        In the simulator's namespace.
    writer : QueueWriter or SnapshotBuffer
    agents, views : sequence of str
        No agents means all.
    amodal : bool
        Whether amodal masks are recorded.
    clock : bool
        Whether /clock is recorded.
    """

    def __init__(
        self,
        node: Node,
        writer: QueueWriter | SnapshotBuffer,
        *,
        agents: Sequence[str],
        views: Sequence[str],
        amodal: bool,
        clock: bool,
    ) -> None:
        self._node = node
        self._writer = writer
        self._agents = tuple(agents)
        self._kept = (*views, *(ON_REQUEST if amodal else ()))
        self._namespace = node.get_namespace().rstrip("/")
        self._taken: dict[str, int] = {}  # messages of each topic that is subscribed to
        self._counters: dict[str, CompletenessCounter] = {}
        self.lost_on_the_way = 0
        self.heard = False
        self._began_ns = time.time_ns()
        self._watch = _SimulatorWatch(node, f"{self._namespace}/scene_info")
        self._subscribe(f"{self._namespace}/scene_info", SCENE_INFO)
        if clock:
            self._subscribe("/clock", CLOCK)
        for agent in self._agents:
            self._subscribe_agent(agent)

    @property
    def frames(self) -> int:
        """How many frames were announced while this listened."""
        return sum(counter.frames for counter in self._counters.values())

    @property
    def lost(self) -> int:
        """Messages that are known to have been sent and are not in the recording.

        Images of announced frames that never came count; a loss that the middleware told of as
        well counts once.
        """
        missing = sum(counter.missing for counter in self._counters.values())
        on_the_way = max(missing, self.lost_on_the_way)
        return on_the_way + self._writer.dropped + self._writer.statistics.lost

    @property
    def simulator_was_killed(self) -> bool:
        """True if a simulator on this host ended without a word while this listened."""
        return self._watch.was_killed

    def look(self) -> None:
        """Subscribe to agents that have come since, and see whether the simulator lives."""
        self._watch.look()
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
        for counter in self._counters.values():
            counter.finish()

    # -- inside ----------------------------------------------------------------------------

    def _subscribe_agent(self, agent: str) -> None:
        for name, type_name in AGENT_TOPICS.items():
            if name not in (*VIEWS, *ON_REQUEST) or name in self._kept:
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
            self.heard = True
            sent_ns = self._put(spec, data, about)
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
        counter = self._counters.setdefault(agent, CompletenessCounter())
        if kind == "frame_info":
            counter.add_info(message_of(AGENT_TOPICS[kind], data).views, sent_ns)
        elif kind in VIEWS:
            counter.add_image(kind, sent_ns)

    def _put(self, spec: RecordedTopic, data: bytes, about: Mapping[str, Any]) -> int:
        # When it was sent, not when it came: that order is the sender's on all of its topics.
        sent_ns = int(about["source_timestamp"] or about["received_timestamp"])
        if spec.qos.durability == "transient_local":
            # A latched message may be hours old; a recording begins when it begins.
            self._writer.put(spec.name, data, max(sent_ns, self._began_ns))
        else:
            self._writer.put(spec.name, data, sent_ns)
        return sent_ns

    def _count_lost(self, name: str, event: Any) -> None:
        # While writer and reader are finding each other, Fast DDS calls what was sent before then
        # lost; it says so until the first message at the latest, which may be handled before.
        if self._taken[name] > 1:
            self.lost_on_the_way += event.total_count_change


class _SimulatorWatch:
    """Notices that a simulator on this host was killed.

    One that ends by itself takes its topics along; of one that was killed the lock is free at once
    while DDS still tells of its topics.
    """

    def __init__(self, node: Node, topic_name: str) -> None:
        self._node = node
        self._topic = topic_name
        self._domain_id = node.context.get_domain_id()
        self._namespace = node.get_namespace()
        self._pid: int | None = None
        self._gone_s: float | None = None
        self.was_killed = False

    def look(self) -> None:
        """See whether it lives."""
        pid = present_simulator(self._domain_id, self._namespace)
        if pid is not None or self._pid is None:
            self._pid, self._gone_s = pid, None
            return
        if not self._node.count_publishers(self._topic):
            self._pid = None
        elif self._gone_s is None:
            self._gone_s = time.monotonic()
        elif time.monotonic() - self._gone_s > CLEAN_END_S:
            self._pid = None
            self.was_killed = True
            _log.error("the simulator %s was killed; what it sent is kept", self._namespace)


def main(argv: Sequence[str] | None = None) -> int:
    """Record until asked to end; return the exit status."""
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
    writer: QueueWriter | SnapshotBuffer
    if values["snapshot_s"]:
        writer = SnapshotBuffer(
            Path(output),
            options,
            keep_s=values["snapshot_s"],
            limit_bytes=values["queue_bytes"],
        )
        how = _offer_snapshots(node, writer, values["snapshot_s"])
    else:
        writer = QueueWriter(RecordingWriter(output, options), values["queue_bytes"])
        how = f"recording {node.get_namespace()} to {output}"
    executor = SingleThreadedExecutor(context=node.context)
    try:
        recorder = Recorder(
            node,
            writer,
            agents=[agent for agent in values["agents"] if agent],
            views=views,
            amodal=values["amodal"],
            clock=values["clock"],
        )
        executor.add_node(node)
        spinning = ExecutorThread(executor)
        spinning.start()
        node.get_logger().info(f"{how}; Ctrl-C ends it")
        reported_s = began_s = time.monotonic()
        while not stop.wait(LOOK_INTERVAL_S) and writer.failure is None:
            recorder.look()
            if (
                values["progress"]
                and time.monotonic() - reported_s >= values["progress_interval_s"]
            ):
                reported_s = time.monotonic()
                node.get_logger().info(_progress(recorder, writer, reported_s - began_s))
        ended_s = time.monotonic()
        spinning.stop(2.0)
        recorder.finish()
    finally:
        executor.shutdown(0.0)
        problem = _closed(writer)
    line = _progress(recorder, writer, ended_s - began_s)
    done = f"recorded {output}"
    if isinstance(writer, SnapshotBuffer):
        done = f"wrote {len(writer.written)} bags"
    node.get_logger().info(f"{done}: {line}")
    if problem is not None:
        raise problem
    if not recorder.heard:
        node.get_logger().error(
            f"no simulator was heard in {node.get_namespace()} of ROS domain "
            f"{node.context.get_domain_id()}; nothing is recorded"
        )
    return int(bool(recorder.lost) or not recorder.heard or recorder.simulator_was_killed)


def _offer_snapshots(node: Node, writer: SnapshotBuffer, keep_s: float) -> str:
    """Have the service and SIGUSR1 write what is kept; return a sentence on how to ask."""
    asked = threading.Lock()  # one bag at a time

    def write() -> tuple[bool, str]:
        with asked:
            try:
                folder = writer.write()
            except RecordingError as problem:
                node.get_logger().error(str(problem))
                return False, str(problem)
        node.get_logger().info(f"wrote {folder}")
        return True, str(folder)

    def answer(_: Any, response: Any) -> Any:
        response.success, response.message = write()
        return response

    def on_signal(*_: object) -> None:
        threading.Thread(target=write, name="snapshot", daemon=True).start()

    service = f"{node.get_fully_qualified_name()}/snapshot"
    node.create_service(Trigger, service, answer)
    signal.signal(signal.SIGUSR1, on_signal)
    return (
        f"keeping the last {keep_s:g} s of {node.get_namespace()}; to write them: the service "
        f"{service} (std_srvs/Trigger), or kill -USR1 {os.getpid()}"
    )


def _closed(writer: QueueWriter | SnapshotBuffer) -> RecordingError | None:
    try:
        writer.close()
    except RecordingError as problem:
        return problem
    return None


def _progress(recorder: Recorder, writer: QueueWriter | SnapshotBuffer, elapsed_s: float) -> str:
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
