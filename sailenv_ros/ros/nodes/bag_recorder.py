"""Subscribes to what is recorded and hands each message to a bag's writer."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, cast

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node

from sailenv_ros.recording.channels import (
    AGENT_TOPICS,
    CLOCK,
    ON_REQUEST,
    SCENE_INFO,
    message_of,
    topic,
)
from sailenv_ros.recording.completeness import CompletenessCounter
from sailenv_ros.recording.queue_writer import QueueWriter
from sailenv_ros.recording.schemas import message_class
from sailenv_ros.recording.snapshot_buffer import SnapshotBuffer
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.ros.nodes.qos import recorded_qos
from sailenv_ros.system.presence import present_simulator
from sailenv_ros.types.rigs import body_of
from sailenv_ros.types.views import VIEWS

__all__ = ["CLEAN_END_S", "DEPTH", "Recorder"]


CLEAN_END_S = 1.5
"""Time that a simulator which ends by itself may take from its lock to its topics [s]."""

DEPTH = 30
"""Number of messages of a topic that may wait in the middleware: a second of frames."""

_log = logging.getLogger(__name__)


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
        """Number of frames that were announced since the recorder began to listen."""
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
        above, suffix = f"{self._namespace}/", "/frame_info"
        agents = {
            name[len(above) : -len(suffix)]
            for name, types in self._node.get_topic_names_and_types()
            if name.startswith(above) and name.endswith(suffix)
            if AGENT_TOPICS["frame_info"] in types
        }
        for agent in agents:
            # Below an agent there are the cameras of its rig, else those of another simulator.
            if "/" not in agent or body_of(agent) in agents:
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
            self.heard |= type_name != CLOCK  # which is of any simulator of the domain
            sent_ns = self._put(spec, data, about)
            if agent:
                self._count(name.rpartition("/")[2], agent, data, sent_ns)

        self._node.create_subscription(
            message_class(type_name),
            name,
            cast(Any, take),  # its types know of no raw messages
            recorded_qos(spec.qos, DEPTH),
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
