"""People in recordings: skeletons come back as they were, and skin from them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import motion
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.recorded_geometry import with_skin
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.skeleton import COCO_KEYPOINTS

pytestmark = pytest.mark.ros

COUNT = 3
SCENE = """
version: 1
objects:
  - {name: ground, asset: plane, static: true, scale: [6, 6, 1]}
  - name: eve
    asset: person_03_in_parts
    position: [0, 0, 0]
    scale: 0.9
    behaviours: [{type: walk_around}]
"""


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[Frame]]:
    """Frames of a person who walks, as they were recorded."""
    folder = tmp_path_factory.mktemp("people")
    scene = folder / "walk.yaml"
    scene.write_text(SCENE)
    spec = AgentSpec(
        name="eye", intrinsics=CameraIntrinsics(width=120, height=160), rate_hz=10.0,
        pose=look_at((2.6, 0.4, 1.2), (0.0, 0.0, 0.8)), following=False,
    )  # fmt: skip
    with Simulation(str(scene), mode="lockstep", agent=spec, light="plain") as simulation:
        simulation.step(120)
        with RecordingWriter(folder / "bag") as writer:
            views = ("depth", "instance", "flow_forward")
            record_lockstep(simulation, writer, frames=COUNT, agents=["eye"], views=views)
    with RecordingReader(folder / "bag") as reader:
        yield list(RecordedFrames(reader, "eye"))


def test_keypoints_are_known_of_recorded_frames(frames: list[Frame]) -> None:
    """COCO's, in the world and in the picture; they move as the person walks."""
    noses = []
    for frame in frames:
        assert frame.states is not None
        (eve,) = frame.states.skeletons
        points = frame.keypoints(eve)
        assert points.names == COCO_KEYPOINTS
        noses.append(points.world[0])
        joints = frame.joints(eve)
        head = joints.world[joints.names.index("head")]
        assert np.linalg.norm(points.world[0] - head) < 0.3
    assert np.linalg.norm(noses[-1] - noses[0]) > 0.02


def test_motion_between_recorded_frames_follows_the_skin(frames: list[Frame]) -> None:
    """It is that of the simulation, which had the vertices; without them limbs would be rigid."""
    for one, other in itertools.pairwise(frames):
        told = one["flow_forward"]
        moved = motion(with_skin(one), with_skin(other)).flow
        np.testing.assert_allclose(moved, told, atol=2e-3)
        limbs = ~np.isnan(told).any(axis=-1) & (one["instance"] > 1)
        rigid = motion(one, other).flow
        assert np.nanmax(np.abs(rigid - told)[limbs]) > 0.3


def test_frames_that_have_skin_or_need_none_stay_as_they_are(frames: list[Frame]) -> None:
    skinned = with_skin(frames[0])
    assert skinned.states is not None
    assert frames[0].info is not None
    clothes = [one.id for one in frames[0].info.instances if one.is_part]
    assert sorted(skinned.states.deformations) == [*skinned.states.skeletons, *clothes]
    assert with_skin(skinned) is skinned
    with pytest.raises(InvalidState, match="not known"):
        with_skin(replace(frames[0], info=None))
