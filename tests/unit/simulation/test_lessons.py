"""Objects that come and go: by their own times and in lessons; who waits is nowhere."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidEntry, InvalidRequest, InvalidState, SceneError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.scene.spec import LessonsSpec, ObjectSpec
from sailenv_ros.simulation.script.lesson_plan import LessonPlan, ScheduledLesson
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.lessons import LessonState
from tests.support.waiting import until

# Everything stands in the same place, where a wall would be met by what moves.
SCHOOL = """
version: 1
gravity: [0, 0, 0]
lights: [{name: sun, type: directional, direction: [1, 0.2, -1], intensity: 3}]
objects:
  - {name: shelf, asset: cube, position: [4, 0, 1], scale: [0.1, 3, 2], static: true}
  - name: runner
    asset: cube
    position: [2, 0, 1]
    scale: 0.3
    gravity: false
    behaviours:
      - {type: linear_waypoints, total_time: 1, loop: false,
         waypoints: [{position: [2, 0, 1]}, {position: [2, 0.5, 1]}]}
  - {name: shaker, asset: sphere, position: [2, 0, 1], scale: 0.4, gravity: false,
     behaviours: [{type: poltergeist, mean_interval: 0.1}]}
  - {name: guest, asset: cone, position: [2, 0, 2], scale: 0.3, gravity: false, appear: 0.5,
     leave: 1.0}
lessons:
  laps: 2
  pause: 0.25
  sequence:
    - objects: [runner]
    - {name: shaking, objects: [shaker], duration: 0.5}
"""
LAP_STEPS = 240 + 60 + 120 + 60
VIEWS = ["depth", "instance", "flow"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "school.yaml").write_text(SCHOOL, encoding="utf-8")
    return folder


def simulation(folder: Path, scene: str = "school", **options: Any) -> Simulation:
    lens = CameraIntrinsics(width=80, height=60)
    eye = AgentSpec(
        name="eye",
        intrinsics=lens,
        rate_hz=0.0,
        following=False,
        pose=look_at((-1.0, 0.0, 1.2), (2.0, 0.0, 1.2)),
    )
    given: dict[str, Any] = {"mode": "lockstep", "backend": "native", **options}
    return Simulation(scene, scene_paths=[folder], agent=eye, **given)


@pytest.fixture
def school(folder: Path) -> Iterator[Simulation]:
    with simulation(folder) as made:
        yield made


def there(frame: Frame) -> set[str]:
    return {shown.name for shown in frame.instances.values()}


def seen(frame: Frame) -> set[str]:
    ids = np.unique(frame["instance"])
    return {frame.instances[int(id_)].name for id_ in ids if id_}


def test_who_waits_is_nowhere(school: Simulation) -> None:
    """Pixels, tables, boxes and the engine know who is there; the id of an object stays its own."""
    numbers: dict[str, set[int]] = {}
    expected = {
        **{0: "runner", 239: "runner", 240: "", 299: "", 300: "shaking", 419: "shaking", 420: ""},
        **{LAP_STEPS: "runner", 2 * LAP_STEPS - 61: "shaking", 2 * LAP_STEPS: ""},
    }
    now = 0
    for step, name in expected.items():
        if step > now:
            school.step(step - now)
        now = step
        frame = school.capture(VIEWS)
        lesson = {"runner": {"runner"}, "shaking": {"shaker"}, "": set()}[name]
        guest = {"guest"} if 120 <= step < 240 else set()
        assert there(frame) == {"shelf"} | lesson | guest, step
        assert seen(frame) == there(frame), step
        assert set(frame.objects.names) == there(frame)
        assert frame.states is not None
        assert len(frame.states) == len(frame.instances)
        for id_, shown in frame.instances.items():
            numbers.setdefault(shown.name, set()).add(id_)
    assert all(len(ids) == 1 for ids in numbers.values())
    with pytest.raises(InvalidState, match="'shaker' is not there now"):
        school.get_object("shaker")
    assert school.lesson is not None
    assert school.lesson.phase == "ended"


def test_each_frame_tells_its_lesson(school: Simulation) -> None:
    told = [school.capture(["depth"]).lesson]
    for _ in range(2 * LAP_STEPS // 60):
        school.step(60)
        told.append(school.capture(["depth"]).lesson)
    names = [(state.lap, state.number, state.name, state.phase) for state in told if state]
    lap = [(1, "runner", "lesson")] * 4 + [(1, "runner", "pause")]
    lap += [(2, "shaking", "lesson")] * 2 + [(2, "shaking", "pause")]
    assert names == [(number, *rest) for number in (1, 2) for rest in lap] + [
        (2, 2, "shaking", "ended")
    ]
    first = told[0]
    assert first == LessonState(
        phase="lesson",
        lap=1,
        laps=2,
        number=1,
        count=2,
        name="runner",
        objects=("runner",),
        begins_ns=0,
        ends_ns=1_000_000_000,
    )
    assert LessonState.from_json(first.to_json()) == first
    assert school.capture(["depth"]).to_dict()["lesson"] == told[-1]


def test_what_comes_has_no_past_and_is_where_it_was(school: Simulation) -> None:
    """Its first frame has no flow; its track is that of the first lap but for rounding of times."""
    tracks = []
    for _ in range(2):
        frame = school.capture(VIEWS)
        id_ = next(id_ for id_, shown in frame.instances.items() if shown.name == "runner")
        assert np.isnan(frame["flow"][frame["instance"] == id_]).all()
        places: list[Any] = []
        for _ in range(12):
            school.step(10)
            places.append(school.get_object("runner").pose.position_m)
        assert np.abs(school.capture(VIEWS)["flow"][frame["instance"] == id_]).max() > 1.0
        tracks.append(places)
        school.step(LAP_STEPS - 120)
    assert np.allclose(tracks[0], tracks[1], rtol=0.0, atol=1e-12)
    assert tracks[0][-1] == pytest.approx((2.0, 0.25, 1.0), abs=1e-6)


def test_runs_are_the_same_bytes(folder: Path) -> None:
    def run() -> list[bytes]:
        with simulation(folder, seed=5) as school:
            frames = []
            for _ in range(12):
                frames.append(b"".join(school.capture(VIEWS)[view].tobytes() for view in VIEWS))
                school.step(40)
            return frames

    assert run() == run()


def test_a_reset_begins_the_lessons_anew(school: Simulation) -> None:
    first = school.capture(VIEWS)
    school.step(300)
    assert "shaker" in there(school.capture(VIEWS))
    school.reset()
    again = school.capture(VIEWS)
    assert there(again) == there(first)
    assert np.array_equal(again["depth"], first["depth"])
    assert again.lesson == first.lesson


def test_lessons_are_begun_and_stopped(school: Simulation) -> None:
    state = school.start_lessons({"sequence": [{"objects": ["shaker", "guest"], "duration": 0.6}]})
    assert (state.name, state.laps, state.lap) == ("shaker, guest", 0, 1)
    school.step(1)
    assert "shaker" in there(school.capture(["instance"]))
    assert "runner" not in there(school.capture(["instance"]))
    school.step(143)
    assert school.get_lesson() == school.lesson
    assert school.lesson is not None
    assert school.lesson.lap == 2
    school.stop_lessons()
    assert school.lesson.phase == "stopped"
    before = there(school.capture(["instance"]))
    school.step(240)
    assert there(school.capture(["instance"])) == before
    with pytest.raises(InvalidState, match="no lessons"):
        school.stop_lessons()
    school.start_lessons()
    assert "shaker" in there(school.capture(["instance"]))


@pytest.mark.parametrize(
    ("lessons", "wrong"),
    [
        ({"sequence": [{"objects": ["shaker"]}]}, "has no end, as 'shaker' moves without end"),
        ({"sequence": [{"objects": ["shelf"]}]}, "takes no time"),
        ({"sequence": []}, "at least 1 entry"),
        ({"sequence": [{"objects": ["nobody"], "duration": 1}]}, "no object 'nobody'"),
        ({"sequence": [{"objects": ["guest"], "duration": 0.3}]}, "appears 0.5 s after"),
        ({"sequence": [{"objects": ["guest"], "duration": float("nan")}]}, "a number above 0"),
        ({"sequence": [{"objects": ["guest", "guest"], "duration": 1}]}, "a second time"),
        ({"sequence": [{"objects": ["guest"]}], "after": "loop"}, "only beside laps"),
        ({"sequence": [{"objects": ["guest"]}], "laps": 0}, "an integer from 1"),
        ({"laps": 3}, "is missing"),
        ("7", "a mapping"),
    ],
)
def test_wrong_lessons_are_refused_and_change_nothing(
    school: Simulation, lessons: Any, wrong: str
) -> None:
    before, state = there(school.capture(["instance"])), school.lesson
    with pytest.raises(InvalidRequest, match=wrong):
        school.start_lessons(lessons)
    assert school.lesson == state
    assert there(school.capture(["instance"])) == before


def test_files_with_wrong_lessons_are_told_by_line(folder: Path) -> None:
    endless = SCHOOL.replace(
        "{name: shaking, objects: [shaker], duration: 0.5}", "{objects: [shaker]}"
    )
    (folder / "endless.yaml").write_text(endless, encoding="utf-8")
    with pytest.raises(SceneError, match=r"endless.yaml:24:.*'shaker' moves without end"):
        simulation(folder, "endless")
    (folder / "backwards.yaml").write_text(
        SCHOOL.replace("leave: 1.0", "leave: 0.5"), encoding="utf-8"
    )
    with pytest.raises(SceneError, match="later than appear"):
        simulation(folder, "backwards")


def test_lessons_of_a_scenario(school: Simulation) -> None:
    scenario = {
        "scene": "optical",
        "objects": [
            {"id": "a", "prefab": "cube", "position": {"x": 1, "z": 1}},
            {"id": "b", "prefab": "sphere", "position": {"x": 1, "z": 1}},
        ],
        "lessons": {
            "laps": 1,
            "after": "loop",
            "sequence": [{"objects": [name], "duration": 0.1} for name in "ab"],
        },
    }
    ids = school.load_scenario(scenario)
    assert there(school.capture(["instance"])) & {"a", "b"} == {"a"}
    school.step(24)
    frame = school.capture(["instance"])
    assert there(frame) & {"a", "b"} == {"b"}
    assert frame.instances[ids[1]].name == "b"
    school.reset()
    assert there(school.capture(["instance"])) & {"a", "b"} == {"a"}
    school.step(48)
    assert school.lesson is not None
    assert (school.lesson.lap, school.lesson.laps) == (2, 1)
    both = {**scenario, "timings": {"type": "all_together"}}
    with pytest.raises(InvalidRequest, match="timings must be left out"):
        school.load_scenario(both)
    scenario["lessons"] = {"sequence": [{"objects": ["a"]}]}
    with pytest.raises(InvalidEntry, match="takes no time"):
        school.load_scenario(scenario)
    assert school.lesson.lap == 2


def test_a_saved_scene_has_its_lessons(school: Simulation, folder: Path) -> None:
    """Saved in the middle of a lesson it holds everybody, as the file had them."""
    school.step(130)
    text = school.scene_text()
    (folder / "saved.yaml").write_text(text, encoding="utf-8")
    with simulation(folder, "saved") as again:
        assert again.lesson is not None
        first, other = again.capture(VIEWS), None
        school.reset()
        other = school.capture(VIEWS)
        assert there(first) == there(other)
        assert np.array_equal(first["depth"], other["depth"])
        again.step(300)
        assert "shaker" in there(again.capture(VIEWS))


def test_objects_of_lessons_are_neither_renamed_nor_removed(school: Simulation) -> None:
    with pytest.raises(InvalidState, match="comes and goes with the lessons"):
        school.despawn_object("runner")
    with pytest.raises(InvalidState, match="comes and goes with the lessons"):
        school.change_object("runner", name="walker")
    school.change_object("runner", colour="#ff0000")
    with pytest.raises(InvalidRequest, match="in use"):
        school.spawn_object("cube", object_name="shaker")


def test_time_that_runs_by_itself_stops_at_the_end(folder: Path) -> None:
    (folder / "short.yaml").write_text(
        SCHOOL.replace("pause: 0.25", "pause: 0").replace("laps: 2", "laps: 1"), encoding="utf-8"
    )
    with simulation(folder, "short", mode="realtime", real_time_factor=10.0) as school:
        until(lambda: school.info.paused, "the lessons to end")
        assert school.sim_time_ns == 1_500_000_000
        assert school.lesson is not None
        assert school.lesson.phase == "ended"
        school.resume()
        until(lambda: school.sim_time_ns > 2_000_000_000, "time to go on")


# -- the plan ----------------------------------------------------------------------------------


def plan(seed: int = 0, **lessons: Any) -> LessonPlan:
    names = [f"o{number}" for number in range(6)]
    objects = {name: ObjectSpec(name=name, asset="cube") for name in names}
    sequence = [{"objects": [name], "duration": 1} for name in names]
    return LessonPlan(LessonsSpec(sequence=sequence, **lessons), objects, seed)


def turns(of: LessonPlan, count: int) -> list[ScheduledLesson]:
    return list(itertools.islice(of.turns(), count))


def test_orders_are_drawn_for_each_lap() -> None:
    def order(of: LessonPlan, laps: int) -> list[tuple[str, ...]]:
        names = [turn.lesson.name for turn in turns(of, 6 * laps)]
        return [tuple(names[6 * lap : 6 * lap + 6]) for lap in range(laps)]

    given = tuple(f"o{number}" for number in range(6))
    assert order(plan(), 3) == [given] * 3
    drawn = order(plan(seed=7, shuffled=True), 4)
    assert all(sorted(lap) == list(given) for lap in drawn)
    assert len(set(drawn)) > 1
    assert drawn == order(plan(seed=7, shuffled=True), 4)
    assert drawn != order(plan(seed=8, shuffled=True), 4)
    looped = order(plan(seed=7, shuffled=True, laps=2, after="loop"), 6)
    assert looped == drawn[:2] * 3


def test_laps_end_loop_or_go_on() -> None:
    assert len(turns(plan(laps=2), 100)) == 12
    assert not any(turn.endless for turn in turns(plan(laps=2), 100))
    on = turns(plan(laps=2, after="go_on"), 100)
    assert [turn.endless for turn in on] == [False] * 11 + [True]
    assert len(turns(plan(laps=2, after="loop"), 100)) == 100
    assert len(turns(plan(), 100)) == 100


def test_varied_laps_have_seeds_of_their_own() -> None:
    varied = plan(seed=3, varied=True)
    seeds = [varied.seed_of(lap, 3) for lap in range(1, 5)]
    assert seeds[0] == 3
    assert len(set(seeds)) == 4
    assert seeds == [plan(seed=3, varied=True).seed_of(lap, 3) for lap in range(1, 5)]
    assert [plan(seed=3).seed_of(lap, 3) for lap in (1, 2)] == [3, 3]


@pytest.mark.parametrize(
    "text", ["", "[]", "7", "{}", '{"lap": 1}', "[" * 100_000, json.dumps({"phase": "lesson"})]
)
def test_a_foreign_text_is_no_lesson(text: str) -> None:
    with pytest.raises(InvalidRequest, match="LessonState"):
        LessonState.from_json(text)
