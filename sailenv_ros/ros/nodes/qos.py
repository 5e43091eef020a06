"""Quality of service of every topic of the nodes, each with its reason."""

from __future__ import annotations

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

__all__ = [
    "clock_qos",
    "command_qos",
    "diagnostics_qos",
    "frame_qos",
    "latched_qos",
    "no_events",
    "overridable",
]


def frame_qos() -> QoSProfile:
    """Images and what belongs to them: reliable, so that subscribers of every kind match.

    Only the last few are kept: a slow subscriber loses frames and does not hold up the node.
    """
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=3,
    )


def latched_qos() -> QoSProfile:
    """State that whoever comes late must know: the last message is kept for it."""
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
    )


def clock_qos() -> QoSProfile:
    """/clock: best effort and the latest alone, as every node's time source subscribes."""
    return QoSProfile(
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
    )


def command_qos() -> QoSProfile:
    """Commands: best effort fits every sender, and the latest is the one that counts."""
    return QoSProfile(
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
    )


def diagnostics_qos() -> QoSProfile:
    """/diagnostics: reliable, as its aggregators and viewers subscribe."""
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
    )


def overridable() -> QoSOverridingOptions:
    """Let users set history, depth and reliability by ``qos_overrides`` parameters."""
    return QoSOverridingOptions.with_default_policies()


def no_events() -> PublisherEventCallbacks:
    """No event handlers: each is one more thing that the executor waits for in every turn.

    A subscriber whose quality of service does not fit is warned on its own side.
    """
    return PublisherEventCallbacks(use_default_callbacks=False)
