"""Quality of service of every topic of the nodes, each with its reason."""

from __future__ import annotations

import time
from collections.abc import Iterable

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from tf2_msgs.msg import TFMessage

from sailenv_ros.recording.topics import OfferedQos
from sailenv_ros.ros.nodes.parameters import given_parameters

__all__ = [
    "await_arrival",
    "clock_qos",
    "command_qos",
    "diagnostics_qos",
    "frame_qos",
    "latched_qos",
    "no_events",
    "overriding",
    "recorded_qos",
    "transform_publishers",
]


def transform_publishers(node: Node) -> tuple[Publisher, Publisher]:
    """Return tf2's own topics, which are global: of what moves, and the latched one of the rest."""
    return (
        node.create_publisher(TFMessage, "/tf", frame_qos(), event_callbacks=no_events()),
        node.create_publisher(TFMessage, "/tf_static", latched_qos(), event_callbacks=no_events()),
    )


def frame_qos() -> QoSProfile:
    """Images and what belongs to them: reliable, so that subscribers of every kind match.

    Only the last few are kept: a slow subscriber loses frames and does not hold up the node.
    """
    return _last_kept(depth=3)


def latched_qos() -> QoSProfile:
    """State that late subscribers must know: the last message is kept for it."""
    return _last_kept(latched=True)


def clock_qos() -> QoSProfile:
    """/clock: best effort and the latest alone, as every node's time source subscribes."""
    return _last_kept(reliable=False)


def command_qos() -> QoSProfile:
    """Commands: best effort fits every sender, and the latest is the one that counts."""
    return _last_kept(reliable=False)


def diagnostics_qos() -> QoSProfile:
    """/diagnostics: reliable, as its aggregators and viewers subscribe."""
    return _last_kept()


def recorded_qos(offered: OfferedQos, depth: int) -> QoSProfile:
    """Reliability and durability as the publisher of a recorded topic offered them."""
    return _last_kept(
        depth,
        reliable=offered.reliability != "best_effort",
        latched=offered.durability == "transient_local",
    )


def overriding(node: Node, topic: str) -> QoSOverridingOptions | None:
    """Let users set history, depth and reliability of a topic by ``qos_overrides`` parameters.

    Returns
    -------
    options : QoSOverridingOptions or None
        None where the node was started without such a parameter: rclpy declares three for each
        topic and never takes them back, so each agent that comes and goes would leave some behind.
    """
    prefix = f"qos_overrides.{node.resolve_topic_name(topic)}."
    given = any(name.startswith(prefix) for name in given_parameters(node))
    return QoSOverridingOptions.with_default_policies() if given else None


def no_events() -> PublisherEventCallbacks:
    """No event handlers: each is one more thing that the executor waits for in every turn.

    A subscriber whose quality of service does not fit is warned on its own side.
    """
    return PublisherEventCallbacks(use_default_callbacks=False)


def await_arrival(publishers: Iterable[Publisher], timeout_s: float) -> bool:
    """Wait until every reliable subscriber has what was published; return whether all have.

    A subscriber that was suspended uses up the time, which is that of all publishers together.
    """
    deadline_s = time.monotonic() + timeout_s
    for publisher in publishers:
        # In short turns, as rclpy waits with Python's lock held.
        while not publisher.wait_for_all_acked(Duration()):
            if time.monotonic() >= deadline_s:
                return False
            time.sleep(0.002)
    return True


def _last_kept(depth: int = 1, *, reliable: bool = True, latched: bool = False) -> QoSProfile:
    """Return a profile that keeps the last messages; latched, for who comes late too."""
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
    )
