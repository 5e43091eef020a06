"""Optical flow against arithmetic: cameras and bodies that move, turn, stand still, come and go."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from tests.render.conftest import Render
from tests.support.ray_cast import cast, flow_by_arithmetic
from tests.support.tiny_scenes import (
    FORWARD,
    FRAME_NS,
    Thing,
    box_mesh,
    camera_at,
    checker,
    contents_of,
    model_of,
    moved,
    snapshot_of,
    wall_mesh,
)

DT_S = FRAME_NS * 1e-9
BOX = model_of(box_mesh(1.0))
WALL = model_of(wall_mesh(60.0, 60.0))

# What the arithmetic of float32 depth allows, far inside the promised 1e-3 px per frame.
EXACT_PX = 2e-4


def pair(things: list[Thing], poses: list[Pose], **kwargs: int) -> tuple:  # type: ignore[type-arg]  # two snapshots
    """Snapshots before and after things have moved to `poses`."""
    contents = contents_of(things)
    before = snapshot_of(things, contents=contents)
    after = snapshot_of(moved(things, *poses), contents=contents, time_ns=FRAME_NS, **kwargs)  # type: ignore[arg-type]  # histories
    return before, after


def check(
    render: Render, things: list[Thing], poses: list[Pose], now: Camera, then: Camera
) -> None:
    """Compare the flow view with arithmetic at every pixel away from edges."""
    before, after = pair(things, poses)
    views = render(after, now, "flow", "flow_valid", "instance", past=(before, then))
    hits = cast(after, now)
    expected = flow_by_arithmetic(hits, after, now, before, then)
    sure = hits.away_from_edges() | ((hits.row < 0) & (views["instance"] == 0))
    sure &= np.isfinite(expected).all(axis=-1)
    assert sure.mean() > 0.2
    error_px = np.abs(views["flow"][sure] - expected[sure]) * DT_S
    # Relative too: a point close to the earlier camera's plane moves by thousands of pixels.
    allowed = np.maximum(EXACT_PX, 2e-6 * np.abs(expected[sure]) * DT_S)
    assert (error_px <= allowed).all(), error_px.max()
    assert views["flow_valid"][sure].all()


def test_a_still_world_has_no_flow_at_all(render: Render) -> None:
    """Still camera, still bodies: exactly 0.0, valid, sky included."""
    things = [Thing(BOX, Pose.from_rpy_deg((3.0, 0.3, 0.1), (10, 20, 30)))]
    camera = camera_at(Pose.from_rpy_deg((0.1, 0.2, 0.3), (1, 2, 3)))
    before, after = pair(things, [things[0].pose])
    views = render(after, camera, "flow", "flow_valid", past=(before, camera))
    assert not views["flow"].any()
    assert views["flow_valid"].all()


def test_a_still_body_does_not_move_because_another_does(render: Render) -> None:
    """With a still camera only the moving body's pixels have flow; others exactly none."""
    things = [Thing(BOX, Pose((4.0, 1.0, 0.0))), Thing(BOX, Pose((4.0, -1.0, 0.0)))]
    before, after = pair(things, [things[0].pose, Pose((4.0, -1.1, 0.05))])
    views = render(after, camera_at(), "flow", "instance", past=(before, camera_at()))
    assert not views["flow"][views["instance"] != 2].any()
    assert (np.abs(views["flow"][views["instance"] == 2]) > 0.1).all()


@pytest.mark.parametrize("step", [(0.0, 0.03, 0.0), (0.0, 0.0, -0.02), (0.0, -0.4, 0.3)])
def test_a_sideways_camera_gives_the_pin_hole_formula(
    render: Render, step: tuple[float, float, float]
) -> None:
    """v = f ΔX / (Z Δt): moving left (world +y) shifts a wall to the right (+u)."""
    distance = 2.5
    now = camera_at(Pose(step))
    before, after = pair([Thing(WALL)], [Pose((distance, 0, 0))])
    before = replace(before, world_from_body=after.world_from_body)
    flow = render(after, now, "flow", past=(before, camera_at()))["flow"]
    focal = now.intrinsics.fx
    expected = focal / (distance * DT_S) * np.array([step[1], step[2]])
    assert np.abs(flow - expected).max() * DT_S < EXACT_PX


@pytest.mark.parametrize("turn", [(0, 0, 2.0), (0, -3.0, 0), (5.0, 0, 0), (2.0, 3.0, -4.0)])
def test_a_turning_camera_gives_the_homography_for_all_depths(
    render: Render, turn: tuple[float, float, float]
) -> None:
    """Pure rotation: sky and body move by K R K⁻¹, whatever their depth."""
    things = [Thing(BOX, Pose((3.0, 0.5, 0.0)))]
    now, then = camera_at(Pose.from_rpy_deg((0, 0, 0), turn)), camera_at()
    before, after = pair(things, [things[0].pose])
    flow = render(after, now, "flow", past=(before, then))["flow"]
    k = now.intrinsics.K
    rotation = then.camera_from_world[:3, :3] @ now.world_from_camera[:3, :3]
    v, u = np.mgrid[0 : now.intrinsics.height, 0 : now.intrinsics.width]
    homogeneous = np.stack([u, v, np.ones_like(u)], axis=-1) @ (k @ rotation @ np.linalg.inv(k)).T
    earlier = homogeneous[..., :2] / homogeneous[..., 2:]
    expected = (np.stack([u, v], axis=-1) - earlier) / DT_S
    assert np.abs(flow - expected).max() * DT_S < EXACT_PX


def test_a_moving_and_turning_body_before_a_still_camera(render: Render) -> None:
    """A tumbling, approaching box agrees with rigid-body arithmetic."""
    start = Pose.from_rpy_deg((3.0, 0.2, 0.1), (5, 15, 25))
    end = Pose.from_rpy_deg((2.9, 0.25, 0.06), (9, 11, 33))
    check(render, [Thing(BOX, start, (1.0, 0.6, 1.4))], [end], camera_at(), camera_at())


def test_camera_and_bodies_move_at_once(render: Render) -> None:
    """Several boxes and a wall, all moving, seen by a camera that moves and turns."""
    things = [
        Thing(BOX, Pose.from_rpy_deg((3.0, 0.8, 0.1), (5, 15, 25))),
        Thing(BOX, Pose.from_rpy_deg((4.0, -0.9, 0.3), (0, 50, 10))),
        Thing(WALL, Pose.from_rpy_deg((8.0, 0, 0), (0, 10, 20))),
    ]
    poses = [
        Pose.from_rpy_deg((3.05, 0.7, 0.15), (9, 15, 30)),
        Pose.from_rpy_deg((3.9, -0.9, 0.2), (3, 44, 10)),
        things[2].pose,
    ]
    now = camera_at(Pose.from_rpy_deg((0.1, 0.05, -0.04), (1, -2, 3)))
    check(render, things, poses, now, camera_at())


OFFSETS = st.tuples(*[st.floats(-0.2, 0.2)] * 3)
TURNS = st.tuples(*[st.floats(-12.0, 12.0)] * 3)


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(OFFSETS, TURNS, OFFSETS, TURNS)
def test_any_motion_of_camera_and_body(render: Render, shift, turn, body_shift, body_turn) -> None:  # type: ignore[no-untyped-def]  # four drawn tuples
    """Whatever moves and turns, the flow is the arithmetic's."""
    start = (3.0, 0.1, -0.1)
    end = Pose.from_rpy_deg(np.add(start, body_shift), np.add((5, 15, 25), body_turn))
    now = camera_at(Pose.from_rpy_deg(shift, turn))
    check(render, [Thing(BOX, Pose.from_rpy_deg(start, (5, 15, 25)))], [end], now, camera_at())


def test_flow_is_a_velocity(render: Render) -> None:
    """The same displacement in half the time is twice the flow."""
    things = [Thing(WALL, Pose((3.0, 0, 0)))]
    before, after = pair(things, [Pose((3.0, 0.1, 0))])
    slow = render(after, camera_at(), "flow", past=(before, camera_at()))["flow"]
    quick = replace(after, sim_time_ns=FRAME_NS // 2)
    fast = render(quick, camera_at(), "flow", past=(before, camera_at()))["flow"]
    np.testing.assert_allclose(fast, 2 * slow, rtol=1e-6)


def test_flow_is_not_quantised(render: Render) -> None:
    """A zooming wall gives nearly as many values as pixels, in each component."""
    things = [Thing(WALL, Pose.from_rpy_deg((3.0, 0, 0), (0, 20, 30)))]
    before, after = pair(things, [Pose.from_rpy_deg((2.9, 0, 0), (0, 20, 30))])
    flow = render(
        after,
        camera_at(width=160, height=120),
        "flow",
        past=(before, camera_at(width=160, height=120)),
    )["flow"]
    for component in (0, 1):
        assert len(np.unique(flow[..., component])) > 0.9 * flow[..., 0].size


def test_the_previous_picture_warped_along_the_flow_is_the_present_one(render: Render) -> None:
    """rgb_t(x) = rgb_{t-1}(x - v Δt) off occlusions, for textured surfaces in plain light."""
    skin = {"base_colour_texture": checker(3), "roughness": 1.0}
    things = [
        Thing(model_of(box_mesh(1.0), **skin), Pose.from_rpy_deg((3.0, 0.2, 0.1), (5, 15, 25))),
        Thing(model_of(wall_mesh(12.0, 12.0), **skin), Pose((6.0, 0, 0))),
    ]
    poses = [Pose.from_rpy_deg((2.95, 0.15, 0.12), (7, 13, 29)), things[1].pose]
    contents = contents_of(things, lights=())
    before = snapshot_of(things, contents=contents)
    after = snapshot_of(moved(things, *poses), contents=contents, time_ns=FRAME_NS)
    size = {"width": 320, "height": 240}
    then, now = (
        camera_at(**size),
        camera_at(Pose.from_rpy_deg((0.03, 0.04, 0.0), (1, 0, 1)), **size),
    )
    earlier = render(before, then, "rgb")["rgb"].astype(np.float32)
    views = render(after, now, "rgb", "flow", "occlusion", "instance", past=(before, then))
    v, u = np.mgrid[0:240, 0:320].astype(np.float32)
    source = np.stack([u, v], axis=-1) - views["flow"] * np.float32(DT_S)
    warped = cv2.remap(earlier, source[..., 0], source[..., 1], cv2.INTER_LINEAR)
    edges = [~cast(*seen).away_from_edges() for seen in ((after, now), (before, then))]
    near_edge = np.any([cv2.dilate(e.astype(np.uint8), np.ones((9, 9))) for e in edges], axis=0)
    compared = ~views["occlusion"] & ~near_edge
    assert compared.mean() > 0.7
    difference = np.abs(warped - views["rgb"].astype(np.float32)).max(axis=-1)
    unmoved = np.abs(earlier - views["rgb"].astype(np.float32)).max(axis=-1)
    # Interpolation of a picture with detail; without warping the mean is an order larger.
    assert difference[compared].mean() < 1.5
    assert np.quantile(difference[compared], 0.99) < 8.0
    assert unmoved[compared].mean() > 10 * difference[compared].mean()


def test_a_first_frame_has_no_flow(render: Render) -> None:
    """Without a past nothing is valid; the flow is NaN and never a number."""
    views = render(
        snapshot_of([Thing(BOX, Pose((3.0, 0, 0)))]), camera_at(), "flow", "flow_valid", "occlusion"
    )
    assert np.isnan(views["flow"]).all()
    assert not views["flow_valid"].any()
    assert views["occlusion"].all()


def test_a_new_epoch_has_no_past(render: Render) -> None:
    """After a change of scene or a reset nothing is valid, not even the sky."""
    things = [Thing(BOX, Pose((3.0, 0, 0)))]
    before = snapshot_of(things, epoch=1)
    after = snapshot_of(things, epoch=2, time_ns=FRAME_NS)
    views = render(after, camera_at(), "flow_valid", past=(before, camera_at()))
    assert not views["flow_valid"].any()


def test_what_was_spawned_or_teleported_has_no_past_alone(render: Render) -> None:
    """A new instance and one with a cut-off history are invalid; their neighbours are not."""
    old = Thing(BOX, Pose((4.0, 1.2, 0.0)))
    jumper = Thing(BOX, Pose((4.0, 0.0, 0.0)))
    new = Thing(BOX, Pose((4.0, -1.2, 0.0)))
    before = snapshot_of([old, jumper], histories=[1, 2])
    after = snapshot_of([old, jumper, new], histories=[1, 3, 4], time_ns=FRAME_NS)
    views = render(after, camera_at(), "flow", "flow_valid", "instance", past=(before, camera_at()))
    for instance, valid in ((0, True), (1, True), (2, False), (3, False)):
        assert (views["flow_valid"][views["instance"] == instance] == valid).all()
    np.testing.assert_array_equal(np.isfinite(views["flow"]).all(axis=-1), views["flow_valid"])


def test_what_was_behind_the_camera_had_no_place_in_the_picture(render: Render) -> None:
    """A wall that jumped from behind the camera to its front is invalid; no nonsense numbers."""
    things = [Thing(WALL, Pose((-2.0, 0, 0)))]
    before, after = pair(things, [Pose((2.0, 0, 0))])
    views = render(after, camera_at(), "flow", "flow_valid", past=(before, camera_at()))
    assert not views["flow_valid"].any()
    assert np.isnan(views["flow"]).all()


def test_what_the_foreground_uncovers_was_hidden(render: Render) -> None:
    """A box that moves right uncovers wall on its left side, there alone is occlusion."""
    things = [Thing(BOX, Pose((3.0, 0.0, 0.0))), Thing(WALL, Pose((6.0, 0, 0)))]
    before, after = pair(things, [Pose((3.0, -0.3, 0.0)), things[1].pose])
    size = {"width": 320, "height": 240}
    views = render(
        after, camera_at(**size), "occlusion", "instance", past=(before, camera_at(**size))
    )
    was = render(before, camera_at(**size), "instance")["instance"]
    uncovered = (was == 1) & (views["instance"] == 2)
    assert uncovered.sum() > 1000
    different = views["occlusion"] ^ uncovered
    # The box shows faces it did not show before, and edges fall between pixels.
    assert different[views["instance"] == 2].mean() < 0.004


def test_a_still_picture_hides_nothing(render: Render) -> None:
    """Without motion no pixel is occluded, whatever the slant of its surface."""
    things = [
        Thing(BOX, Pose.from_rpy_deg((3.0, 0.3, 0), (10, 20, 30))),
        Thing(WALL, Pose.from_rpy_deg((6, 0, 0), (0, 85, 0))),
    ]
    before, after = pair(things, [thing.pose for thing in things])
    assert not render(after, camera_at(), "occlusion", past=(before, camera_at()))[
        "occlusion"
    ].any()


def test_occlusion_does_not_depend_on_what_was_asked_before(renderer, render: Render) -> None:  # type: ignore[no-untyped-def]  # fixture
    """With the earlier depth at hand or drawn again, the view is the same to the byte."""
    from sailenv_ros.types.snapshot import Observation

    things = [Thing(BOX, Pose((3.0, 0.0, 0.0))), Thing(WALL, Pose((6.0, 0, 0)))]
    before, after = pair(things, [Pose((3.0, -0.3, 0.0)), things[1].pose])
    camera = camera_at(FORWARD)
    depth = render(before, camera, "depth")["depth"]
    kept = Observation(snapshot=before, camera=camera, depth=depth)
    again = Observation(snapshot=before, camera=camera)
    first = renderer.render(RenderRequest(after, camera, ["occlusion"], kept)).views["occlusion"]
    second = renderer.render(RenderRequest(after, camera, ["occlusion"], again)).views["occlusion"]
    np.testing.assert_array_equal(first, second)
