"""Joints through the simulation: scene files, calls, flow, saved scenes, resets, refusals."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidRequest, SceneError, UnknownName
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.types.geometry import Pose
from tests.support.plain_doors import SCENE


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A cabinet with a door, a knob on it, and a drawer."""
    path = tmp_path / "joints.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.fixture
def simulation(scene: Path) -> Iterator[Simulation]:
    """That scene in lockstep."""
    with Simulation(scene, mode="lockstep") as simulation:
        yield simulation


def positions(simulation: Simulation) -> dict[str, float]:
    """Positions of all joints by name."""
    return {joint.name: joint.position for joint in simulation.get_joints()}


def test_joints_are_listed_and_their_objects_know_who_carries_them(
    simulation: Simulation,
) -> None:
    """Names, types, limits, parents; `fixed` is no joint that moves."""
    door, drawer = simulation.get_joints()
    assert (door.name, door.type, door.parent) == ("door", "hinge", "cabinet")
    assert (door.low, door.high, door.position) == (0.0, 1.5, 0.0)
    assert (drawer.name, drawer.type, drawer.high) == ("drawer", "slide", 0.4)
    parents = {i.name: i.parent for i in simulation.info.instances}
    assert parents == {"cabinet": 0, "door": 1, "knob": 2, "drawer": 1}
    assert not any(i.static for i in simulation.info.instances if i.name != "cabinet")


def test_an_opened_drawer_is_where_arithmetic_says(simulation: Simulation) -> None:
    """The cabinet is turned by 90°: its drawer, drawn along its -x, moves along the world's -y."""
    before = np.asarray(simulation.get_object("drawer").pose.position_m)
    simulation.set_joint_position("drawer", 0.25)
    now = np.asarray(simulation.get_object("drawer").pose.position_m)
    np.testing.assert_allclose(now - before, (0.0, -0.25, 0.0), atol=1e-14)
    assert positions(simulation)["drawer"] == 0.25


def test_flow_of_a_door_is_the_motion_of_its_points(simulation: Simulation) -> None:
    """At every pixel of door and knob: a point of its surface, before and now, through the lens."""
    views = ["depth", "instance", "flow", "flow_valid"]
    simulation.set_joint_position("door", 0.3)
    simulation.capture(views=views)
    old = simulation.get_object("door").pose.matrix()
    simulation.step(8)
    simulation.set_joint_position("door", 0.35)
    frame = simulation.capture(views=views)
    new = simulation.get_object("door").pose.matrix()
    ids = [i.id for i in simulation.info.instances if i.name in ("door", "knob")]
    v, u = np.nonzero(np.isin(frame["instance"], ids))
    assert len(v) > 1000
    lens, world_from_camera = frame.camera.intrinsics, frame.camera.world_from_camera
    points = np.ones((4, len(v)))
    points[:3] = lens.unproject(frame["depth"])[v, u].T
    was = np.linalg.inv(world_from_camera) @ old @ np.linalg.inv(new) @ world_from_camera @ points
    expected = np.stack([u, v], axis=1) - lens.project(was[:3].T)
    np.testing.assert_allclose(frame["flow"][v, u] * (8 / 240), expected, atol=1e-3)
    assert frame["flow_valid"][v, u].all()
    assert np.abs(expected).max() > 3.0


def test_a_motion_takes_its_time_and_reset_undoes_it(simulation: Simulation) -> None:
    """Opened over a second of simulated time; a reset closes it."""
    simulation.set_joint_position("door", 1.0, seconds=1.0)
    simulation.step(120)
    assert positions(simulation)["door"] == pytest.approx(0.5, abs=0.01)
    simulation.step(130)
    assert positions(simulation)["door"] == 1.0
    simulation.reset()
    assert positions(simulation) == {"door": 0.0, "drawer": 0.0}


def test_saved_scenes_keep_positions(simulation: Simulation, tmp_path: Path) -> None:
    """To the bit, also of a door in motion, of a cabinet that was moved, and saved once more."""
    simulation.set_joint_position("drawer", 0.123456789)
    simulation.set_joint_position("door", 0.9, seconds=1.0)
    simulation.move_object("cabinet", (1.5, 0.25, 0.5), (0, 0, 45))
    simulation.step(100)
    saved = tmp_path / "saved.yaml"
    saved.write_text(simulation.scene_text(), encoding="utf-8")
    joints = simulation.get_joints()
    poses = {i.name: simulation.get_object(i.id).pose for i in simulation.info.instances}
    with Simulation(saved, mode="lockstep") as again:
        assert again.get_joints() == joints
        for name, pose in poses.items():
            np.testing.assert_allclose(
                again.get_object(name).pose.matrix(), pose.matrix(), atol=1e-6
            )
        assert again.scene_text() == simulation.scene_text()


def test_refused_requests_change_nothing(simulation: Simulation) -> None:
    """Unknown joint, beyond limits, no number."""
    with pytest.raises(UnknownName, match="dor"):
        simulation.set_joint_position("dor", 0.1)
    for wrong in (1.51, -0.1, math.nan):
        with pytest.raises(InvalidRequest):
            simulation.set_joint_position("door", wrong)
    for wrong_time in (-1.0, math.inf):
        with pytest.raises(InvalidRequest, match="seconds"):
            simulation.set_joint_position("door", 0.1, seconds=wrong_time)
    with pytest.raises(InvalidRequest, match="carries 'door'"):
        simulation.change_object("cabinet", static=False)
    with pytest.raises(InvalidRequest, match="carries 'door'"):
        simulation.change_object("cabinet", name="box")
    simulation.step(10)
    assert positions(simulation) == {"door": 0.0, "drawer": 0.0}


def test_a_joint_survives_changes_of_what_moves(simulation: Simulation) -> None:
    """Another colour of door and cabinet leaves the door where it is."""
    simulation.set_joint_position("door", 0.7)
    before = simulation.get_object("door").pose
    simulation.change_object("door", colour=(1.0, 0.0, 0.0))
    simulation.change_object("cabinet", colour=(0.0, 1.0, 0.0))
    simulation.step(5)
    assert simulation.get_object("door").pose == before
    assert positions(simulation)["door"] == 0.7


def test_a_drawer_taken_out_comes_back_as_it_was(simulation: Simulation) -> None:
    """As the window's undo does."""
    run = EditOperations.object_record, EditOperations.restore_object
    simulation.set_joint_position("drawer", 0.2)
    record = run[0](simulation, "drawer")
    pose = simulation.get_object("drawer").pose
    simulation.despawn_object("drawer")
    assert "drawer" not in positions(simulation)
    run[1](simulation, None, record)
    assert positions(simulation)["drawer"] == 0.2
    assert simulation.get_object("drawer").pose == pose


def test_lockstep_runs_are_equal_byte_for_byte(scene: Path) -> None:
    """Pictures and truth of a door that is opened and one that is shut."""

    def run() -> list[bytes]:
        with Simulation(scene, mode="lockstep", seed=3) as simulation:
            simulation.set_joint_position("door", 1.0, seconds=0.5)
            frames = []
            for _ in range(3):
                simulation.step(40)
                frame = simulation.capture(views=["rgb", "depth", "instance", "flow"])
                frames += [frame[name].tobytes() for name in ("rgb", "depth", "instance", "flow")]
            return frames

    assert run() == run()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"limits": [1.0, 0.5]}, "low below high"),
        ({"limits": [0.0, float("nan")]}, "limits"),
        ({"limits": [0.0, 1.0], "position": 2.0}, "within the limits, from 0 to 1"),
        ({"axis": [0, 0, 0]}, "not all 0"),
        ({"type": "ball"}, "hinge, slide, fixed|hinge"),
        ({"parent": "wardrobe"}, "no object 'wardrobe'"),
        ({"parent": "knob"}, "this one carries"),
        ({"parent": "door"}, "this one carries"),
        ({"parent": "loose"}, "moves freely"),
        ({"friction": -1.0}, "friction|0"),
        ({"type": "fixed", "limits": [0, 1]}, "hinge or a slide"),
    ],
)
def test_malformed_joints_are_refused(
    tmp_path: Path, change: dict[str, Any], sentence: str
) -> None:
    """Each with a sentence that names the place."""
    data = yaml.safe_load(SCENE)
    data["objects"].append({"name": "loose", "asset": "cube"})
    data["objects"][1]["joint"].update(change)
    path = tmp_path / "broken.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    with pytest.raises(SceneError, match=sentence):
        Simulation(path, mode="lockstep").close()


@pytest.mark.parametrize("key", ["static", "velocity", "behaviours"])
def test_what_cannot_stand_beside_joints_is_refused(tmp_path: Path, key: str) -> None:
    """static, velocities; open_and_close where there is no joint."""
    data = yaml.safe_load(SCENE)
    if key == "behaviours":
        data["objects"].append(
            {"name": "loose", "asset": "cube", "behaviours": [{"type": "open_and_close"}]}
        )
    else:
        data["objects"][1][key] = True if key == "static" else [1, 0, 0]
    path = tmp_path / "broken.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    with pytest.raises(SceneError, match="joint"):
        Simulation(path, mode="lockstep").close()


def test_free_space_is_that_of_the_open_door(tmp_path: Path) -> None:
    """A gap of 1 m in a wall lets a body pass while the door in it is open."""

    def slab(name: str, position: list[float], scale: list[float]) -> dict[str, Any]:
        return {
            "name": name, "asset": "cube", "static": True, "position": position, "scale": scale
        }  # fmt: skip

    data = {
        "version": 1,
        "objects": [
            slab("floor", [0, 0, -0.5], [8, 8, 1]),
            slab("left", [-2.25, 0, 1], [3.5, 0.1, 2]),
            slab("right", [2.25, 0, 1], [3.5, 0.1, 2]),
            {
                "name": "door",
                "asset": "cube",
                "position": [0, 0, 1],
                "scale": [0.98, 0.05, 1.98],
                "joint": {"type": "hinge", "origin": [-0.49, 0, 0], "limits": [0, 1.57]},
            },
        ],
    }
    path = tmp_path / "gap.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    with Simulation(path, mode="lockstep") as simulation:
        ends = (0.0, -2.0, 0.0), (0.0, 2.0, 0.0)
        assert not simulation.free_space(radius_m=0.2).reachable(*ends)
        simulation.set_joint_position("door", 1.57)
        assert simulation.free_space(radius_m=0.2).reachable(*ends)


def test_poses_in_files_count_from_the_parent(simulation: Simulation) -> None:
    """A door at [0.6, 0, 0] of a cabinet at [2, 0, 0.5] that is turned by 90°."""
    pose = simulation.get_object("door").pose
    np.testing.assert_allclose(
        pose.matrix(), Pose.from_rpy_deg((2.0, 0.6, 0.5), (0, 0, 90)).matrix(), atol=1e-15
    )
