"""Scenes drawn at random in a running simulation: the same again, frame by frame, byte by byte."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidEntry, InvalidRequest, InvalidState, SceneError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose

VIEWS = ["rgb", "depth", "instance", "albedo"]
DEN = """
version: 1
room: {size: [4, 4, 3]}
lights: [{name: lamp, type: point, position: [0, 0, 2.5], intensity: 1}]
objects:
  - {name: desk, asset: cube, wall: north, scale: [1, 0.6, 0.7], static: true}
  - {name: cup, asset: cube, on: desk, scale: 0.1, static: true}
  - {name: crate, asset: cube, position: [1, -1, 0.2], scale: 0.4, static: true}
  - {name: ball, asset: sphere, position: [0, -0.5, 2], scale: 0.3, restitution: 0.8}
agents:
  - {name: eye, width: 96, height: 72, rate: 0, following: false, position: [-1.8, -1.8, 1.5],
     rotation: [0, 20, 45]}
randomise:
  - {name: layout, type: object, of: desk, offset: {uniform: [[-1, 0, 0], [1, 0, 0]]}}
  - {name: kind, type: object, of: crate, asset: {choice: [sphere, cylinder, cone]}}
  - {name: walls, type: material, of: "* wall", colour: {uniform: ["#202020", "#f0f0f0"]}}
  - {name: floor, type: material, of: floor, material: {choice: [carpet, white_tiles, concrete]}}
  - {name: lamp, type: light, of: lamp, every: frame, intensity: {log_uniform: [0.3, 3]},
     offset: {uniform: [[-1, -1, -0.5], [1, 1, 0]]}}
  - {name: look, type: camera, of: eye, every: frame, position: [-1.7, -1.7, 1.4],
     look_at: {uniform: [[-0.5, -0.5, 0], [0.5, 0.5, 1]]}, exposure: {normal: [0, 0.5]}}
  - {name: junk, type: distractors, assets: [cube, cone], count: {uniform: [1, 3]},
     within: [[-1, -1, 1], [1, 1, 2]], scale: {uniform: [0.05, 0.2]}}
  - {name: sky, type: environment, every: frame, exposure: {normal: [0, 0.3]},
     sky_zenith: {uniform: ["#203050", "#a0c0f0"]}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes")
    (folder / "den.yaml").write_text(DEN, encoding="utf-8")
    plain = DEN[: DEN.index("randomise:")]
    (folder / "plain.yaml").write_text(plain, encoding="utf-8")
    return folder


def simulation(folder: Path, scene: str = "den", seed: int = 3) -> Simulation:
    return Simulation(scene, mode="lockstep", seed=seed, scene_paths=[folder], backend="native")


@pytest.fixture
def den(folder: Path) -> Iterator[Simulation]:
    with simulation(folder) as made:
        yield made


def capture(of: Simulation) -> Frame:
    return of.capture(VIEWS, agent="eye")


def same(one: Frame, other: Frame) -> bool:
    return all(np.array_equal(one[view], other[view], equal_nan=True) for view in VIEWS)


def test_frames_are_made_again_from_their_records(den: Simulation, folder: Path) -> None:
    frames = [capture(den)]
    den.randomise()
    frames.append(capture(den))
    for steps in (7, 40):
        den.step(steps)
        frames.append(capture(den))
    assert not same(frames[1], frames[2])
    with simulation(folder, seed=77) as other:
        for frame in frames[::-1]:
            record = json.loads(json.dumps(frame.randomised))
            other.randomise(record=record)
            if record["step"]:
                other.step(record["step"])
            again = capture(other)
            assert same(frame, again)
            assert again.randomised == frame.randomised


def test_record_holds_also_if_the_scene_draws_otherwise_now(den: Simulation, folder: Path) -> None:
    den.randomise(seed=8)
    den.step(5)
    frame = capture(den)
    with simulation(folder, "plain") as other:
        other.randomise(record=frame.randomised)
        other.step(5)
        assert same(frame, capture(other))


RULED = """
randomise:
  - {name: yard, type: object, of: crate, offset: {uniform: [[-0.5, -0.5, 0], [0.5, 0.5, 0]]}}
  - {name: look, type: camera, of: eye, every: EVERY, rule: RULE, settings: {SETTINGS}}
"""
RULES = {
    "room_view": "objects: 1, nearest_m: 0.3, height_m: [0.8, 1.2]",
    "free_view": "objects: 1, nearest_m: 0.3, height_m: [0.8, 1.2]",
    "coverage": "height_m: [0.8, 1.2], attempts: 20, visible: 0.1, nearest_m: 0.3",
    "object_view": "objects: [crate]",
}


def ruled(rule: str, every: str) -> str:
    plain = DEN[: DEN.index("randomise:")]
    drawn = RULED.replace("RULE", rule).replace("EVERY", every)
    return plain + drawn.replace("SETTINGS", RULES[rule])


@pytest.mark.parametrize("every", ["epoch", "frame"])
@pytest.mark.parametrize("rule", sorted(RULES))
def test_rules_place_cameras_and_the_record_keeps_the_place(
    tmp_path: Path, folder: Path, rule: str, every: str
) -> None:
    """A frame is made again from its record where no rule is; another epoch stands elsewhere."""
    (tmp_path / "ruled.yaml").write_text(ruled(rule, every), encoding="utf-8")
    with simulation(tmp_path, "ruled") as made:
        first = capture(made)
        made.randomise()
        second = capture(made)
        poses = [frame.camera.pose for frame in (first, second)]
        assert poses[0] != poses[1]
        if rule == "object_view":
            crate = next(i.id for i in made.info.instances if i.name == "crate")
            for frame in (first, second):
                assert 0.02 <= float((frame["instance"] == crate).mean()) <= 0.6
        else:
            assert all(0.8 <= pose.position_m[2] <= 1.2 for pose in poses)
    record = json.loads(json.dumps(second.randomised))
    assert set(record[every]["agents"]["eye"]) == {"position", "rotation"}
    with simulation(folder, "plain") as other:
        other.randomise(record=record)
        assert same(second, capture(other))


def test_a_rule_that_is_none_is_told_with_its_place(tmp_path: Path) -> None:
    """Names and settings of rules are checked with the file."""
    text = ruled("room_view", "epoch").replace("rule: room_view", "rule: room_vue")
    (tmp_path / "vue.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match="did you mean 'room_view'"):
        simulation(tmp_path, "vue")
    text = ruled("room_view", "epoch").replace("objects: 1", "objekts: 1")
    (tmp_path / "set.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match="is not a setting of room_view"):
        simulation(tmp_path, "set")
    text = ruled("room_view", "epoch").replace("rule:", "position: [0, 0, 1], rule:")
    (tmp_path / "both.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match="rule"):
        simulation(tmp_path, "both")


def test_seed_and_index_decide(den: Simulation) -> None:
    first = den.randomise(seed=5)
    second = den.randomise()
    assert (first["index"], second["index"]) == (0, 1)
    assert first["epoch"] != second["epoch"]
    assert den.randomise(seed=5, index=1) == second
    assert den.randomise(5) == den.randomise(5, index=0)


def test_reset_brings_the_same_back_and_another_seed_draws_anew(den: Simulation) -> None:
    den.randomise()
    frame = capture(den)
    den.reset()
    assert same(frame, capture(den))
    den.reset(seed=1234)
    other = capture(den)
    assert other.randomised is not None
    assert other.randomised["index"] == 0
    assert not same(frame, other)


def test_two_frames_of_one_instant_are_drawn_once(den: Simulation) -> None:
    one, two = capture(den), capture(den)
    assert one.randomised == two.randomised
    assert same(one, two)


def test_what_stands_on_something_goes_with_it(den: Simulation) -> None:
    for _ in range(3):
        record = den.randomise()
        offset = record["epoch"]["objects"]["desk"]["offset"]
        desk, cup = den.get_object("desk").pose, den.get_object("cup").pose
        assert abs(offset[0]) > 1e-6
        np.testing.assert_allclose(desk.position_m[0], offset[0], atol=1e-9)
        np.testing.assert_allclose(cup.position_m[:2], desk.position_m[:2], atol=1e-6)


def test_objects_of_the_epoch_are_there(den: Simulation) -> None:
    record = den.randomise()
    added = record["epoch"]["added"]
    names = {instance.name: instance for instance in den.info.instances}
    assert 1 <= len(added) <= 3
    assert all(entry["name"] in names for entry in added)
    assert names["crate"].asset == record["epoch"]["objects"]["crate"]["asset"]
    painted = json.loads(names["floor"].painted)
    assert painted[0]["material"] == record["epoch"]["materials"]["floor"]["all"]["material"]


def test_absent_object_takes_along_what_stands_on_it(folder: Path) -> None:
    with simulation(folder, "plain") as plain:
        plain.randomise(things=[{"name": "x", "type": "object", "of": "desk", "there": False}])
        names = {instance.name for instance in plain.info.instances}
        assert not names & {"desk", "cup"}
        assert "crate" in names


def test_physics_is_not_touched_by_what_is_drawn_for_frames(folder: Path) -> None:
    poses = []
    for frames in (0, 5):
        with simulation(folder) as made:
            made.randomise(seed=9)
            for _ in range(max(frames, 1)):
                made.step(60 // max(frames, 1))
                if frames:
                    capture(made)
            poses.append(made.get_object("ball").pose)
    assert poses[0] == poses[1]


def test_things_of_a_call_take_the_place_of_the_scenes(folder: Path) -> None:
    with simulation(folder, "plain") as plain:
        with pytest.raises(InvalidState):
            plain.randomise()
        text = "[{name: l, type: light, of: lamp, intensity: {uniform: [1, 2]}}]"
        record = plain.randomise(seed=1, things=text)
        assert list(record["epoch"]) == ["lights"]
        assert plain.get_light("lamp").intensity == record["epoch"]["lights"]["lamp"]["intensity"]
        assert plain.randomise()["epoch"] != record["epoch"]
        plain.change_scene("plain")
        with pytest.raises(InvalidState):
            plain.randomise()


@pytest.mark.parametrize(
    "given",
    [
        {"things": [{"name": "x", "type": "light", "of": "sun", "intensity": 1}]},
        {"things": [{"name": "x", "type": "light", "of": "lamp", "intensity": {"uniform": 1}}]},
        {"things": 3},
        {"things": "[{"},
        {"record": {}},
        {"record": "no json"},
        {"record": "[" * 2000},
        {"record": {"seed": -1, "index": 0, "step": 0, "epoch": {}, "frame": {}}},
        {"seed": -1},
        {"index": 1.5},
    ],
)
def test_refusal_changes_nothing(den: Simulation, given: dict[str, Any]) -> None:
    epoch, frame = den.info.epoch, capture(den)
    with pytest.raises((InvalidRequest, InvalidEntry)):
        den.randomise(**given)
    assert den.info.epoch == epoch
    assert same(frame, capture(den))


def test_what_cannot_be_placed_leaves_the_world(den: Simulation) -> None:
    epoch, frame = den.info.epoch, capture(den)
    record = dict(frame.randomised or {})
    record["epoch"] = {"added": [{"name": "x", "asset": "marzipan", "position": [0, 0, 0],
                                  "orientation": [0, 0, 0, 1]}]}  # fmt: skip
    with pytest.raises(InvalidRequest):
        den.randomise(record=record)
    assert den.info.epoch == epoch
    assert same(frame, capture(den))


def test_saved_scene_is_what_was_drawn_and_draws_no_more(den: Simulation, folder: Path) -> None:
    den.randomise(seed=21)
    den.save_scene("kept", overwrite=True)
    saved = (folder / "kept.yaml").read_text(encoding="utf-8")
    assert "randomise" not in saved
    drawn = {i.name: (i.asset, i.painted) for i in den.info.instances}
    with simulation(folder, "kept") as kept:
        assert {i.name: (i.asset, i.painted) for i in kept.info.instances} == drawn


def test_cameras_of_programs_are_drawn_too(folder: Path) -> None:
    thing = {
        "name": "eyes",
        "type": "camera",
        "position": {"uniform": [[-1, -1, 1], [1, 1, 2]]},
        "look_at": [0, 0, 0],
        "vertical_fov": {"uniform": [30, 90]},
    }
    with simulation(folder, "plain") as plain:
        lens = CameraIntrinsics(width=32, height=24)
        plain.register_agent(AgentSpec(name="mine", following=False, intrinsics=lens))
        plain.set_pose(Pose((0.0, 0.0, 1.0)), agent="mine")
        record = plain.randomise(things=[thing])
        for name in ("mine", "eye"):
            place = record["epoch"]["agents"][name]["position"]
            np.testing.assert_allclose(plain.get_pose(agent=name).position_m, place, atol=1e-12)


RELATIVE = [
    {"name": "stops", "type": "environment", "every": "frame",
     "exposure": {"add": {"uniform": [-0.5, 0.5]}}},
    {"name": "lamp", "type": "light", "of": "lamp", "every": "frame",
     "intensity": {"times": {"log_uniform": [0.5, 2]}}},
    {"name": "eye", "type": "camera", "of": "eye", "every": "frame", "exposure": {"add": 0.25}},
    {"name": "size", "type": "object", "of": "desk", "scale": {"times": 0.5}},
]  # fmt: skip


def test_relative_values_start_from_the_files_own_in_every_frame(den: Simulation) -> None:
    """They do not pile up from frame to frame, and the record alone makes a frame again."""
    den.randomise(seed=4, things=RELATIVE)
    desk = den.get_object("desk")
    assert desk.scale == (0.5, 0.3, 0.35)
    frames = []
    for _ in range(4):
        den.step(3)
        frames.append(capture(den))
        record = frames[-1].randomised
        assert record is not None
        drawn, amounts = record["frame"], record["frame"]["relative"]
        stops = amounts["environment"]["exposure"]["add"]
        assert drawn["environment"]["exposure"] == stops  # the scene's own is 0
        factor = amounts["lights"]["lamp"]["intensity"]["times"]
        assert drawn["lights"]["lamp"]["intensity"] == factor  # the scene's own is 1
        assert drawn["agents"]["eye"]["exposure"] == 0.25
    assert len({frame.randomised["frame"]["environment"]["exposure"] for frame in frames}) == 4  # type: ignore[index]
    record = json.loads(json.dumps(frames[2].randomised))
    den.randomise(record=record)
    den.step(record["step"])
    assert same(frames[2], capture(den))


MOVING = [
    {"name": "toy", "type": "spawn", "assets": ["sphere", "cone"], "count": {"uniform": [2, 4]},
     "scale": {"uniform": [0.1, 0.2]}, "height": {"uniform": [0, 0.5]}},
    {"name": "kite", "type": "spawn", "assets": ["cube"], "within": [[-1, -1, 1.5], [1, 1, 2]],
     "gravity": False, "scale": 0.2, "velocity": [0.1, 0, 0],
     "behaviours": [{"type": "rotate_rigidbody", "angular_velocity": [0, 0, 90]}]},
    {"name": "stir", "type": "behaviour", "of": ["crate", "ball"], "choose": "one",
     "behaviours": [{"type": "rotate_rigidbody", "angular_velocity": [0, 0, 45]},
                    {"type": "rotate_rigidbody", "angular_velocity": [0, 0, -45]}]},
]  # fmt: skip


def test_spawned_objects_stand_free_and_move(den: Simulation) -> None:
    """Each has a place of its own; what was static in the file turns, too."""
    record = den.randomise(seed=6, things=MOVING)
    toys = [one for one in record["epoch"]["added"] if one["name"].startswith("toy")]
    assert 2 <= len(toys) <= 4
    for number, one in enumerate(toys):
        for other in toys[:number]:
            apart = np.linalg.norm(np.subtract(one["position"][:2], other["position"][:2]))
            assert apart > 0.5 * (one["scale"] + other["scale"])
    assert set(record["epoch"]["behaviours"]) == {"crate", "ball"}
    crate = den.get_object("crate").pose.rpy_deg[2]
    first = capture(den)
    den.step(60)
    kite = den.get_object("kite 1")
    turned = (kite.pose.rpy_deg[2] - record["epoch"]["added"][-1]["rotation"][2]) % 360.0
    assert abs(turned - 22.5) < 1.0
    assert 5.0 < abs(den.get_object("crate").pose.rpy_deg[2] - crate) < 12.0  # rubs on the floor
    assert not same(first, capture(den))


def test_what_moves_is_made_again_from_the_record(den: Simulation, folder: Path) -> None:
    """The record has the places that were found; nothing is looked for again."""
    den.randomise(seed=9, things=MOVING)
    den.step(30)
    frame = capture(den)
    assert frame.randomised is not None
    assert not any("floor" in one for one in frame.randomised["epoch"]["added"])
    with simulation(folder, "plain", seed=1) as other:
        other.randomise(record=json.loads(json.dumps(frame.randomised)))
        other.step(30)
        assert same(frame, capture(other))


def test_an_object_for_which_there_is_no_floor_is_left_out(den: Simulation) -> None:
    thing = {"name": "hall", "type": "spawn", "assets": ["cube"], "scale": 6}
    record = den.randomise(seed=9, things=[thing])
    assert record["epoch"] == {"added": [], "left_out": ["hall 1"]}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"behaviours": [{"type": "dance"}]}, "dance"),
        ({"behaviours": [{"type": "rotate_rigidbody", "angle": 3}]}, "angle"),
        ({"assets": ["cuube"]}, "cuube"),
        ({"within": [[0, 0, 1], [0, 0, 0]]}, "lowest corner"),
        ({"within": [[0, 0, 0], [0, 0, 1]], "height": 1}, "height"),
        ({"every": "frame"}, "every"),
    ],
)
def test_spawns_that_are_none_are_told(den: Simulation, change: dict[str, Any], told: str) -> None:
    with pytest.raises(InvalidEntry, match=told):
        den.randomise(things=[{**MOVING[0], **change}])


def test_what_comes_later_moves_as_it_was_drawn(tmp_path: Path) -> None:
    """An object that appears after the beginning gets its behaviours when it comes."""
    plain = DEN[: DEN.index("randomise:")].replace(
        "{name: ball, asset: sphere,", "{name: ball, asset: sphere, appear: 0.1, gravity: false,"
    )
    (tmp_path / "late.yaml").write_text(plain, encoding="utf-8")
    spin = {"type": "rotate_rigidbody", "angular_velocity": [0, 0, 90]}
    thing = {"name": "spin", "type": "behaviour", "of": {"category": "sphere"}}
    with simulation(tmp_path, "late") as made:
        record = made.randomise(things=[{**thing, "behaviours": [spin]}])
        assert record["epoch"] == {"behaviours": {"ball": [spin]}}
        made.step(144)  # 0.6 s, of which it is there 0.5 s
        assert abs(made.get_object("ball").pose.rpy_deg[2] - 45.0) < 1.0
