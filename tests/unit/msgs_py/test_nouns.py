"""Times, poses, cameras, agents and scenes as messages."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from geometry_msgs.msg import Point, Quaternion
from geometry_msgs.msg import Pose as PoseMsg
from hypothesis import given
from hypothesis import strategies as st
from std_msgs.msg import Header

import sailenv_msgs.msg as msgs
from sailenv_msgs.msg import AgentInfo
from sailenv_msgs_py.agents import agent_spec_from_msg, agent_spec_to_msg
from sailenv_msgs_py.camera_info import camera_info_from_intrinsics, intrinsics_from_camera_info
from sailenv_msgs_py.frame_info import frame_info_to_msg, header_of_frame
from sailenv_msgs_py.pictures import (
    picture_changes_from_msg,
    picture_from_msg,
    picture_to_msg,
)
from sailenv_msgs_py.scene_info import (
    light_from_msg,
    light_to_msg,
    scene_info_from_msg,
    scene_info_to_msg,
)
from sailenv_msgs_py.stamps import MAX_STAMP_NS, ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_stamped_to_msg, pose_to_msg
from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.frame import FIVE_VIEWS, VIEWS, Frame
from sailenv_ros.geometry import Pose
from sailenv_ros.labels import Category, CategoryTable, Instance
from sailenv_ros.lights import Environment, Light
from sailenv_ros.picture_settings import NAMES, PictureSettings
from sailenv_ros.scene_info import MoverInfo, SceneInfo

COORDINATES = st.floats(-1e4, 1e4)
ANGLES = st.floats(-360.0, 360.0)
POSES = st.builds(
    Pose.from_rpy_deg,
    st.tuples(COORDINATES, COORDINATES, COORDINATES),
    st.tuples(ANGLES, ANGLES, ANGLES),
)
SIZES = st.integers(8, 4096)
INTRINSICS = st.builds(
    CameraIntrinsics,
    width=SIZES,
    height=SIZES,
    vertical_fov_deg=st.floats(1.0, 170.0),
    near_m=st.floats(1e-3, 1.0),
    far_m=st.floats(2.0, 1e4),
)
PICTURES = st.builds(
    PictureSettings,
    exposure=st.floats(-16.0, 16.0),
    tone_curve=st.sampled_from(["filmic", "linear"]),
    occlusion_strength=st.floats(0.0, 1.0),
    occlusion_radius_m=st.floats(0.01, 5.0),
    smooth_edges=st.booleans(),
    supersampling=st.integers(1, 4),
    bloom=st.floats(0.0, 1.0),
    full_well=st.floats(0.0, 1e7),
    read_noise=st.floats(0.0, 1e4),
)
SPECS = st.builds(
    AgentSpec,
    name=st.from_regex(r"[a-z][a-z0-9_]{0,62}", fullmatch=True),
    intrinsics=INTRINSICS,
    depth_range_m=st.floats(1.5, 1e3),
    rate_hz=st.floats(0.0, 240.0),
    views=st.sets(st.sampled_from(sorted(VIEWS)), min_size=1).map(tuple),
    following=st.booleans(),
    mover=st.text(max_size=8).filter(lambda text: "\x00" not in text),
    # Sizes beyond a quarter of the greatest have no room for more samples.
    picture=PICTURES.map(lambda picture: dataclasses.replace(picture, supersampling=1)),
)


@given(st.integers(0, MAX_STAMP_NS))
def test_times_survive_to_the_nanosecond(time_ns: int) -> None:
    """A stamp is the simulated time, exactly."""
    stamp = stamp_from_ns(time_ns)
    assert 0 <= stamp.nanosec < 10**9
    assert ns_from_stamp(stamp) == time_ns


@pytest.mark.parametrize("time_ns", [-1, MAX_STAMP_NS + 1])
def test_a_time_that_no_stamp_holds_is_refused(time_ns: int) -> None:
    """Nothing wraps around silently."""
    with pytest.raises(InvalidRequest, match="time must be"):
        stamp_from_ns(time_ns)


@given(POSES)
def test_poses_survive_bit_for_bit(pose: Pose) -> None:
    """Position and quaternion are copied, not computed."""
    assert pose_from_msg(pose_to_msg(pose)) == pose


@pytest.mark.parametrize(
    "msg",
    [
        PoseMsg(position=Point(x=math.nan)),
        PoseMsg(position=Point(z=math.inf)),
        PoseMsg(orientation=Quaternion(w=1.2)),
        PoseMsg(orientation=Quaternion(x=0.0, w=0.0)),
        PoseMsg(orientation=Quaternion(w=math.nan)),
    ],
)
def test_a_pose_that_is_none_is_refused(msg: PoseMsg) -> None:
    """NaN, infinity and quaternions that are not of unit length do not get in."""
    with pytest.raises(InvalidRequest, match="must be"):
        pose_from_msg(msg)


def test_stamped_poses_name_their_frame() -> None:
    """The stamp and the coordinate frame are those given."""
    msg = pose_stamped_to_msg(Pose((1.0, 2.0, 3.0)), stamp_from_ns(5), "world")
    assert (msg.header.frame_id, msg.header.stamp.nanosec, msg.pose.position.y) == ("world", 5, 2.0)


@given(INTRINSICS)
def test_camera_infos_hold_the_intrinsics(intrinsics: CameraIntrinsics) -> None:
    """K is ours, P is [K | 0], and the axis meets ((W - 1)/2, (H - 1)/2)."""
    msg = camera_info_from_intrinsics(intrinsics, Header())
    assert np.array_equal(np.reshape(msg.k, (3, 3)), intrinsics.K)
    assert np.array_equal(np.reshape(msg.p, (3, 4))[:, :3], intrinsics.K)
    assert (msg.k[2], msg.k[5]) == ((intrinsics.width - 1) / 2, (intrinsics.height - 1) / 2)
    assert list(msg.d) == [0.0] * 5
    assert np.array_equal(np.reshape(msg.r, (3, 3)), np.eye(3))
    back = intrinsics_from_camera_info(msg, near_m=intrinsics.near_m, far_m=intrinsics.far_m)
    assert np.allclose(back.K, intrinsics.K, rtol=1e-9)


def test_a_camera_of_another_kind_is_refused() -> None:
    """Distortion, oblong pixels and an axis off the centre are not dropped silently."""
    for change in ({"d": [0.1, 0.0, 0.0, 0.0, 0.0]}, {"k": [5.0, 0, 0, 0, 6.0, 0, 0, 0, 1]}):
        msg = camera_info_from_intrinsics(CameraIntrinsics(), Header())
        for field, value in change.items():
            setattr(msg, field, value)
        with pytest.raises(InvalidRequest):
            intrinsics_from_camera_info(msg)
    shifted = camera_info_from_intrinsics(CameraIntrinsics(), Header())
    shifted.k[2] += 0.5
    with pytest.raises(InvalidRequest, match="cx, cy"):
        intrinsics_from_camera_info(shifted)


@given(SPECS, st.none() | POSES)
def test_agents_survive(spec: AgentSpec, pose: Pose | None) -> None:
    """Everything of a spec travels but its pose, which stands beside the message."""
    back = agent_spec_from_msg(agent_spec_to_msg(spec), pose=pose)
    assert back == dataclasses.replace(spec, pose=pose)


def test_a_message_with_a_name_alone_is_an_agent() -> None:
    """The message's defaults are the spec's own, so a request need not spell them out."""
    assert agent_spec_from_msg(AgentInfo(name="cam")) == AgentSpec(name="cam", views=FIVE_VIEWS)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"width": 0}, InvalidRequest),
        ({"height": 100000}, InvalidRequest),
        ({"name": "Not a name"}, InvalidRequest),
        ({"views": ["rgb", "heat"]}, UnknownName),
        ({"rate_hz": math.nan}, InvalidRequest),
        ({"vertical_fov_deg": math.inf}, InvalidRequest),
        ({"near_m": -1.0}, InvalidRequest),
        ({"picture": msgs.PictureSettings(bloom=math.nan)}, InvalidRequest),
        ({"picture": msgs.PictureSettings(tone_curve="log")}, UnknownName),
    ],
)
def test_an_agent_out_of_range_is_refused(
    change: dict[str, object], error: type[Exception]
) -> None:
    """Every number of a request is looked at."""
    fields = {"name": "cam", **change}
    with pytest.raises(error, match="must be"):
        agent_spec_from_msg(AgentInfo(**fields))


def test_a_picture_s_message_has_every_setting() -> None:
    """Names, order and defaults are those of the noun; numbers keep their precision."""
    assert tuple(msgs.PictureSettings.get_fields_and_field_types()) == NAMES
    assert picture_from_msg(msgs.PictureSettings()) == PictureSettings()
    fine = PictureSettings(exposure=0.1, read_noise=1.0 / 3.0)
    assert picture_from_msg(picture_to_msg(fine)) == fine


def test_some_settings_of_a_picture_are_taken_over() -> None:
    """Those that are named, or all if none is; what is not named is not looked at."""
    msg = msgs.PictureSettings(exposure=1.5, bloom=7.0)
    assert picture_changes_from_msg(msg, ["exposure"]) == {"exposure": 1.5}
    assert tuple(picture_changes_from_msg(msg, [])) == NAMES
    with pytest.raises(UnknownName, match="did you mean 'bloom'"):
        picture_changes_from_msg(msg, ["blom"])


def scene_info() -> SceneInfo:
    """A scene with one of everything."""
    cube = Instance(
        id=7, name="red cube", asset="cube", category_id=1, category="cube", static=False
    )
    sun = Light(name="sun", type="directional", direction=(0.0, 0.6, -0.8), intensity=2.5)
    return SceneInfo(
        scene="optical",
        scenes=("optical", "room"),
        epoch=2,
        revision=9,
        sim_time_ns=1_234_567_890,
        mode="lockstep",
        paused=True,
        real_time_factor=0.5,
        seed=2**62,
        categories=CategoryTable([Category(id=1, name="cube", colour=(9, 8, 7))]),
        instances=(cube, dataclasses.replace(cube, id=65535, name="floor", static=True)),
        moving=frozenset({7}),
        spawnables=("cube",),
        lights=(sun,),
        environment=Environment(ambient=(0.25, 0.5, 1.0), background="colour", exposure=-1.5),
        agents=(AgentSpec(name="agent", mover="mover"),),
        movers=(
            MoverInfo(
                name="mover",
                controller="waypoint",
                waypoints=(Pose((1.0, 2.0, 3.0)), Pose.from_rpy_deg((0, 0, 1), (0, 0, 90))),
                total_time_s=12.5,
                loop=False,
            ),
            MoverInfo(name="cart", controller="rigidbody"),
        ),
        renderer="blank",
    )


def test_scenes_survive() -> None:
    """Clients read the very scene that the simulator announced."""
    info = scene_info()
    back = scene_info_from_msg(scene_info_to_msg(info))
    names = [field.name for field in dataclasses.fields(SceneInfo)]
    assert [
        (name, getattr(back, name)) for name in names if name not in ("categories", "environment")
    ] == [
        (name, getattr(info, name)) for name in names if name not in ("categories", "environment")
    ]
    assert dict(back.categories) == dict(info.categories)
    assert back.environment.ambient == (0.25, 0.5, 1.0)
    assert (back.environment.background, back.environment.exposure) == ("colour", -1.5)


UNIT = st.floats(0.0, 1.0, width=32)


@given(
    st.builds(
        Light,
        name=st.just("lamp"),
        type=st.sampled_from(["directional", "point", "spot", "area"]),
        colour=st.tuples(UNIT, UNIT, UNIT),
        intensity=st.floats(0.0, 1e6, width=32),
        position_m=st.tuples(COORDINATES, COORDINATES, COORDINATES),
        direction=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.1, 1)),
    )
)
def test_lights_survive(light: Light) -> None:
    """Numbers of single precision come back as they were; directions to rounding."""
    back = light_from_msg(light_to_msg(light))
    assert np.allclose(back.direction, light.direction, rtol=0.0, atol=1e-15)
    same = dataclasses.replace(back, direction=light.direction)
    assert [getattr(same, f) for f in ("name", "type", "colour", "intensity", "position_m")] == [
        getattr(light, f) for f in ("name", "type", "colour", "intensity", "position_m")
    ]
    assert same.inner_cone_deg == pytest.approx(light.inner_cone_deg, rel=1e-6)


def test_frame_infos_tell_what_belongs_to_the_frame() -> None:
    """Sequence, times, scene and the camera's optical pose are the frame's own."""
    pose = Pose.from_rpy_deg((1.0, 2.0, 3.0), (0.0, 0.0, 90.0))
    camera = Camera(intrinsics=CameraIntrinsics(width=8, height=8), pose=pose)
    frame = Frame(
        agent="cam",
        scene="optical",
        epoch=3,
        revision=4,
        sequence=5,
        stamp_ns=2_000_000_001,
        dt_ns=33_333_333,
        camera=camera,
        views={"rgb": np.zeros((8, 8, 3), np.uint8)},
        timings_s={"render": 0.25},
    )
    header = header_of_frame(frame)
    msg = frame_info_to_msg(frame, header, views=("rgb",), depth_range_m=12.0)
    assert (header.stamp.sec, header.stamp.nanosec) == (2, 1)
    assert header.frame_id == "cam/camera_optical_frame"
    assert (msg.agent, msg.scene, msg.epoch, msg.revision, msg.sequence) == (
        "cam",
        "optical",
        3,
        4,
        5,
    )
    assert (msg.dt_ns, msg.views, msg.depth_range_m, msg.render_s) == (
        33_333_333,
        ["rgb"],
        12.0,
        0.25,
    )
    optical = pose_from_msg(msg.camera_pose)
    assert np.allclose(optical.matrix(), camera.world_from_camera, atol=1e-12)
