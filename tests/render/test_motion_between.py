"""Motion between any two frames, against rays and rigid-body arithmetic in double precision."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_bench.experiments.flow_accuracy import EYE, STEPS, begin_scenario, flow_test_scene
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_bench.experiments.motion_field import Instant, MotionField, motion_field
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import motion
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at

GAPS = (1, 8, 32)
VIEWS = ("depth", "instance", "object_coords", "normals")


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with flow_test_scene(160, 120) as opened:
        yield opened


@pytest.mark.gl
@pytest.mark.parametrize("name", SCENARIOS)
def test_motion_is_the_arithmetic_s_over_any_gap_in_both_directions(
    simulation: Simulation, name: str
) -> None:
    """Flow to 0.01 px, scene flow to 1e-5 m, exactly 0 where nothing moves; masks agree."""
    scenario = SCENARIOS[name]
    boxes = begin_scenario(simulation, scenario)
    seen: dict[int, tuple[Frame, Instant]] = {}
    for number in (0, *GAPS):
        done = max(seen, default=0)
        if number:
            simulation.step(STEPS * (number - done))
        frame = simulation.capture(VIEWS, agent=EYE)
        poses = [simulation.get_object(box.instance_id).pose for box in boxes]
        seen[number] = frame, Instant(camera=frame.camera, poses=poses)
    for gap in GAPS:
        for begin, end in ((0, gap), (gap, 0)):
            (one, now), (other, then) = seen[begin], seen[end]
            truth = motion_field(boxes, now, then)
            compare(one, other, truth, now, then)
        both_ways(seen[0][0], seen[gap][0])


def cosines(frame: Frame) -> NDArray[np.float64]:
    """Return the cosine between each pixel's ray and the surface's normal, (H, W)."""
    lens = frame.camera.intrinsics
    v, u = np.mgrid[: lens.height, : lens.width]
    rays = np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(lens.K).T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return np.asarray((rays * frame["normals"]).sum(axis=-1), np.float64)


def compare(one: Frame, other: Frame, truth: MotionField, now: Instant, then: Instant) -> None:
    moved = motion(one, other)
    assert moved.duration_s == pytest.approx((other.stamp_ns - one.stamp_ns) * 1e-9)
    same = one["instance"] == truth.instance
    assert same.mean() > 0.99
    sure = same & moved.valid
    np.testing.assert_allclose(moved.flow[sure], -truth.displacement_px[sure], atol=0.01)
    surface = same & (truth.instance > 0)
    error = np.abs(moved.scene_flow[surface] + truth.moved_m[surface]).max(axis=-1)
    # Of a surface seen nearly edge-on a rounding of the depth is a longer way along it.
    facing = np.abs(cosines(one)[surface]) > 0.1
    assert facing.mean() > 0.95
    assert error[facing].max() < 1e-5
    assert error.max() < 5e-5
    still = np.isin(one["instance"], unmoved(now, then, one))
    assert not moved.scene_flow[still].any()
    if np.array_equal(now.camera.world_from_camera, then.camera.world_from_camera):
        assert not moved.flow[still].any()
    away = sure & ~near_edges(one["instance"])
    assert (moved.out_of_view == truth.leaves)[away].all()
    # The other picture decides by its pixels: beside an edge of what hides they are another's.
    hidden = moved.occluded == truth.hidden
    assert hidden[away].mean() > 0.97
    assert not (moved.occluded & moved.out_of_view).any()
    assert (moved.visible | moved.occluded | moved.out_of_view)[moved.valid].all()


def unmoved(now: Instant, then: Instant, frame: Frame) -> NDArray[Any]:
    assert frame.states is not None
    ids = frame.states.ids
    return np.array(
        [ids[k] for k, (a, b) in enumerate(zip(now.poses, then.poses, strict=True)) if a == b]
    )


def near_edges(ids: NDArray[np.uint16]) -> NDArray[np.bool_]:
    edges = np.zeros(ids.shape, bool)
    for axis in (0, 1):
        for shift in (-1, 1):
            edges |= np.roll(ids, shift, axis) != ids
    return edges


def both_ways(one: Frame, other: Frame) -> None:
    """Forward and back again is where it began, for what both frames show, in whole pixels."""
    forward, backward = motion(one, other), motion(other, one)
    rows, columns = np.nonzero(forward.visible & ~near_edges(one["instance"]))
    flow = forward.flow[rows, columns]
    to_column, to_row = (np.rint(np.stack([columns, rows]) + flow.T)).astype(int)
    inside = (to_column >= 0) & (to_column < 160) & (to_row >= 0) & (to_row < 120)
    rows, columns, flow = rows[inside], columns[inside], flow[inside]
    to_row, to_column = to_row[inside], to_column[inside]
    on_same = one["instance"][rows, columns] == other["instance"][to_row, to_column]
    on_same &= ~near_edges(other["instance"])[to_row, to_column]
    back = backward.flow[to_row, to_column]
    # The nearest pixel's centre lies up to half a pixel beside the point.
    nearby = np.linalg.norm(back + flow, axis=1)[on_same]
    assert np.median(nearby) < 0.5
    one_point = one["object_coords"][rows, columns][on_same]
    same_point = other["object_coords"][to_row, to_column][on_same]
    assert np.median(np.linalg.norm(one_point - same_point, axis=1)) < 0.02


@pytest.mark.gl
def test_motion_between_two_cameras_of_different_lenses(simulation: Simulation) -> None:
    """At one instant, in both directions: a stereo pair whose right eye zooms and sees less."""
    boxes = begin_scenario(simulation, SCENARIOS["rotate_rigidbody"])
    lens = CameraIntrinsics(width=100, height=90, vertical_fov_deg=35.0)
    simulation.register_agent(
        AgentSpec(name="right", intrinsics=lens, following=False, rate_hz=0.0)
    )
    try:
        simulation.set_pose(look_at((-1.5, -0.6, 1.6), (0.3, 0.1, 1.4)), agent="right")
        left = simulation.capture(VIEWS, agent=EYE)
        right = simulation.capture(VIEWS, agent="right")
    finally:
        simulation.delete_agent("right")
    poses = [simulation.get_object(box.instance_id).pose for box in boxes]
    ends = [(frame, Instant(camera=frame.camera, poses=poses)) for frame in (left, right)]
    for (one, now), (other, then) in (ends, ends[::-1]):
        moved, truth = motion(one, other), motion_field(boxes, now, then)
        assert moved.duration_s == 0.0
        sure = (one["instance"] == truth.instance) & moved.valid
        assert sure.mean() > 0.5
        np.testing.assert_allclose(moved.flow[sure], -truth.displacement_px[sure], atol=0.01)
        assert not moved.scene_flow[sure].any()
        away = sure & ~near_edges(one["instance"])
        assert (moved.out_of_view == truth.leaves)[away].all()
        assert (moved.occluded == truth.hidden)[away].mean() > 0.97
        assert moved.visible.any()


@pytest.mark.gl
def test_object_coords_are_the_points_in_their_own_frames(simulation: Simulation) -> None:
    """Carried back by the instance's pose they are what depth says; still under any motion."""
    boxes = begin_scenario(simulation, SCENARIOS["both"])
    simulation.step(40)
    frame = simulation.capture((*VIEWS, "normals"), agent=EYE)
    assert frame.states is not None
    world = frame.camera.intrinsics.unproject(frame["depth"])
    matrix = frame.camera.world_from_camera
    world = world @ matrix[:3, :3].T + matrix[:3, 3]
    for box in boxes:
        seen = frame["instance"] == box.instance_id
        pose = frame.states.matrices[frame.states.row(box.instance_id)]
        carried = frame["object_coords"][seen] @ pose[:3, :3].T + pose[:3, 3]
        np.testing.assert_allclose(carried, world[seen], atol=2e-6)
        # On the surface of its box, in metres.
        middle = 0.5 * (np.array(box.low) + box.high)
        half = 0.5 * (np.array(box.high) - box.low)
        beside = np.abs(np.abs(frame["object_coords"][seen] - middle) - half)
        assert beside.min(axis=1).max(initial=0.0) < 1e-5
    assert np.isnan(frame["object_coords"][frame["instance"] == 0]).all()
