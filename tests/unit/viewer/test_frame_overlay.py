"""What is drawn over a frame, as the page is told: objects, tracks, the image circle."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
import pytest

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.skeleton import COCO_KEYPOINTS, COCO_SKELETON, Skeleton
from sailenv_ros.viewer.frame_overlay import (
    PIECES,
    image_circle,
    overlay_of,
    seen_points,
    seen_segments,
)
from sailenv_ros.viewer.scene_json import lens_to_json
from tests.support.small_frame import small_frame
from tests.unit.frame.truth.test_object_table import frame_of

FISHEYE = CameraIntrinsics(
    width=81, height=61, fx_px=20.0, fy_px=20.0, cx_offset_px=3.0, max_angle_deg=100.0,
    distortion_model="equidistant", distortion=(0.0, 0.0, 0.0, 0.0),
)  # fmt: skip
EYE = Camera(intrinsics=FISHEYE, pose=Pose((1.0, 2.0, 3.0)))


def masks_of(only: int = 0) -> AmodalMasks:
    assert only == 3, "no other object is drawn"
    return AmodalMasks(
        height=30, width=40, ids=np.array([3], np.uint16), pixels=np.array([100]),
        whole_pixels=np.array([100]), boxes=np.array([[5, 6, 14, 15]], np.int32),
        whole_boxes=np.array([[5, 6, 14, 15]], np.int32), crops=(np.ones((10, 10), bool),),
    )  # fmt: skip


def test_boxes_edges_and_the_outline_are_told() -> None:
    """Of visible objects alone; JSON holds it; what is not asked for is empty."""
    instance = np.zeros((30, 40), np.uint16)
    instance[5:20, 7:31] = 3
    frame = replace(frame_of(instance=instance), draw_amodal=masks_of)
    told = json.loads(json.dumps(overlay_of(frame, boxes=True, space=True, whole=3)))
    assert told["boxes"] == [[3, 7, 5, 30, 19]]
    ((id_, edges),) = told["edges"]
    assert (id_, len(edges)) == (3, 12)
    corner = np.round(frame.objects.corner_pixels[0, 0], 1).tolist()
    assert edges[0][:2] == corner
    (line,) = told["whole"]
    assert sorted(zip(line[::2], line[1::2], strict=True)) == [(5, 6), (5, 15), (14, 6), (14, 15)]
    assert not any(overlay_of(frame).values())
    with pytest.raises(InvalidState, match="no amodal masks"):
        overlay_of(frame_of(instance=instance), whole=3)


def by_arithmetic(point: tuple[float, float, float]) -> tuple[float, float]:
    """Where `EYE`, which looks along x, sees a point: f θ from the axis."""
    ahead, left, up = np.subtract(point, (1.0, 2.0, 3.0))
    radius = 20.0 * math.atan2(math.hypot(left, up), ahead)
    length = math.hypot(left, up)
    return 43.0 - radius * left / length, 30.0 - radius * up / length


def test_a_track_is_seen_through_a_fisheye() -> None:
    """Waypoints beside and behind the eye too, if the lens sees them; none too near or unseen."""
    places = [(3.0, 1.0, 3.5), (0.9, 5.0, 3.0), (-4.0, 2.0, 3.1), (1.0, 2.0, 3.01)]
    frame = replace(frame_of(), camera=EYE)
    told = overlay_of(frame, track=[Pose(place) for place in places])
    assert [number for number, *_ in told["waypoints"]] == [1, 2]
    for (_, *pixel), place in zip(told["waypoints"], places, strict=False):
        assert pixel == pytest.approx(by_arithmetic(place), abs=0.051)
    first = told["track"][:PIECES]
    assert first[0][:2] == told["waypoints"][0][1:]
    assert first[-1][2:] == told["waypoints"][1][1:]
    assert all(before[2:] == after[:2] for before, after in pairwise(first))
    for at, piece in enumerate(first):
        between = np.asarray(places[0]) + at / PIECES * np.subtract(places[1], places[0])
        assert piece[:2] == pytest.approx(by_arithmetic(tuple(between)), abs=0.051)
    closed = overlay_of(frame, track=[Pose(place) for place in places[:2]], loop=True)
    assert len(closed["track"]) == 2 * PIECES


def test_edges_are_bent_by_a_fisheye_alone() -> None:
    """Through a pin-hole an edge is one piece; through a fisheye each piece lies on its curve."""
    instance = np.zeros((30, 40), np.uint16)
    instance[5:20, 7:31] = 3
    frame = frame_of(instance=instance)
    lens = replace(FISHEYE, width=40, height=30)
    bent = replace(frame, camera=replace(frame.camera, intrinsics=lens))
    ((_, pieces),) = overlay_of(bent, space=True)["edges"]
    assert len(pieces) == 12 * PIECES
    corners = np.round(bent.objects.corner_pixels[0], 1)
    assert pieces[0][:2] == tuple(corners[0])
    assert pieces[-1][2:] == tuple(corners[-1])


def test_no_line_leads_across_the_seam() -> None:
    """Behind a camera that sees all around, a line leaves on one side and comes on the other."""
    lens = CameraIntrinsics(
        width=200, height=100, fx_px=200 / math.tau, fy_px=100 / math.pi,
        distortion_model="equirectangular",
    )  # fmt: skip
    (line,) = seen_segments(Camera(intrinsics=lens), [(-1.0, 1.0, 0.1)], [(-1.0, -1.1, 0.1)])
    assert len(line) == PIECES - 1
    assert all(abs(u1 - u0) < 30.0 for u0, _, u1, _ in line)
    left, right = seen_points(Camera(intrinsics=lens), [(-1.0, 1.0, 0.1), (-1.0, -1.1, 0.1)])
    assert left[0] < 50.0 < 150.0 < right[0]


def test_the_image_circle_is_the_border_of_what_is_seen() -> None:
    """Filled it is `valid_pixels`; a lens that sees with each pixel has none."""
    lens = replace(FISHEYE, max_angle_deg=70.0)
    (line,) = image_circle(lens)
    filled = np.zeros((61, 81), np.uint8)
    cv2.fillPoly(filled, [np.reshape(line, (-1, 2))], 1)
    np.testing.assert_array_equal(filled.astype(bool), lens.valid_pixels())
    radii = np.hypot(*(np.reshape(line, (-1, 2)) - (lens.cx, lens.cy)).T)
    assert radii.max() == pytest.approx(20.0 * math.radians(70.0), abs=1.0)
    assert image_circle(CameraIntrinsics()) == []
    frame = replace(frame_of(), camera=Camera(intrinsics=lens))
    assert overlay_of(frame, circle=True)["circle"] == [line]


def test_a_lens_is_told_by_its_numbers() -> None:
    """Coefficients by their names; that of parallel rays has no angle."""
    told = json.loads(json.dumps(lens_to_json(FISHEYE)))
    assert told["coefficients"] == [["k1", 0.0], ["k2", 0.0], ["k3", 0.0], ["k4", 0.0]]
    assert (told["model"], told["max_angle_deg"]) == ("equidistant", pytest.approx(100.0))
    assert [told[name] for name in ("fx", "fy", "cx", "cy")] == [20.0, 20.0, 43.0, 30.0]
    plain = lens_to_json(CameraIntrinsics())
    assert (plain["model"], plain["coefficients"]) == ("pinhole", [])
    flat = CameraIntrinsics(fx_px=100.0, fy_px=100.0, distortion_model="orthographic")
    assert lens_to_json(flat)["max_angle_deg"] is None


def test_people_are_lines_between_keypoints_that_are_seen_or_hidden() -> None:
    """Keypoints of COCO two metres ahead; before those on the left stands another thing."""
    across = np.linspace(-0.5, 0.5, len(COCO_KEYPOINTS))
    points = np.stack([np.full_like(across, 2.0), -across, 0.3 * across], axis=1)
    skeleton = Skeleton(
        joint_names=("root",), parents=np.array([-1]), world_from_joint=np.eye(4)[None, :3],
        point_names=COCO_KEYPOINTS, points=points,
    )  # fmt: skip
    states = InstanceStates(
        ids=np.array([3], np.uint16), positions=np.zeros((1, 3)),
        orientations=np.array([[0.0, 0.0, 0.0, 1.0]]), linear_velocities=np.zeros((1, 3)),
        angular_velocities=np.zeros((1, 3)), skeletons={3: skeleton},
    )  # fmt: skip
    instance = np.full((60, 80), 3, np.uint16)
    depth = np.full((60, 80), 2.0, np.float32)
    instance[:, :40], depth[:, :40] = 9, 1.0
    frame = replace(
        small_frame({"instance": instance, "depth": depth}, 80, 60), states=states,
        info=frame_of().info,
    )  # fmt: skip
    told = json.loads(json.dumps(overlay_of(frame, people=True)))
    ((id_, limbs, places),) = told["people"]
    assert (id_, len(limbs), len(places)) == (3, len(COCO_SKELETON), len(COCO_KEYPOINTS))
    pixels = np.round(seen_points(frame.camera, points), 1).tolist()
    assert [place[:2] for place in places] == pixels
    assert [seen for *_, seen in places] == [u >= 39.5 for u, _ in pixels]
    first, last = COCO_SKELETON[0]
    assert limbs[0] == [*pixels[first - 1], *pixels[last - 1]]
    assert not overlay_of(frame)["people"]
