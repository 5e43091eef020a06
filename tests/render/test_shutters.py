"""Rolling shutters and exposure times, against rays and arithmetic of the tests' own.

Each row is compared with what the camera and the things of its own instant give; how they move in
the meantime is a law of the tests.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion.between import motion
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from tests.support.lockstep_core import lockstep_core
from tests.support.ray_cast import cast, points_met
from tests.support.tiny_scenes import (
    FRAME_NS,
    SUN,
    Thing,
    box_mesh,
    checker,
    contents_of,
    model_of,
    snapshot_of,
    wall_mesh,
)

WIDTH, HEIGHT = 80, 56
ROW_S = 4e-4
"""Slow, so that rows differ: the last one is read 22 ms after the first one."""

SKIN: dict[str, Any] = {"base_colour_texture": checker(3)}
THINGS = [
    Thing(model_of(wall_mesh(30.0, 30.0), **SKIN), Pose((6.0, 0.0, 0.0))),
    Thing(model_of(box_mesh(0.6), **SKIN), Pose((2.2, 0.5, 0.2))),
    Thing(model_of(box_mesh(0.5), **SKIN), Pose((2.6, -0.6, -0.2))),
    Thing(model_of(box_mesh(0.4), **SKIN), Pose((1.9, -0.1, 0.45))),
]
CONTENTS = contents_of(THINGS, lights=[SUN])
MOVING = (1, 3)
LENSES = {
    "pinhole": CameraIntrinsics(width=WIDTH, height=HEIGHT),
    "equidistant": CameraIntrinsics(
        width=WIDTH,
        height=HEIGHT,
        distortion_model="equidistant",
        distortion=(0.02, -0.01, 0.001, 0.0),
        fx_px=30.0,
        fy_px=30.0,
        max_angle_deg=95.0,
    ),
    "orthographic": CameraIntrinsics(
        width=WIDTH, height=HEIGHT, distortion_model="orthographic", fx_px=26.0, fy_px=24.0
    ),
}


def camera_pose(time_s: float) -> Pose:
    """Walks and turns at some speed."""
    turn = (4.0, 20.0 * time_s, 40.0 * time_s)
    return Pose.from_rpy_deg((0.8 * time_s, 0.5 * time_s, 0.1), turn)


def thing_pose(row: int, time_s: float) -> Pose:
    """Turns and moves, or stands."""
    thing = THINGS[row]
    if row not in MOVING:
        return thing.pose
    place = np.asarray(thing.pose.position_m) + np.array([0.0, -0.7, 0.6]) * time_s
    return Pose.from_rpy_deg(place, (50.0 + 90.0 * time_s, 30.0, 20.0 * row))


def world_at(time_s: float) -> WorldSnapshot:
    """The things at an instant."""
    return WorldSnapshot(
        sim_time_ns=round(time_s * 1e9),
        step=0,
        contents=CONTENTS,
        world_from_body=np.stack([thing_pose(k, time_s).matrix() for k in range(len(THINGS))]),
        histories=np.ones(len(THINGS), np.int64),
    )


def camera_through(lens: CameraIntrinsics, time_s: float, **picture: Any) -> Camera:
    """The camera at an instant."""
    return Camera(
        intrinsics=lens, pose=camera_pose(time_s), picture=PictureSettings(**picture), name="eye"
    )


def row_times(middle_s: float) -> NDArray[np.float64]:
    """When each row is exposed."""
    numbers = np.arange(HEIGHT, dtype=np.float64)
    times: NDArray[np.float64] = middle_s + (numbers - 0.5 * (HEIGHT - 1)) * ROW_S
    return times


def observed(lens: CameraIntrinsics, middle_s: float, **picture: Any) -> Observation:
    """What a rolling shutter sees around an instant."""
    times = row_times(middle_s)
    moving = [[thing_pose(k, t).matrix() for k in MOVING] for t in times]
    cameras = [camera_through(lens, t).world_from_camera for t in times]
    return Observation(
        snapshot=world_at(middle_s),
        camera=camera_through(lens, middle_s, **picture),
        rows=RowPoses(
            times_ns=np.round(1e9 * times).astype(np.int64),
            world_from_camera=np.stack(cameras),
            ids=CONTENTS.instance_ids[list(MOVING)],
            world_from_instance=np.array(moving),
        ),
    )


def seen(
    renderer: NativeRenderer,
    now: Observation,
    *views: str,
    past: Observation | None = None,
    samples: tuple[Observation, ...] = (),
) -> dict[str, NDArray[Any]]:
    """Views of an observation."""
    rendered = renderer.render(
        RenderRequest(now.snapshot, now.camera, views, past, rows=now.rows, samples=samples)
    )
    return dict(rendered.views)


@pytest.fixture(scope="module")
def native() -> Iterator[NativeRenderer]:
    """A native renderer."""
    made = NativeRenderer(threads=2)
    yield made
    made.close()


@pytest.mark.parametrize("name", LENSES)
def test_each_row_is_what_rays_of_its_own_instant_meet(native: NativeRenderer, name: str) -> None:
    """Ids, distances to 1e-5, and object coordinates, away from edges; nothing is between rows."""
    lens = LENSES[name]
    now = observed(lens, 0.05)
    reach = "range" if name == "equidistant" else "depth"
    views = seen(native, now, "instance", reach, "object_coords", "normals")
    compared = 0
    for row, time_s in enumerate(row_times(0.05)):
        camera = camera_through(lens, time_s)
        hits = cast(world_at(time_s), camera)
        away = hits.away_from_edges()[row]
        compared += int(away.sum())
        ids = np.where(hits.row >= 0, hits.row + 1, 0)[row]
        np.testing.assert_array_equal(views["instance"][row][away], ids[away])
        np.testing.assert_allclose(views[reach][row][away], hits.depth[row][away], rtol=1e-5)
        np.testing.assert_allclose(views["normals"][row][away], hits.normal[row][away], atol=1e-5)
        met = away & (ids > 0)
        points = points_met(camera, hits.depth)[row][met]
        points = points @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
        for column, point in zip(np.flatnonzero(met), points, strict=True):
            pose = thing_pose(int(ids[column]) - 1, time_s).matrix()
            own = pose[:3, :3].T @ (point - pose[:3, 3])
            np.testing.assert_allclose(views["object_coords"][row, column], own, atol=1e-4)
    assert compared > 0.5 * WIDTH * HEIGHT


@pytest.mark.parametrize("name", LENSES)
def test_flow_is_from_the_row_of_then_to_the_row_of_now(native: NativeRenderer, name: str) -> None:
    """To 0.01 px over the time between the frames; points of all rows, still and moving."""
    lens = LENSES[name]
    duration_s = FRAME_NS * 1e-9
    now, past = observed(lens, 0.05 + duration_s), observed(lens, 0.05)
    views = seen(native, now, "flow", "flow_valid", "object_coords", "instance", past=past)
    errors = []
    times = row_times(0.05)
    for row in range(0, HEIGHT, 5):
        for column in range(0, WIDTH, 7):
            id_ = int(views["instance"][row, column])
            if not id_:
                continue
            # The place in each row's own picture; the row that it lies in is where both agree.
            own = np.append(views["object_coords"][row, column].astype(np.float64), 1.0)
            points = [
                (camera_through(lens, t).camera_from_world @ thing_pose(id_ - 1, t).matrix() @ own)
                for t in times
            ]
            places = lens.project(np.array(points)[:, :3])
            ahead = places[:, 1] - np.arange(HEIGHT)
            crossing = np.flatnonzero(np.diff(np.sign(ahead)) != 0)
            if not len(crossing):
                continue
            k = int(crossing[0])
            share = ahead[k] / (ahead[k] - ahead[k + 1])
            place = places[k] + share * (places[k + 1] - places[k])
            flow = (np.array([column, row]) - place) / duration_s
            assert views["flow_valid"][row, column]
            errors.append(np.abs(views["flow"][row, column] - flow).max() * duration_s)
    assert len(errors) > 80
    assert max(errors) <= 0.01


def test_pnp_finds_the_pose_of_each_row(native: NativeRenderer) -> None:
    """OpenCV's pose from the surface points of one row: to 0.2 mm and 0.01 degrees."""
    posts = [(1.5, 0.5), (2.4, -0.9), (3.1, 1.2), (1.9, -0.25), (3.8, 0.1)]
    things = [
        THINGS[0],
        *(Thing(model_of(box_mesh((0.2, 0.2, 9.0))), Pose((x, y, 0.0))) for x, y in posts),
    ]
    lens = CameraIntrinsics(width=320, height=240)
    times = 0.05 + (np.arange(240) - 119.5) * 3e-5
    cameras = np.stack([camera_through(lens, t).world_from_camera for t in times])
    still = RowPoses(
        times_ns=np.round(1e9 * times).astype(np.int64),
        world_from_camera=cameras,
        ids=np.zeros(0, np.uint16),
        world_from_instance=np.zeros((240, 0, 4, 4)),
    )
    now = Observation(snapshot=snapshot_of(things), camera=camera_through(lens, 0.05), rows=still)
    views = seen(native, now, "object_coords", "instance")
    middle = np.linalg.inv(cameras[119])
    apart = np.linalg.norm(cameras[0, :3, 3] - cameras[239, :3, 3])
    assert apart > 5e-3
    for row in range(0, 240, 7):
        ids = views["instance"][row]
        stands = np.array([things[k - 1].pose.position_m for k in ids])
        found, rotation, shift = cv2.solvePnP(
            views["object_coords"][row].astype(np.float64) + stands,
            np.stack([np.arange(320.0), np.full(320, float(row))], axis=-1),
            lens.K,
            None,
            rvec=cv2.Rodrigues(middle[:3, :3])[0],
            tvec=middle[:3, 3:].copy(),
            useExtrinsicGuess=True,
        )
        assert found
        turn = cv2.Rodrigues(rotation)[0]
        place = (-turn.T @ shift).ravel()
        assert np.linalg.norm(place - cameras[row, :3, 3]) <= 2e-4
        angle = Rotation.from_matrix(turn @ cameras[row, :3, :3]).magnitude()
        assert np.degrees(angle) <= 0.01


def test_rows_that_see_one_instant_have_the_bytes_of_a_global_shutter(
    native: NativeRenderer,
) -> None:
    """All views, with smooth edges and glass; on one thread and on two."""
    views = ("rgb", "depth", "instance", "normals", "albedo")
    world = SceneLibrary().build("optical")
    world.step(30)
    scene = world.snapshot()
    world.close()
    lens = CameraIntrinsics(width=120, height=90)
    camera = Camera(intrinsics=lens, pose=look_at((3.5, -1.0, 2.2), (0.0, 0.0, 0.9)))
    now = Observation(snapshot=scene, camera=camera)
    height = lens.height
    rows = RowPoses(
        times_ns=np.zeros(height, np.int64),
        world_from_camera=np.tile(camera.world_from_camera, (height, 1, 1)),
        ids=scene.contents.instance_ids[2:5].copy(),
        world_from_instance=np.tile(scene.world_from_body[2:5], (height, 1, 1, 1)),
    )
    expected = seen(native, now, *views)
    single = NativeRenderer(threads=1)
    for renderer in (native, single):
        found = seen(renderer, replace(now, rows=rows), *views)
        for view in views:
            np.testing.assert_array_equal(found[view], expected[view], err_msg=view)
    single.close()


@pytest.mark.parametrize("supersampling", [1, 2])
def test_a_blurred_picture_is_the_mean_light_of_its_instants(
    native: NativeRenderer, supersampling: int
) -> None:
    """Each row of a rolling one over its own exposure; labels are those of the middle."""
    picture = {"tone_curve": "linear", "supersampling": supersampling}
    lens = LENSES["pinhole"]
    offsets = np.array([-0.02, 0.0, 0.02])
    now = observed(lens, 0.1, **picture)
    samples = tuple(observed(lens, 0.1 + offset, **picture) for offset in offsets)
    blurred = seen(native, now, "rgb", "depth", "instance", samples=samples)
    plain = seen(native, now, "depth", "instance")
    np.testing.assert_array_equal(blurred["depth"], plain["depth"])
    np.testing.assert_array_equal(blurred["instance"], plain["instance"])
    pictures = [seen(native, sample, "rgb")["rgb"] for sample in samples]
    light = np.mean([_linear(rgb) for rgb in pictures], axis=0)
    dark = (np.array(pictures) < 250).all(axis=(0, 3))
    error = np.abs(blurred["rgb"] - 255.0 * _encoded(light))[dark]
    assert dark.mean() > 0.8
    assert error.max() <= 1.5
    sharp = np.abs(pictures[1].astype(float) - blurred["rgb"])[dark]
    assert sharp.max() > 20.0


def _linear(rgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    code = rgb / 255.0
    return np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def _encoded(light: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


# -- through a simulation ------------------------------------------------------------------


def simulation(**picture: Any) -> SynchronousSimulation:
    """The scene optical, through a camera whose mover walks."""
    made = lockstep_core("optical", renderer=NativeRenderer(threads=1))
    lens = CameraIntrinsics(width=WIDTH, height=HEIGHT)
    settings = PictureSettings(**picture)
    made.register_agent(AgentSpec(name="shutter", intrinsics=lens, picture=settings))
    return made


def frame_of(made: SynchronousSimulation, *views: str) -> Frame:
    """A frame of that camera."""
    return made.capture(views, agent="shutter")


@pytest.mark.parametrize("read_out", ["down", "up"])
def test_poses_of_rows_are_those_that_physics_had(read_out: str) -> None:
    """Between the poses at two physics steps: places along a line, turns at one speed."""
    made = simulation(row_time_us=400.0, read_out=read_out, exposure_time_ms=2.0)
    record = made.agents["shutter"]
    known = {}
    for _ in range(40):
        made.step(1)
        snapshot = made.world.snapshot()
        known[snapshot.sim_time_ns] = (
            snapshot.world_from_body,
            made.agents.camera(record, made.world).world_from_camera,
        )
    frame = frame_of(made, "depth", "instance", "flow")
    made.close()
    rows = frame.row_poses
    assert rows is not None
    span_ns = round((HEIGHT - 1) * 4e5 + 2e6)
    assert frame.stamp_ns == max(known) - span_ns // 2
    step = 1.0 if read_out == "down" else -1.0
    expected = frame.stamp_ns + step * (np.arange(HEIGHT) - 0.5 * (HEIGHT - 1)) * 4e5
    np.testing.assert_allclose(rows.times_ns, expected, atol=1.0)
    assert len(rows.ids) > 3
    assert not np.array_equal(rows.world_from_camera[0], rows.world_from_camera[-1])
    instants = np.array(sorted(known))
    columns = rows.ids.astype(int) - 1
    for row in range(0, HEIGHT, 3):
        time_ns = rows.times_ns[row]
        after = int(np.searchsorted(instants, time_ns))
        begin, end = int(instants[after - 1]), int(instants[after])
        share = (time_ns - begin) / (end - begin)
        pairs = [(known[begin][1], known[end][1], rows.world_from_camera[row])]
        for column, pose in zip(columns, rows.world_from_instance[row], strict=True):
            pairs.append((known[begin][0][column], known[end][0][column], pose))
        for first, second, found in pairs:
            place = first[:3, 3] + share * (second - first)[:3, 3]
            turn = Rotation.from_matrix(second[:3, :3] @ first[:3, :3].T).as_rotvec()
            turned = Rotation.from_rotvec(share * turn).as_matrix() @ first[:3, :3]
            np.testing.assert_allclose(found[:3, 3], place, atol=1e-9)
            np.testing.assert_allclose(found[:3, :3], turned, atol=1e-8)


def test_a_frame_belongs_to_the_middle_of_its_exposure() -> None:
    """Stamp, camera, states and labels of a global shutter that is open for 20 ms."""
    made = simulation(exposure_time_ms=25.0, exposure_samples=3)
    made.step(24)  # 0.1 s; 3 steps later the exposure's middle lies on a step
    reference = simulation()
    reference.step(24)
    sharp = frame_of(reference, "rgb", "depth", "instance")
    made.step(3)
    frame = frame_of(made, "rgb", "depth", "instance")
    made.close()
    reference.close()
    assert frame.stamp_ns == sharp.stamp_ns == 100_000_000
    assert frame.row_poses is None
    np.testing.assert_array_equal(frame["instance"], sharp["instance"])
    np.testing.assert_allclose(frame["depth"], sharp["depth"], rtol=1e-6)
    assert frame.states is not None
    assert sharp.states is not None
    np.testing.assert_allclose(frame.states.positions, sharp.states.positions, atol=1e-12)
    assert (frame["rgb"] != sharp["rgb"]).any()


def test_points_of_a_rolling_frame_lie_where_the_things_stand() -> None:
    """The points of the floor have height 0, whatever their row; motion is refused in words."""
    made = simulation(row_time_us=400.0)
    made.step(48)
    frame = frame_of(made, "depth", "instance", "category", "rgb")
    made.close()
    cloud = frame.points()
    floor = cloud.instance == 1
    assert floor.sum() > 100
    assert np.abs(cloud.xyz[floor, 2]).max() < 1e-4
    with pytest.raises(InvalidRequest, match="rolling shutter"):
        motion(frame, frame)


def test_at_the_start_and_after_a_jump_rows_see_one_instant() -> None:
    """Nothing is known of before: things stood where they are."""
    made = simulation(row_time_us=400.0, exposure_time_ms=5.0)
    assert frame_of(made, "depth").row_poses is None
    assert frame_of(made, "depth").stamp_ns == 0
    made.step(48)
    assert frame_of(made, "depth").row_poses is not None
    made.set_position((1.0, 2.0, 1.5), agent="shutter", teleport=True)
    rows = frame_of(made, "depth").row_poses
    made.close()
    assert rows is None or (rows.world_from_camera == rows.world_from_camera[0]).all()


def test_what_was_before_the_shutter_took_time_is_not_known() -> None:
    """Nor what was between two times at which it did; what is put elsewhere moves in one step."""
    made = simulation(row_time_us=400.0)
    made.step(12)
    made.set_picture(PictureSettings(), agent="shutter")
    made.step(48)
    made.set_picture(row_time_us=400.0, agent="shutter")
    assert frame_of(made, "depth").row_poses is None
    made.step(12)
    made.set_position((1.0, 2.0, 1.5), agent="shutter")
    rows = frame_of(made, "depth").row_poses
    assert rows is not None
    places = rows.world_from_camera[:, :3, 3]
    in_last_step = rows.times_ns > made.world.sim_time_ns - 1e9 / 240
    assert np.linalg.norm(np.diff(places[~in_last_step], axis=0), axis=1).max() < 1e-3
    np.testing.assert_allclose(places[-1], (1.0, 2.0, 1.5), atol=1e-3)
    made.step(1)
    made.move_object(2, (0.0, 0.5, 1.4))
    assert np.isfinite(frame_of(made, "depth")["depth"]).any()
    made.step(12)
    rows = frame_of(made, "depth").row_poses
    assert rows is not None
    still = rows.world_from_camera[:, :3, 3]
    np.testing.assert_allclose(still, [(1.0, 2.0, 1.5)] * HEIGHT, atol=1e-9)
    made.close()


def test_equal_calls_give_equal_bytes() -> None:
    """Of a rolling, blurred, noisy picture too."""
    frames = []
    for _ in range(2):
        made = simulation(row_time_us=200.0, exposure_time_ms=8.0, full_well=800.0)
        made.step(30)
        frame_of(made, "rgb")
        made.step(9)
        frames.append(frame_of(made, "rgb", "flow", "occlusion"))
        made.close()
    for view in frames[0]:
        np.testing.assert_array_equal(frames[0][view], frames[1][view], err_msg=view)
