"""Lockstep over ROS: the same seed and the same calls give the same bytes, process by process."""

from __future__ import annotations

import hashlib

import pytest

from sailenv_msgs.srv import Reset, SetPose, Step
from sailenv_msgs_py.transforms import pose_to_msg
from sailenv_ros.types.geometry import look_at
from tests.support.ros_probe import Eye, Probe
from tests.support.sim_node_process import NodeProcess

pytestmark = pytest.mark.ros

VIEWS = ("rgb", "depth", "category", "instance", "flow", "flow_valid")


def session(probe: Probe) -> list[tuple[str, str]]:
    """Drive a camera through moving bodies; return a digest of every view of every frame."""
    digests = []
    with Eye(probe, VIEWS) as eye:
        for number, steps in enumerate((1, 8, 8, 3, 40, 240)):
            position = (4.0, 0.2 * number, 1.5 + 0.1 * number)
            request = SetPose.Request(pose=pose_to_msg(look_at(position, (0.0, 0.0, 1.0))))
            probe.done(SetPose, "eye/set_pose", request)
            probe.done(Step, "step", Step.Request(steps=steps))
            for view, values in eye.capture().items():
                digests.append((view, hashlib.sha256(values.tobytes()).hexdigest()))
    return digests


def test_two_processes_give_the_same_bytes() -> None:
    """Every view of every frame is the same in two processes, and again after a reset."""
    sessions = []
    for _ in range(2):
        with (
            NodeProcess("/same", mode="lockstep", seed=5, agent__name="") as _,
            Probe("/same") as p,
        ):
            sessions.append(session(p))
            p.done(Reset, "reset", Reset.Request(keep_seed=True))
            sessions.append(session(p))
    pictures = [digest for view, digest in sessions[0] if view == "rgb"]
    assert len(set(pictures)) == len(pictures), "the frames do not differ from each other"
    for other in sessions[1:]:
        assert other == sessions[0]
