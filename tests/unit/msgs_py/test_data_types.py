"""Times, poses, cameras, agents and scenes as messages."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_msgs.msg import Point, Quaternion
from geometry_msgs.msg import Pose as PoseMsg
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

import sailenv_msgs.msg as msgs
from sailenv_msgs.msg import AgentInfo
from sailenv_msgs.srv import SetIntrinsics
from sailenv_msgs_py.agent_msgs import agent_spec_from_msg
from sailenv_msgs_py.camera_info import camera_info_from_intrinsics, intrinsics_from_camera_info
from sailenv_msgs_py.frame_info import frame_info_to_msg, header_of_frame
from sailenv_msgs_py.intrinsics_fields import (
    INTRINSICS_FIELDS,
    intrinsics_fields,
    intrinsics_from_fields,
)
from sailenv_msgs_py.picture_msgs import (
    picture_from_msg,
    picture_to_msg,
)
from sailenv_msgs_py.stamps import MAX_STAMP_NS, ns_from_stamp, stamp_from_ns
from sailenv_msgs_py.transforms import pose_from_msg, pose_stamped_to_msg, pose_to_msg
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import NAMES, PictureSettings
from sailenv_ros.types.views import FIVE_VIEWS
from tests.support.small_frame import small_frame

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
    cx_offset_px=st.floats(-4.0, 4.0) | st.just(0.0),
    cy_offset_px=st.floats(-4.0, 4.0) | st.just(0.0),
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
    """K is ours, P is [K | 0], and a central axis meets ((W - 1)/2, (H - 1)/2)."""
    msg = camera_info_from_intrinsics(intrinsics, Header())
    assert np.array_equal(np.reshape(msg.k, (3, 3)), intrinsics.K)
    assert np.array_equal(np.reshape(msg.p, (3, 4))[:, :3], intrinsics.K)
    assert msg.k[2] == (intrinsics.width - 1) / 2 + intrinsics.cx_offset_px
    assert msg.k[5] == (intrinsics.height - 1) / 2 + intrinsics.cy_offset_px
    assert list(msg.d) == [0.0] * 5
    assert np.array_equal(np.reshape(msg.r, (3, 3)), np.eye(3))
    back = intrinsics_from_camera_info(msg, near_m=intrinsics.near_m, far_m=intrinsics.far_m)
    assert np.allclose(back.K, intrinsics.K, rtol=1e-9, atol=1e-6)
    if intrinsics.cx_offset_px == 0.0:
        assert back.cx_offset_px == 0.0


@pytest.mark.parametrize(
    ("model", "coefficients", "told"),
    [
        ("plumb_bob", (-0.28, 0.08, 1e-3, -2e-3), [-0.28, 0.08, 1e-3, -2e-3, 0.0]),
        ("plumb_bob", (-0.28, 0.08, 1e-3, -2e-3, 0.01), None),
        ("rational_polynomial", (0.6, -0.03, 0.0, 1e-3, 0.001, 0.95, 0.03, -0.004), None),
        ("equidistant", (0.003, 0.001, -0.002, 0.0002), None),
        ("mei", (1.04, -0.2, 0.04, 0.0, 0.0), None),
    ],
)
def test_camera_infos_hold_the_distortion(
    model: str, coefficients: tuple[float, ...], told: list[float] | None
) -> None:
    """Under ROS's names, with as many coefficients as `image_geometry` reads; and come back."""
    lens = CameraIntrinsics(
        fx_px=700.0, fy_px=650.5, cx_offset_px=4.5, distortion_model=model, distortion=coefficients
    )
    msg = camera_info_from_intrinsics(lens, Header())
    assert msg.distortion_model == model
    assert [*msg.d] == (told or [*coefficients])
    assert [*msg.k] == [700.0, 0.0, 324.0, 0.0, 650.5, 239.5, 0.0, 0.0, 1.0]
    assert [*msg.p] == [700.0, 0.0, 324.0, 0.0, 0.0, 650.5, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0]
    back = intrinsics_from_camera_info(msg)
    assert [*back.distortion] == [*msg.d]
    np.testing.assert_array_equal(back.unit_rays(), lens.unit_rays())


def test_a_camera_info_of_others_is_read_or_refused() -> None:
    """Oblong pixels, a sensor that is not tilted; models, axes and focal lengths that are none."""
    msg = camera_info_from_intrinsics(CameraIntrinsics(), Header())
    msg.k[0] = 500.0
    assert intrinsics_from_camera_info(msg).fx == 500.0
    msg.distortion_model, msg.d = "rational_polynomial", [0.1, *[0.0] * 13]
    assert len(intrinsics_from_camera_info(msg).distortion) == 12
    msg.d = [0.1, *[0.0] * 12, 0.2]
    with pytest.raises(InvalidRequest, match="distortion must be 8 or 12 finite numbers"):
        intrinsics_from_camera_info(msg)
    msg.distortion_model = "thin_prism_fisheye"
    with pytest.raises(InvalidRequest, match="distortion_model must be one of: pinhole, plumb_bob"):
        intrinsics_from_camera_info(msg)
    with pytest.raises(InvalidRequest, match="focal lengths fx, fy must be above 0"):
        intrinsics_from_camera_info(CameraInfo(width=64, height=48))
    shifted = camera_info_from_intrinsics(CameraIntrinsics(), Header())
    shifted.k[2] += 320.5
    with pytest.raises(InvalidRequest, match="cx_offset_px"):
        intrinsics_from_camera_info(shifted)


def test_a_request_for_a_lens_arrives_as_it_was_sent() -> None:
    """Of any model; without its fields it is the usual one."""
    lens = CameraIntrinsics(
        vertical_fov_deg=190.0,
        cx_offset_px=-3.5,
        max_angle_deg=110.0,
        distortion_model="equidistant",
        distortion=(0.01, 0.0, -0.001, 0.0),
    )
    parallel = CameraIntrinsics(fx_px=90.0, fy_px=80.0, distortion_model="orthographic")
    for sent in (lens, parallel, CameraIntrinsics(fx_px=400.0, fy_px=300.0)):
        request = SetIntrinsics.Request(**intrinsics_fields(sent))
        received = {name: getattr(request, name) for name in INTRINSICS_FIELDS}
        assert intrinsics_from_fields(received) == sent
    plain = SetIntrinsics.Request()
    received = {name: getattr(plain, name) for name in INTRINSICS_FIELDS}
    assert intrinsics_from_fields(received) == CameraIntrinsics()


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
    """Names, order and defaults are those of the data type; numbers keep their precision."""
    assert tuple(msgs.PictureSettings.get_fields_and_field_types()) == NAMES
    assert picture_from_msg(msgs.PictureSettings()) == PictureSettings()
    fine = PictureSettings(exposure=0.1, read_noise=1.0 / 3.0)
    assert picture_from_msg(picture_to_msg(fine)) == fine


def test_frame_infos_tell_what_belongs_to_the_frame() -> None:
    """Sequence, times, scene and the camera's optical pose are the frame's own."""
    pose = Pose.from_rpy_deg((1.0, 2.0, 3.0), (0.0, 0.0, 90.0))
    camera = Camera(intrinsics=CameraIntrinsics(width=8, height=8), pose=pose)
    about = {"agent": "cam", "scene": "optical", "epoch": 3, "revision": 4, "sequence": 5}
    times = {"stamp_ns": 2_000_000_001, "dt_ns": 33_333_333, "timings_s": {"render": 0.25}}
    views = {"rgb": np.zeros((8, 8, 3), np.uint8)}
    frame = small_frame(views, camera=camera, **about, **times)
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
