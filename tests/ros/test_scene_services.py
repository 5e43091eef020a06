"""Services about objects and lights over DDS: what they do, and that a refusal does nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from std_msgs.msg import ColorRGBA

from sailenv_msgs.msg import AgentInfo, Behaviour, PictureSettings, SceneInfo
from sailenv_msgs.srv import (
    Capture,
    ChangeScene,
    DeleteAgent,
    DespawnObject,
    GetAmbientLight,
    GetLight,
    GetObject,
    GetPose,
    LoadScenario,
    MoveObject,
    RegisterAgent,
    Reset,
    SetAmbientLight,
    SetBackground,
    SetLight,
    SetPicture,
    SetPose,
    SetPosition,
    SetRate,
    SetRotation,
    SpawnObject,
    Step,
    UploadModel,
)
from sailenv_msgs_py.changes import changes_to_msg
from tests.support.ros_probe import LATCHED, Eye, Probe, Topic
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

NAMESPACE = "/scene_services"


@pytest.fixture(scope="module")
def probe() -> Iterator[Probe]:
    """A participant beside a lockstep simulator."""
    with NodeProcess(NAMESPACE, mode="lockstep", agent__name=""), Probe(NAMESPACE) as probe:
        yield probe


@pytest.fixture
def scene(probe: Probe) -> Iterator[Topic]:
    """scene_info, of the scene at its beginning."""
    probe.done(Reset, "reset", Reset.Request(keep_seed=True))
    topic = probe.listen(SceneInfo, "scene_info", LATCHED)
    until(lambda: topic.messages, "scene_info")
    yield topic
    probe.listen_no_more()


def at(x: float, y: float, z: float) -> Pose:
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(w=1.0))


def spawn(probe: Probe, asset: str = "cube", **fields: Any) -> Any:
    request = SpawnObject.Request(**{"asset": asset, "pose": at(3.0, 0.0, 1.0), **fields})
    return probe.done(SpawnObject, "spawn_object", request)


# -- objects -------------------------------------------------------------------------------


def test_a_spawned_id_is_in_the_image_and_in_scene_info(probe: Probe, scene: Topic) -> None:
    """The answer's id is the value of the object's pixels, and scene_info names it."""
    answer = spawn(probe, is_static=True, scale=Vector3(x=1.0, y=2.0, z=2.0), name="wall")
    assert answer.spawned_name == "wall"
    until(lambda: answer.id in [i.id for i in scene.last.instances], "the id in scene_info")
    instance = next(i for i in scene.last.instances if i.id == answer.id)
    assert (instance.name, instance.asset, instance.is_static) == ("wall", "cube", True)
    with Eye(probe, ("instance",)) as eye:
        views = eye.capture()
        assert answer.id in np.unique(views["instance"])
        probe.done(DespawnObject, "despawn_object", DespawnObject.Request(id=answer.id))
        assert answer.id not in np.unique(eye.capture()["instance"])
    until(lambda: answer.id not in [i.id for i in scene.last.instances], "it to be gone")
    assert spawn(probe, name="wall").id > answer.id


def test_an_object_says_what_and_where_it_is(probe: Probe, scene: Topic) -> None:
    """get_object has what spawn_object was told, and the motion since."""
    turning = Behaviour(
        type="rotate_rigidbody", parameters_json=json.dumps({"angular_velocity": [0, 0, 180]})
    )
    pose = at(0.0, 0.0, 40.0)
    id_ = spawn(probe, pose=pose, mass_kg=2.5, behaviours=[turning], category="chair").id
    first = probe.done(GetObject, "get_object", GetObject.Request(id=id_))
    assert first.pose.pose.position == pose.position
    assert (first.mass_kg, first.scale, first.instance.category) == (
        2.5,
        Vector3(x=1.0, y=1.0, z=1.0),
        "chair",
    )
    assert first.instance.moving
    assert [b.type for b in first.behaviours] == ["rotate_rigidbody"]
    assert json.loads(first.behaviours[0].parameters_json) == {"angular_velocity": [0, 0, 180]}
    probe.done(Step, "step", Step.Request(steps=24))
    later = probe.done(GetObject, "get_object", GetObject.Request(id=id_))
    assert later.twist.angular.z == pytest.approx(math.pi, rel=1e-3)
    assert later.twist.linear.z == pytest.approx(-9.81 * 0.1, rel=1e-3)


def test_an_object_is_moved_and_stands_still(probe: Probe, scene: Topic) -> None:
    """move_object puts it there and stops it."""
    id_ = spawn(probe, pose=at(0.0, 0.0, 40.0)).id
    probe.done(Step, "step", Step.Request(steps=24))
    goal = at(1.0, 2.0, 30.0)
    probe.done(MoveObject, "move_object", MoveObject.Request(id=id_, pose=goal))
    state = probe.done(GetObject, "get_object", GetObject.Request(id=id_))
    assert state.pose.pose.position == goal.position
    assert state.twist.linear == Vector3()


def test_a_scenario_is_a_scene_with_more_objects(probe: Probe, scene: Topic) -> None:
    """YAML and JSON documents give the ids of their objects, in a new epoch."""
    epoch = scene.last.epoch
    objects = [{"asset": "cube", "position": [3, 0, 1], "name": "first"}, {"asset": "sphere"}]
    document = json.dumps({"scene": "object_view", "objects": objects})
    answer = probe.done(LoadScenario, "load_scenario", LoadScenario.Request(document=document))
    until(lambda: scene.last.epoch > epoch, "the new epoch")
    names = {i.id: i.name for i in scene.last.instances}
    assert scene.last.scene == "object_view"
    assert [names[id_] for id_ in answer.ids] == ["first", "sphere_1"]
    probe.done(
        LoadScenario, "load_scenario", LoadScenario.Request(document="scene: optical\nobjects: []")
    )
    until(lambda: scene.last.scene == "optical", "the scene")


# -- lights ---------------------------------------------------------------------------------


def test_only_the_named_fields_of_a_light_change(probe: Probe, scene: Topic) -> None:
    """The rest of the message is not looked at; the answer is the light as it is then."""
    before = probe.done(GetLight, "get_light", GetLight.Request(name="sun")).light
    changes = changes_to_msg({"intensity": 0.5, "direction": (0.0, 0.0, -2.0)})
    request = SetLight.Request(name="sun", changes=changes)
    after = probe.done(SetLight, "set_light", request).light
    assert (after.intensity, after.direction) == (0.5, Vector3(z=-1.0))
    assert (after.colour, after.type) == (before.colour, before.type)
    assert probe.done(GetLight, "get_light", GetLight.Request(name="sun")).light == after
    until(lambda: scene.last.lights[0] == after, "the light in scene_info")


def test_the_picture_shows_ambient_light_and_background(probe: Probe, scene: Topic) -> None:
    """Full ambient light makes it brighter; the background has its colour where nothing is."""
    with Eye(probe, ("rgb", "instance")) as eye:
        dark = eye.capture()
        bright = ColorRGBA(r=2.0, g=2.0, b=2.0)
        request = SetAmbientLight.Request(colour=bright)
        probe.done(SetAmbientLight, "set_ambient_light", request)
        answer = probe.done(GetAmbientLight, "get_ambient_light")
        assert (answer.colour.r, answer.colour.g, answer.colour.b) == (2.0, 2.0, 2.0)
        red = SetBackground.Request(colour=ColorRGBA(r=1.0))
        probe.done(SetBackground, "set_background", red)
        lit = eye.capture()
        there = lit["instance"] > 0
        assert lit["rgb"][there].mean() > dark["rgb"][there].mean() + 10
        nothing = lit["rgb"][~there]
        assert nothing.size
        assert (np.median(nothing, axis=0)[1:] < np.median(nothing, axis=0)[0]).all()
    until(lambda: not scene.last.environment.sky, "the background in scene_info")


# -- what cannot be --------------------------------------------------------------------------

REFUSALS = [
    (SpawnObject, "spawn_object", SpawnObject.Request(asset="cubee"), "did you mean 'cube'"),
    (
        SpawnObject,
        "spawn_object",
        SpawnObject.Request(asset="cube", pose=Pose(orientation=Quaternion(x=2.0))),
        "orientation",
    ),
    (
        SpawnObject,
        "spawn_object",
        SpawnObject.Request(asset="cube", scale=Vector3(x=-1.0, y=1.0, z=1.0)),
        "scale",
    ),
    (
        SpawnObject,
        "spawn_object",
        SpawnObject.Request(
            asset="cube", behaviours=[Behaviour(type="rotate_rigidbody", parameters_json="[1]")]
        ),
        "parameters_json must be a JSON object",
    ),
    (DespawnObject, "despawn_object", DespawnObject.Request(id=0), "instance id must be"),
    (GetObject, "get_object", GetObject.Request(id=65535), "instance id must be"),
    (
        MoveObject,
        "move_object",
        MoveObject.Request(id=1, pose=at(math.nan, 0.0, 0.0)),
        "position must be three finite numbers",
    ),
    (GetLight, "get_light", GetLight.Request(name="sn"), "did you mean 'sun'"),
    (
        SetLight,
        "set_light",
        SetLight.Request(name="sun", changes=changes_to_msg({"brightness": 1.0})),
        "attribute of a light must be one of",
    ),
    (
        SetLight,
        "set_light",
        SetLight.Request(name="sun", changes=changes_to_msg({"type": ""})),
        "must be one of",
    ),
    (
        SetAmbientLight,
        "set_ambient_light",
        SetAmbientLight.Request(colour=ColorRGBA(r=-1.0)),
        "three numbers from 0",
    ),
    (
        LoadScenario,
        "load_scenario",
        LoadScenario.Request(document="{objects: [{asset: cube, scale: big}]}"),
        "scale must be",
    ),
    (LoadScenario, "load_scenario", LoadScenario.Request(document="a: [1"), "is not YAML"),
    (LoadScenario, "load_scenario", LoadScenario.Request(document=""), "is empty"),
]


@pytest.mark.parametrize(
    ("kind", "service", "request_", "sentence"),
    REFUSALS,
    ids=[f"{service}-{number}" for number, (_, service, *_) in enumerate(REFUSALS)],
)
def test_a_refusal_is_one_sentence_and_changes_nothing(
    probe: Probe, scene: Topic, kind: Any, service: str, request_: Any, sentence: str
) -> None:
    """success is false, the message names what was wrong, and no new scene_info comes of it."""
    until(lambda: scene.last.epoch, "scene_info")
    revision = scene.last.revision
    answer = probe.call(kind, service, request_)
    assert not answer.success
    assert sentence in answer.message
    assert "\n" not in answer.message
    id_ = spawn(probe).id
    until(lambda: id_ in [i.id for i in scene.last.instances], "a good request afterwards")
    # The good request announces itself in one step; the refused one did not.
    assert scene.last.revision - revision <= 2


# -- anything at all -------------------------------------------------------------------------

NUMBERS = st.one_of(st.floats(width=32), st.floats(-10, 10), st.just(1.0))
TEXTS = st.one_of(
    st.sampled_from(["cube", "sphere", "sun", "optical", "", "ball", "scene: optical"]),
    st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=12),
)
POINTS = st.builds(Point, x=NUMBERS, y=NUMBERS, z=NUMBERS)
PARAMETERS = st.builds(
    lambda name, value: changes_to_msg({name: value})[0],
    st.one_of(
        st.sampled_from(["type", "colour", "intensity", "direction", "exposure", "bloom", "agent"]),
        TEXTS,
    ),
    st.one_of(st.none(), st.booleans(), NUMBERS, TEXTS, st.lists(NUMBERS, max_size=4)),
)
VECTORS = st.builds(Vector3, x=NUMBERS, y=NUMBERS, z=NUMBERS)
COLOURS = st.builds(ColorRGBA, r=st.floats(width=32), g=st.floats(0, 1, width=32))
POSES = st.builds(
    Pose,
    position=POINTS,
    orientation=st.one_of(
        st.just(Quaternion(w=1.0)), st.builds(Quaternion, x=NUMBERS, y=NUMBERS, z=NUMBERS)
    ),
)
BEHAVIOURS = st.lists(
    st.builds(
        Behaviour,
        type=st.one_of(st.just("rotate_rigidbody"), TEXTS),
        parameters_json=st.one_of(st.just('{"angular_velocity": [1, 2, 3]}'), TEXTS),
    ),
    max_size=2,
)
PICTURES = st.builds(
    PictureSettings,
    exposure=NUMBERS,
    tone_curve=st.one_of(st.sampled_from(["filmic", "linear"]), TEXTS),
    bloom=st.one_of(st.just(0.0), st.floats()),
    full_well=st.one_of(st.just(0.0), st.floats()),
)
IDS = st.one_of(st.integers(0, 12), st.integers(0, 65535))
ANY_REQUEST = st.one_of(
    st.builds(
        SpawnObject.Request,
        asset=TEXTS,
        name=TEXTS,
        pose=POSES,
        scale=st.one_of(st.just(Vector3()), VECTORS),
        is_static=st.booleans(),
        mass_kg=NUMBERS,
        category=TEXTS,
        behaviours=BEHAVIOURS,
    ),
    st.builds(DespawnObject.Request, id=IDS),
    st.builds(MoveObject.Request, id=IDS, pose=POSES, teleport=st.booleans()),
    st.builds(GetObject.Request, id=IDS),
    st.builds(GetLight.Request, name=TEXTS),
    st.builds(
        SetLight.Request,
        name=TEXTS,
        changes=st.lists(PARAMETERS, max_size=3),
    ),
    st.builds(SetAmbientLight.Request, colour=COLOURS),
    st.builds(SetBackground.Request, sky=st.booleans(), colour=COLOURS),
    st.builds(LoadScenario.Request, document=TEXTS),
    st.builds(Step.Request, steps=st.integers(-2, 4)),
)
ANY_AGENT_REQUEST = st.one_of(
    st.builds(
        RegisterAgent.Request,
        agent=st.builds(
            AgentInfo,
            name=st.one_of(st.sampled_from(["eye", "other", "third"]), TEXTS),
            width=st.one_of(st.just(32), st.integers(0, 2**32 - 1)),
            height=st.one_of(st.just(24), st.integers(0, 2**32 - 1)),
            vertical_fov_deg=st.one_of(st.just(60.0), st.floats()),
            rate_hz=st.one_of(st.just(0.0), st.floats()),
            views=st.lists(st.one_of(st.sampled_from(["rgb", "flow"]), TEXTS), max_size=2),
            following=st.booleans(),
            mover=st.one_of(st.just(""), TEXTS),
            picture=PICTURES,
        ),
        has_pose=st.booleans(),
        pose=POSES,
    ),
    st.builds(DeleteAgent.Request, name=st.one_of(st.sampled_from(["other", "third"]), TEXTS)),
    st.builds(SetPosition.Request, position=POINTS, teleport=st.booleans()),
    st.builds(SetRotation.Request, roll_deg=st.floats(), pitch_deg=NUMBERS, yaw_deg=NUMBERS),
    st.builds(SetPose.Request, pose=POSES),
    st.builds(
        SetPicture.Request,
        changes=st.lists(PARAMETERS, max_size=3),
    ),
    st.builds(SetRate.Request, rate_hz=st.one_of(st.just(0.0), st.floats())),
    st.builds(
        Capture.Request,
        views=st.lists(st.one_of(st.sampled_from(["depth", "instance"]), TEXTS), max_size=2),
    ),
    st.builds(ChangeScene.Request, scene=TEXTS),
    st.builds(Reset.Request, keep_seed=st.booleans(), seed=st.integers(-(2**63), 2**63 - 1)),
    st.builds(
        UploadModel.Request,
        filename=st.sampled_from(["a.zip", "b.glb", "c"]),
        name=TEXTS,
        category=TEXTS,
        height_m=st.floats(),
        data=st.lists(st.integers(0, 255), max_size=40),
    ),
)
SERVICES = {
    kind.Request: (kind, name)
    for kind, name in (
        (SpawnObject, "spawn_object"),
        (DespawnObject, "despawn_object"),
        (MoveObject, "move_object"),
        (GetObject, "get_object"),
        (GetLight, "get_light"),
        (SetLight, "set_light"),
        (SetAmbientLight, "set_ambient_light"),
        (SetBackground, "set_background"),
        (LoadScenario, "load_scenario"),
        (Step, "step"),
        (RegisterAgent, "register_agent"),
        (DeleteAgent, "delete_agent"),
        (SetPosition, "eye/set_position"),
        (SetRotation, "eye/set_rotation"),
        (SetPose, "eye/set_pose"),
        (SetRate, "eye/set_rate"),
        (SetPicture, "eye/set_picture"),
        (Capture, "eye/capture"),
        (ChangeScene, "change_scene"),
        (Reset, "reset"),
        (UploadModel, "upload_model"),
    )
}


@pytest.mark.slow
@pytest.mark.timeout(300)  # 500 requests, some of them for large pictures
@settings(
    max_examples=25,
    deadline=None,
    phases=(Phase.explicit, Phase.reuse, Phase.generate),
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(requests=st.lists(st.one_of(ANY_REQUEST, ANY_AGENT_REQUEST), min_size=10, max_size=30))
def test_hostile_requests_are_answered(probe: Probe, scene: Topic, requests: list[Any]) -> None:
    """Each is done or refused in one sentence that blames no fault, and the node goes on."""
    eye = AgentInfo(name="eye", width=32, height=24, rate_hz=0.0)
    probe.call(RegisterAgent, "register_agent", RegisterAgent.Request(agent=eye))
    probe.discover({name: kind for kind, name in SERVICES.values()})
    for request in requests:
        kind, service = SERVICES[type(request)]
        answer = probe.call(kind, service, request)
        assert answer.success == (not answer.message)
        assert "\n" not in answer.message
        assert "a fault in the simulator" not in answer.message
    probe.done(GetPose, "eye/get_pose")
