"""Requests that change what a scene holds: ids, announcements, refusals, invariants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from sailenv_ros.errors import (
    DeadlineExceeded,
    InvalidEntry,
    InvalidRequest,
    NameTaken,
    SailenvError,
    UnknownName,
)
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.scene_info import SceneInfo
from tests.support.lockstep_core import lockstep_core

AHEAD = Pose((2.0, 0.0, 1.0))


def make_core() -> SynchronousSimulation:
    core = lockstep_core()
    core.register_agent(AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=16, height=16)))
    return core


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    made = make_core()
    yield made
    made.close()


@pytest.fixture
def told(core: SynchronousSimulation) -> list[SceneInfo]:
    infos: list[SceneInfo] = []
    core.on_info = infos.append
    return infos


def ids_of(core: SynchronousSimulation) -> list[int]:
    return [instance.id for instance in core.info.instances]


# -- objects -----------------------------------------------------------------------------------


def test_a_spawned_object_is_announced_at_once(
    core: SynchronousSimulation, told: list[SceneInfo]
) -> None:
    """The answered id is in the next scene_info, and in the frame after it, with its values."""
    turned = Pose.from_rpy_deg((1.0, 2.0, 3.0), (10.0, 20.0, 30.0))
    id_ = core.spawn_object(
        "cube", object_name="box", pose=turned, scale=(1, 2, 3), remove_dynamics=True
    )
    assert [i.name for i in told[-1].instances if i.id == id_] == ["box"]
    frame = core.capture(["instance"], agent="eye")
    assert frame.revision <= told[-1].revision
    state = core.get_object(id_)
    assert (state.id, state.name, state.asset, state.static) == (id_, "box", "cube", True)
    assert state.pose == turned
    assert state.scale == (1.0, 2.0, 3.0)
    assert state.mass_kg == 0.0
    sizes = np.divide(
        state.size_m,
        core.get_object(core.spawn_object("cube", pose=AHEAD, remove_dynamics=False)).size_m,
    )
    assert sizes == pytest.approx([1.0, 2.0, 3.0])


def test_ids_are_never_used_again(core: SynchronousSimulation) -> None:
    """An object that comes after one that went has a number of its own."""
    seen = set(ids_of(core))
    for _ in range(5):
        id_ = core.spawn_object("sphere", object_name="ball", pose=AHEAD, remove_dynamics=False)
        assert id_ not in seen
        seen.add(id_)
        core.despawn_object("ball")
        assert id_ not in ids_of(core)


def test_a_waiting_frame_does_not_outlive_its_world(core: SynchronousSimulation) -> None:
    """A frame that nobody has taken is dropped when the scene ends, not when an object goes."""
    core.set_rate(30.0, agent="eye")
    id_ = core.spawn_object("cube", pose=AHEAD, remove_dynamics=False)
    stream = core.open_stream("eye", ("instance",), lambda _: None)
    core.streams.render_due()
    core.despawn_object(id_)
    assert id_ in stream.get(0.0).instances
    for end in (core.reset, lambda: core.change_scene("optical")):
        core.streams.render_due()
        core.step(8)
        end()
        with pytest.raises(DeadlineExceeded):
            stream.get(0.0)
    core.step(8)
    assert stream.get(0.0).epoch == core.info.epoch


def test_a_frame_is_delivered_to_whom_it_was_drawn_for(
    core: SynchronousSimulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who wants no more views while it is drawn gets it all the same; it is not drawn again."""
    core.set_rate(30.0, agent="eye")
    stream = core.open_stream("eye", ("instance",), lambda _: None)
    render = core.streams._render

    def changing_minds(*asked: Any) -> Sequence[Frame]:
        stream.set_views(())
        return render(*asked)

    monkeypatch.setattr(core.streams, "_render", changing_minds)
    core.streams.render_due()
    assert [*stream.get(0.0).views] == ["instance"]


def test_an_object_without_a_name_is_given_one(core: SynchronousSimulation) -> None:
    """The first free number after the asset's catalogue name, whichever name it was asked by."""
    first, second = (
        core.spawn_object(asset, pose=AHEAD, remove_dynamics=False) for asset in ("cube", "Cube")
    )
    assert core.get_object(second).name != core.get_object(first).name
    assert {core.get_object(i).name.rpartition("_")[0] for i in (first, second)} == {"cube"}


def test_objects_go_by_id_and_by_name(core: SynchronousSimulation) -> None:
    """Both name the same object, also as NumPy's integers, which are the values of pixels."""
    id_ = core.spawn_object("cube", object_name="box", pose=AHEAD, remove_dynamics=False)
    assert core.get_object("box") == core.get_object(id_) == core.get_object(np.uint16(id_))  # type: ignore[arg-type]  # what a pixel holds


def test_a_moved_object_is_where_it_was_put_and_stands_still(core: SynchronousSimulation) -> None:
    """Its velocity is gone, its pose is the one given."""
    id_ = core.spawn_object("cube", pose=Pose((0.0, 0.0, 50.0)), remove_dynamics=False)
    core.step(60)
    assert core.get_object(id_).linear_velocity[2] < -1.0
    core.move_object(id_, pose=AHEAD)
    state = core.get_object(id_)
    assert state.pose.position_m == pytest.approx(AHEAD.position_m)
    assert state.linear_velocity == state.angular_velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("teleport", [False, True])
def test_only_a_teleport_cuts_the_past_off(core: SynchronousSimulation, teleport: bool) -> None:
    """A moved object keeps its history, so that flow shows the motion."""
    id_ = core.spawn_object("cube", pose=AHEAD, remove_dynamics=False)
    row = ids_of(core).index(id_)
    before = core.world.snapshot().histories[row]
    core.move_object(id_, pose=Pose((2.5, 0.0, 1.0)), teleport=teleport)
    assert (core.world.snapshot().histories[row] != before) == teleport


def test_behaviours_of_a_spawned_object_start_when_it_does(core: SynchronousSimulation) -> None:
    """It turns at its rate from then on, and says what moves it."""
    core.step(100)
    turning = {"type": "rotate_rigidbody", "angular_velocity": (0, 0, 90)}
    id_ = core.spawn_object(
        "cube", pose=Pose((0.0, 0.0, 60.0)), behaviours=[turning], remove_dynamics=False
    )
    assert id_ in core.info.moving
    core.step(2)
    state = core.get_object(id_)
    assert state.angular_velocity[2] == pytest.approx(np.pi / 2, rel=1e-3)
    assert state.behaviours == ({"type": "rotate_rigidbody", "angular_velocity": (0.0, 0.0, 90.0)},)


# -- lights and surroundings -------------------------------------------------------------------


def test_a_changed_light_is_announced(core: SynchronousSimulation, told: list[SceneInfo]) -> None:
    """What was named is changed, the rest is as it was, and the direction has unit length."""
    before = core.lights[0]
    changed = core.set_light(before.name, intensity=0.25, direction=(0, 0, -4))
    assert (changed.intensity, changed.direction) == (0.25, (0.0, 0.0, -1.0))
    assert (changed.colour, changed.type) == (before.colour, before.type)
    assert told[-1].lights[0] == core.lights[0] == changed


def test_surroundings_are_announced(core: SynchronousSimulation, told: list[SceneInfo]) -> None:
    """Ambient light and background change alone; a background without colour keeps the last."""
    core.set_background("colour", (0.1, 0.2, 0.3))
    core.set_background("sky")
    core.set_ambient_light(np.array([1.0, 2.0, 3.0]))
    environment = told[-1].environment
    assert environment.background == "sky"
    assert environment.background_colour == (0.1, 0.2, 0.3)
    assert environment.ambient == (1.0, 2.0, 3.0)


# -- scenarios ---------------------------------------------------------------------------------


SCENARIO = {
    "scene": "solid_benchmark",
    "objects": [
        {"asset": "cube", "position": [0, 0, 30]},
        {"asset": "Sphere", "name": "ball", "position": [0, 3, 30], "scale": 2},
    ],
}


def test_a_scenario_is_a_scene_with_more_objects(core: SynchronousSimulation) -> None:
    """Its objects follow the scene's own, and a reset brings them back."""
    core.change_scene("solid_benchmark")
    own = len(core.info.instances)
    core.change_scene("optical")
    ids = core.load_scenario(SCENARIO)
    assert core.info.scene == "solid_benchmark"
    assert ids == (own + 1, own + 2)
    core.step(5)
    core.reset()
    assert core.get_object("ball").id == ids[1]
    core.change_scene("solid_benchmark")
    assert len(core.info.instances) == own


# -- refusals ----------------------------------------------------------------------------------


def hollow_loop() -> list[Any]:
    loop: list[Any] = []
    loop.append(loop)
    return loop


BAD_REQUESTS = [
    (
        lambda c: c.spawn_object("cubee", pose=AHEAD, remove_dynamics=False),
        UnknownName,
        "did you mean 'cube'",
    ),
    (
        lambda c: c.spawn_object(7, pose=AHEAD, remove_dynamics=False),
        InvalidRequest,
        "name must be a text",
    ),
    (
        lambda c: c.spawn_object("cube", pose=(0, 0, 0), remove_dynamics=False),
        InvalidRequest,
        "pose must be a sailenv_ros",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, object_name="a\nb", remove_dynamics=False),
        InvalidEntry,
        "name must be",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, object_name="box", remove_dynamics=False),
        NameTaken,
        "not in use",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, scale=0, remove_dynamics=False),
        InvalidRequest,
        "scale.*0.001 to 1000",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, scale=(1, 2), remove_dynamics=False),
        InvalidRequest,
        "scale",
    ),
    (
        lambda c: c.spawn_object("sphere", pose=AHEAD, scale=(1, 2, 1), remove_dynamics=False),
        InvalidEntry,
        "as a ball",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, remove_dynamics=1),
        InvalidRequest,
        "remove_dynamics must be true or false",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, mass_kg=-1, remove_dynamics=False),
        InvalidEntry,
        "mass must be",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, category="chairr", remove_dynamics=False),
        InvalidEntry,
        "did you mean",
    ),
    (
        lambda c: c.spawn_object(
            "cube", pose=AHEAD, behaviours=[{"type": "spin"}], remove_dynamics=False
        ),
        InvalidEntry,
        "behaviours.0..type.*rotate_rigidbody",
    ),
    (
        lambda c: c.spawn_object(
            "cube", pose=AHEAD, remove_dynamics=True, behaviours=[{"type": "rotate_rigidbody"}]
        ),
        InvalidEntry,
        "static",
    ),
    (
        lambda c: c.spawn_object("cube", pose=AHEAD, behaviours=3, remove_dynamics=False),
        InvalidRequest,
        "must be a list",
    ),
    (lambda c: c.despawn_object(60000), InvalidRequest, "instance id must be"),
    (lambda c: c.despawn_object("bxo"), UnknownName, "did you mean 'box'"),
    (lambda c: c.get_object(True), InvalidRequest, "an instance id, or the name"),
    (lambda c: c.get_object(1.0), InvalidRequest, "an instance id, or the name"),
    (lambda c: c.move_object("box", pose=(0, 0, 0)), InvalidRequest, "pose must be a sailenv_ros"),
    (lambda c: c.move_object(-1, pose=AHEAD), InvalidRequest, "instance id must be"),
    (lambda c: c.set_light("sn", intensity=1), UnknownName, "light must be one of"),
    (lambda c: c.set_light("sun", brightness=1), UnknownName, "attribute of a light must be"),
    (lambda c: c.set_light("sun", type="laser"), UnknownName, "directional, point, spot, area"),
    (lambda c: c.set_light("sun", intensity=float("nan")), InvalidRequest, "from 0 to 1000000"),
    (lambda c: c.set_light("sun", intensity="bright"), InvalidRequest, "from 0 to 1000000"),
    (lambda c: c.set_light("sun", inner_cone_deg=50), InvalidRequest, "outer_cone_deg = 35"),
    (lambda c: c.set_light("sun", direction=(0, 0, 0)), InvalidRequest, "not all zero"),
    (lambda c: c.set_light("sun", colour=(0, -1, 0)), InvalidRequest, "three numbers from 0"),
    (lambda c: c.set_ambient_light((1, 1)), InvalidRequest, "colour must be three finite"),
    (lambda c: c.set_background("sea"), UnknownName, "background must be one of: sky, colour"),
    (lambda c: c.set_background("colour", (-1, 0, 0)), InvalidRequest, "three numbers from 0"),
    (lambda c: c.load_scenario("optcal"), UnknownName, "did you mean 'optical'"),
    (lambda c: c.load_scenario({"scena": "optical"}), UnknownName, "did you mean 'scene'"),
    (lambda c: c.load_scenario(["optical"]), InvalidRequest, "a mapping with scene"),
    (lambda c: c.load_scenario({"objects": 3}), InvalidRequest, "a list of objects"),
    (lambda c: c.load_scenario({"objects": [3]}), InvalidEntry, "must be a mapping"),
    (lambda c: c.load_scenario({"objects": hollow_loop()}), InvalidRequest, "20 deep at most"),
    (
        lambda c: c.load_scenario({"objects": [{"asset": "cube", "name": "a"}] * 2}),
        InvalidEntry,
        "name",
    ),
]


@pytest.mark.parametrize(("call", "error", "sentence"), BAD_REQUESTS)
def test_a_refused_request_changes_nothing(
    core: SynchronousSimulation,
    told: list[SceneInfo],
    call: Any,
    error: type[Exception],
    sentence: str,
) -> None:
    """Each bad request gets one sentence; the world goes on as it was and nothing is announced."""
    core.spawn_object("cube", object_name="box", pose=AHEAD, remove_dynamics=False)
    told.clear()
    contents, snapshot = core.world.contents, core.world.snapshot()
    with pytest.raises(error, match=sentence):
        call(core)
    assert told == []
    assert core.world.contents is contents
    assert core.world.snapshot() is snapshot


# -- anything at all ---------------------------------------------------------------------------


ANYTHING = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-10, 70000),
    st.floats(),
    st.sampled_from(["", "cube", "Sphere", "sun", "lamp", "optical", "box", "chair", "colour"]),
    st.text(max_size=8),
    st.lists(st.floats(-3, 3), max_size=4),
)
NAMES = st.one_of(st.sampled_from(["box", "ball", "thing"]), ANYTHING)
OBJECTS = st.one_of(st.integers(1, 12), NAMES)
POSES = st.one_of(
    st.builds(
        Pose,
        st.tuples(*[st.floats(-20, 20)] * 3),
        st.sampled_from([(0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0)]),
    ),
    ANYTHING,
)
SCALES = st.one_of(st.floats(0.001, 10), st.tuples(*[st.floats(0, 1000)] * 3), ANYTHING)
TURNING = st.fixed_dictionaries(
    {"type": st.one_of(st.just("rotate_rigidbody"), ANYTHING)},
    optional={"angular_velocity": st.one_of(st.tuples(*[st.floats(-500, 500)] * 3), ANYTHING)},
)
REQUESTS = st.one_of(
    st.tuples(
        st.just("spawn_object"),
        st.tuples(st.one_of(st.sampled_from(["cube", "sphere", "cylinder"]), ANYTHING)),
        st.fixed_dictionaries(
            {"pose": POSES},
            optional={
                "object_name": NAMES,
                "scale": SCALES,
                "remove_dynamics": st.one_of(st.booleans(), ANYTHING),
                "category": st.one_of(st.just("chair"), ANYTHING),
                "behaviours": st.one_of(st.lists(TURNING, max_size=2), ANYTHING),
                "mass_kg": st.one_of(st.floats(0.01, 1e6), ANYTHING),
            },
        ),
    ),
    st.tuples(st.just("despawn_object"), st.tuples(OBJECTS), st.just({})),
    st.tuples(st.just("get_object"), st.tuples(OBJECTS), st.just({})),
    st.tuples(
        st.just("move_object"),
        st.tuples(OBJECTS),
        st.fixed_dictionaries({"pose": POSES}, optional={"teleport": ANYTHING}),
    ),
    st.tuples(
        st.just("set_light"),
        st.tuples(st.one_of(st.just("sun"), ANYTHING)),
        st.dictionaries(
            st.sampled_from(["type", "colour", "intensity", "direction", "outer_cone_deg", "x"]),
            st.one_of(st.just("point"), ANYTHING),
            max_size=3,
        ),
    ),
    st.tuples(st.just("set_ambient_light"), st.tuples(ANYTHING), st.just({})),
    st.tuples(st.just("set_background"), st.tuples(st.just("colour"), ANYTHING), st.just({})),
    st.tuples(
        st.just("load_scenario"),
        st.tuples(st.dictionaries(st.sampled_from(["scene", "objects", "x"]), ANYTHING)),
        st.just({}),
    ),
    st.tuples(st.just("step"), st.tuples(st.integers(1, 3)), st.just({})),
)


# Shrinking a list of requests that do things takes minutes and says little more.
@settings(max_examples=100, deadline=None, phases=(Phase.explicit, Phase.reuse, Phase.generate))
@given(requests=st.lists(REQUESTS, min_size=10, max_size=30))
def test_whatever_is_asked_the_world_stays_whole(requests: list[Any]) -> None:
    """Random and hostile requests: done or refused with a typed error; never half of either."""
    core = make_core()
    told: list[SceneInfo] = [core.info]
    core.on_info = told.append
    seen: dict[int, set[int]] = {}
    try:
        for name, args, kwargs in requests:
            contents = core.world.contents
            refusal = refused(getattr(core, name), *args, **kwargs)
            if refusal is not None:
                assert "\n" not in str(refusal)
                assert core.world.contents is contents
            check_whole(core, told, seen)
    finally:
        core.close()


def refused(request: Any, *args: Any, **kwargs: Any) -> SailenvError | None:
    """Ask for something; return the typed error, if it was refused."""
    try:
        request(*args, **kwargs)
    except SailenvError as error:
        return error
    return None


def check_whole(
    core: SynchronousSimulation, told: list[SceneInfo], seen: dict[int, set[int]]
) -> None:
    """Ids are known and never used again, names differ, poses are finite, frames can be made."""
    snapshot = core.world.snapshot()
    assert np.isfinite(snapshot.world_from_body).all()
    ids = snapshot.contents.instance_ids.tolist()
    assert [instance.id for instance in told[-1].instances] == ids
    assert len({instance.name for instance in told[-1].instances}) == len(ids)
    known = seen.setdefault(core.info.epoch, set())
    fresh = set(ids) - known
    assert not fresh or not known or min(fresh) > max(known)
    known.update(ids)
    assert core.capture(["instance"], agent="eye").revision <= told[-1].revision
