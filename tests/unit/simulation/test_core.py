"""Requests, schedules and histories, with a renderer that only remembers what it was asked."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidRequest,
    InvalidState,
    NameTaken,
    SceneError,
    UnknownName,
)
from sailenv_ros.simulation.frame_maker import FrameMaker
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.scene_info import SceneInfo
from tests.support.blank_renderer import BlankRenderer
from tests.support.lockstep_core import lockstep_core

SMALL = CameraIntrinsics(width=16, height=12)


def make_core(**kwargs: object) -> tuple[SynchronousSimulation, BlankRenderer]:
    renderer = BlankRenderer()
    return lockstep_core(renderer=renderer, **kwargs), renderer


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    made, _ = make_core()
    yield made
    made.close()


def spec(name: str = "eye", **kwargs: object) -> AgentSpec:
    return AgentSpec(name=name, intrinsics=SMALL, **kwargs)  # type: ignore[arg-type]  # settings of a test


def test_streamed_frames_fall_on_the_rate_s_grid() -> None:
    """30 Hz is a frame every 8 steps: after a second 31 frames, the first at time 0."""
    core, renderer = make_core()
    core.register_agent(spec())
    stream = core.open_stream("eye", ("depth",), lambda _: None)
    core.streams.render_due()
    core.step(240)
    steps = [snapshot.step for snapshot, *_ in renderer.calls]
    assert steps == list(range(0, 241, 8))
    assert stream.dropped == 30
    assert stream.get(0.0).sequence == 31


@pytest.mark.parametrize("views", [("rgb", "depth"), ("instance",)])
def test_the_renderer_takes_a_scene_up_while_it_changes(
    views: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not in the first frame's deadline; what agents see alone; a reset shows what is known.

    So it is where a simulation works beside its callers.
    """
    monkeypatch.setattr(FrameMaker, "work_alone", lambda _: None)
    core, renderer = make_core()
    core.change_scene("solid_benchmark")
    assert not renderer.calls  # there is nobody to be drawn for
    core.register_agent(spec(views=views))
    core.change_scene("optical")
    (call,) = renderer.calls
    assert call[0].contents is core.world.contents
    assert call[3] == (("rgb",) if "rgb" in views else ("depth",))
    assert core.capture(views, agent="eye").sequence == 1
    core.reset()
    assert len(renderer.calls) == 2
    core.close()


def test_views_that_the_renderer_cannot_make_are_refused_where_they_are_asked_for() -> None:
    """At the capture and at the stream, before a frame falls due; what was wanted stays so."""
    core, renderer = make_core()
    renderer.supported_views = ("rgb", "depth")
    core.register_agent(spec())
    refused = pytest.raises(InvalidRequest, match="that this renderer makes: rgb, depth, got")
    with refused:
        core.capture(("depth", "normals"), agent="eye")
    with refused:
        core.open_stream("eye", ("normals",), lambda _: None)
    stream = core.open_stream("eye", ("depth",), lambda _: None)
    with refused:
        stream.set_views(("normals",))
    core.streams.render_due()
    assert [views for *_, views in renderer.calls] == [("depth",)]
    assert list(stream.get(0.0).views) == ["depth"]


@settings(max_examples=12, deadline=None)
@given(rate=st.floats(0.5, 240.0))
def test_any_rate_gives_its_number_of_frames(rate: float) -> None:
    """Over two seconds an agent gets rate x 2 frames and the first, to one frame; none twice."""
    core, renderer = make_core()
    core.register_agent(spec(rate_hz=rate))
    core.open_stream("eye", ("depth",), lambda _: None)
    core.step(480)
    steps = [snapshot.step for snapshot, *_ in renderer.calls]
    assert abs(len(steps) - (2 * rate + 1)) <= 1.0
    assert sorted(set(steps)) == steps
    core.close()


def test_a_view_that_nobody_wants_is_not_rendered() -> None:
    """Nothing is rendered without a stream, and only the union of what streams want with some."""
    core, renderer = make_core()
    core.register_agent(spec())
    core.step(48)
    assert renderer.calls == []
    core.open_stream("eye", (), lambda _: None)
    core.step(48)
    assert renderer.calls == []
    core.open_stream("eye", ("depth",), lambda _: None)
    core.open_stream("eye", ("flow", "rgb"), lambda _: None)
    core.step(8)
    assert {views for *_, views in renderer.calls} == {("rgb", "depth", "flow")}


@pytest.mark.parametrize("asked", range(1, 6))
def test_whoever_wants_nothing_any_more_may_say_so_at_any_time(
    core: SynchronousSimulation, monkeypatch: pytest.MonkeyPatch, asked: int
) -> None:
    """From a thread of its own, between any two looks at what it wants: the simulation goes on."""
    core.register_agent(spec())
    stream = core.open_stream("eye", ("depth",), lambda _: None)
    left = asked

    def views(own: FrameStream) -> tuple[str, ...]:
        nonlocal left
        left -= 1
        now = own._views
        if left == 0:
            own.set_views(())
        return now

    monkeypatch.setattr(FrameStream, "views", property(views))
    core.streams.render_due()
    core.advance_to(24, every_frame=False)
    assert left <= 0
    assert core.world.step_count == 24
    assert not stream.closed


def test_a_late_loop_renders_the_last_frame_and_counts_the_others() -> None:
    """Catching up 48 steps at 30 Hz shows one frame and says that five were skipped."""
    core, renderer = make_core()
    core.register_agent(spec())
    core.open_stream("eye", ("depth",), lambda _: None)
    core.streams.render_due()
    core.advance_to(48, every_frame=False)
    assert [snapshot.step for snapshot, *_ in renderer.calls] == [0, 48]
    assert core.streams.skipped_frames == 5


def test_flow_refers_to_the_last_frame_of_an_earlier_instant() -> None:
    """The first frame has no past; two frames of one instant share theirs; a step moves it on."""
    core, renderer = make_core()
    core.register_agent(spec())
    first = core.capture(["flow"], agent="eye")
    again = core.capture(["flow"], agent="eye")
    core.step(3)
    third = core.capture(["flow"], agent="eye")
    fourth = core.capture(["flow"], agent="eye")
    assert (first.dt_ns, again.dt_ns) == (0, 0)
    assert third.dt_ns == fourth.dt_ns == 12_500_000
    pasts = [previous for _, previous, *_ in renderer.calls]
    assert pasts[:2] == [None, None]
    assert pasts[2] is not None
    assert pasts[2].snapshot.step == 0
    assert [frame.sequence for frame in (first, again, third, fourth)] == [1, 2, 3, 4]


def test_a_set_pose_is_motion_and_a_teleport_is_not(core: SynchronousSimulation) -> None:
    """After set_position the next frame keeps its past; after a teleport it has none."""
    core.register_agent(spec(following=False))
    core.capture(["depth"], agent="eye")
    core.step(8)
    core.set_position((1.0, 0.0, 1.0), agent="eye")
    assert core.capture(["depth"], agent="eye").dt_ns > 0
    core.step(8)
    core.set_position((2.0, 0.0, 1.0), teleport=True, agent="eye")
    assert core.capture(["depth"], agent="eye").dt_ns == 0


def test_a_following_agent_moves_its_mover_and_all_who_follow(core: SynchronousSimulation) -> None:
    """set_position on a follower moves every follower; a free agent stays."""
    for name, following in (("a", True), ("b", True), ("free", False)):
        core.register_agent(spec(name, following=following))
    before = core.get_pose(agent="free")
    core.set_position((1.0, 2.0, 3.0), agent="a")
    core.step(24)
    assert core.get_pose(agent="a") == core.get_pose(agent="b")
    assert core.get_pose(agent="b").position_m == (1.0, 2.0, 3.0)
    assert core.get_pose(agent="free") == before
    assert core.info.movers[0].controller == "rigidbody"


def test_an_agent_that_stops_following_stays_where_it_is(core: SynchronousSimulation) -> None:
    """It is left in place; when it follows again it is at the mover."""
    core.register_agent(spec())
    core.step(100)
    here = core.get_pose(agent="eye")
    assert core.set_follow(False, agent="eye") is False
    core.step(100)
    assert core.get_pose(agent="eye") == here
    assert core.set_follow(True, agent="eye") is True
    assert core.get_pose(agent="eye") != here


def test_rotation_and_position_leave_each_other_alone(core: SynchronousSimulation) -> None:
    """set_rotation keeps the position, set_position the rotation, to the bit."""
    core.register_agent(spec(following=False, pose=Pose.from_rpy_deg((1, 2, 3), (10, 20, 30))))
    core.set_rotation((0.0, 0.0, 90.0), agent="eye")
    assert core.get_pose(agent="eye").position_m == (1.0, 2.0, 3.0)
    turned = core.get_pose(agent="eye").orientation_xyzw
    core.set_position((0.0, 0.0, 1.0), agent="eye")
    assert core.get_pose(agent="eye").orientation_xyzw == turned


def test_a_new_scene_and_a_reset_have_no_past() -> None:
    """Epochs grow, time starts at 0, flow has nothing to refer to, agents live on."""
    core, renderer = make_core()
    core.register_agent(spec())
    core.step(50)
    core.capture(["flow"], agent="eye")
    core.change_scene("solid_benchmark")
    assert core.info.scene == "solid_benchmark"
    assert core.capture(["flow"], agent="eye").dt_ns == 0
    core.step(10)
    assert core.reset() == 3
    frame = core.capture(["flow"], agent="eye")
    assert (frame.dt_ns, frame.stamp_ns, frame.epoch) == (0, 0, 3)
    assert renderer.calls[-1][1] is None


def test_a_reset_puts_every_byte_back(core: SynchronousSimulation) -> None:
    """After a reset the same steps give the same poses, whatever was done meanwhile."""
    core.register_agent(spec())
    core.step(200)
    before = core.world.snapshot().world_from_body.tobytes()
    pose = core.get_pose(agent="eye")
    core.set_position((9.0, 9.0, 9.0), agent="eye")
    core.set_follow(False, agent="eye")
    core.step(33)
    core.reset()
    core.step(200)
    assert core.world.snapshot().world_from_body.tobytes() == before
    assert core.get_pose(agent="eye") == pose


def test_no_frame_is_newer_than_the_scene_info_told() -> None:
    """Listeners have heard of a revision before a frame carries it."""
    core, _ = make_core()
    told: list[SceneInfo] = []
    core.on_info = told.append
    core.register_agent(spec())
    for change in (core.reset, lambda: core.change_scene("solid_benchmark")):
        change()
        frame = core.capture(["instance"], agent="eye")
        assert frame.info is told[-1]
        assert (frame.revision, frame.epoch) == (told[-1].revision, told[-1].epoch)
    assert [info.revision for info in told] == sorted({info.revision for info in told})


def test_a_frame_keeps_the_instances_of_its_own_instant(core: SynchronousSimulation) -> None:
    """What is spawned or removed later changes no frame that was taken before."""
    core.register_agent(spec())
    before = core.capture(["instance"], agent="eye")
    id_ = core.spawn_object("cube", object_name="box", pose=Pose((3.0, 0.0, 1.0)))
    between = core.capture(["instance"], agent="eye")
    core.despawn_object(id_)
    after = core.capture(["instance"], agent="eye")
    assert [id_ in frame.instances for frame in (before, between, after)] == [False, True, False]
    assert between.to_dict()["instances"][id_].name == "box"
    assert before.revision < between.revision < after.revision


BAD_REQUESTS = [
    (lambda c: c.change_scene("optcal"), UnknownName, "did you mean 'optical'"),
    (
        lambda c: c.set_position((float("nan"), 0, 0), agent="eye"),
        InvalidRequest,
        "three finite numbers",
    ),
    (
        lambda c: c.set_position((float("inf"), 0, 0), agent="eye"),
        InvalidRequest,
        "three finite numbers",
    ),
    (lambda c: c.set_position((1e9, 0, 0), agent="eye"), InvalidRequest, "within ±10000"),
    (lambda c: c.set_rotation((0, 0), agent="eye"), InvalidRequest, "three finite numbers"),
    (lambda c: c.set_position((0, 0, 0), agent="nobody"), UnknownName, "agent must be one of: eye"),
    (lambda c: c.get_agent_pose(agent="nobody"), UnknownName, "agent must be one of: eye"),
    (lambda c: c.delete_agent("nobody"), UnknownName, "agent must be one of: eye"),
    (lambda c: c.register_agent(spec()), NameTaken, "agent name must be a name that is not in use"),
    (
        lambda c: c.register_agent(spec("b", mover="bus")),
        UnknownName,
        "mover must be one of: mover",
    ),
    (lambda c: c.step(-1), InvalidRequest, "steps must be an integer from 1 to 1000000, got -1"),
    (lambda c: c.step(0), InvalidRequest, "steps must be an integer from 1"),
    (lambda c: c.step(1.5), InvalidRequest, "steps must be an integer from 1"),
    (lambda c: c.reset(-1), InvalidRequest, "seed must be an integer from 0"),
    (lambda c: c.capture(["colour"], agent="eye"), UnknownName, "view must be one of: rgb, depth"),
    (lambda c: c.capture([], agent="eye"), InvalidRequest, "views must be at least one of"),
    (lambda c: c.pause(), InvalidState, "a lockstep simulation cannot be paused"),
]


@pytest.mark.parametrize(("call", "error", "sentence"), BAD_REQUESTS)
def test_a_refused_request_changes_nothing(
    core: SynchronousSimulation, call, error, sentence
) -> None:  # type: ignore[no-untyped-def]  # three columns of a table
    """Each bad request gets one sentence, and world, agents and info are as before."""
    core.register_agent(spec())
    info, snapshot, pose = core.info, core.world.snapshot(), core.get_agent_pose(agent="eye")
    with pytest.raises(error, match=sentence):
        call(core)
    assert core.world.snapshot() is snapshot
    assert core.get_agent_pose(agent="eye") == pose
    assert core.info.revision == info.revision
    assert core.info.agents == info.agents


def test_a_scene_file_with_faults_leaves_the_present_one(
    core: SynchronousSimulation, tmp_path: Path
) -> None:
    """Changing to a broken file raises all its errors and the old world goes on."""
    broken = tmp_path / "broken.yaml"
    broken.write_text("version: 1\nobjects:\n  - {name: a, asset: cubee, colr: red}\n")
    world = core.world
    with pytest.raises(SceneError) as caught:
        core.change_scene(str(broken))
    assert len(caught.value.diagnostics) == 2
    assert core.world is world
    core.step(1)


def test_at_most_sixteen_agents(core: SynchronousSimulation) -> None:
    """The seventeenth is refused in words."""
    for number in range(16):
        core.register_agent(spec(f"agent_{number}"))
    with pytest.raises(InvalidState, match="16 agents, which is the most; delete one first"):
        core.register_agent(spec("one_more"))


def test_a_running_simulation_is_not_stepped_by_hand() -> None:
    """step is for paused and lockstep simulations."""
    core, renderer = make_core(mode="realtime")
    with pytest.raises(InvalidState, match="pause it before stepping"):
        core.step(1)
    core.pause()
    assert core.step(2) == 8_333_333
    core.close()
    assert renderer.closed


def test_picture_settings_go_to_the_camera_and_survive_a_reset(core: SynchronousSimulation) -> None:
    """As registered, then as set; the camera carries its agent's name; wrong ones are refused."""
    renderer = core.frames._renderer
    assert isinstance(renderer, BlankRenderer)
    first, second = PictureSettings(exposure=1.0), PictureSettings(full_well=500.0)
    core.register_agent(spec(rate_hz=0.0, picture=first))
    core.capture(("rgb",), agent="eye")
    core.set_picture(second, agent="eye")
    core.capture(("rgb",), agent="eye")
    core.reset()
    core.capture(("rgb",), agent="eye")
    cameras = [camera for *_, camera, _ in renderer.calls]
    assert [camera.picture for camera in cameras] == [first, second, second]
    assert {camera.name for camera in cameras} == {"eye"}
    with pytest.raises(InvalidRequest, match="PictureSettings"):
        core.set_picture({"exposure": 1.0}, agent="eye")  # type: ignore[arg-type]  # on purpose
    with pytest.raises(UnknownName, match="agent"):
        core.set_picture(first, agent="nobody")
    assert core.info.agents[-1].picture == second


def test_some_settings_of_a_picture_are_changed(core: SynchronousSimulation) -> None:
    """The others stay; what is refused, or names nothing, changes nothing and is not announced."""
    begun = PictureSettings(bloom=0.5, smooth_edges=False)
    core.register_agent(spec(rate_hz=0.0, picture=begun))
    changed = core.set_picture(exposure=1.0, tone_curve="linear", agent="eye")
    assert changed == PictureSettings(
        bloom=0.5, smooth_edges=False, exposure=1.0, tone_curve="linear"
    )
    assert core.get_picture(agent="eye") == core.info.agents[-1].picture == changed
    assert core.set_picture(begun, bloom=0.25, agent="eye") == replace(begun, bloom=0.25)
    before = core.info
    refused: list[dict[str, Any]] = [
        {"exposure": 1.0, "bloom": 2.0},
        {"exposure": "bright"},
        {"exposure": 1.0, "tone_curve": "log"},
        {"exposure": 1.0, "rate_hz": 2.0},
        {"exposure": 1.0, "settings": begun},
        {"smooth_edges": 1},
    ]
    for changes in refused:
        with pytest.raises(InvalidRequest, match="must be"):
            core.set_picture(**changes, agent="eye")
    with pytest.raises(UnknownName, match="did you mean 'exposure'"):
        core.set_picture(exposur=1.0, agent="eye")
    assert (
        core.set_picture(agent="eye") == core.get_picture(agent="eye") == replace(begun, bloom=0.25)
    )
    assert core.info.revision == before.revision
    with pytest.raises(UnknownName, match="agent"):
        core.get_picture(agent="nobody")


def test_an_agent_s_picture_is_an_object_of_settings() -> None:
    """A mapping in its place is refused in words."""
    with pytest.raises(InvalidRequest, match="object of PictureSettings"):
        AgentSpec(name="eye", picture={"exposure": 1.0})  # type: ignore[arg-type]  # on purpose


def test_a_picture_of_too_many_samples_changes_nothing(core: SynchronousSimulation) -> None:
    """Neither by its settings nor by its size, whichever comes second."""
    wide = CameraIntrinsics(width=2048, height=16)
    core.register_agent(spec(rate_hz=0.0))
    core.set_intrinsics(wide, agent="eye")
    twice = PictureSettings(supersampling=2)
    core.set_picture(twice, agent="eye")
    before = core.info.agents
    with pytest.raises(InvalidRequest, match="supersampling must be at most 2 for 2048 x 16 px"):
        core.set_picture(PictureSettings(supersampling=3), agent="eye")
    with pytest.raises(InvalidRequest, match="supersampling must be at most 1 for 4096 x 16 px"):
        core.set_intrinsics(CameraIntrinsics(width=4096, height=16), agent="eye")
    assert core.info.agents == before


def test_a_depth_sensor_of_parallel_rays_is_refused(core: SynchronousSimulation) -> None:
    """From both sides; an ideal one measures depth."""
    parallel = CameraIntrinsics(
        width=16, height=16, distortion_model="orthographic", fx_px=9.0, fy_px=9.0
    )
    sensor = PictureSettings(depth_sensor="kinect_v1")
    accepted = "depth_sensor must be 'ideal' where rays are parallel"
    with pytest.raises(InvalidRequest, match=accepted):
        replace(spec(rate_hz=0.0), intrinsics=parallel, picture=sensor)
    core.register_agent(spec(rate_hz=0.0))
    core.set_picture(sensor, agent="eye")
    before = core.info.agents
    with pytest.raises(InvalidRequest, match=accepted):
        core.set_intrinsics(parallel, agent="eye")
    assert core.info.agents == before
    core.set_picture(PictureSettings(), agent="eye")
    core.set_intrinsics(parallel, agent="eye")
    with pytest.raises(InvalidRequest, match=accepted):
        core.set_picture(sensor, agent="eye")


def test_a_changed_rate_begins_on_its_own_grid(core: SynchronousSimulation) -> None:
    """Frames fall on multiples of the new interval, from the next on; a reset keeps the rate."""
    core.register_agent(spec(rate_hz=30.0))
    stream = core.open_stream("eye", ("depth",), lambda _: None)
    core.step(10)
    core.set_rate(60.0, agent="eye")
    stamps = []
    for _ in range(12):
        core.step(1)
        with contextlib.suppress(DeadlineExceeded):
            stamps.append(round(stream.get(0.0).stamp_ns * 240e-9))
    assert stamps == [8, 12, 16, 20]
    core.reset()
    assert core.info.agents[-1].rate_hz == 60.0
    core.set_rate(0.0, agent="eye")
    core.step(48)
    with pytest.raises(DeadlineExceeded):
        stream.get(0.0)


def test_another_lens_begins_without_a_past(core: SynchronousSimulation) -> None:
    """The next frame has the new size and refers to no earlier one; a reset keeps the lens."""
    core.register_agent(spec())
    core.capture(("depth",), agent="eye")
    core.step(8)
    wide = CameraIntrinsics(width=20, height=10, vertical_fov_deg=90.0)
    core.set_intrinsics(wide, agent="eye")
    frame = core.capture(("depth", "flow"), agent="eye")
    assert frame["depth"].shape == (10, 20)
    assert frame.dt_ns == 0
    core.reset()
    assert core.info.agents[-1].intrinsics == wide
    with pytest.raises(InvalidRequest):
        core.set_intrinsics(CameraIntrinsics(near_m=20.0), agent="eye")
    assert core.info.agents[-1].intrinsics == wide


@pytest.mark.parametrize("rate", [-1.0, 241.0, float("nan"), "often"])
def test_a_rate_out_of_range_changes_nothing(core: SynchronousSimulation, rate: object) -> None:
    """The old rate stays."""
    core.register_agent(spec(rate_hz=30.0))
    with pytest.raises(InvalidRequest, match="a number from 0 to 240"):
        core.set_rate(rate, agent="eye")  # type: ignore[arg-type]  # on purpose
    assert core.info.agents[-1].rate_hz == 30.0
