"""Depth against arithmetic: planes, slopes, clip distances, unprojection, quantisation."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.types.geometry import Pose, look_at
from tests.render.conftest import Render
from tests.support.ray_cast import cast
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    model_of,
    snapshot_of,
    wall_mesh,
)

WALL = model_of(wall_mesh(400.0, 400.0))
CLIPS = [(0.05, 100.0), (0.5, 20.0)]


@pytest.mark.parametrize("distance", [0.75, 3.0, 17.5])
@pytest.mark.parametrize(("near", "far"), CLIPS)
def test_a_wall_ahead_has_one_depth(
    render: Render, distance: float, near: float, far: float
) -> None:
    """A plane at right angles to the axis has the same depth everywhere (not the same distance)."""
    scene = snapshot_of([Thing(WALL, Pose((distance, 0.0, 0.0)))])
    depth = render(scene, camera_at(near_m=near, far_m=far), "depth")["depth"]
    np.testing.assert_allclose(depth, distance, rtol=1e-6)


@pytest.mark.parametrize("yaw", [-70.0, -30.0, 10.0, 60.0])
@pytest.mark.parametrize(("near", "far"), CLIPS)
def test_a_slanted_wall_lies_where_rays_meet_it(
    render: Render, yaw: float, near: float, far: float
) -> None:
    """Depth of a plane through (4, 0, 0) turned about the vertical is that of its rays."""
    camera = camera_at(near_m=near, far_m=far, width=160, height=120)
    scene = snapshot_of([Thing(WALL, Pose.from_rpy_deg((4.0, 0.0, 0.0), (0.0, 0.0, yaw)))])
    depth = render(scene, camera, "depth")["depth"]
    expected = cast(scene, camera).depth
    inside = (expected > near * 1.001) & (expected < far * 0.999)
    assert inside.mean() > 0.5
    np.testing.assert_allclose(depth[inside], expected[inside], rtol=1e-5)


def test_a_floor_seen_at_a_grazing_angle(render: Render) -> None:
    """A huge floor 1.5 m below a level camera: depth f·h / (v - cy) to 1e-5, up to 40 m away."""
    floor = Thing(WALL, Pose.from_rpy_deg((0.0, 0.0, -1.5), (0.0, 90.0, 0.0)))
    camera = camera_at(width=64, height=480, far_m=1000.0)
    depth = render(snapshot_of([floor]), camera, "depth")["depth"]
    rows = np.arange(480) - camera.intrinsics.cy
    expected = camera.intrinsics.fy * 1.5 / rows[rows > 0]
    near_rows = expected < 40.0
    below = depth[rows > 0][near_rows]
    np.testing.assert_allclose(
        below, np.broadcast_to(expected[near_rows, None], below.shape), rtol=1e-5
    )
    assert np.isinf(depth[rows < 0]).all()


def test_unprojected_depth_lies_on_the_surface(render: Render) -> None:
    """Every pixel of a turned box, back in the body's frame, lies on one of its faces."""
    pose = Pose.from_rpy_deg((3.0, 0.2, -0.1), (20.0, 35.0, 50.0))
    camera = camera_at(look_at((0.1, -0.4, 0.3), (3.0, 0.0, 0.0)), width=200, height=150)
    scene = snapshot_of([Thing(model_of(box_mesh(1.0)), pose)])
    views = render(scene, camera, "depth", "instance")
    points = camera.intrinsics.unproject(views["depth"])[views["instance"] == 1]
    world = points @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
    body = (world - np.asarray(pose.position_m)) @ pose.matrix()[:3, :3]
    assert len(body) > 3000
    np.testing.assert_allclose(np.abs(body).max(axis=1), 0.5, atol=1e-5)


def test_what_is_nearer_than_near_covers_its_pixels_with_nan(render: Render) -> None:
    """A wall at half the near distance hides what is behind it: labelled, depth NaN."""
    scene = snapshot_of([Thing(WALL, Pose((5.0, 0, 0))), Thing(WALL, Pose((0.25, 0, 0)))])
    views = render(scene, camera_at(near_m=0.5), "depth", "instance", "flow_valid")
    assert np.isnan(views["depth"]).all()
    assert (views["instance"] == 2).all()


def test_what_is_farther_than_far_is_nothing(render: Render) -> None:
    """A wall beyond the far distance gives inf and the background's id."""
    scene = snapshot_of([Thing(WALL, Pose((25.0, 0, 0)))])
    views = render(scene, camera_at(far_m=20.0), "depth", "instance", "category")
    assert np.isposinf(views["depth"]).all()
    assert not views["instance"].any()
    assert not views["category"].any()


def test_a_wall_through_the_camera_is_cut_at_near_and_far(render: Render) -> None:
    """A side wall that runs from behind the camera to beyond far: right on both sides of each."""
    side = Thing(WALL, Pose.from_rpy_deg((0.0, 0.3, 0.0), (0.0, 0.0, 90.0)))
    camera = camera_at(near_m=0.5, far_m=4.0, width=160)
    scene = snapshot_of([side])
    views = render(scene, camera, "depth", "instance")
    expected = cast(scene, camera).depth
    margin = 1e-4
    inside = (expected > 0.5 + margin) & (expected < 4.0 - margin)
    np.testing.assert_allclose(views["depth"][inside], expected[inside], rtol=1e-5)
    too_near = expected < 0.5 - margin
    assert np.isnan(views["depth"][too_near]).all()
    assert (views["instance"][too_near] == 1).all()
    assert np.isinf(views["depth"][expected > 4.0 + margin]).all()
    assert too_near.any()
    assert inside.any()


def test_depth_is_not_quantised(render: Render) -> None:
    """A slanted wall gives nearly as many depths as pixels."""
    scene = snapshot_of([Thing(WALL, Pose.from_rpy_deg((4.0, 0, 0), (0.0, 23.0, 31.0)))])
    depth = render(scene, camera_at(width=320, height=240), "depth")["depth"]
    assert len(np.unique(depth)) > 0.9 * depth.size


@pytest.mark.parametrize(("width", "height"), [(8, 8), (9, 8), (641, 479), (33, 200)])
def test_any_size_gives_the_same_world(render: Render, width: int, height: int) -> None:
    """Odd sizes have no shifted rows: a slanted wall lies where rays meet it."""
    camera = camera_at(width=width, height=height)
    scene = snapshot_of([Thing(WALL, Pose.from_rpy_deg((4.0, 0, 0), (0.0, 20.0, 30.0)))])
    np.testing.assert_allclose(
        render(scene, camera, "depth")["depth"], cast(scene, camera).depth, rtol=1e-5
    )


def test_depth_does_not_depend_on_the_distance_from_the_world_s_origin(render: Render) -> None:
    """The same view 2 km away from the origin has the same depth to 1e-6."""
    pose = Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 20.0, 30.0))
    far_off = Pose((2003.0, -1500.0, 300.0), pose.orientation_xyzw)
    near_by = render(snapshot_of([Thing(WALL, pose)]), camera_at(), "depth")["depth"]
    away = render(
        snapshot_of([Thing(WALL, far_off)]), camera_at(Pose((2000.0, -1500.0, 300.0))), "depth"
    )["depth"]
    np.testing.assert_allclose(away, near_by, rtol=1e-6)
