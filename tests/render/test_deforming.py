"""Surfaces that deform: flow, own coordinates, occlusion and shadows against arithmetic."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sailenv_ros.frame.motion import ObjectPoints, SceneGeometry, motion, object_coordinates, track
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.tiny_scenes import FRAME_NS, Thing, box_mesh, camera_at, checker, model_of
from tests.support.waving_sheet import (
    corners_in_world,
    deforming_snapshot,
    first_hits,
    sheet_mesh,
    waved,
)

SHEET = model_of(sheet_mesh(), base_colour_texture=checker(3), double_sided=True)
BOX = model_of(box_mesh(0.4))
SCALE = (1.0, 1.1, 0.9)
DT_S = FRAME_NS * 1e-9
NOW = camera_at(Pose.from_rpy_deg((0.0, 0.05, 0.0), (1, 2, 3)), width=97, height=73)
THEN = camera_at(width=97, height=73)

EXACT_PX = 1e-3
"""What depths of single precision allow; 0.01 px is promised."""


def instants(*, above_m: float = -9.0, turned: bool = True) -> tuple[WorldSnapshot, WorldSnapshot]:
    """A sheet that waves and moves, with a box before it that rests; before and after."""
    found = []
    for time_ns, phase, yaw in ((0, 0.3, 10.0), (FRAME_NS, 0.9, 14.0 if turned else 10.0)):
        pose = Pose.from_rpy_deg((3.0, 0.1, 0.05), (4, 5, yaw))
        things = [Thing(SHEET, pose, SCALE), Thing(BOX, Pose((2.0, 0.5, -0.2)))]
        shape = waved(SHEET, phase, above_m=above_m)
        found.append(deforming_snapshot(things, [shape, None], time_ns=time_ns))
    before, after = found
    contents = after.contents
    return replace(before, contents=contents), after


def expected_flow(
    now: WorldSnapshot, then: WorldSnapshot, camera: Camera, earlier: Camera
) -> tuple[np.ndarray, np.ndarray]:
    """(H, W, 2) flow of the sheet in pixels, by its vertices, and (H, W) where it is sure."""
    present = corners_in_world(now.deformations[1], now.world_from_body[0], SCALE)
    past = corners_in_world(then.deformations[1], then.world_from_body[0], SCALE)
    triangle, weights = first_hits(camera, present)
    world = np.einsum("hwk,hwkj->hwj", weights, past[triangle])
    matrix = earlier.camera_from_world
    optical = world @ matrix[:3, :3].T + matrix[:3, 3]
    rows, columns = np.mgrid[0 : camera.intrinsics.height, 0 : camera.intrinsics.width]
    flow = np.stack([columns, rows], axis=-1) - earlier.intrinsics.project(optical)
    return flow, (triangle >= 0) & (weights.min(axis=2) > 1e-3)


def test_flow_of_a_surface_is_that_of_its_vertices(render: Render) -> None:
    before, after = instants()
    views = render(after, NOW, "flow", "flow_valid", "instance", past=(before, THEN))
    expected, sure = expected_flow(after, before, NOW, THEN)
    sure &= views["instance"] == 1
    assert sure.mean() > 0.2
    assert views["flow_valid"][sure].all()
    error_px = np.abs(views["flow"][sure] * DT_S - expected[sure])
    assert error_px.max() < EXACT_PX
    assert np.abs(expected[sure]).max() > 2.0  # it moves


def test_what_does_not_deform_has_no_flow(render: Render) -> None:
    before, after = instants(above_m=0.1, turned=False)
    views = render(after, THEN, "flow", "instance", "object_coords", past=(before, THEN))
    sheet = views["instance"] == 1
    low = sheet & (views["object_coords"][..., 2] < 0.1 * SCALE[2] - 2.0 / 12)
    assert low.sum() > 200
    assert (views["flow"][low] == 0.0).all()
    assert (views["flow"][sheet & ~low] != 0.0).any()


def test_own_coordinates_are_those_at_rest(render: Render) -> None:
    _, after = instants()
    views = render(after, NOW, "object_coords", "instance")
    present = corners_in_world(after.deformations[1], after.world_from_body[0], SCALE)
    triangle, weights = first_hits(NOW, present)
    mesh = SHEET.parts[0].mesh
    rest = (mesh.positions * np.array(SCALE))[mesh.triangles]
    sure = (triangle >= 0) & (weights.min(axis=2) > 1e-3) & (views["instance"] == 1)
    own = np.einsum("hwk,hwkj->hwj", weights, rest[triangle])
    assert np.abs(views["object_coords"][sure] - own[sure]).max() < 2e-6


def test_depth_follows_the_vertices(render: Render) -> None:
    _, after = instants()
    views = render(after, NOW, "depth", "instance")
    present = corners_in_world(after.deformations[1], after.world_from_body[0], SCALE)
    triangle, weights = first_hits(NOW, present)
    sure = (triangle >= 0) & (weights.min(axis=2) > 1e-3) & (views["instance"] == 1)
    world = np.einsum("hwk,hwkj->hwj", weights, present[triangle])
    depth = (world - NOW.world_from_camera[:3, 3]) @ NOW.world_from_camera[:3, 2]
    assert np.abs(views["depth"][sure] / depth[sure] - 1.0).max() < 3e-6


def test_pictures_and_shadows_change_with_the_shape(render: Render) -> None:
    before, after = instants(turned=False)
    first = render(before, THEN, "rgb")["rgb"].copy()
    second = render(after, THEN, "rgb")["rgb"].copy()
    assert (first != second).any()
    again = render(before, THEN, "rgb")["rgb"]
    assert (first == again).all()


def test_without_a_shape_in_the_past_there_is_no_flow(render: Render) -> None:
    before, after = instants()
    views = render(
        after,
        THEN,
        "flow_valid",
        "instance",
        past=(replace(before, deformations={}), THEN),
    )
    assert not views["flow_valid"][views["instance"] == 1].any()
    assert views["flow_valid"][views["instance"] == 2].all()


def frame_of(snapshot: WorldSnapshot, camera: Camera, views: dict[str, np.ndarray]) -> dict:  # type: ignore[type-arg]  # as `Agent.get_frame` gives it
    """A frame as a dict."""
    count = len(snapshot.contents.instances)
    poses = [Pose.from_matrix(matrix) for matrix in snapshot.world_from_body]
    states = InstanceStates(
        ids=snapshot.contents.instance_ids,
        positions=np.array([pose.position_m for pose in poses]),
        orientations=np.array([pose.orientation_xyzw for pose in poses]),
        linear_velocities=np.zeros((count, 3)),
        angular_velocities=np.zeros((count, 3)),
        scales=np.array([drawn.scale for drawn in snapshot.contents.instances]),
        histories=snapshot.histories,
        deformations=snapshot.deformations,
    )
    return {
        "scene": "tiny",
        "epoch": 1,
        "stamp_ns": snapshot.sim_time_ns,
        "camera": camera,
        "states": states,
        "depth_m": views["depth"],
        "instance": views["instance"],
    }


def test_motion_and_tracks_between_frames_follow_the_vertices(render: Render) -> None:
    before, after = instants()
    frames = [
        frame_of(snapshot, camera, render(snapshot, camera, "depth", "instance"))
        for snapshot, camera in ((after, NOW), (before, THEN))
    ]
    moved = motion(frames[0], frames[1])
    expected, sure = expected_flow(after, before, NOW, THEN)
    sure &= frames[0]["instance"] == 1
    assert np.abs(moved.flow[sure] + expected[sure]).max() < EXACT_PX
    backward = render(after, NOW, "flow", past=(before, THEN))["flow"]
    assert np.abs(moved.flow[sure] + backward[sure] * DT_S).max() < EXACT_PX

    pixels = np.argwhere(sure)[::37][:, ::-1]
    queries = np.column_stack([np.zeros(len(pixels)), pixels])
    geometry = SceneGeometry.of_contents(after.contents)
    tracks = track(queries, frames, geometry)
    v, u = pixels.T[::-1]
    assert (tracks.instances == 1).all()
    assert tracks.visible[:, 0].all()
    assert np.abs(tracks.pixels[:, 0] - pixels).max() < EXACT_PX
    assert np.abs(tracks.pixels[:, 1] - (pixels - expected[v, u])).max() < EXACT_PX
    coords = object_coordinates(frames[0])
    assert np.abs(tracks.coords - coords[v, u]).max() < 2e-6
    same = track(ObjectPoints(tracks.instances, coords[v, u]), frames, geometry)
    assert np.abs(same.pixels - tracks.pixels).max() < EXACT_PX
    scene = moved.scene_flow[v, u] @ NOW.world_from_camera[:3, :3].T
    assert np.abs(scene - (tracks.positions[:, 1] - tracks.positions[:, 0])).max() < 1e-5


@pytest.mark.parametrize("lens", ["equidistant", "orthographic"])
def test_flow_through_other_lenses_is_that_of_the_vertices(render: Render, lens: str) -> None:
    before, after = instants()
    lens_of: dict[str, Any] = {"distortion_model": lens, "fx_px": 60.0, "fy_px": 60.0}
    lens_of |= {"width": 97, "height": 73, "max_angle_deg": 95.0}
    if lens == "equidistant":
        lens_of["distortion"] = (0.0, 0.0, 0.0, 0.0)
    else:
        del lens_of["max_angle_deg"]
    camera, earlier = (replace(camera_at(**lens_of), pose=one.pose) for one in (NOW, THEN))
    views = render(after, camera, "flow", "instance", "depth", "range", past=(before, earlier))
    frames = [
        frame_of(snapshot, one, render(snapshot, one, "depth", "instance", "range"))
        | {"range": render(snapshot, one, "range")["range"]}
        for snapshot, one in ((after, camera), (before, earlier))
    ]
    pixels = np.argwhere(views["instance"] == 1)[::53][:, ::-1]
    queries = np.column_stack([np.zeros(len(pixels)), pixels])
    tracks = track(queries, frames, SceneGeometry.of_contents(after.contents))
    own = tracks.instances == 1
    v, u = pixels[own].T[::-1]
    moved = tracks.pixels[own, 0] - tracks.pixels[own, 1]
    assert np.abs(views["flow"][v, u] * DT_S - moved).max() < 2e-3
