"""Behaviours as plain functions: tracks against arithmetic, seeds, errors, users' modules."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sailenv_ros.behaviours import (
    STEP_S,
    BodyState,
    BodyStates,
    RunningBehaviour,
    behaviour_errors,
    behaviour_kinds,
    known_behaviour_errors,
    start_behaviour,
)
from sailenv_ros.behaviours.steering import turn_vector
from sailenv_ros.behaviours.waypoints import Waypoints, catmull_pose, linear_pose
from sailenv_ros.cli.main import main
from sailenv_ros.errors import InvalidRequest, SceneError
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.bullet import STEPS_PER_SECOND

USERS = "tests.support.users_behaviours:drift"

FIERCE: dict[str, dict[str, Any]] = {
    "poltergeist": {"mean_interval": 0.05, "duration": 0.05},
    "uniform_movement_random_bounce": {"speed": 1.0, "angular_speed": 90.0},
}

CORNERS: list[dict[str, Any]] = [
    {"position": [0, 0, 0]},
    {"position": [2, 0, 0], "rotation": [0, 0, 90]},
    {"position": [2, 2, 0], "rotation": [0, 0, 180]},
    {"position": [0, 2, 1], "rotation": [0, 0, -90]},
]

OF_PEOPLE = ("walk_around", "sit", "lie", "visit", "play_clip", "fetch", "open_by_hand")
"""See `test_behaviours_of_people`."""

ALL: dict[str, dict[str, Any]] = {
    "rotate_rigidbody": {},
    "poltergeist": {"mean_interval": 0.2},
    "wander_plane": {"waypoints": [[1, 0, 1], [-1, 0, 1], [0, 1, 2]]},
    "uniform_movement_random_bounce": {},
    "linear_waypoints": {"waypoints": CORNERS},
    "catmull_waypoints": {"waypoints": CORNERS},
    "wrench": {"force": [1, 2, 3], "duration": 1.0},
    "open_and_close": {"period": 4.0},
}


def at_rest(pose: Pose | None = None, **kwargs: Any) -> BodyState:
    """A body of 2 kg that stands still."""
    still = {"linear_velocity": np.zeros(3), "angular_velocity": np.zeros(3)}
    return BodyState(pose=pose or Pose(), mass_kg=2.0, **{**still, **kwargs})


def actions(type_: str, seed: int, count: int = 480) -> list[Any]:
    running = start_behaviour(type_, ALL[type_], seed=seed, object_name="thing", place=0)
    body = at_rest(joint_limits=(0.0, 1.0))
    return [running.act(step * STEP_S, body) for step in range(count)]


def test_a_step_is_the_engines() -> None:
    """Behaviours, which know no engine, count with its steps."""
    assert STEP_S == 1.0 / STEPS_PER_SECOND


def test_all_are_listed_and_each_says_what_it_does() -> None:
    """The registry holds them all, with a sentence and described parameters."""
    kinds = behaviour_kinds()
    assert set(kinds) == {*ALL, *OF_PEOPLE}
    for kind in kinds.values():
        assert kind.summary.endswith(".")
        assert all(field.description for field in kind.parameters.model_fields.values())


@pytest.mark.parametrize("type_", ALL)
def test_a_seed_gives_the_same_actions_again(type_: str) -> None:
    """The same seed, the same actions; and 2 s of them are not all empty."""
    first = actions(type_, 7)
    assert first == actions(type_, 7)
    assert any(action.acts for action in first)


@pytest.mark.parametrize("type_", ["poltergeist", "uniform_movement_random_bounce"])
def test_another_seed_gives_other_actions(type_: str) -> None:
    """Random ones depend on the seed."""
    assert actions(type_, 7) != actions(type_, 8)


@given(
    st.lists(st.floats(-180, 180), min_size=3, max_size=3),
    st.lists(st.floats(-180, 180), min_size=3, max_size=3),
)
def test_turns_are_the_shorter_ones(first: list[float], second: list[float]) -> None:
    """The turn applied to the first orientation gives the second, by at most half a turn."""
    start, end = Pose.from_rpy_deg((0, 0, 0), first), Pose.from_rpy_deg((0, 0, 0), second)
    turn = turn_vector(start, end)
    assert np.linalg.norm(turn) <= np.pi + 1e-9
    reached = Rotation.from_rotvec(turn) * Rotation.from_quat(start.orientation_xyzw)
    np.testing.assert_allclose(reached.as_matrix(), end.matrix()[:3, :3], atol=1e-7)


@pytest.mark.parametrize("pose_of", [linear_pose, catmull_pose])
@pytest.mark.parametrize("loop", [True, False])
def test_tracks_come_by_every_waypoint_in_time(pose_of: Any, loop: bool) -> None:
    """Equal legs: 4 of a loop or 3 of an open track share 12 s; the second loop is the first."""
    track = Waypoints(waypoints=CORNERS, total_time=12.0, loop=loop)
    leg = 12.0 / (4 if loop else 3)
    for number, waypoint in enumerate(track.poses):
        pose = pose_of(track, number * leg)
        np.testing.assert_allclose(pose.position_m, waypoint.position_m, atol=1e-9)
        np.testing.assert_allclose(pose.matrix(), waypoint.matrix(), atol=1e-9)
    later = pose_of(track, 12.0 + 1.0)
    expected = pose_of(track, 1.0) if loop else track.poses[-1]
    np.testing.assert_allclose(later.matrix(), expected.matrix(), atol=1e-9)


def test_a_catmull_track_is_smooth_where_a_linear_one_has_a_corner() -> None:
    """The spline's velocity at an inner waypoint is half the way between its neighbours."""
    track = Waypoints(waypoints=CORNERS, total_time=4.0)
    h = 1e-5
    for number in range(4):
        before, here, after = (
            np.array(catmull_pose(track, 4.0 + number + dt).position_m) for dt in (-h, 0, h)
        )
        neighbours = [np.array(track.poses[(number + way) % 4].position_m) for way in (-1, 1)]
        expected = (neighbours[1] - neighbours[0]) / 2
        np.testing.assert_allclose((after - here) / h, expected, atol=1e-3)
        np.testing.assert_allclose((here - before) / h, expected, atol=1e-3)


def test_a_track_rests_between_its_rounds() -> None:
    """It runs for 4 s, stands at its beginning for 3 s, and runs again."""
    track = Waypoints(waypoints=CORNERS, total_time=4.0, rest=3.0)
    plain = Waypoints(waypoints=CORNERS, total_time=4.0)
    for pose_of in (linear_pose, catmull_pose):
        for time_s in (0.0, 0.7, 3.99):
            for rounds in (0, 1, 5):
                pose = pose_of(track, time_s + rounds * 7.0)
                np.testing.assert_allclose(
                    pose.matrix(), pose_of(plain, time_s).matrix(), atol=1e-9
                )
        for time_s in (4.0, 5.5, 6.99, 13.9):
            pose = pose_of(track, time_s)
            np.testing.assert_array_equal(pose.position_m, track.poses[0].position_m)
    running = start_behaviour(
        "linear_waypoints",
        {"waypoints": CORNERS, "total_time": 4.0, "rest": 3.0},
        seed=0, object_name="a", place=0,
    )  # fmt: skip
    # At rest in its place it is left alone; pushed away it comes back; still moving it is stopped.
    assert not running.act(5.0, at_rest(track.poses[0])).acts
    away = running.act(5.0, at_rest(Pose((0.01, 0.0, 0.0))))
    np.testing.assert_allclose(away.linear_velocity, (-0.01 / STEP_S, 0.0, 0.0))
    slow = at_rest(track.poses[0], linear_velocity=np.array([1e-9, 0.0, 0.0]))
    assert running.act(5.0, slow).linear_velocity == (0.0, 0.0, 0.0)


def test_a_single_waypoint_is_a_place_to_be() -> None:
    """A track of one waypoint holds the object there."""
    track = Waypoints(waypoints=CORNERS[1:2], total_time=3.0)
    for pose_of in (linear_pose, catmull_pose):
        assert pose_of(track, 1.7).position_m == (2.0, 0.0, 0.0)


def test_a_start_delays_everything() -> None:
    """Before its start a behaviour does nothing; then its clock begins at 0."""
    parameters = {"waypoints": CORNERS, "start": 1.0, "total_time": 8.0}
    running = start_behaviour(
        "linear_waypoints", parameters, seed=0, object_name="a", place=0, start_s=2.0
    )
    assert not running.act(2.9, at_rest()).acts
    action = running.act(3.0, at_rest())
    assert action.linear_velocity == pytest.approx((1.0, 0.0, 0.0), abs=1e-9)


def test_a_poltergeist_pushes_by_mass_and_inertia() -> None:
    """Its force is mass times at most the acceleration, its torque that of the inertia."""
    heavy, light = (
        start_behaviour(
            "poltergeist",
            {"mean_interval": 0.1, "acceleration": 10.0},
            seed=3,
            object_name="a",
            place=0,
        )
        for _ in range(2)
    )
    pushes = 0
    for step in range(2400):
        strong = heavy.act(step * STEP_S, at_rest())
        inertia = np.array([0.1, 0.1, 0.1])
        weak = light.act(step * STEP_S, at_rest(inertia_kg_m2=inertia))
        assert strong.acts == weak.acts
        if strong.force_n is None or strong.torque_nm is None:
            continue
        pushes += 1
        assert 10.0 <= np.linalg.norm(strong.force_n) <= 20.0
        np.testing.assert_allclose(weak.torque_nm, 0.1 * np.array(strong.torque_nm))
    assert 24 * 10 < pushes < 2400 * 0.9


def test_an_impact_turns_the_movement_back() -> None:
    """Stopped by a wall ahead, the object leaves it on the next step, at the same speed."""
    for seed in range(50):
        running = start_behaviour(
            "uniform_movement_random_bounce",
            {"start_direction": [1, 0, 0], "speed": 2.0},
            seed=seed,
            object_name="a",
            place=0,
        )
        assert running.act(0.0, at_rest()).linear_velocity == (2.0, 0.0, 0.0)
        after = running.act(STEP_S, at_rest(linear_velocity=np.zeros(3))).linear_velocity
        assert after is not None
        assert after[0] < 0.0
        assert np.linalg.norm(after) == pytest.approx(2.0)


def test_a_plane_that_was_crossed_turns_the_movement_back() -> None:
    """Behind a plane of the view it turns to the front; in front it goes straight on."""
    running = start_behaviour(
        "uniform_movement_random_bounce",
        {"start_direction": [1, 0, 0], "keep_in_view": "agent"},
        seed=0,
        object_name="a",
        place=0,
    )
    moving = np.array([1.0, 0.0, 0.0])
    planes = np.array([[-1.0, 0.0, 0.0, 2.0]])
    for x, ahead in ((1.0, True), (1.9, True), (2.1, False), (2.2, False)):
        state = at_rest(Pose((x, 0, 0)), linear_velocity=moving, frustum_planes=planes)
        velocity = running.act(x, state).linear_velocity
        assert velocity is not None
        assert (velocity[0] > 0) == ahead
        moving = np.array(velocity)


@pytest.mark.parametrize(
    ("type_", "parameters", "place", "words"),
    [
        ("polter", {}, ("type",), "poltergeist"),
        ("linear_waypoints", {"waypoints": []}, ("waypoints",), "at least 1"),
        ("linear_waypoints", {}, ("waypoints",), "missing"),
        ("linear_waypoints", {"waypoints": CORNERS, "total_time": -1}, ("total_time",), "above 0"),
        ("catmull_waypoints", {"waypoints": CORNERS, "total_time": 0}, ("total_time",), "above 0"),
        ("poltergeist", {"mean_interval": -2}, ("mean_interval",), "from 0.05"),
        ("poltergeist", {"strength": 3}, ("strength",), "not a parameter of poltergeist"),
        ("wander_plane", {"waypoints": [[0, 0, 0]]}, ("waypoints",), "at least 2"),
        ("uniform_movement_random_bounce", {"speed": 0}, ("speed",), "above 0"),
        ("uniform_movement_random_bounce", {"speed": 99}, ("speed",), "at most 10"),
        ("rotate_rigidbody", {"start": -1}, ("start",), "from 0"),
    ],
)
def test_wrong_parameters_are_told_with_their_place(
    type_: str, parameters: dict[str, Any], place: tuple[str, ...], words: str
) -> None:
    """Each error names the key and what is accepted."""
    diagnostics = list(behaviour_errors(type_, parameters))
    assert [found for found, _ in diagnostics] == [place]
    assert words in diagnostics[0][1]
    with pytest.raises(InvalidRequest):
        start_behaviour(type_, parameters, seed=0, object_name="a", place=0)


def test_strangers_cannot_have_a_module_imported() -> None:
    """A request that names a module is refused until a file has named it; then it runs."""
    before = set(sys.modules)
    assert list(known_behaviour_errors("tests.support.unheard_of:drift", {}))
    assert set(sys.modules) == before
    assert list(behaviour_errors(USERS, {"speed": 2.0})) == []
    assert list(known_behaviour_errors(USERS, {"speed": 2.0})) == []
    running = start_behaviour(USERS, {"speed": 2.0}, seed=0, object_name="a", place=0)
    assert running.act(0.0, at_rest()).linear_velocity == (2.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("type_", "words"),
    [
        ("no_such_module_there:thing", "cannot be imported"),
        ("tests.support.users_behaviours:sway", "it has: drift"),
        ("math:sqrt", "it has: none"),
    ],
)
def test_users_modules_that_do_not_fit_are_told(type_: str, words: str) -> None:
    """A missing module, a missing behaviour and another kind of thing are errors of the type."""
    ((place, sentence),) = behaviour_errors(type_, {})
    assert place == ("type",)
    assert words in sentence


def test_the_command_lists_every_parameter(capsys: pytest.CaptureFixture[str]) -> None:
    """`sailenv behaviours` prints each type with each parameter and its default."""
    assert main(["behaviours"]) == 0
    printed = capsys.readouterr().out
    for kind in behaviour_kinds().values():
        assert f"{kind.type}: {kind.summary}" in printed
        assert all(f"  {name}" in printed for name in kind.parameters.model_fields)
    assert main(["behaviours", "levitate"]) == 2


@pytest.fixture
def hostile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scene whose behaviour's module leaves a mark where it is run."""
    (tmp_path / "hostile_module.py").write_text(
        "from pathlib import Path\n"
        "Path(__file__).with_name('mark').touch()\n"
        "from tests.support.users_behaviours import drift\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "hostile_module", raising=False)
    scene = tmp_path / "hostile.yaml"
    scene.write_text(
        "version: 1\n"
        "objects:\n"
        "  - {name: a, asset: Cube, behaviours: [{type: 'hostile_module:drift', speed: 1.0}]}\n"
    )
    return scene


def test_no_command_runs_code_of_a_scene_file_unasked(
    hostile: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Checking runs nothing; whatever builds the scene refuses it and says how to allow it."""
    assert main(["scene", "check", str(hostile)]) == 0
    assert "names the code of 'hostile_module:drift'" in capsys.readouterr().out
    assert main(["scene", "check", "--physics", str(hostile)]) == 1
    assert "allow that: --allow-modules" in capsys.readouterr().out
    assert main(["scene", "render", str(hostile), "-o", str(hostile.with_suffix(".png"))]) == 2
    assert "allow that: --allow-modules" in capsys.readouterr().err
    with pytest.raises(SceneError, match="would run the code of the Python module"):
        SceneLibrary().build(hostile)
    assert not hostile.with_name("mark").exists()


def test_code_of_a_scene_file_runs_where_it_is_allowed(hostile: Path) -> None:
    """With the user's word the behaviour moves its object."""
    library = SceneLibrary(allow_modules=True)
    assert not hostile.with_name("mark").exists()
    world = library.build(hostile)
    try:
        assert hostile.with_name("mark").exists()
        world.step(24)
        assert world.object_state(world.find("a")).pose.position_m[0] > 0.05
    finally:
        world.close()


@pytest.mark.parametrize("type_", ["poltergeist", "uniform_movement_random_bounce"])
def test_many_bodies_at_once_are_each_as_if_alone(type_: str) -> None:
    """The batch of a kind has the very numbers of each body asked alone, over half a second."""
    count, rng = 20, np.random.default_rng(5)

    def started() -> list[RunningBehaviour]:
        return [
            start_behaviour(type_, FIERCE[type_], seed=1, object_name=f"body {n}", place=0)
            for n in range(count)
        ]

    together, alone = started(), started()
    batch = together[0].kind.batch
    assert batch is not None
    for step in range(120):
        bodies = [
            at_rest(
                Pose.from_rpy_deg(rng.uniform(-1, 1, 3), rng.uniform(-180, 180, 3)),
                linear_velocity=rng.uniform(-2, 2, 3),
                inertia_kg_m2=rng.uniform(0.1, 1, 3),
                frustum_planes=np.array([[0.0, 0.0, -1.0, 0.5]][: step % 2]).reshape(-1, 4),
            )
            for _ in range(count)
        ]
        rows = [n for n in range(count) if not together[n].is_idle(step * STEP_S)]
        expected = [alone[n].act(step * STEP_S, bodies[n]) for n in rows]
        if not rows:
            continue
        ones = [BodyStates.of(bodies[n]) for n in rows]
        states = BodyStates(
            **{
                field.name: np.concatenate([getattr(one, field.name) for one in ones])
                for field in dataclasses.fields(BodyStates)
                if field.name != "frustum_planes"
            },
            frustum_planes=tuple(bodies[n].frustum_planes for n in rows),
        )
        actions = batch([together[n] for n in rows], np.full(len(rows), step * STEP_S), states)
        assert [actions.row(row) for row in range(len(rows))] == expected
        for row, n in enumerate(rows):
            together[n].idle_until_s = actions.row(row).idle_until_s or 0.0
