"""The arithmetic that judges flow, against cases whose answer is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_bench.experiments.motion_field import BoxSolid, Instant, motion_field
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose

LENS = CameraIntrinsics(width=48, height=36)
WALL = BoxSolid(name="wall", instance_id=7, low=(0.0, -20.0, -20.0), high=(1.0, 20.0, 20.0))


def instant(camera: Pose, *boxes: Pose) -> Instant:
    return Instant(camera=Camera(intrinsics=LENS, pose=camera), poses=boxes)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(1.0, 9.0))
def test_a_wall_before_a_sideways_camera_moves_by_the_pin_hole_formula(
    left: float, up: float, distance: float
) -> None:
    """Displacement is f ΔX / Z at every pixel of a wall that faces the camera."""
    wall = Pose((distance, 0.0, 0.0))
    field = motion_field([WALL], instant(Pose((0.0, left, up)), wall), instant(Pose(), wall))
    expected = LENS.fx / distance * np.array([left, up])
    assert (field.instance == 7).all()
    np.testing.assert_allclose(
        field.displacement_px, np.broadcast_to(expected, (36, 48, 2)), atol=1e-9
    )


def test_a_wall_that_moves_is_as_a_camera_that_moves() -> None:
    """Only what moves relatively matters."""
    now, then = Pose((3.0, 0.2, -0.1)), Pose((3.0, 0.0, 0.0))
    field = motion_field([WALL], instant(Pose(), now), instant(Pose(), then))
    expected = LENS.fx / 3.0 * np.array([-0.2, 0.1])
    np.testing.assert_allclose(
        field.displacement_px, np.broadcast_to(expected, (36, 48, 2)), atol=1e-9
    )


@pytest.mark.parametrize("turn", [(0, 0, 2.0), (0, -3.0, 0), (5.0, 2.0, -4.0)])
def test_where_nothing_is_the_turn_of_the_camera_alone_counts(turn: tuple[float, ...]) -> None:
    """The homography K R K⁻¹, whatever way the camera went."""
    now = instant(Pose.from_rpy_deg((0.5, 0.2, 0.1), turn))
    then = instant(Pose())
    field = motion_field([], now, then)
    rotation = then.camera.camera_from_world[:3, :3] @ now.camera.world_from_camera[:3, :3]
    v, u = np.mgrid[0:36, 0:48]
    moved = np.stack([u, v, np.ones_like(u)], -1) @ (LENS.K @ rotation @ np.linalg.inv(LENS.K)).T
    expected = np.stack([u, v], -1) - moved[..., :2] / moved[..., 2:]
    assert not field.instance.any()
    np.testing.assert_allclose(field.displacement_px, expected, atol=1e-9)


def test_the_nearer_of_two_boxes_is_seen() -> None:
    """Order in the list does not matter."""
    near = BoxSolid(name="near", instance_id=3, low=(-0.2,) * 3, high=(0.2,) * 3)
    for boxes, poses in (
        ([WALL, near], (Pose((5.0, 0, 0)), Pose((2.0, 0, 0)))),
        ([near, WALL], (Pose((2.0, 0, 0)), Pose((5.0, 0, 0)))),
    ):
        field = motion_field(boxes, instant(Pose(), *poses), instant(Pose(), *poses))
        assert field.instance[18, 24] == 3
        assert field.instance[0, 0] == 7
        np.testing.assert_allclose(field.displacement_px, 0.0, atol=1e-12)


def test_what_was_behind_the_camera_has_no_motion() -> None:
    """Nan, and no nonsense number."""
    field = motion_field(
        [WALL], instant(Pose(), Pose((2.0, 0, 0))), instant(Pose(), Pose((-3.0, 0, 0)))
    )
    assert np.isnan(field.displacement_px).all()
