"""Rigs: cameras on one body, one instant for all, each with its own exact past."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from sailenv_ros import Pose, RigCamera, Simulation
from sailenv_ros.errors import InvalidRequest, InvalidState, NameTaken, SailenvError, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import motion
from sailenv_ros.frame.stereo import disparity
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec, stereo_baseline_m
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from tests.support.blank_renderer import BlankRenderer
from tests.support.lockstep_core import lockstep_core
from tests.support.ray_cast import cast

LENS = CameraIntrinsics(width=160, height=120, cx_offset_px=3.25, fx_px=140.0, fy_px=150.0)
FISHEYE = CameraIntrinsics(
    width=96,
    height=96,
    fx_px=32.0,
    fy_px=32.0,
    distortion_model="equidistant",
    distortion=(0.01, 0.0, 0.0, 0.0),
    max_angle_deg=85.0,
)
VIEWS = ("rgb", "depth", "instance", "flow", "flow_valid", "occlusion", "range")
BASELINE_M = 0.4
RIG = {
    "left": RigCamera(intrinsics=LENS, extrinsics=Pose((0.02, 0.2, 0.01)), views=VIEWS),
    "right": RigCamera(intrinsics=LENS, extrinsics=Pose((0.02, -0.2, 0.01)), views=VIEWS),
    "wide": RigCamera(
        intrinsics=FISHEYE,
        extrinsics=Pose.from_rpy_deg((-0.05, 0.0, 0.1), (10, 20, 30)),
        views=VIEWS,
    ),
}
START = Pose.from_rpy_deg((-3.0, 0.2, 1.1), (3.0, 12.0, 5.0))
STAGE = """
version: 1
settled: false
objects:
  - {name: wall, asset: cube, position: [3, 0, 1], scale: [0.1, 8, 4], static: true}
  - {name: floor, asset: cube, position: [0, 0, -0.05], scale: [9, 7, 0.1], static: true}
  - {name: near, asset: cube, position: [0, 0.1, 0.5], scale: [0.3, 0.4, 1], static: true}
  - {name: box, asset: cube, position: [1, -1, 0.6], scale: 0.5, static: true}
agents:
  - name: head
    following: false
    position: [-3.0, 0.2, 1.1]
    rate: 30
    cameras:
      - {name: left, width: 16, height: 12, position: [0, 0.06, 0]}
      - {name: right, width: 16, height: 12, position: [0, -0.06, 0], rotation: [0, 0, -4],
         views: [depth], picture: {exposure: 0.5}}
"""


def rig(**settings: Any) -> AgentSpec:
    return AgentSpec(
        **{
            "name": "rig",
            "following": False,
            "pose": START,
            "cameras": RIG,
            "rate_hz": 0,
            **settings,
        }
    )


@pytest.fixture
def core(tmp_path: Path) -> Iterator[SynchronousSimulation]:
    stage = tmp_path / "stage.yaml"
    stage.write_text(STAGE, encoding="utf-8")
    made = lockstep_core(stage, renderer=NativeRenderer())
    made.register_agent(rig())
    yield made
    made.close()


def test_one_instant_and_known_places(core: SynchronousSimulation) -> None:
    """Each camera is where its extrinsics say, whatever the body's pose; one stamp for all."""
    core.step(8)
    frames = core.capture_rig(agent="rig")
    assert list(frames) == ["left", "right", "wide"]
    assert {frame.stamp_ns for frame in frames.values()} == {33_333_333}
    body = core.get_agent_pose(agent="rig").pose.matrix()
    for name, frame in frames.items():
        expected = body @ RIG[name].extrinsics.matrix()
        assert np.abs(frame.camera.pose.matrix() - expected).max() < 1e-12
        assert core.get_agent_pose(agent=f"rig/{name}").pose == frame.camera.pose
        assert frame.camera.intrinsics == RIG[name].intrinsics
        assert tuple(frame) == VIEWS


def test_a_camera_of_a_rig_sees_what_any_agent_there_sees(core: SynchronousSimulation) -> None:
    """The same bytes as a camera of the same name and pose that stands alone."""
    frames = core.capture_rig(agent="rig")
    renderer = NativeRenderer()
    for frame in frames.values():
        alone = renderer.render(RenderRequest(core.world.snapshot(), frame.camera, VIEWS)).views
        for view in VIEWS:
            assert frame[view].tobytes() == alone[view].tobytes()
    renderer.close()


def test_flow_is_of_each_camera_s_own_past(core: SynchronousSimulation) -> None:
    """What stands still moves as the camera's own two poses say, also off the body's centre."""
    before = core.capture_rig(agent="rig")
    core.step(24)
    core.set_pose(Pose.from_rpy_deg((-2.9, 0.15, 1.15), (1.0, 9.0, 11.0)), agent="rig")
    after = core.capture_rig(agent="rig")
    for name, frame in after.items():
        points = points_of(frame)
        then = before[name].camera
        eye = then.camera_from_world
        earlier = then.intrinsics.project(points @ eye[:3, :3].T + eye[:3, 3])
        v, u = np.mgrid[: frame.camera.intrinsics.height, : frame.camera.intrinsics.width]
        moved = np.stack([u, v], axis=-1) - earlier
        seen = (frame["flow_valid"] > 0) & np.isfinite(points[..., 0])
        assert seen.mean() > 0.4
        wrong = np.abs(frame["flow"] * frame.dt_s - moved)[seen].max()
        assert wrong < 2e-3
        assert frame.dt_ns == 100_000_000


def test_a_teleport_of_the_body_cuts_the_past_of_its_cameras(core: SynchronousSimulation) -> None:
    """None has flow then; a set pose alone is motion."""
    core.capture_rig(agent="rig")
    core.step(8)
    core.set_pose(Pose((-2.0, 0.0, 1.0)), teleport=True, agent="rig")
    assert {frame.dt_ns for frame in core.capture_rig(agent="rig").values()} == {0}


def test_disparity_is_arithmetic_and_opencv_s(core: SynchronousSimulation) -> None:
    """d = fx B / z; OpenCV makes of it the points that the depth tells."""
    frames = core.capture_rig(agent="rig")
    left, right = frames["left"], frames["right"]
    stereo = disparity(left, right)
    assert stereo.baseline_m == pytest.approx(BASELINE_M, abs=1e-12)
    expected = LENS.fx * BASELINE_M / left["depth"].astype(np.float64)
    near = np.isfinite(left["depth"])
    assert near.any()
    assert not near.all()
    assert np.abs(stereo.disparity[near] / expected[near] - 1.0).max() < 1e-6
    assert (stereo.disparity[np.isposinf(left["depth"])] == 0.0).all()
    points = cv2.reprojectImageTo3D(stereo.disparity, stereo.Q.astype(np.float32))
    assert np.abs(points - LENS.unproject(left["depth"]))[near].max() < 1e-4


def test_q_is_that_of_stereo_rectify() -> None:
    """With square pixels it is what `cv2.stereoRectify` computes of the same pair."""
    lens = CameraIntrinsics(width=64, height=48)
    cameras = {
        "left": RigCamera(intrinsics=lens, extrinsics=Pose((0, 0.05, 0))),
        "right": RigCamera(intrinsics=lens, extrinsics=Pose((0, -0.05, 0))),
    }
    with Simulation("optical", mode="lockstep", agent=rig(cameras=cameras)) as simulation:
        frames = simulation.capture_rig()
        again = disparity(*simulation.get_frames().values())
    stereo = disparity(frames["left"], frames["right"])
    assert again.disparity.tobytes() == stereo.disparity.tobytes()
    size, move = (64, 48), np.array([[-0.1], [0.0], [0.0]])
    none = np.zeros(5)
    _, _, _, right_p, q, *_ = cv2.stereoRectify(
        lens.K, none, lens.K, none, size, np.eye(3), move, flags=cv2.CALIB_ZERO_DISPARITY, alpha=-1
    )
    assert right_p[0, 3] / right_p[0, 0] == pytest.approx(-stereo.baseline_m)
    assert q[3] / stereo.Q[3, 2] == pytest.approx([0.0, 0.0, 1.0, 0.0], abs=1e-9)
    assert stereo.Q[:3, :3].tolist() == [[1, 0, 0], [0, 1, 0], [0, 0, 0]]
    assert stereo.Q[:3, 3] == pytest.approx([-lens.cx, -lens.cy, lens.fx])


def test_what_one_camera_alone_sees_is_occluded(core: SynchronousSimulation) -> None:
    """Away from edges: where a ray from the right camera to the point is stopped before it."""
    frames = core.capture_rig(agent="rig")
    left, right = frames["left"], frames["right"]
    stereo = disparity(left, right)
    snapshot = core.world.snapshot()
    hits = cast(snapshot, left.camera)
    points = points_of(left)
    eye = right.camera.camera_from_world
    there = right.camera.intrinsics.project(points @ eye[:3, :3].T + eye[:3, 3])
    depths = (points @ eye[:3, :3].T + eye[:3, 3])[..., 2]
    inside = (there > -0.5) & (there < np.array([LENS.width, LENS.height]) - 0.5)
    seen = np.isfinite(depths) & hits.away_from_edges()
    assert (stereo.out_of_view == ~inside.all(axis=-1))[seen].all()
    # The judge casts rays of a picture: one of twice the size tells what lies on both sides.
    fine = Camera(intrinsics=LENS.resized(2 * LENS.width, 2 * LENS.height), pose=right.camera.pose)
    judged = cast(snapshot, fine)
    columns, rows = np.moveaxis(np.rint(2.0 * np.nan_to_num(there) + 0.5).astype(int), -1, 0)
    within = inside.all(axis=-1) & seen & (columns > 2) & (rows > 2)
    within &= (columns < fine.intrinsics.width - 3) & (rows < fine.intrinsics.height - 3)
    stopped, open_ = np.zeros_like(within), np.zeros_like(within)
    v, u = np.nonzero(within)
    around = np.stack(
        [
            judged.depth[rows[v, u] + dv, columns[v, u] + du]
            for dv in (-2, 0, 2)
            for du in (-2, 0, 2)
        ]
    )
    stopped[v, u] = (around < 0.9 * depths[v, u]).all(axis=0)
    open_[v, u] = (around > 0.98 * depths[v, u]).all(axis=0)
    assert stopped.sum() > 100
    assert open_.sum() > 5000
    assert stereo.occluded[stopped].all()
    assert stereo.visible[open_].all()


def test_motion_between_cameras_of_any_lens(core: SynchronousSimulation) -> None:
    """From the pin-hole into the fisheye: points are seen where both extrinsics say."""
    frames = core.capture_rig(agent="rig")
    left, wide = frames["left"], frames["wide"]
    eye = wide.camera.camera_from_world
    there = FISHEYE.project(points_of(left) @ eye[:3, :3].T + eye[:3, 3])
    found = motion(left, wide)
    v, u = np.mgrid[: LENS.height, : LENS.width]
    seen = found.visible & np.isfinite(left["depth"])
    assert seen.mean() > 0.1
    assert np.abs(found.flow + np.stack([u, v], axis=-1) - there)[seen].max() < 1e-3


def test_streamed_frames_of_a_rig_have_equal_stamps(core: SynchronousSimulation) -> None:
    """One rate for the body and its cameras, on one grid of time."""
    streams = [
        core.open_stream(f"head/{name}", ("depth",), lambda _: None) for name in ("left", "right")
    ]
    core.set_rate(20.0, agent="head")
    stamps: list[tuple[int, ...]] = []
    for _ in range(3):
        core.step(12)
        stamps.append(tuple(stream.get(0.0).stamp_ns for stream in streams))
    assert stamps == [(50_000_000,) * 2, (100_000_000,) * 2, (150_000_000,) * 2]


def test_cameras_of_a_rig_are_rendered_at_once(tmp_path: Path) -> None:
    """Captured or streamed; other agents' frames are not kept back for them."""
    stage = tmp_path / "stage.yaml"
    stage.write_text(STAGE, encoding="utf-8")
    renderer = BlankRenderer()
    core = lockstep_core(stage, renderer=renderer)
    core.register_agent(AgentSpec(name="alone", intrinsics=LENS))
    try:
        core.capture_rig(agent="head")
        streams = [
            core.open_stream(name, ("depth",), lambda _: None)
            for name in ("head/left", "alone", "head/right")
        ]
        for name in ("head", "alone"):
            core.set_rate(20.0, agent=name)
        renderer.together.clear()
        core.capture_rig(agent="head")
        core.step(12)
        rig = ("head/left", "head/right")
        assert Counter(renderer.together) == {rig: 3, ("alone",): 2}
        assert [stream.get(0.0).stamp_ns for stream in streams] == [50_000_000] * 3
    finally:
        core.close()


def test_a_scene_s_rig_is_saved_as_it_is(core: SynchronousSimulation, tmp_path: Path) -> None:
    """Unchanged it keeps its text; changed or registered by a program it comes back equal."""
    text = core.scene_text()
    assert "cameras:" in text
    assert "rotation: [0, 0, -4]" in text
    core.set_pose(Pose((-1, 0, 1)), agent="head")
    core.set_picture(bloom=0.25, agent="head/left")
    (tmp_path / "again.yaml").write_text(core.scene_text(cameras=["rig/left"]))
    again = lockstep_core(tmp_path / "again.yaml")
    for name in ("head", "rig"):
        now, then = (one.agents.with_cameras(one.agents[name]) for one in (core, again))
        assert now.cameras is not None
        assert then.cameras is not None
        assert list(now.cameras) == list(then.cameras)
        for camera in now.cameras:
            one, other = now.cameras[camera], then.cameras[camera]
            assert np.allclose(one.extrinsics.matrix(), other.extrinsics.matrix(), atol=1e-8)
            assert (one.views, one.picture) == (other.views, other.picture)
            assert one.intrinsics == other.intrinsics
    assert again.get_agent_pose(agent="head").pose.position_m == (-1.0, 0.0, 1.0)
    again.close()


def test_a_rig_lives_and_goes_as_one(core: SynchronousSimulation) -> None:
    """A reset keeps it, deleting the body ends its cameras; one camera can be deleted alone."""
    stream = core.open_stream("rig/wide", ("depth",), lambda _: None)
    core.reset()
    assert list(core.capture_rig(agent="rig")) == ["left", "right", "wide"]
    core.delete_agent("rig/right")
    assert list(core.capture_rig(agent="rig")) == ["left", "wide"]
    core.register_agent(AgentSpec(name="rig/tail", intrinsics=LENS, extrinsics=Pose()))
    assert list(core.capture_rig(("depth",), agent="rig")) == ["left", "wide", "tail"]
    core.delete_agent("rig")
    assert stream.closed
    assert [spec.name for spec in core.info.agents] == ["head", "head/left", "head/right"]


def test_baselines_are_of_rectified_pairs_alone(core: SynchronousSimulation) -> None:
    """To the rig's first camera; 0 where axes or pictures differ."""
    specs = {spec.name: spec for spec in core.info.agents}
    baselines = {name: stereo_baseline_m(spec, specs.values()) for name, spec in specs.items()}
    assert baselines.pop("rig/right") == pytest.approx(BASELINE_M)
    assert set(baselines.values()) == {0.0}


REFUSED: list[tuple[type[SailenvError], str, Callable[[SynchronousSimulation], object]]] = [
    (InvalidState, "rig/left' is fixed to its rig", lambda c: c.set_pose(Pose(), agent="rig/left")),
    (InvalidState, "fixed to its rig", lambda c: c.set_position((0, 0, 0), agent="rig/left")),
    (InvalidState, "fixed to its rig", lambda c: c.set_follow(True, agent="rig/left")),
    (InvalidState, "fixed to its rig", lambda c: c.set_look_at("box", agent="rig/left")),
    (InvalidState, "'rig/left' is no rig", lambda c: c.capture_rig(agent="rig/left")),
    (UnknownName, "view must be", lambda c: c.capture_rig("smell", agent="rig")),
    (NameTaken, "'rig'", lambda c: c.register_agent(rig())),
    (UnknownName, "'no'", lambda c: c.register_agent(AgentSpec(name="no/eye", extrinsics=Pose()))),
    (
        InvalidState,
        "17 of 16 agents",
        lambda c: c.register_agent(
            rig(name="more", cameras={f"c{number}": RigCamera() for number in range(9)})
        ),
    ),
]


@pytest.mark.parametrize(("kind", "words", "call"), REFUSED)
def test_what_cannot_be_is_refused_and_changes_nothing(
    core: SynchronousSimulation,
    kind: type[SailenvError],
    words: str,
    call: Callable[[SynchronousSimulation], object],
) -> None:
    """In one sentence; agents, poses and sequences stay."""
    before = core.info.agents, core.get_agent_pose(agent="rig")
    with pytest.raises(kind, match=words):
        call(core)
    assert (core.info.agents, core.get_agent_pose(agent="rig")) == before


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"cameras": {}}, "cameras must be at least one RigCamera by its name"),
    ({"cameras": {"Left": RigCamera()}}, "name of the camera must be a lower-case letter"),
    ({"cameras": {"left": LENS}}, "camera 'left' must be a sailenv_ros.RigCamera"),
    ({"cameras": {"left": RigCamera(views=("smell",))}}, "view must be one of"),
    ({"name": "a/b"}, "name of the agent must be"),
    ({"extrinsics": Pose()}, "name of the camera must be <agent>/<camera>"),
    ({"name": "a/b", "extrinsics": Pose()}, "pose must be left out: 'a/b' goes where 'a' goes"),
    ({"name": "a/b", "extrinsics": 1, "pose": None}, "extrinsics must be a sailenv_ros.Pose"),
]


@pytest.mark.parametrize(("settings", "words"), WRONG)
def test_a_rig_that_cannot_be_is_refused(settings: dict[str, Any], words: str) -> None:
    """Where it is described, in words of what is accepted."""
    with pytest.raises(InvalidRequest, match=words):
        rig(**settings)


def test_pairs_that_are_not_rectified_have_no_disparity(core: SynchronousSimulation) -> None:
    """Turned, of another lens, in the wrong order, of two instants."""
    frames = core.capture_rig(agent="rig")
    core.step(1)
    later = core.capture_rig(agent="rig")
    pairs = [("right", "left", frames), ("left", "wide", frames), ("left", "right", later)]
    for one, other, those in pairs:
        with pytest.raises(InvalidRequest, match=r"(stereo|rectified) pair"):
            disparity(frames[one], those[other])


def points_of(frame: Frame) -> np.ndarray[Any, np.dtype[np.float64]]:
    """(H, W, 3) world coordinates of what is seen; not finite where nothing is."""
    lens = frame.camera.intrinsics
    if lens.is_pinhole:
        points = lens.unproject(frame["depth"])
    else:
        points = lens.unit_rays() * frame["range"].astype(np.float64)[..., None]
    world = frame.camera.world_from_camera
    with np.errstate(invalid="ignore"):
        moved: np.ndarray[Any, np.dtype[np.float64]] = points @ world[:3, :3].T + world[:3, 3]
    moved[~np.isfinite(moved).all(axis=-1)] = np.nan
    return moved
