"""A frame's values at a pixel, the place that is seen there, and its message."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.colours import view_picture
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Instance
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import VIEWS
from sailenv_ros.viewer.encoding import FrameMessages, outline, view_png, views_to_json
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from tests.support.small_frame import small_frame
from tests.support.tiny_scenes import CATEGORIES

WIDTH, HEIGHT = 12, 9


def frame_of(pose: Pose | None = None, **views: Any) -> Frame:
    """A small frame of the given views."""
    lens = CameraIntrinsics(width=WIDTH, height=HEIGHT, vertical_fov_deg=90.0)
    camera = Camera(intrinsics=lens, pose=pose or Pose())
    about = {"scene": "test", "sequence": 7, "stamp_ns": 1_500_000_000}
    return small_frame(views, camera=camera, timings_s={"render": 0.002}, **about)


def info_with(name: str) -> SceneInfo:
    """A scene of one object, number 300."""
    instance = Instance(
        id=300, name=name, asset="cube", category_id=5, category="kind 5", static=False
    )
    return SceneInfo(
        scene="test",
        scenes=("test",),
        epoch=1,
        revision=1,
        sim_time_ns=0,
        mode="realtime",
        paused=False,
        real_time_factor=1.0,
        seed=0,
        categories=CATEGORIES,
        instances=(instance,),
    )


def numbered_views() -> dict[str, Any]:
    """Arrays in which no two pixels are alike."""
    rng = np.random.default_rng(3)
    return {
        "rgb": rng.integers(0, 256, (HEIGHT, WIDTH, 3)).astype(np.uint8),
        "depth": rng.uniform(0.1, 9.0, (HEIGHT, WIDTH)).astype(np.float32),
        "category": np.full((HEIGHT, WIDTH), 5, np.uint8),
        "instance": np.full((HEIGHT, WIDTH), 300, np.uint16),
        "flow": rng.normal(0.0, 90.0, (HEIGHT, WIDTH, 2)).astype(np.float32),
    }


def test_the_values_told_are_those_of_the_arrays() -> None:
    """Not rounded: a float32 goes through JSON unchanged."""
    views = numbered_views()
    told = json.loads(json.dumps(values_at(frame_of(**views), info_with("box"), 4, 6)))
    assert np.float32(told["depth"]) == views["depth"][6, 4]
    assert np.array_equal(np.float32(told["flow"]), views["flow"][6, 4])
    assert told["rgb"] == views["rgb"][6, 4].tolist()
    assert (told["instance"], told["instance_id"]) == ("box", 300)
    assert (told["category"], told["category_id"]) == ("kind 5", 5)


def test_what_does_not_exist_is_told_as_such() -> None:
    """Nothing hit, nearer than the near plane, no flow: none of them is a number."""
    views = numbered_views()
    views["depth"][0, :2] = (math.inf, math.nan)
    views["flow"][0, 0] = math.nan
    frame = frame_of(**views)
    assert values_at(frame, info_with("box"), 0, 0)["depth"] is None
    assert values_at(frame, info_with("box"), 0, 0)["flow"] is None
    assert values_at(frame, info_with("box"), 1, 0)["depth"] == "near"


def test_beside_the_image_circle_nothing_is_told_or_placed() -> None:
    """A pixel that sees nothing is not near, and nothing can stand there."""
    lens = CameraIntrinsics(
        width=WIDTH, height=HEIGHT, fx_px=4.0, fy_px=4.0, max_angle_deg=60.0,
        distortion_model="equidistant", distortion=(0.0, 0.0, 0.0, 0.0),
    )  # fmt: skip
    views = {"depth": np.full((HEIGHT, WIDTH), math.nan, np.float32)}
    frame = replace(frame_of(**views), camera=Camera(intrinsics=lens))
    assert values_at(frame, info_with("box"), 0, 0)["depth"] is None
    assert values_at(frame, info_with("box"), 6, 4)["depth"] == "near"
    with pytest.raises(InvalidRequest, match="lens sees"):
        standing_point(frame, 0, 0)


@pytest.mark.parametrize(
    "pixel", [(-1, 0), (WIDTH, 0), (0, HEIGHT), (1.5, 0), (True, 0), (None, 0)]
)
def test_a_pixel_outside_is_refused(pixel: tuple[Any, Any]) -> None:
    """So is what is no pixel."""
    with pytest.raises(InvalidRequest):
        pixel_of(frame_of(**numbered_views()), *pixel)


def test_something_stands_on_the_floor_that_is_seen() -> None:
    """A camera 2 m up that looks down sees its own foot in the middle, half a pixel aside."""
    down = Pose.from_rpy_deg((1.0, -2.0, 2.0), (0.0, 90.0, 0.0))
    frame = frame_of(down, depth=np.full((HEIGHT, WIDTH), 2.0, np.float32))
    x, y, z = standing_point(frame, 6, 4)
    half_px_m = 2.0 * 0.5 / frame.camera.intrinsics.fx
    assert (x, z) == (pytest.approx(1.0), pytest.approx(0.005, abs=1e-9))
    assert y == pytest.approx(-2.0 - half_px_m)


def test_something_stands_before_a_wall() -> None:
    """A wall 3 m ahead: 30 cm are left for what is put there."""
    frame = frame_of(depth=np.full((HEIGHT, WIDTH), 3.0, np.float32))
    x, _, z = standing_point(frame, 6, 4)
    assert x == pytest.approx(2.7)
    assert z == pytest.approx(0.0, abs=1e-9)


def test_where_nothing_is_near_it_is_put_ahead() -> None:
    """Three metres: half of what counts as near."""
    frame = frame_of(depth=np.full((HEIGHT, WIDTH), np.inf, np.float32))
    assert standing_point(frame, 6, 4)[0] == pytest.approx(3.0)


def test_a_message_holds_what_it_says() -> None:
    """Ids come through the PNG unharmed; what is visible is counted."""
    views = numbered_views()
    views["instance"][:3] = 0
    views["category"][:3] = 9
    frame = frame_of(**views)
    messages = FrameMessages(frame, categories=CATEGORIES, depth_range_m=10.0)
    message = messages.message(("rgb", "category"), number=4, selected=300, dropped=2)
    size = int.from_bytes(message[:4], "little")
    head = json.loads(message[4 : 4 + size])
    assert (head["number"], head["sequence"], head["time_s"]) == (4, 7, 1.5)
    assert head["dropped"] == 2
    assert head["visible"] == [[300, WIDTH * (HEIGHT - 3)]]
    assert head["outline"] == [[0, 3, 0, 8, 11, 8, 11, 3]]
    at = 4 + size
    for view, kept in zip(head["views"], ("rgb", "category"), strict=True):
        assert view["name"] == kept
        data = np.frombuffer(message[at : at + view["size"]], np.uint8)
        picture = cv2.imdecode(data, cv2.IMREAD_COLOR)[..., ::-1]
        wanted = view_picture(kept, views[kept], table=CATEGORIES)
        assert picture.shape == wanted.shape
        if view["mime"] == "image/png":
            assert np.array_equal(picture, wanted)
        at += view["size"]
    assert at == len(message)


def test_a_picture_is_made_once_for_all_clients(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second client of a frame is sent the same pictures."""
    made: list[str] = []

    def counted(view: str, *rest: Any, **settings: Any) -> Any:
        made.append(view)
        return view_picture(view, *rest, **settings)

    monkeypatch.setattr("sailenv_ros.viewer.encoding.view_picture", counted)
    frame = frame_of(**numbered_views())
    messages = FrameMessages(frame, categories=CATEGORIES, depth_range_m=10.0)
    first = messages.message(("rgb", "depth"), number=1)
    assert messages.message(("rgb", "depth"), number=1) == first
    assert len(messages.message(("depth",), number=1)) < len(first)
    assert made == ["rgb", "depth"]


def test_a_screenshot_loses_nothing() -> None:
    """The picture's pixels are the array's."""
    views = numbered_views()
    data = view_png(frame_of(**views), "rgb", categories=CATEGORIES, depth_range_m=10.0)
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
    assert np.array_equal(picture, views["rgb"])


def test_an_outline_goes_around_holes_too() -> None:
    """A ring has a line outside and one inside; an absent id has none."""
    ring = np.zeros((9, 9), np.uint16)
    ring[1:8, 1:8] = 7
    ring[3:6, 3:6] = 0
    assert len(outline(ring, 7)) == 2
    assert outline(ring, 8) == []


def test_every_view_is_told_of_a_pixel() -> None:
    """Views that the page has no words for are told as numbers, or None where there are none."""
    rng = np.random.default_rng(5)
    views: dict[str, Any] = {
        name: rng.integers(0, 2, spec.shape(HEIGHT, WIDTH)).astype(spec.dtype)
        for name, spec in VIEWS.items()
    }
    views["normals"][6, 4] = (0.25, -0.5, 0.75)
    views["normals"][0, 0] = math.nan
    frame = frame_of(**views)
    told = json.loads(json.dumps(values_at(frame, info_with("box"), 4, 6)))
    assert told.keys() == {*VIEWS, "category_id", "instance_id", "u", "v", "sequence"}
    assert told["normals"] == [0.25, -0.5, 0.75]
    assert told["occlusion"] is bool(views["occlusion"][6, 4])
    assert values_at(frame, info_with("box"), 0, 0)["normals"] is None


def test_the_page_is_told_of_the_views_that_can_be_rendered() -> None:
    """In their order, with what it needs to lay them out and to write their values."""
    told = views_to_json(("rgb", "depth", "occlusion"))
    assert [(view["name"], view["shown"], view["unit"]) for view in told] == [
        ("rgb", True, ""),
        ("depth", True, "m"),
        ("occlusion", False, ""),
    ]
