"""Every field of every message, drawn at random: data type → message → data type, and back.

What a conversion forgets comes back as a default, so fields are drawn, never left out; and a last
test holds that each field of each message really takes more than one value.
"""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Callable, Mapping
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

import sailenv_msgs.msg as msgs
from sailenv_msgs.srv import GetObject
from sailenv_msgs_py.agent_msgs import agent_spec_from_msg, agent_spec_to_msg
from sailenv_msgs_py.changes import changes_from_msg, changes_to_msg
from sailenv_msgs_py.contact_msgs import contact_from_msg, contact_to_msg, contacts_to_msg
from sailenv_msgs_py.frame_info import (
    camera_of_frame_info,
    frame_info_to_msg,
    header_of_frame,
    lesson_of_frame_info,
    randomised_of_frame_info,
    row_poses_of_frame_info,
    states_of_frame_info,
)
from sailenv_msgs_py.mover_msgs import rigid_body_to_msg
from sailenv_msgs_py.object_msgs import (
    behaviour_from_msg,
    behaviour_to_msg,
    object_state_from_response,
    object_state_to_response,
)
from sailenv_msgs_py.object_truth_msgs import amodal_masks_from_msgs, objects_to_msg
from sailenv_msgs_py.picture_msgs import picture_from_msg, picture_to_msg
from sailenv_msgs_py.point_clouds import point_cloud_to_msg
from sailenv_msgs_py.scene_msgs import (
    light_from_msg,
    light_to_msg,
    scene_info_from_msg,
    scene_info_to_msg,
)
from sailenv_msgs_py.stamps import MAX_STAMP_NS, ns_from_stamp
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth import AmodalMasks
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.contacts import Contact
from sailenv_ros.types.depth_sensor_names import depth_sensor_names
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import Category, CategoryTable, Instance, Keypoint
from sailenv_ros.types.lessons import LessonPhase, LessonState
from sailenv_ros.types.lights import LIGHT_ATTRIBUTES, LIGHT_LIMITS, Environment, Light
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.types.picture_settings import LIMITS, PictureSettings
from sailenv_ros.types.rigid_body import RIGID_BODY_LIMITS, RigidBody
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.scene_info import MoverInfo, SceneInfo
from sailenv_ros.types.skeleton import Skeleton
from sailenv_ros.types.views import RENDERED_VIEWS, VIEWS
from tests.support.small_frame import small_frame

pytestmark = pytest.mark.ros

TEXTS = st.text(max_size=8).filter(lambda text: "\x00" not in text)
NAMES = st.from_regex(r"[a-z][a-z0-9_]{0,20}", fullmatch=True)
COORDINATES = st.floats(-1e4, 1e4)
TRIPLES = st.tuples(COORDINATES, COORDINATES, COORDINATES)
TIMES_NS = st.integers(0, MAX_STAMP_NS)
# What travels in single precision is drawn in single precision.
UNIT = st.floats(0.0, 1.0, width=32)
COLOURS = st.tuples(UNIT, UNIT, UNIT)
ANGLES = st.floats(-360.0, 360.0)
POSES = st.builds(Pose.from_rpy_deg, TRIPLES, st.tuples(ANGLES, ANGLES, ANGLES))
VIEW_SETS = st.sets(st.sampled_from(sorted(RENDERED_VIEWS)), min_size=1).map(tuple)

CATEGORIES = st.builds(
    Category,
    id=st.integers(1, 65535).filter(lambda id_: id_ != 255),
    name=NAMES,
    colour=st.tuples(*[st.integers(0, 255)] * 3),
)
CONTACTS = st.builds(
    Contact,
    first=st.integers(0, 2**16 - 1),
    second=st.integers(0, 2**16 - 1),
    mover=TEXTS,
    other_mover=TEXTS,
    position_m=TRIPLES,
    normal=TRIPLES,
    impulse_n_s=st.floats(0, 1e6),
    depth_m=st.floats(-1, 1),
    sim_time_ns=st.integers(0, MAX_STAMP_NS),
)

KEYPOINTS = st.builds(Keypoint, name=TEXTS, position_m=TRIPLES)
INSTANCES = st.builds(
    Instance,
    id=st.integers(1, 65535),
    name=TEXTS,
    asset=TEXTS,
    category_id=st.integers(0, 65535),
    category=TEXTS,
    static=st.booleans(),
    low_m=TRIPLES,
    high_m=TRIPLES,
    parent=st.integers(0, 65535),
    keypoints=st.lists(KEYPOINTS, max_size=2).map(tuple),
    materials=st.lists(TEXTS, max_size=2).map(tuple),
    painted=TEXTS,
)
LIGHTS = st.builds(
    lambda inner, outer, **light: Light(
        inner_cone_deg=min(inner, outer), outer_cone_deg=max(inner, outer), **light
    ),
    inner=st.floats(0.0, 89.0, width=32),
    outer=st.floats(0.0, 89.0, width=32),
    name=TEXTS,
    type=st.sampled_from(["directional", "point", "spot", "area"]),
    colour=COLOURS,
    position_m=TRIPLES,
    direction=TRIPLES.filter(lambda xyz: np.linalg.norm(xyz) > 1e-3),
    **{
        name: st.floats(
            bounds.least or 0.0, bounds.most, width=32, exclude_min=bounds.above is not None
        )
        for name, bounds in LIGHT_LIMITS.items()
        if not name.endswith("_cone_deg")
    },
)
# The colours of the sky do not travel; they are those of the scene.
ENVIRONMENTS = st.builds(
    Environment,
    ambient=COLOURS,
    background=st.sampled_from(["sky", "colour"]),
    background_colour=COLOURS,
    exposure=st.floats(-16.0, 16.0, width=32),
)
LOOK_ATS = st.builds(LookAt, obj=TEXTS, point_m=TRIPLES)
RIGID_BODIES = st.builds(
    RigidBody,
    gravity=st.booleans(),
    **{name: st.floats(at.least, at.most) for name, at in RIGID_BODY_LIMITS.items()},
)
MOVERS = st.builds(
    MoverInfo,
    name=TEXTS,
    controller=st.sampled_from(["waypoint", "rigidbody"]),
    waypoints=st.lists(POSES, max_size=3).map(tuple),
    total_time_s=st.floats(0.1, 1e6),
    loop=st.booleans(),
    body=st.none() | RIGID_BODIES,
    look_at=st.none() | LOOK_ATS,
)
PICTURES = st.builds(
    PictureSettings,
    tone_curve=st.sampled_from(["filmic", "linear"]),
    smooth_edges=st.booleans(),
    read_out=st.sampled_from(["down", "up"]),
    depth_sensor=st.sampled_from(depth_sensor_names()),
    **{
        name: (st.integers if at.whole else st.floats)(at.least, at.most)
        for name, at in LIMITS.items()
    },
)
PINHOLES = st.builds(
    CameraIntrinsics,
    # At four samples across and down, no side has more than 4096.
    width=st.integers(8, 1024),
    height=st.integers(8, 1024),
    vertical_fov_deg=st.floats(1.0, 170.0),
    near_m=st.floats(1e-3, 1.0),
    far_m=st.floats(2.0, 1e4),
    cx_offset_px=st.floats(-4.0, 4.0),
    cy_offset_px=st.floats(-4.0, 4.0),
)
LENSES = st.builds(
    CameraIntrinsics,
    fx_px=st.floats(300.0, 900.0),
    fy_px=st.floats(300.0, 900.0),
    max_angle_deg=st.sampled_from([0.0, 40.0, 85.0]),
    distortion_model=st.just("equidistant"),
    distortion=st.tuples(*[st.floats(0.0, 0.1)] * 4),
)
INTRINSICS = PINHOLES | LENSES
AGENTS = (
    st.builds(
        AgentSpec,
        name=NAMES,
        intrinsics=INTRINSICS,
        depth_range_m=st.floats(1.5, 1e3),
        rate_hz=st.floats(0.0, 240.0),
        views=VIEW_SETS,
        following=st.booleans(),
        mover=TEXTS,
        picture=PICTURES,
        look_at=st.none() | LOOK_ATS,
    )
    | st.builds(
        AgentSpec,
        name=st.builds("{}/{}".format, NAMES, NAMES),
        intrinsics=INTRINSICS,
        depth_range_m=st.floats(1.5, 1e3),
        views=VIEW_SETS,
        extrinsics=POSES,
    )
    | st.builds(AgentSpec, name=NAMES, intrinsics=PINHOLES, carrier=NAMES, pose=POSES)
)
JSON_VALUES = st.recursive(
    st.booleans() | st.integers(-(2**53), 2**53) | st.floats(allow_nan=False) | TEXTS,
    lambda values: st.lists(values, max_size=3),
    max_leaves=4,
)
BEHAVIOURS = st.builds(
    lambda kind, parameters: {"type": kind, **parameters},
    NAMES,
    st.dictionaries(NAMES.filter(lambda name: name != "type"), JSON_VALUES, max_size=3),
)
OBJECTS = st.builds(
    ObjectState,
    id=st.integers(1, 65535),
    name=TEXTS,
    asset=TEXTS,
    category_id=st.integers(0, 255),
    category=TEXTS,
    pose=POSES,
    scale=TRIPLES,
    size_m=TRIPLES,
    static=st.booleans(),
    mass_kg=st.floats(0.0, 1e6),
    bottom_m=st.floats(-1e3, 1e3),
    linear_velocity=TRIPLES,
    angular_velocity=TRIPLES,
    behaviours=st.lists(BEHAVIOURS, max_size=2).map(tuple),
    sim_time_ns=TIMES_NS,
)


@st.composite
def scene_infos(draw: st.DrawFn) -> SceneInfo:
    """Return scenes with up to three of everything, each id and each name once."""
    instances = draw(st.lists(INSTANCES, max_size=3, unique_by=lambda instance: instance.id))
    of_name: Callable[[Any], Any] = lambda thing: thing.name  # noqa: E731  # two uses of one key
    categories = draw(
        st.lists(CATEGORIES, max_size=3, unique_by=(of_name, lambda category: category.id))
    )
    return SceneInfo(
        scene=draw(TEXTS),
        scenes=tuple(draw(st.lists(TEXTS, max_size=3))),
        epoch=draw(st.integers(0, 2**32 - 1)),
        revision=draw(st.integers(0, 2**32 - 1)),
        sim_time_ns=draw(TIMES_NS),
        mode=draw(st.sampled_from(["realtime", "lockstep"])),
        paused=draw(st.booleans()),
        real_time_factor=draw(st.floats(0.1, 10.0)),
        seed=draw(st.integers(0, 2**63 - 1)),
        categories=CategoryTable(categories),
        instances=tuple(instances),
        moving=frozenset(i.id for i in instances if draw(st.booleans())),
        spawnables=tuple(draw(st.lists(TEXTS, max_size=3))),
        lights=tuple(draw(st.lists(LIGHTS, max_size=2))),
        environment=draw(ENVIRONMENTS),
        agents=tuple(draw(st.lists(AGENTS, max_size=2))),
        movers=tuple(draw(st.lists(MOVERS, max_size=2))),
        renderer=draw(TEXTS),
    )


@st.composite
def skeletons(draw: st.DrawFn) -> Skeleton:
    """Return skeletons of up to three joints and two points."""
    joints, points = draw(st.integers(0, 3)), draw(st.integers(0, 2))
    poses = [draw(POSES).matrix()[:3] for _ in range(joints)]
    return Skeleton(
        joint_names=tuple(draw(TEXTS) for _ in range(joints)),
        parents=np.array([draw(st.integers(-1, joint - 1)) for joint in range(joints)], np.int64),
        world_from_joint=np.array(poses, np.float64).reshape(-1, 3, 4),
        point_names=tuple(draw(TEXTS) for _ in range(points)),
        points=np.array([draw(TRIPLES) for _ in range(points)], np.float64).reshape(-1, 3),
    )


SKELETONS = skeletons()


@st.composite
def instance_states(draw: st.DrawFn) -> InstanceStates:
    """Return states of up to three instances."""
    ids = sorted(draw(st.sets(st.integers(1, 65535), max_size=3)))
    poses = [draw(POSES) for _ in ids]

    def column(values: st.SearchStrategy[Any], width: int) -> Any:
        return np.array([draw(values) for _ in ids]).reshape(-1, width)

    return InstanceStates(
        ids=np.array(ids, np.uint16),
        positions=np.array([pose.position_m for pose in poses]).reshape(-1, 3),
        orientations=np.array([pose.orientation_xyzw for pose in poses]).reshape(-1, 4),
        linear_velocities=column(TRIPLES, 3),
        angular_velocities=column(TRIPLES, 3),
        scales=column(TRIPLES, 3),
        histories=np.array([draw(st.integers(0, 2**32 - 1)) for _ in ids], np.int64),
        skeletons={id_: draw(SKELETONS) for id_ in ids if draw(st.booleans())},
    )


@st.composite
def frames(draw: st.DrawFn) -> Frame:
    """Return frames of a few pixels."""
    camera = Camera(intrinsics=draw(INTRINSICS), pose=draw(POSES))
    return Frame(
        agent=draw(NAMES),
        scene=draw(TEXTS),
        epoch=draw(st.integers(0, 2**32 - 1)),
        revision=draw(st.integers(0, 2**32 - 1)),
        sequence=draw(st.integers(0, 2**64 - 1)),
        stamp_ns=draw(TIMES_NS),
        dt_ns=draw(st.integers(0, 2**63 - 1)),
        camera=camera,
        views={},
        timings_s={"render": draw(st.floats(0.0, 1e3))},
        states=draw(st.none() | instance_states()),
        randomised=draw(st.none() | st.dictionaries(TEXTS, COORDINATES, max_size=2)),
        lesson=draw(st.none() | lesson_states()),
        exposure=draw(st.floats(-16.0, 16.0)),
        row_poses=draw(st.none() | row_poses()),
    )


@st.composite
def row_poses(draw: st.DrawFn) -> RowPoses:
    """Return poses of one to three rows, of up to two instances."""
    rows = draw(st.integers(1, 3))
    ids = sorted(draw(st.sets(st.integers(1, 65535), max_size=2)))
    poses = [[draw(POSES).matrix() for _ in range(1 + len(ids))] for _ in range(rows)]
    matrices = np.array(poses)
    return RowPoses(
        times_ns=np.array([draw(TIMES_NS) for _ in range(rows)], np.int64),
        world_from_camera=matrices[:, 0].copy(),
        ids=np.array(ids, np.uint16),
        world_from_instance=matrices[:, 1:].copy(),
    )


def lesson_states() -> st.SearchStrategy[LessonState]:
    """Return every state that lessons may be in."""
    counts = st.integers(0, 2**62)
    return st.builds(
        LessonState,
        phase=st.sampled_from(get_args(LessonPhase)),
        name=TEXTS,
        objects=st.lists(TEXTS, max_size=2).map(tuple),
        **dict.fromkeys(("lap", "laps", "number", "count", "begins_ns", "ends_ns"), counts),
    )


@st.composite
def observed_frames(draw: st.DrawFn) -> Frame:
    """Return frames of a few pixels that show some of the objects of their scene."""
    info, states = draw(scene_infos()), draw(instance_states())
    instances = [dataclasses.replace(draw(INSTANCES), id=id_) for id_ in states.ids.tolist()]
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = draw(st.tuples(st.integers(8, 10), st.integers(8, 10)))
    shown = rng.choice(np.array([0, *states.ids], np.uint16), size)
    lens = CameraIntrinsics(width=size[1], height=size[0], near_m=0.01, far_m=1e4)
    pose = draw(POSES)
    if len(states.ids) and draw(st.booleans()):  # few poses that are drawn see an object
        target = states.positions[0]
        inwards = np.copysign((4.0, 3.0, 2.0), -target)  # poses have a largest coordinate
        pose = look_at(tuple(target + inwards), tuple(target))
    return dataclasses.replace(
        draw(frames()),
        camera=Camera(intrinsics=lens, pose=pose),
        views={
            "instance": shown,
            "depth": np.full(size, np.inf, np.float32),
            "flow": rng.normal(0.0, 9.0, (*size, 2)).astype(np.float32),
        },
        info=dataclasses.replace(info, instances=tuple(instances)),
        states=states,
        draw_amodal=lambda: _random_masks(states.ids, rng, size),
    )


def _random_masks(ids: np.ndarray, rng: np.random.Generator, size: tuple[int, int]) -> AmodalMasks:
    """Return masks of one rectangle each, or of nothing."""
    boxes = np.full((len(ids), 4), -1, np.int32)
    crops = []
    for box in boxes:
        if rng.random() < 0.2:
            crops.append(np.zeros((0, 0), bool))
            continue
        left, top = rng.integers(0, 8, 2)
        right, bottom = rng.integers(left, 8), rng.integers(top, 8)
        box[:] = left, top, right, bottom
        crops.append(rng.random((bottom - top + 1, right - left + 1)) < 0.7)
    pixels = np.array([crop.sum() for crop in crops], np.int64)
    return AmodalMasks(
        height=size[0],
        width=size[1],
        ids=ids,
        pixels=pixels,
        whole_pixels=pixels + rng.integers(0, 9, len(ids)),
        boxes=boxes,
        whole_boxes=boxes - rng.integers(0, 9, (len(ids), 4)).astype(np.int32),
        crops=tuple(crops),
    )


def objects_of(frame: Frame) -> msgs.Objects:
    return objects_to_msg(frame, header_of_frame(frame), frame.amodal)


@given(observed_frames())
def test_objects(frame: Frame) -> None:
    """The message holds the table's values; masks come back bit for bit."""
    message, table = objects_of(frame), frame.objects_with_amodal
    assert [one.id for one in message.objects] == table.ids.tolist()
    for row, one in enumerate(message.objects):
        assert (one.name, one.category) == (table.names[row], table.categories[row])
        assert one.visible_pixels == table.visible_pixels[row]
        assert one.visible_box.tolist() == table.visible_boxes[row].tolist()
        np.testing.assert_array_equal(one.corner_pixels.reshape(8, 2), table.corner_pixels[row])
        pose = Pose((0.0, 0.0, 0.0), tuple(getattr(one.pose.orientation, k) for k in "xyzw"))
        np.testing.assert_allclose(
            pose.matrix()[:3, :3], table.world_from_object[row, :3, :3], atol=1e-9
        )
        np.testing.assert_array_equal(one.visible_share, table.visible_share[row])
        assert one.distance == table.distances[row]
    masks = (one.amodal for one in message.objects)
    read = amodal_masks_from_msgs(masks, message.height, message.width)
    for name in ("ids", "pixels", "whole_pixels", "boxes", "whole_boxes"):
        np.testing.assert_array_equal(getattr(read, name), getattr(frame.amodal, name))
    for id_ in table.ids.tolist():
        assert (read.mask(id_) == frame.amodal.mask(id_)).all()


def test_masks_that_do_not_fit_are_refused() -> None:
    """Run lengths of another size, and a box beside the picture."""
    message = msgs.AmodalMask(id=1, pixels=1, whole_pixels=1, box=[0, 0, 0, 0], counts=[0, 1, 63])
    assert amodal_masks_from_msgs([message], 8, 8).mask(1).sum() == 1
    with pytest.raises(InvalidRequest, match="run lengths"):
        amodal_masks_from_msgs([message], 8, 9)
    message.box = [0, 0, 8, 0]
    with pytest.raises(InvalidRequest, match="in the picture"):
        amodal_masks_from_msgs([message], 8, 8)


def test_point_clouds_are_what_rviz_reads() -> None:
    """Field by field, at the offsets that the message says; PCL's colour."""
    depth = np.full((8, 8), 2.0, np.float32)
    depth[0, 0] = np.inf
    rgb = np.zeros((8, 8, 3), np.uint8)
    rgb[1, 2] = (10, 20, 30)
    instance = np.full((8, 8), 700, np.uint16)
    frame = small_frame({"depth": depth, "rgb": rgb, "instance": instance})
    cloud = point_cloud_to_msg(frame, header_of_frame(frame))
    assert (cloud.height, cloud.width, cloud.row_step) == (8, 8, 8 * cloud.point_step)
    assert len(cloud.data) == 8 * cloud.row_step
    data = bytes(cloud.data)
    at = {field.name: field.offset + (8 + 2) * cloud.point_step for field in cloud.fields}
    read = {name: np.frombuffer(data, "<f4", 1, at[name])[0] for name in "xyz"}
    np.testing.assert_allclose(
        [read[name] for name in "xyz"], frame.points(in_world=False).xyz[8 + 2 - 1]
    )
    assert np.frombuffer(data, "<u4", 1, at["rgb"])[0] == 10 << 16 | 20 << 8 | 30
    assert np.frombuffer(data, "<u2", 1, at["instance"])[0] == 700
    assert np.isnan(np.frombuffer(data, "<f4", 3, 0)).all()


def same_light(one: Light, other: Light) -> None:
    """A direction is brought to unit length anew; everything else is copied."""
    np.testing.assert_allclose(one.direction, other.direction, rtol=0.0, atol=1e-15)
    for name in ("name", *LIGHT_ATTRIBUTES):
        assert name == "direction" or getattr(one, name) == getattr(other, name), name


@given(LIGHTS)
def test_lights(light: Light) -> None:
    msg = light_to_msg(light)
    same_light(light_from_msg(msg), light)
    changes = {name: getattr(light, name) for name in LIGHT_ATTRIBUTES}
    same_light(Light(name=light.name, **changes_from_msg(changes_to_msg(changes))), light)


VALUES = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_nan=False),
    st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"])),
    st.lists(st.floats(allow_nan=False), max_size=4),
    st.lists(st.booleans(), min_size=1, max_size=4),
    st.lists(st.sampled_from(["a", "b"]), min_size=1, max_size=4),
)


@given(st.dictionaries(TEXTS, VALUES, max_size=4))
def test_changes_of_anything(changes: dict[str, Any]) -> None:
    assert changes_from_msg(changes_to_msg(changes)) == changes


def test_changes_have_the_types_of_numpy_and_refuse_what_no_message_holds() -> None:
    """Arrays are lists, scalars numbers; a mapping, a mixed list, a name twice are errors."""
    given_ = {"a": np.float32(0.5), "b": np.arange(2), "c": (1, np.float64(2.0)), "d": 2**70}
    read = changes_from_msg(changes_to_msg(given_))
    assert read == {"a": 0.5, "b": [0.0, 1.0], "c": [1.0, 2.0], "d": float(2**70)}
    for value in ({}, [1, "a"], object(), [None]):
        with pytest.raises(InvalidRequest, match="a number, a text"):
            changes_to_msg({"x": value})
    with pytest.raises(InvalidRequest, match="each name once"):
        changes_from_msg(changes_to_msg({"x": 1}) * 2)


@given(PICTURES)
def test_settings_of_pictures(settings_: PictureSettings) -> None:
    msg = picture_to_msg(settings_)
    assert picture_from_msg(msg) == settings_


@given(AGENTS, st.none() | POSES)
def test_agents(spec: AgentSpec, pose: Pose | None) -> None:
    """The start pose stands beside the message; carried ones have theirs in it."""
    pose = None if spec.body else spec.pose if spec.carrier else pose
    msg = agent_spec_to_msg(spec)
    assert agent_spec_from_msg(msg, pose=pose) == dataclasses.replace(spec, pose=pose)


@given(CONTACTS)
def test_contacts(contact: Contact) -> None:
    assert contact_from_msg(contact_to_msg(contact)) == contact


@given(BEHAVIOURS)
def test_behaviours(behaviour: Mapping[str, Any]) -> None:
    msg = behaviour_to_msg(behaviour)
    assert behaviour_from_msg(msg) == behaviour


@given(OBJECTS)
def test_states_of_objects(state: ObjectState) -> None:
    response = GetObject.Response()
    object_state_to_response(state, response)
    assert object_state_from_response(response) == state


# Drawing a scene of everything is slow in itself.
@settings(max_examples=30, suppress_health_check=[HealthCheck.too_slow], deadline=None)
@given(scene_infos())
def test_scenes(info: SceneInfo) -> None:
    msg = scene_info_to_msg(info)
    back = scene_info_from_msg(msg)
    for field in dataclasses.fields(SceneInfo):
        one, other = getattr(back, field.name), getattr(info, field.name)
        if field.name == "lights":
            for read, written in zip(one, other, strict=True):
                same_light(read, written)
        elif field.name == "categories":
            assert dict(one) == dict(other)
        else:
            assert one == other, field.name


def same_arrays(
    read: InstanceStates | RowPoses | None, written: InstanceStates | RowPoses | None
) -> None:
    """Every array has the same bytes."""
    assert (read is None) == (written is None)
    for name in () if read is None else [entry.name for entry in dataclasses.fields(read)]:
        one, other = getattr(read, name), getattr(written, name)
        if name == "deformations":  # vertices do not travel
            assert not one
            continue
        if name == "skeletons":
            assert list(one) == list(other)
            for id_ in other:
                same_skeleton(one[id_], other[id_])
            continue
        same_bytes(one, other)


def same_bytes(one: np.ndarray, other: np.ndarray) -> None:
    assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())


def same_skeleton(read: Skeleton, written: Skeleton) -> None:
    for field in dataclasses.fields(written):
        one, other = getattr(read, field.name), getattr(written, field.name)
        if isinstance(other, tuple):
            assert one == other
        else:
            assert (one.dtype, one.shape, one.tobytes()) == (
                other.dtype,
                other.shape,
                other.tobytes(),
            )


@pytest.mark.parametrize("field", ["instance_ids", "instance_histories", "instance_states"])
def test_states_that_do_not_fit_are_refused(field: str) -> None:
    """An array of another length than the others is an error, not a wrong pose."""
    msg = msgs.FrameInfo(
        has_states=True,
        instance_ids=[1, 2],
        instance_histories=[1, 2],
        instance_states=[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *[0.5] * 9] * 2,
    )
    assert states_of_frame_info(msg) is not None
    setattr(msg, field, getattr(msg, field)[:-1])
    with pytest.raises(InvalidRequest, match="instance"):
        states_of_frame_info(msg)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("id", 8),
        ("joint_names", ["root"]),
        ("parents", [0, 0]),
        ("parents", [-2, 0]),
        ("joint_poses", [0.5] * 23),
        ("joint_poses", [float("nan")] * 24),
        ("points", [0.5, 0.5]),
        ("points", [float("inf")] * 3),
        ("point_names", []),
    ],
)
def test_skeletons_that_do_not_fit_are_refused(field: str, value: Any) -> None:
    """Two joints and a keypoint of the only instance; each joint comes after its parent."""
    told = msgs.Skeleton(
        id=7, joint_names=["root", "head"], parents=[-1, 0], joint_poses=[0.5] * 24,
        point_names=["nose"], points=[0.5] * 3,
    )  # fmt: skip
    state = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, *[0.5] * 9]
    msg = msgs.FrameInfo(
        has_states=True, instance_ids=[7], instance_histories=[1], instance_states=state,
        skeletons=[told],
    )  # fmt: skip
    states = states_of_frame_info(msg)
    assert states is not None
    assert states.skeletons[7].joints.tolist() == [[0.5] * 3] * 2
    setattr(told, field, value)
    with pytest.raises(InvalidRequest, match=r"skeleton|joint"):
        states_of_frame_info(msg)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("times_ns", []),
        ("times_ns", [1, 2, 3]),
        ("instance_ids", [4]),
        ("poses", [0.0] * 23),
        ("poses", [float("nan")] * 24),
    ],
)
def test_poses_of_rows_that_do_not_fit_are_refused(field: str, value: list[float]) -> None:
    """Two rows of a camera alone have 24 numbers, all finite."""
    told = msgs.RowPoses(times_ns=[1, 2], poses=[*np.eye(3, 4).ravel()] * 2)
    msg = msgs.FrameInfo(row_poses=[told])
    rows = row_poses_of_frame_info(msg)
    assert rows is not None
    np.testing.assert_array_equal(rows.world_from_camera, [np.eye(4)] * 2)
    setattr(told, field, value)
    with pytest.raises(InvalidRequest, match="row_poses"):
        row_poses_of_frame_info(msg)


def frame_info_of(frame: Frame) -> msgs.FrameInfo:
    views = tuple(VIEWS)[: 1 + frame.sequence % len(VIEWS)]
    return frame_info_to_msg(
        frame, header_of_frame(frame), views=views, depth_range_m=1.0 + frame.epoch
    )


@given(frames(), VIEW_SETS, st.floats(0.1, 1e4))
def test_frame_infos(frame: Frame, views: tuple[str, ...], depth_range_m: float) -> None:
    """Every field but the pose is the frame's own value; the pose is its camera's, to rounding."""
    header = header_of_frame(frame)
    msg = frame_info_to_msg(frame, header, views=views, depth_range_m=depth_range_m)
    told = {name: getattr(msg, name) for name in msg.get_fields_and_field_types()}
    told.pop("camera_pose")
    assert ns_from_stamp(told.pop("header").stamp) == frame.stamp_ns
    same_arrays(states_of_frame_info(msg), frame.states)
    same_arrays(row_poses_of_frame_info(msg), frame.row_poses)
    assert randomised_of_frame_info(msg) == frame.randomised
    told.pop("randomised")
    assert lesson_of_frame_info(msg) == frame.lesson
    told.pop("lesson")
    for name in [
        name for name in told if name.startswith(("instance_", "has_", "row_poses", "skeletons"))
    ]:
        told.pop(name)
    assert told == {
        "agent": frame.agent,
        "scene": frame.scene,
        "epoch": frame.epoch,
        "revision": frame.revision,
        "sequence": frame.sequence,
        "dt_ns": frame.dt_ns,
        "views": list(views),
        "near_m": frame.camera.intrinsics.near_m,
        "far_m": frame.camera.intrinsics.far_m,
        "depth_range_m": depth_range_m,
        "render_s": frame.timings_s["render"],
        "exposure": frame.exposure,
    }
    read = camera_of_frame_info(msg, frame.camera.intrinsics)
    np.testing.assert_allclose(
        read.world_from_camera, frame.camera.world_from_camera, rtol=0.0, atol=1e-9
    )


def test_every_field_of_every_message_is_drawn_above() -> None:
    """No message of the package lacks a strategy, and no field of one is always the same."""
    taken: dict[tuple[str, str], set[str]] = defaultdict(set)

    def note(msg: Any) -> None:
        """Remember the values of a message's fields, and of the messages of ours within it."""
        for field in msg.get_fields_and_field_types():
            value = getattr(msg, field)
            taken[type(msg).__name__, field].add(repr(value))
            for part in value if isinstance(value, list) else [value]:
                if type(part).__module__.startswith("sailenv_msgs."):
                    note(part)

    quick = settings(
        max_examples=240, database=None, derandomize=True, deadline=None, phases=[Phase.generate]
    )
    quick(given(BEHAVIOURS.map(behaviour_to_msg))(note))()
    quick(
        given(
            st.builds(
                contacts_to_msg,
                st.lists(CONTACTS, max_size=3),
                sim_time_ns=st.integers(0, MAX_STAMP_NS),
                revision=st.integers(0, 2**32 - 1),
            )
        )(note)
    )()
    # Scenes hold few agents and bodies; each of their fields needs examples of its own.
    quick(given(AGENTS.map(agent_spec_to_msg))(note))()
    quick(given(RIGID_BODIES.map(rigid_body_to_msg))(note))()
    quick(given(scene_infos().map(scene_info_to_msg))(note))()
    quick(given(frames().map(frame_info_of))(note))()
    quick(given(observed_frames().map(objects_of))(note))()
    every = {
        (kind, field)
        for kind in dir(msgs)
        if isinstance(getattr(msgs, kind), type)
        for field in getattr(msgs, kind).get_fields_and_field_types()
    }
    assert {at for at in every if len(taken[at]) < 2} == set()
