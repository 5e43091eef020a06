"""A recording with robots: each link's id, parent, category and flow, as they were live."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Agent
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec, due_steps
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from tests.support.robot_files import ARM

pytestmark = pytest.mark.ros

FRAMES = 4
VIEWS = ("instance", "category", "flow")
SCENE = """
version: 1
objects:
  - {name: floor, asset: cube, static: true, position: [0, 0, -0.5], scale: [10, 10, 1]}
robots:
  - {name: arm, file: arm.urdf, joints: [{name: shoulder, position: 0.3}]}
"""
EYE = AgentSpec(
    name="eye",
    pose=Pose.from_rpy_deg((1.6, 0.0, 0.7), (0.0, 5.0, 180.0)),
    following=False,
    intrinsics=CameraIntrinsics(width=64, height=48),
    rate_hz=30.0,
    views=VIEWS,
)


def begun(folder: Path) -> Simulation:
    """An arm that bends, seen by an eye; a second one was spawned."""
    (folder / "arm.urdf").write_text(ARM, encoding="utf-8")
    scene = folder / "robots.yaml"
    scene.write_text(SCENE, encoding="utf-8")
    simulation = Simulation(str(scene), mode="lockstep", backend="native", agent=EYE)
    simulation.spawn_robot(str(folder / "arm.urdf"), (0, 0.6, 0), name="second")
    simulation.drive_joints({"shoulder": -0.4, "elbow": 0.9}, robot="arm")
    simulation.drive_joints({"shoulder": 0.5}, robot="second")
    return simulation


def test_links_are_known_in_a_recording_as_they_were(tmp_path: Path) -> None:
    """Read twice, with the bytes that the simulation itself gives at the same steps."""
    with begun(tmp_path) as running, RecordingWriter(tmp_path / "bag") as writer:
        robots = {name: running.get_robot(name).links for name in ("arm", "second")}
        record_lockstep(running, writer, frames=FRAMES)
    with begun(tmp_path) as live, Agent.from_recording(tmp_path / "bag") as recording:
        frames = list(recording)
        again = [recording[number] for number in range(FRAMES)]
        assert len(frames) == FRAMES
        moved = 0.0
        step = 0
        for frame, same, due in zip(frames, again, due_steps(EYE.rate_hz, FRAMES), strict=True):
            if due > step:
                live.step(due - step)
                step = due
            now = live.capture(agent="eye")
            for view in VIEWS:
                np.testing.assert_array_equal(frame[view], same[view])
                # An agent tells no motion of its first frame as none.
                np.testing.assert_array_equal(frame[view], np.nan_to_num(now[view]))
            links = np.isin(frame["instance"], [n for own in robots.values() for n in own.values()])
            assert links.sum() > 50
            robot = next(n for n, one in recording.categories.items() if one == "robot")
            assert set(frame["category"][links].tolist()) == {robot}
            moved = max(moved, float(np.abs(frame["flow"][links]).max()))
        assert moved > 0.5
        with RecordingReader(tmp_path / "bag") as reader:
            known = {one.id: one for one in RecordedFrames(reader)[0].info.instances}
        for name, own in robots.items():
            for link, number in own.items():
                assert (known[number].name, known[number].category) == (f"{name} {link}", "robot")
                assert recording.instances[number].category == "robot"
            assert known[own["lower"]].parent == own["upper"]
            assert known[own["right"]].parent == own["lower"]
            assert known[own["base"]].parent == 0
