"""Doors of rooms that open: where their leaves are, what they let pass, how they are saved."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidRequest, SceneError
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.world import World
from tests.support.built_world import corners_of

ROOM = """
version: 1
room:
  size: [6, 4, 2.5]
  openings:
    - {{type: door, wall: south, at: -1.5{outer}}}
  partitions:
    - {{name: inner wall, start: [0.5, -2], end: [0.5, 2], doorways: [{{at: 0.3{inner}}}]}}
objects:
  - {{name: box, asset: cube, static: true, position: [2, 1, 0.5]}}
"""


def room(tmp_path: Path, *, outer: str = "", inner: str = "") -> Path:
    """A room of two, with a door to the outside and a doorway."""
    path = tmp_path / "doors.yaml"
    path.write_text(ROOM.format(outer=outer, inner=inner), encoding="utf-8")
    return path


def world_of(path: Path) -> World:
    """Build the world of a scene file."""
    return SceneLibrary().build(path, 0, 1, lambda: 1)


def corners(world: World, *names: str) -> np.ndarray:
    """Return the sorted corners of all triangles of some objects in the world [m]."""
    points = corners_of(world, *names)
    return points[np.lexsort(points.round(5).T)]


@pytest.mark.parametrize("degrees", [0, 40, 90])
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_hinged_leaf_is_where_a_fixed_one_stands(tmp_path: Path, degrees: int, side: str) -> None:
    """Frame and leaf together are the very triangles of the door in one piece."""
    keys = f", open: {degrees}, hinge: {side}"
    whole = world_of(room(tmp_path, outer=keys))
    halves = world_of(room(tmp_path, outer=f"{keys}, hinged: true"))
    expected, found = corners(whole, "door 1"), corners(halves, "door 1", "door 1 leaf")
    np.testing.assert_allclose(found, expected, atol=2e-5)
    joint = halves.joints()[0]
    assert (joint.name, joint.parent, joint.low) == ("door 1 leaf", "door 1", 0.0)
    assert joint.position == pytest.approx(math.radians(degrees))


def test_leaves_come_after_the_objects(tmp_path: Path) -> None:
    """Ids of walls and objects do not depend on how doors are made."""
    plain = world_of(room(tmp_path)).contents.instances
    doors = world_of(room(tmp_path, outer=", hinged: true", inner=", door: true")).contents
    names = [drawn.instance.name for drawn in doors.instances]
    assert names[: len(plain)] == [drawn.instance.name for drawn in plain]
    assert names[len(plain) :] == ["door 1 leaf", "inner wall door 1 leaf"]
    assert all(drawn.is_baked for drawn in doors.instances)
    assert [d.instance.static for d in doors.instances[-2:]] == [False, False]


def test_a_shut_door_stands_in_the_way(tmp_path: Path) -> None:
    """Between the rooms one walks only through the open door; a ray too."""
    path = room(tmp_path, inner=", door: true")
    with Simulation(path, mode="lockstep") as simulation:
        ends = (-1.5, 0.3, 0.0), (2.0, -0.5, 0.0)
        assert not simulation.free_space().reachable(*ends)
        simulation.set_joint_position("inner wall door 1 leaf", 1.6, seconds=1.0)
        simulation.step(300)
        assert simulation.free_space().reachable(*ends)


def test_doors_swing_clear_of_their_frames(tmp_path: Path) -> None:
    """Pushed lightly they turn up to their limits, on either side and in either wall."""
    keys = ", open: 1, hinge: {}"
    for side in ("left", "right"):
        path = room(
            tmp_path,
            outer=f"{keys.format(side)}, hinged: true",
            inner=f", door: true{keys.format(side)}",
        )
        with Simulation(path, mode="lockstep") as simulation:
            for joint in simulation.get_joints():
                simulation.set_joint_position(joint.name, joint.high, seconds=2.0)
            simulation.step(490)
            for joint in simulation.get_joints():
                assert joint.position == joint.high == pytest.approx(math.radians(115))
                simulation.set_joint_position(joint.name, 0.0, seconds=2.0)
            simulation.step(490)
            assert [joint.position for joint in simulation.get_joints()] == [0.0, 0.0]


def test_saved_rooms_keep_doors_open(tmp_path: Path) -> None:
    """As they are, to rounding of degrees."""
    path = room(tmp_path, outer=", hinged: true", inner=", door: true")
    with Simulation(path, mode="lockstep") as simulation:
        simulation.set_joint_position("door 1 leaf", 0.7)
        simulation.set_joint_position("inner wall door 1 leaf", 1.1)
        saved = tmp_path / "saved.yaml"
        saved.write_text(simulation.scene_text(), encoding="utf-8")
    with Simulation(saved, mode="lockstep") as again:
        positions = [joint.position for joint in again.get_joints()]
        np.testing.assert_allclose(positions, [0.7, 1.1], rtol=1e-15)


def test_a_leaf_is_painted_with_its_door(tmp_path: Path) -> None:
    """Frame and leaf have one colour, which is saved; the leaf stays open."""
    with Simulation(room(tmp_path, outer=", hinged: true"), mode="lockstep") as simulation:
        simulation.set_joint_position("door 1 leaf", 0.5)
        simulation.set_material("door 1", colour="#ff0000")
        leaf = next(i.id for i in simulation.info.instances if i.name == "door 1 leaf")
        cast = simulation.cast_rays([(-1.5, 0.0, 1.9)], [(0.0, -1.0, 0.0)])
        assert cast.instance_ids.tolist() == [leaf]
        assert [joint.position for joint in simulation.get_joints()] == [0.5]
        assert "colour: '#ff0000'" in simulation.scene_text()
        with pytest.raises(InvalidRequest, match="with which goes its leaf"):
            simulation.set_material("door 1 leaf", colour="#00ff00")


def test_what_means_nothing_is_refused(tmp_path: Path) -> None:
    """`open` of a doorway without a door; an object by the name of a leaf; moving a leaf."""
    with pytest.raises(SceneError, match="only beside door"):
        load_scene(room(tmp_path, inner=", open: 30"))
    path = room(tmp_path, outer=", hinged: true")
    path.write_text(path.read_text().replace("name: box", "name: door 1 leaf"))
    with pytest.raises(SceneError, match="part of the room"):
        load_scene(path)
    with Simulation(room(tmp_path, outer=", hinged: true"), mode="lockstep") as simulation:
        with pytest.raises(InvalidRequest, match="set_joint_position"):
            simulation.move_object("door 1 leaf", (0, 0, 0))
        with pytest.raises(InvalidRequest, match="carries 'door 1 leaf'"):
            simulation.despawn_object("door 1")
