"""Frames of an agent's topics: those of its own registration alone."""

from __future__ import annotations

import os
from contextlib import closing

from sailenv_msgs.msg import FrameInfo
from sailenv_ros.ros.client.connection import Connection
from sailenv_ros.ros.client.frame_topics import AgentTopics
from tests.support.ros_probe import Probe
from tests.support.waiting import until

NAMESPACE = "/named_again"


def test_what_an_earlier_agent_of_the_name_sent_is_not_taken() -> None:
    """Its topics may linger: its frames know a scene that did not have this agent yet."""
    domain = int(os.environ.get("ROS_DOMAIN_ID", "0"))
    with (
        Probe(NAMESPACE) as probe,
        closing(Connection(domain, NAMESPACE)) as connection,
        closing(AgentTopics(connection, "eye", ())) as topics,
    ):
        sent = probe.node.create_publisher(FrameInfo, "eye/frame_info", 10)
        until(lambda: sent.get_subscription_count() == 1, "the reader to be known")
        topics.await_publishers(10.0)
        for revision in (6, 7):
            sent.publish(FrameInfo(revision=revision, sequence=100 + revision))
        topics.begin(8)
        sent.publish(FrameInfo(revision=7, sequence=107))
        assert topics.take(107, 10.0, quiet_s=1.0) is None
        sent.publish(FrameInfo(revision=8, sequence=1))
        assert topics.take_newer(0, (), 10.0).sequence == 1
