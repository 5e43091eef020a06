"""What is known of objects, over ROS: topics, the service, an Agent's frames."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2

from sailenv_msgs.msg import Objects
from sailenv_msgs_py.object_truth_msgs import amodal_masks_from_msgs
from sailenv_ros import Agent
from sailenv_ros.errors import InvalidState
from tests.support.ros_probe import Probe
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/objects_known"
SIZE = {"width": 96, "height": 72}
SIMULATOR = {"scene": "optical", "gateway.port": 0, "viewer.port": 0, "agent.width": 96,
             "agent.height": 72, "agent.rate_hz": 10.0}  # fmt: skip


@pytest.fixture(scope="module")
def agent() -> Iterator[Agent]:
    """An Agent beside a simulator in real time whose own agent streams frames."""
    with Agent(**SIZE, namespace=NAMESPACE, simulator=SIMULATOR) as agent:
        yield agent


def test_an_agents_frame_knows_its_objects(agent: Agent) -> None:
    """Table, amodal masks and points are those of the frame; masks come before the next one."""
    for _ in range(2):  # by topics, then through shared memory
        frame = agent.capture()
        table = frame.objects_with_amodal
        assert table.ids.tolist() == sorted(frame.instances)
        assert np.isfinite(table.world_from_object).all()
        seen = np.unique(frame["instance"])
        assert table.ids[table.visible].tolist() == seen[seen > 0].tolist()
        for id_ in table.ids[table.visible].tolist():
            visible = frame["instance"] == id_
            # With another renderer than the native one pixels on edges may differ.
            assert (visible & ~frame.amodal.mask(id_)).sum() <= 0.1 * visible.sum() + 2
        assert len(frame.points()) == np.isfinite(frame["depth"]).sum()
    late = agent.capture()
    agent.capture()
    with pytest.raises(InvalidState, match="no longer the last"):
        _ = late.amodal


def test_topics_tell_of_the_frame_while_somebody_listens(agent: Agent) -> None:
    """Objects without and with masks, and a cloud as large as the picture."""
    with Probe(NAMESPACE) as probe:
        plain = probe.listen(Objects, "agent/objects")
        amodal = probe.listen(Objects, "agent/objects/amodal")
        cloud = probe.listen(PointCloud2, "agent/points")
        until(lambda: plain.messages and amodal.messages and cloud.messages, "one of each")
        assert {one.name for one in plain.last.objects} == {
            instance.name for instance in agent.info.instances
        }
        assert all(len(one.amodal.counts) == 0 for one in plain.last.objects)
        assert any(one.visible_pixels for one in plain.last.objects)
        drawn = amodal.last.objects  # the next message may be there any moment
        masks = amodal_masks_from_msgs((one.amodal for one in drawn), 72, 96)
        for one in drawn:
            assert masks.mask(one.id).sum() == one.amodal.pixels
        assert (cloud.last.width, cloud.last.height) == (96, 72)
        assert cloud.last.header.frame_id == plain.last.header.frame_id
