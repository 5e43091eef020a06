"""Cameras of a rig in a scene file: what they become, and what is refused where."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros import Pose
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.rigs import RigCamera
from tests.unit.scene.reading import diagnostics, read

SCENE = """\
version: 1
agents:
  - name: head
    rate: 10
    cameras:
      - {name: left, width: 64, height: 48, position: [0, 0.06, 0]}
      - {name: down, rotation: [0, 45, 0], views: [range], depth_range: 5,
         fx: 100, fy: 90, distortion_model: equidistant,
         distortion: [0.1, 0, 0, 0], max_angle: 95, picture: {bloom: 0.5}}
"""

LEFT = "{name: left, width: 64, height: 48, position: [0, 0.06, 0]}"


def test_cameras_of_a_rig(tmp_path: Path) -> None:
    """Lens, extrinsics, views and picture of each, in the order of the file."""
    (agent,) = read(tmp_path, SCENE).agents
    spec = agent.to_agent_spec()
    assert spec.cameras == {
        "left": RigCamera(
            intrinsics=CameraIntrinsics(width=64, height=48), extrinsics=Pose((0.0, 0.06, 0.0))
        ),
        "down": RigCamera(
            intrinsics=CameraIntrinsics(
                fx_px=100.0,
                fy_px=90.0,
                distortion_model="equidistant",
                distortion=(0.1, 0.0, 0.0, 0.0),
                max_angle_deg=95.0,
            ),
            extrinsics=Pose.from_rpy_deg((0, 0, 0), (0, 45, 0)),
            views=("range",),
            depth_range_m=5.0,
            picture=PictureSettings(bloom=0.5),
        ),
    }
    assert list(spec.cameras) == ["left", "down"]
    assert [camera.name for camera in spec.camera_specs] == ["head/left", "head/down"]
    assert {camera.rate_hz for camera in spec.camera_specs} == {10.0}
    assert (
        read(tmp_path, "version: 1\nagents: [{name: eye}]").agents[0].to_agent_spec().cameras
        is None
    )


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            "{name: left, width: 64, following: false}",
            "6:33: agents[0].cameras[0].following: is not a key that is known here",
        ),
        (
            "{name: down, width: 64}",
            "7:16: agents[0].cameras[1].name: must be unique among cameras, but cameras[0] has",
        ),
        ("{name: Left}", "6:16: agents[0].cameras[0].name: must be a lower-case letter"),
        ("{width: 64}", "6:9: agents[0].cameras[0].name: is missing"),
        (
            "{name: left, position: [0, 0.06]}",
            "6:32: agents[0].cameras[0].position: must be three numbers [x, y, z] in [m], got",
        ),
        (
            "{name: left, rotation: [0, 0, 0], orientation: [0, 0, 0, 1]}",
            "6:56: agents[0].cameras[0].orientation: cannot stand beside rotation",
        ),
        (
            "{name: left, distortion_model: plumb_bob, distortion: [1]}",
            "6:63: agents[0].cameras[0].distortion: must be 4 or 5 finite numbers",
        ),
        ("{name: left, near: 3, far: 2}", "6:28: agents[0].cameras[0].near: is refused: near must"),
    ],
)
def test_a_wrong_camera_is_told_where_it_stands(tmp_path: Path, entry: str, message: str) -> None:
    """With what is accepted."""
    (found,) = diagnostics(tmp_path, SCENE.replace(LEFT, entry))
    assert found.startswith(message)


def test_a_rig_without_cameras_is_refused(tmp_path: Path) -> None:
    """A rig has at least one; an agent without the key is none."""
    for cameras, message in (
        ("[]", "3:27: agents[0].cameras: must be a list of at least 1 entry, got 0"),
        ("{left: {}}", "3:27: agents[0].cameras: must be a list (each entry begins with -)"),
    ):
        text = f"version: 1\nagents:\n  - {{name: head, cameras: {cameras}}}"
        (found,) = diagnostics(tmp_path, text)
        assert found.startswith(message)
