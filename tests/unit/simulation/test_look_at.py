"""Look-at constraints: agents and movers that face a point or an object, whatever moves."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest, InvalidState, SceneError, UnknownName
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose, facing
from sailenv_ros.types.look_at import LookAt
from tests.support.lockstep_core import lockstep_core

STAGE = """
version: 1
gravity: [0, 0, 0]
objects:
  - {name: post, asset: cube, position: [3, 0, 1], scale: [0.5, 1, 2], static: true}
  - name: ball
    asset: sphere
    position: [2, -1, 1]
    scale: 0.3
    gravity: false
    behaviours:
      - {type: linear_waypoints, total_time: 2, loop: false,
         waypoints: [{position: [2, -1, 1]}, {position: [2, 1, 1.5]}]}
  - {name: guest, asset: cone, position: [0, 4, 1], scale: 0.3, gravity: false, appear: 0.25,
     leave: 0.5, velocity: [1, 0, 0]}
movers:
  - name: rail
    total_time: 4
    loop: false
    waypoints: [{position: [-1, 0, 1]}, {position: [-1, 2, 2]}]
  - {name: cart, position: [0, 2, 1.5], rotation: [0, 0, 30], controller: rigidbody,
     keep_looking_at: {object: post, point: [0.1, 0.2, 0.3]}}
agents:
  - {name: rider, width: 16, height: 12}
  - {name: porter, width: 16, height: 12, mover: cart}
  - {name: watcher, width: 16, height: 12, following: false, position: [0, 0, 1.5],
     keep_looking_at: {object: ball}}
  - {name: host, width: 16, height: 12, following: false, position: [0, 0, 1],
     keep_looking_at: {object: guest}}
"""


def away(pose: Pose, target_m: tuple[float, float, float]) -> float:
    """Return how far a point is beside the optical axis [rad]; behind is π; rolled is inf."""
    axes = pose.matrix()[:3, :3]
    offset = axes.T @ (np.asarray(target_m) - pose.position_m)
    if abs(axes[2, 1]) > 1e-12 or axes[2, 2] < -1e-12:
        return math.inf
    return math.atan2(math.hypot(offset[1], offset[2]), offset[0])


def place(core: SynchronousSimulation, name: str) -> tuple[float, float, float]:
    return core.get_object(name).pose.position_m


def faced(core: SynchronousSimulation, agent: str, target_m: tuple[float, float, float]) -> bool:
    return away(core.get_pose(agent=agent), target_m) < 1e-9


# -- arithmetic --------------------------------------------------------------------------------

COORDINATE = st.floats(-50.0, 50.0)
POINT = st.tuples(COORDINATE, COORDINATE, COORDINATE)


@given(POINT, POINT, st.tuples(*[st.floats(-180.0, 180.0)] * 3))
def test_the_point_lies_on_the_axis_and_nothing_rolls(
    eye: tuple[float, float, float],
    target: tuple[float, float, float],
    rpy: tuple[float, float, float],
) -> None:
    pose = Pose.from_rpy_deg(eye, rpy)
    turned = facing(pose, target)
    assert turned.position_m == pose.position_m
    if math.dist(eye, target) < 1e-6:
        return
    # Closer to the vertical than 1e-9 the heading is kept, and the axis may be that far off.
    assert away(turned, target) < 3e-9


@pytest.mark.parametrize(
    ("target", "rpy"),
    [
        ((1.0, 1.0, 0.0), (0.0, 0.0, 45.0)),
        ((-1.0, 0.0, 1.0), (0.0, -45.0, 180.0)),
        ((0.0, -3.0, -math.sqrt(3.0)), (0.0, 30.0, -90.0)),
    ],
)
def test_angles_are_those_of_the_textbook(
    target: tuple[float, float, float], rpy: tuple[float, float, float]
) -> None:
    turned = facing(Pose.from_rpy_deg((0.0, 0.0, 0.0), (70.0, 10.0, -20.0)), target)
    np.testing.assert_allclose(turned.rpy_deg, rpy, atol=1e-12)


@pytest.mark.parametrize("up", [5.0, -5.0])
@pytest.mark.parametrize("beside", [0.0, 1e-12])
def test_straight_above_and_below_the_heading_is_kept(up: float, beside: float) -> None:
    pose = Pose.from_rpy_deg((1.0, 2.0, 3.0), (0.0, 20.0, 70.0))
    axes = facing(pose, (1.0 - beside, 2.0, 3.0 + up)).matrix()[:3, :3]
    np.testing.assert_allclose(axes[:, 0], (0.0, 0.0, math.copysign(1.0, up)), atol=1e-12)
    heading = math.radians(70.0)
    left = (-math.sin(heading), math.cos(heading), 0.0)
    np.testing.assert_allclose(axes[:, 1], left, atol=1e-12)
    assert facing(pose, pose.position_m) == pose


# -- who is faced ------------------------------------------------------------------------------


def test_a_standing_agent_faces_what_moves_in_every_step(core: SynchronousSimulation) -> None:
    """That of a scene file from the start, that of a request at once."""
    assert faced(core, "watcher", place(core, "ball"))
    before = place(core, "ball")
    for _ in range(48):
        core.step(5)
        assert faced(core, "watcher", place(core, "ball"))
    assert math.dist(before, place(core, "ball")) > 0.5
    core.set_look_at("post", agent="watcher")
    assert faced(core, "watcher", place(core, "post"))
    core.set_look_at(point_m=(-1.0, -2.0, 0.5), agent="watcher")
    core.step()
    assert faced(core, "watcher", (-1.0, -2.0, 0.5))


def test_one_that_is_carried_faces_a_point_from_wherever_it_is(core: SynchronousSimulation) -> None:
    """The agent's position is its mover's, which is not turned; another agent is left alone."""
    core.set_look_at(point_m=(0.5, 0.0, 0.2), agent="rider")
    for _ in range(10):
        core.step(60)
        rail = core.get_mover_pose("rail")
        assert core.get_pose(agent="rider").position_m == rail.position_m
        assert faced(core, "rider", (0.5, 0.0, 0.2))
        assert rail.rpy_deg == (0.0, 0.0, 0.0)


def test_a_mover_faces_and_turns_what_follows_it(core: SynchronousSimulation) -> None:
    """A point of an object, in its own frame; where it walks to is seen from there."""
    target = (3.1, 0.2, 1.3)
    assert faced(core, "porter", target)
    core.set_mover_look_at("ball", mover="rail")
    for _ in range(20):
        core.drive_mover((0.0, 1.0, 0.0), mover="cart")
        core.step(24)
        assert faced(core, "porter", target)
        assert faced(core, "rider", place(core, "ball"))
    # Sideways, facing: around the point, on a circle but for the length of the steps.
    there = core.get_pose(agent="porter").position_m
    start = math.dist((0.0, 2.0), target[:2])
    assert math.dist(there[:2], target[:2]) == pytest.approx(start, rel=0.01)
    assert math.dist(there, (0.0, 2.0, 1.5)) > 1.0


def test_an_agent_may_face_another_thing_than_its_mover(core: SynchronousSimulation) -> None:
    core.set_look_at("ball", agent="porter")
    assert faced(core, "porter", place(core, "ball"))
    core.set_look_at(agent="porter")
    assert faced(core, "porter", (3.1, 0.2, 1.3))


def test_who_is_gone_is_looked_for_where_it_was_last(core: SynchronousSimulation) -> None:
    """Whether anybody asked meanwhile or not; also who leaves, and who has not come yet."""
    core.set_mover_look_at("ball", mover="rail")
    core.step(100)
    last = place(core, "ball")
    core.despawn_object("ball")
    core.step(30)
    for agent in ("watcher", "rider"):
        assert faced(core, agent, last)
    core.reset()
    # It waits where it will appear, comes after 60 steps, drifts, and leaves after 120.
    assert faced(core, "host", (0.0, 4.0, 1.0))
    core.step(100)
    drifting = place(core, "guest")
    assert drifting[0] > 0.1
    assert faced(core, "host", drifting)
    core.step(40)
    gone = core.get_pose(agent="host")
    assert away(gone, (0.25, 4.0, 1.0)) < math.radians(0.2)
    core.step(40)
    assert core.get_pose(agent="host") == gone


def test_one_that_is_renamed_is_the_same(core: SynchronousSimulation) -> None:
    core.change_object("ball", name="football")
    core.step(60)
    assert faced(core, "watcher", place(core, "football"))


# -- what ends it ------------------------------------------------------------------------------


def test_to_be_turned_ends_it_and_to_be_moved_does_not(core: SynchronousSimulation) -> None:
    core.set_position((0.5, 0.5, 2.0), agent="watcher")
    assert core.get_pose(agent="watcher").position_m == (0.5, 0.5, 2.0)
    assert faced(core, "watcher", place(core, "ball"))
    core.set_rotation((0.0, 10.0, 200.0), agent="watcher")
    core.step(30)
    np.testing.assert_allclose(
        core.get_pose(agent="watcher").rpy_deg, (0.0, 10.0, -160.0), atol=1e-9
    )
    core.set_look_at("ball", agent="watcher")
    given = Pose.from_rpy_deg((0.0, 1.0, 1.0), (5.0, 0.0, 20.0))
    core.set_pose(given, agent="watcher")
    core.step(30)
    assert core.get_pose(agent="watcher") == given


def test_to_be_released_leaves_it_turned_as_it_is(core: SynchronousSimulation) -> None:
    """One that a track turns goes on as its track says."""
    core.step(20)
    seen = core.get_pose(agent="watcher")
    core.set_look_at(agent="watcher")
    core.set_look_at(agent="watcher")
    core.step(20)
    assert core.get_pose(agent="watcher") == seen
    carried = core.get_pose(agent="porter")
    core.set_mover_look_at(mover="cart")
    assert core.get_pose(agent="porter") == carried
    core.set_mover_look_at("ball", mover="rail")
    core.set_mover_look_at(mover="rail")
    assert core.get_mover_pose("rail").rpy_deg == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("how", ["turn", "drive", "set_pose", "set_rotation"])
def test_a_mover_that_is_turned_by_hand_faces_nothing(
    core: SynchronousSimulation, how: str
) -> None:
    core.set_look_at("ball", agent="porter")
    before = core.get_mover_pose("cart")
    if how == "turn":
        core.turn_mover(yaw_rad=0.5, mover="cart")
    elif how == "drive":
        core.drive_mover(angular_rad_s=(0.0, 0.0, 1.0), mover="cart")
        core.step(120)
    elif how == "set_pose":
        core.set_pose(before.turned((0.0, 0.0, math.sin(0.25), math.cos(0.25))), agent="porter")
    else:
        roll, pitch, yaw = before.rpy_deg
        core.set_rotation((roll, pitch, yaw + math.degrees(0.5)), agent="porter")
    turned = core.get_mover_pose("cart")
    change = math.radians(turned.rpy_deg[2] - before.rpy_deg[2])
    assert change == pytest.approx(0.5, abs=0.01)
    core.step(10)
    assert core.get_mover_pose("cart") == turned
    if how.startswith("set"):  # the agent was turned, not only its mover
        assert core.get_pose(agent="porter") == turned


def test_a_carried_agent_that_is_moved_does_not_turn_its_mover(core: SynchronousSimulation) -> None:
    core.set_mover_look_at(mover="cart")
    core.set_look_at("ball", agent="porter")
    turned = core.get_mover_pose("cart").orientation_xyzw
    core.set_position((0.0, 3.0, 1.0), agent="porter")
    assert core.get_mover_pose("cart") == Pose((0.0, 3.0, 1.0), turned)
    assert faced(core, "porter", place(core, "ball"))


def test_a_reset_begins_as_the_scene_does(core: SynchronousSimulation) -> None:
    core.set_look_at("ball", agent="rider")
    core.set_look_at(agent="watcher")
    core.set_mover_look_at(mover="cart")
    core.reset()
    core.step(30)
    assert faced(core, "watcher", place(core, "ball"))
    assert faced(core, "porter", (3.1, 0.2, 1.3))
    assert core.get_pose(agent="rider").rpy_deg == (0.0, 0.0, 0.0)


def test_another_scene_keeps_points_and_objects_of_the_same_name(
    stage: Path, tmp_path: Path
) -> None:
    bare = (
        "version: 1\nobjects:\n  - {name: post, asset: cube, position: [0, 5, 0], static: true}\n"
    )
    (tmp_path / "bare.yaml").write_text(bare, encoding="utf-8")
    two = lockstep_core(stage.stem, tmp_path)
    two.set_look_at("post", agent="rider")
    two.set_look_at(point_m=(1.0, 1.0, 1.0), agent="porter")
    two.change_scene("bare")
    assert faced(two, "rider", (0.0, 5.0, 0.0))
    assert faced(two, "porter", (1.0, 1.0, 1.0))
    assert two.get_pose(agent="watcher").rpy_deg == (0.0, 0.0, 0.0)
    two.close()


# -- files and determinism ---------------------------------------------------------------------


def test_saved_scenes_keep_it(core: SynchronousSimulation, tmp_path: Path) -> None:
    """That of the file as it was, that of requests, and of one that is gone where it was."""
    core.set_look_at("post", (0.0, 0.1, 0.2), agent="rider")
    core.set_mover_look_at("ball", mover="rail")
    core.set_look_at(point_m=(1.0, 2.0, 3.0), agent="porter")
    core.set_look_at(agent="watcher")
    core.step(50)
    path = tmp_path / "saved.yaml"
    path.write_text(core.scene_text(), encoding="utf-8")
    again = lockstep_core(path)
    for agent in ("rider", "porter", "watcher", "host"):
        saved, made = core.get_pose(agent=agent), again.get_pose(agent=agent)
        if agent != "rider":  # tracks begin anew
            np.testing.assert_allclose(made.matrix(), saved.matrix(), atol=2e-6)
    assert faced(again, "rider", (3.0, 0.1, 1.2))
    assert away(again.get_mover_pose("rail"), place(again, "ball")) < 1e-9
    assert again.scene_text() == core.scene_text()
    again.close()

    core.set_look_at("ball", agent="watcher")
    last = place(core, "ball")
    core.despawn_object("ball")
    path.write_text(core.scene_text(), encoding="utf-8")
    once_more = lockstep_core(path)
    assert faced(once_more, "watcher", last)
    once_more.close()


def test_the_same_requests_give_the_same_poses(stage: Path) -> None:
    """However often somebody asks in between."""

    def run(asks: int) -> list[Pose]:
        made = lockstep_core(stage)
        made.set_mover_look_at("ball", mover="rail")
        made.step(37)
        made.despawn_object("ball")
        poses = []
        for _ in range(5):
            for _ in range(asks):
                made.get_pose(agent="rider")
            made.step(20)
            poses += [made.get_pose(agent=name) for name in ("rider", "watcher", "host")]
        made.close()
        return poses

    assert run(0) == run(3)


# -- what is refused ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("obj", "point", "error"),
    [
        ("bal", None, UnknownName),
        (999, None, InvalidRequest),
        (True, None, InvalidRequest),
        ("guest", None, InvalidState),
        (None, (0.0, math.nan, 0.0), InvalidRequest),
        (None, (0.0, 2e4, 0.0), InvalidRequest),
        ("ball", (0.0, 1.0), InvalidRequest),
    ],
)
def test_what_cannot_be_faced_is_refused_and_changes_nothing(
    core: SynchronousSimulation, obj: object, point: object, error: type[Exception]
) -> None:
    before = core.get_pose(agent="watcher"), core.get_mover_pose("cart")
    with pytest.raises(error):
        core.set_look_at(obj, point, agent="watcher")  # type: ignore[arg-type]
    with pytest.raises(error):
        core.set_mover_look_at(obj, point, mover="cart")  # type: ignore[arg-type]
    assert (core.get_pose(agent="watcher"), core.get_mover_pose("cart")) == before
    with pytest.raises(UnknownName):
        core.set_look_at("ball", agent="nobody")
    with pytest.raises(UnknownName):
        core.set_mover_look_at("ball", mover="nobody")


def test_an_agent_is_registered_with_what_it_faces(core: SynchronousSimulation) -> None:
    lens = CameraIntrinsics(width=16, height=12)
    unknown = AgentSpec(name="one", intrinsics=lens, look_at=LookAt(obj="bal"))
    with pytest.raises(UnknownName):
        core.register_agent(unknown)
    assert "one" not in [spec.name for spec in core.info.agents]
    core.register_agent(AgentSpec(name="one", intrinsics=lens, look_at=LookAt(obj="ball")))
    core.step(20)
    assert faced(core, "one", place(core, "ball"))


@pytest.mark.parametrize(
    ("where", "entry", "says"),
    [
        ("agents", "{object: bal}", "agents[0].keep_looking_at.object"),
        ("agents", "{}", "a point is needed"),
        ("mover", "{object: bal}", "mover.keep_looking_at.object"),
        ("mover", "{point: [0, .nan, 0]}", "point"),
    ],
)
def test_a_scene_file_that_faces_nothing_is_refused(
    tmp_path: Path, where: str, entry: str, says: str
) -> None:
    path = tmp_path / "wrong.yaml"
    text = "version: 1\nobjects: [{name: ball, asset: sphere}]\n"
    held = f"keep_looking_at: {entry}"
    text += f"agents: [{{name: one, {held}}}]\n" if where == "agents" else f"mover: {{{held}}}\n"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SceneError) as refused:
        SceneLibrary().load(path)
    assert says in str(refused.value)
