"""The table of a frame's objects: each column against arithmetic."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.frame.truth.object_table import CORNER_SIGNS, EDGES
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import CategoryTable, Instance, Keypoint
from sailenv_ros.types.scene_info import SceneInfo
from tests.support.small_frame import small_frame

LENS = CameraIntrinsics(width=40, height=30, vertical_fov_deg=60.0)
CAMERA = Camera(intrinsics=LENS, pose=Pose((0.5, -0.2, 1.0)))
PLACES = (Pose.from_rpy_deg((3.0, 0.0, 1.0), (10.0, 20.0, 30.0)), Pose((-2.0, 0.0, 1.0)))


def instance_of(id_: int, **changes: object) -> Instance:
    made = Instance(
        id=id_,
        name=f"thing {id_}",
        asset="cube",
        category_id=1,
        category="cube",
        static=id_ == 2,
        low_m=(-0.5, -0.25, 0.0),
        high_m=(0.5, 0.25, 1.0),
    )
    return replace(made, **changes)  # type: ignore[arg-type]  # of any field


def frame_of(*instances: Instance, with_states: bool = True, **views: np.ndarray) -> Frame:
    """A frame with an object before the camera and one behind it, in any order."""
    states = InstanceStates(
        ids=np.array([3, 7], np.uint16),
        positions=np.array([pose.position_m for pose in PLACES]),
        orientations=np.array([pose.orientation_xyzw for pose in PLACES]),
        linear_velocities=np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]),
        angular_velocities=np.array([[0.1, 0.2, 0.3], [0.0, 0.0, 0.0]]),
    )
    info = SceneInfo(
        scene="hand", scenes=("hand",), epoch=1, revision=1, sim_time_ns=0, mode="lockstep",
        paused=False, real_time_factor=1.0, seed=0, categories=CategoryTable(),
        instances=instances or (instance_of(7), instance_of(3, parent=7)),
    )  # fmt: skip
    known = states if with_states else None
    return small_frame(views, scene="hand", dt_ns=1, camera=CAMERA, info=info, states=known)


def test_poses_boxes_and_corners() -> None:
    """By matrices of poses, corner by corner, in the order of the ids."""
    table = frame_of().objects
    assert table.ids.tolist() == [3, 7]
    assert table.parents.tolist() == [7, 0]
    for row, pose in enumerate(PLACES):
        matrix = pose.matrix()
        np.testing.assert_allclose(table.world_from_object[row], matrix, atol=1e-12)
        seen = CAMERA.camera_from_world @ matrix
        np.testing.assert_allclose(table.camera_from_object[row], seen, atol=1e-12)
        own = np.array([0.0, 0.0, 0.5]) + CORNER_SIGNS * (0.5, 0.25, 0.5)
        world = own @ matrix[:3, :3].T + matrix[:3, 3]
        np.testing.assert_allclose(table.corners[row], world, atol=1e-12)
        optical = world @ CAMERA.camera_from_world[:3, :3].T + CAMERA.camera_from_world[:3, 3]
        np.testing.assert_allclose(table.corner_pixels[row], LENS.project(optical), atol=1e-9)
        centre = matrix[:3, :3] @ (0.0, 0.0, 0.5) + matrix[:3, 3]
        np.testing.assert_allclose(table.box_centres[row], centre, atol=1e-12)
        away = np.linalg.norm(centre - CAMERA.pose.position_m)
        assert table.distances[row] == pytest.approx(away)
    assert np.isnan(table.corner_pixels[1]).all(), "it is behind the camera"
    assert table.box_sizes.tolist() == [[1.0, 0.5, 1.0]] * 2
    assert table.linear_velocities[0].tolist() == [1.0, 2.0, 3.0]
    assert len(EDGES) == 12


def test_corners_are_hidden_by_what_is_seen_before_them() -> None:
    """A corner in the picture is visible unless a surface is nearer there."""
    free = frame_of(depth=np.full((30, 40), np.inf, np.float32)).objects
    inside = (free.corner_pixels[0] > -0.5).all(axis=1) & (
        free.corner_pixels[0] < (39.5, 29.5)
    ).all(axis=1)
    assert inside.any()
    assert (free.corners_visible[0] == inside).all()
    assert not free.corners_visible[1].any()
    for depth in (0.5, np.nan):
        hidden = frame_of(depth=np.full((30, 40), depth, np.float32)).objects
        assert not hidden.corners_visible.any()


def test_pixels_are_told_of_what_is_seen_alone() -> None:
    """At the picture's border, too; what no pixel shows has -1."""
    instance = np.zeros((30, 40), np.uint16)
    instance[0, 0], instance[29, 39] = 3, 3
    flow = np.zeros((30, 40, 2), np.float32)
    flow[0, 0] = (2.0, -4.0)
    table = frame_of(instance=instance, flow=flow).objects
    assert table.visible_pixels.tolist() == [2, 0]
    assert table.visible_boxes.tolist() == [[0, 0, 39, 29], [-1, -1, -1, -1]]
    np.testing.assert_allclose(table.flow[0], (1.0, -2.0))
    assert np.isnan(table.flow[1]).all()
    assert table.visible.tolist() == [True, False]
    assert np.isnan(table.visible_share).all()


def test_amodal_columns_are_those_of_the_masks() -> None:
    """Shares follow from counts of pixels; objects without masks have none."""
    instance = np.zeros((30, 40), np.uint16)
    instance[3:5, 6:8] = 3
    masks = AmodalMasks(
        height=30, width=40,
        ids=np.array([3, 9], np.uint16),
        pixels=np.array([8, 1]), whole_pixels=np.array([16, 1]),
        boxes=np.array([[6, 3, 9, 4], [0, 0, 0, 0]], np.int32),
        whole_boxes=np.array([[2, 3, 9, 4], [0, 0, 0, 0]], np.int32),
        crops=(np.ones((2, 4), bool), np.ones((1, 1), bool)),
    )  # fmt: skip
    frame = replace(frame_of(instance=instance), draw_amodal=lambda: masks)
    table = frame.objects_with_amodal
    assert table.visible_share[0] == 0.5
    assert table.truncated_share[0] == 0.5
    assert table.whole_boxes[0].tolist() == [2, 3, 9, 4]
    assert (table.amodal_pixels[1], table.whole_pixels[1]) == (-1, -1)
    assert np.isnan(table.visible_share[1])
    assert masks.mask(3).sum() == 8
    with pytest.raises(InvalidRequest, match="4"):
        masks.mask(4)
    with pytest.raises(InvalidState, match="depth"):
        masks.depth(3)


def test_rows_are_selected_and_listed() -> None:
    """By truth values and by numbers; as plain values."""
    table = frame_of().objects
    assert table.select(table.static).ids.tolist() == []
    assert table.select([1]).names == ("thing 7",)
    assert table.select(np.array([], int)).corners.shape == (0, 8, 3)
    rows = list(table.rows())
    assert [row["id" + "s"] for row in rows] == [3, 7]
    assert table.row(7) == 1
    with pytest.raises(InvalidRequest, match="5"):
        table.row(5)
    assert "2 objects, 0 of them visible" in table._repr_html_()


def test_keypoints_are_those_of_the_asset_or_the_corners() -> None:
    """In the object's own frame, projected as everything is."""
    named = instance_of(3, keypoints=(Keypoint(name="tip", position_m=(0.0, 0.0, 1.0)),))
    frame = frame_of(named, instance_of(7), depth=np.full((30, 40), np.inf, np.float32))
    tip = frame.keypoints(3)
    matrix = PLACES[0].matrix()
    world = matrix[:3, :3] @ (0.0, 0.0, 1.0) + matrix[:3, 3]
    assert tip.names == ("tip",)
    np.testing.assert_allclose(tip.world[0], world)
    optical = CAMERA.camera_from_world[:3, :3] @ world + CAMERA.camera_from_world[:3, 3]
    np.testing.assert_allclose(tip.pixels[0], LENS.project(optical))
    assert tip.visible.tolist() == [True]
    corners = frame.keypoints(7)
    assert len(corners.names) == 8
    np.testing.assert_allclose(corners.world, frame.objects.corners[1])


def test_what_is_not_known_is_nan_or_refused() -> None:
    """Without states the pose is NaN; without a scene there is no table."""
    table = frame_of(with_states=False).objects
    assert np.isnan(table.world_from_object).all()
    assert np.isnan(table.distances).all()
    frame = replace(frame_of(), info=None)
    with pytest.raises(InvalidState, match="not recorded"):
        _ = frame.objects
    with pytest.raises(InvalidState, match="no amodal masks"):
        _ = frame.amodal


def test_points_are_the_pixels_places(tmp_path: object) -> None:
    """World and optical frame, colours and labels; what has no depth is left out."""
    depth = np.full((30, 40), np.inf, np.float32)
    depth[4, 5], depth[7, 8] = 2.0, np.nan
    rgb = np.zeros((30, 40, 3), np.uint8)
    rgb[4, 5] = (1, 2, 3)
    instance = np.full((30, 40), 3, np.uint16)
    frame = frame_of(depth=depth, rgb=rgb, instance=instance)
    cloud = frame.points()
    assert len(cloud) == 1
    ray = np.array([(5 - LENS.cx) / LENS.fx, (4 - LENS.cy) / LENS.fy, 1.0])
    np.testing.assert_allclose(frame.points(in_world=False).xyz[0], 2.0 * ray, rtol=1e-6)
    world = CAMERA.world_from_camera[:3, :3] @ (2.0 * ray) + CAMERA.world_from_camera[:3, 3]
    np.testing.assert_allclose(cloud.xyz[0], world, rtol=1e-6)
    assert (cloud.rgb[0].tolist(), cloud.instance[0], cloud.category[0]) == ([1, 2, 3], 3, 0)
    assert cloud.pixels.tolist() == [4 * 40 + 5]
    with pytest.raises(UnknownName, match="depth"):
        frame_of(rgb=rgb).points()
