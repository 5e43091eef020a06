"""The dict of one frame: SAILenv's keys and ours, each as documented."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import colour_instances
from tests.support.small_frame import small_frame

NAN = math.nan
CAMERA = Camera(
    intrinsics=CameraIntrinsics(width=8, height=9),
    pose=Pose.from_rpy_deg((1.0, 2.0, 3.0), (0.0, 10.0, 90.0)),
)


def made_of(**views: np.ndarray) -> dict[str, Any]:
    """Make the dict of these views, which are handed over."""
    return frame_of(**views).to_dict(copy=False)


def frame_of(**views: np.ndarray) -> Frame:
    """Make a frame of these views."""
    about = {"scene": "optical", "sequence": 3, "stamp_ns": 2_000_000_001, "dt_ns": 33_333_333}
    return small_frame(views, camera=CAMERA, depth_range_m=10.0, **about)


def test_a_copied_dict_leaves_the_frame_as_it_was() -> None:
    """Its arrays are the caller's own, and no value of the frame has changed."""
    flow = np.zeros((9, 8, 2), np.float32)
    flow[0, 0] = NAN
    depth = np.ones((9, 8), np.float32)
    frame = frame_of(flow=flow, depth=depth)
    entries = frame.to_dict()
    entries["depth_m"][:] = 0.0
    assert entries["flow"][0, 0].tolist() == [0.0, 0.0]
    assert np.isnan(frame["flow"][0, 0]).all()
    assert (frame["depth"] == 1.0).all()


def test_main_is_the_picture_in_the_order_of_opencv() -> None:
    """Blue comes first, and the bytes as received are counted."""
    rgb = np.arange(9 * 8 * 3, dtype=np.uint8).reshape(9, 8, 3)
    frame = made_of(rgb=rgb)
    assert np.array_equal(frame["main"], rgb[..., ::-1])
    assert frame["main"].flags.c_contiguous
    assert frame["sizes"] == {"main": 9 * 8 * 3}


def test_depth_comes_in_metres_and_as_a_picture() -> None:
    """`depth_m` is the view itself, `depth` has SAILenv's shape and type."""
    depth = np.full((9, 8), 2.5, np.float32)
    frame = made_of(depth=depth)
    assert frame["depth_m"] is depth
    assert (frame["depth"].shape, frame["depth"].dtype) == ((9, 8, 1), np.uint8)
    assert frame["sizes"] == {"depth": 9 * 8 * 4}


def test_instances_come_as_ids_and_as_colours() -> None:
    """No two instances share a colour, and the background is black."""
    ids = (np.arange(72, dtype=np.uint16) * 911).reshape(9, 8)
    frame = made_of(instance=ids)
    assert frame["instance"] is ids
    assert np.array_equal(frame["object"], colour_instances(ids)[..., ::-1])
    assert frame["object"][0, 0].tolist() == [0, 0, 0]
    assert len(np.unique(frame["object"].reshape(-1, 3), axis=0)) == len(np.unique(ids))


def test_flow_is_zero_where_it_does_not_exist() -> None:
    """Invalid flow is 0 there and False in `flow_valid`; the rest is untouched."""
    flow = np.ones((9, 8, 2), np.float32)
    flow[2, 3] = NAN
    frame = made_of(flow=flow)
    assert frame["flow_valid"].dtype == np.bool_
    assert np.argwhere(~frame["flow_valid"]).tolist() == [[2, 3]]
    assert frame["flow"][2, 3].tolist() == [0.0, 0.0]
    assert (frame["flow"][frame["flow_valid"]] == 1.0).all()


def test_other_views_keep_their_names() -> None:
    """Category and the views beyond the five are handed on as they are."""
    category, normals = np.ones((9, 8), np.uint8), np.zeros((9, 8, 3), np.float32)
    frame = made_of(category=category, normals=normals)
    assert frame["category"] is category
    assert frame["normals"] is normals
    assert frame["sizes"] == {"category": 72, "normals": 864}


def test_what_belongs_to_the_frame_is_told() -> None:
    """Times, number, scene and the camera: K and its optical frame in the world."""
    frame = made_of()
    assert (frame["sequence"], frame["scene"], frame["stamp_ns"]) == (3, "optical", 2_000_000_001)
    assert frame["dt"] == frame["deltaTime"] == pytest.approx(0.033333333, abs=1e-12)
    assert np.array_equal(frame["K"], CAMERA.intrinsics.K)
    assert np.array_equal(frame["world_from_camera"], CAMERA.world_from_camera)
    frame["world_from_camera"][0, 3] = 99.0
    assert CAMERA.world_from_camera[0, 3] == 1.0
