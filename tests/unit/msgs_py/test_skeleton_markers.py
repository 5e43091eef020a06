"""Markers of skeletons."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_msgs_py.frame_info import WORLD_FRAME_ID, header_of_frame
from sailenv_msgs_py.skeleton_markers import HIDDEN, SEEN, skeleton_markers_to_msg
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.types.geometry import look_at

pytestmark = [pytest.mark.ros, pytest.mark.slow]

SCENE = """
version: 1
room: {size: [5, 5, 2.6]}
objects:
  - {name: anna, asset: person_01, position: [1, 0, 0]}
  - {name: rex, asset: dog_01, position: [1, 1, 0]}
  - {name: stool, asset: stool_01, position: [0.4, 0, 0]}
"""


def test_markers_are_bones_and_keypoints_in_the_world(tmp_path: Path) -> None:
    path = tmp_path / "two.yaml"
    path.write_text(SCENE)
    lens = CameraIntrinsics(width=160, height=120, vertical_fov_deg=60.0)
    eye = AgentSpec(name="eye", intrinsics=lens, following=False)
    with Simulation(path, mode="lockstep", agent=eye, light="plain") as simulation:
        simulation.set_pose(look_at((-2.0, 0.0, 0.9), (1.0, 0.2, 0.8)), teleport=True)
        frame = simulation.capture(["depth", "instance"])
    header = header_of_frame(frame)
    first, *markers = skeleton_markers_to_msg(frame, header).markers
    assert first.action == first.DELETEALL
    assert all(one.header.frame_id == WORLD_FRAME_ID for one in (first, *markers))
    assert all(one.header.stamp == header.stamp for one in (first, *markers))
    anna, rex = (next(i.id for i in frame.info.instances if i.name == n) for n in ("anna", "rex"))
    assert [(one.ns, one.id) for one in markers] == [
        ("bones", anna), ("keypoints", anna), ("bones", rex),
    ]  # fmt: skip
    places = [np.array([(p.x, p.y, p.z) for p in one.points]) for one in markers]
    for id_, ends in ((anna, places[0]), (rex, places[2])):
        own = frame.states.skeletons[id_]
        joined = [
            (own.joints[p], j) for p, j in zip(own.parents, own.joints, strict=True) if p >= 0
        ]
        assert np.array_equal(ends, np.concatenate([np.stack(pair) for pair in joined]))
    found = frame.keypoints(anna)
    assert np.array_equal(places[1], found.world)
    colours = [(c.r, c.g, c.b) for c in markers[1].colors]
    expected = [SEEN if seen else HIDDEN for seen in found.visible]
    assert np.allclose(colours, expected)
    assert found.visible.any()
    assert not found.visible.all()  # the stool hides an ankle
