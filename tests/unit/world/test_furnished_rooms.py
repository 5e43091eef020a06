"""The furnished rooms hold together: nothing overlaps, all rests, the mover's way is free."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sailenv_content.standard.pack_build import build_standard_pack
from sailenv_ros.errors import AssetError, SceneError
from sailenv_ros.simulation.first_scene import default_scene
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.physics_check import obstructions, overlaps, shifts
from sailenv_ros.world.world import World

ROOMS = {
    "room_01": {"laptop", "bed", "desk", "chair", "pen", "notebook"},
    "room_02": {"chair", "couch", "dining table", "painting", "airplane", "fork", "spoon"},
    "room_03": {"toilet", "bathtub", "cleaning bottle", "towel", "sink"},
}


@pytest.fixture(scope="module", autouse=True)
def furniture() -> None:
    build_standard_pack()


@pytest.fixture(scope="module")
def library() -> SceneLibrary:
    return SceneLibrary()


def built(library: SceneLibrary, scene: str | Path) -> World:
    return library.build(scene)


@pytest.fixture(params=ROOMS)
def room(request: pytest.FixtureRequest, library: SceneLibrary) -> Iterator[World]:
    world = built(library, request.param)
    yield world
    world.close()


def test_rooms_hold_what_they_are_known_for(room: World) -> None:
    """The categories that SAILenv's rooms have are there."""
    categories = {i.instance.category for i in room.contents.instances}
    assert categories >= ROOMS[room.scene] | {"wall", "floor", "ceiling", "window", "door"}


def test_nothing_overlaps(room: World) -> None:
    """No two objects stand in one another by more than 2 mm, at the start and after 2 s."""
    assert list(overlaps(room)) == []
    room.step(480)
    assert list(overlaps(room)) == []


def test_everything_rests(room: World) -> None:
    """Within 2 s nothing slides by 2 cm or turns by 5°, and then all poses stay the very same."""
    assert list(shifts(room)) == []
    room.step(720)
    still = [b for b in room.bodies if not b.placement.behaviours]
    before = [body.world_from_body() for body in still]
    room.step(480)
    for body, pose in zip(still, before, strict=True):
        np.testing.assert_array_equal(body.world_from_body(), pose, err_msg=body.placement.name)


def test_the_movers_way_is_free(room: World) -> None:
    """The track keeps 15 cm away from all that collides."""
    assert list(obstructions(room)) == []


def test_waking_up_what_rests(library: SceneLibrary) -> None:
    """A body that sleeps moves again when it is put elsewhere or pushed away."""
    world = built(library, "room_01")
    try:
        world.step(1200)
        ball = next(
            i.instance.id for i in world.contents.instances if i.instance.name == "football"
        )
        world.put_body(ball, Pose((0.9, -1.4, 1.2)))
        world.step(120)
        assert world.body(ball).pose().position_m[2] < 0.6
    finally:
        world.close()


def test_the_default_scene_needs_the_furniture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """With furniture one begins in the bedroom; without, in a scene that needs none."""
    assert default_scene() == "room_01"
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    assert default_scene() == "optical"
    assert "sailenv assets build" in caplog.text
    with pytest.raises(AssetError, match="sailenv assets build"):
        SceneLibrary().load("room_01")
    assert SceneLibrary().load("optical").name == "optical"


def scene(tmp_path: Path, objects: str, room: str = "room: {size: [4, 3, 2.5]}") -> Path:
    path = tmp_path / "test.yaml"
    path.write_text(f"version: 1\n{room}\nobjects:\n{objects}\n")
    return path


def pose_of(world: World, name: str) -> Pose:
    return next(b.pose() for b in world.bodies if b.placement.name == name)


def test_on_counts_from_the_carrier(tmp_path: Path, library: SceneLibrary) -> None:
    """An object upon a turned and scaled box lies 1 mm above it, at the place in its axes."""
    path = scene(
        tmp_path,
        "  - {name: top, asset: cube, on: base, position: [0.1, 0.2, 0.05], scale: 0.2}\n"
        "  - {name: base, asset: cube, position: [0.5, 0, 0.4], rotation: [0, 0, 90], scale: 0.8,"
        " static: true}",
    )
    world = built(library, path)
    try:
        assert pose_of(world, "top").position_m == pytest.approx((0.3, 0.1, 0.8 + 0.1 + 0.051))
    finally:
        world.close()


@pytest.mark.parametrize(
    ("wall", "position", "yaw"),
    [
        ("north", (0.5, 1.5 - 0.2 - 0.004 - 0.015, 0.401), -90.0),
        ("east", (2.0 - 0.2 - 0.004 - 0.015, 0.5, 0.401), 180.0),
        ("south", (0.5, -1.5 + 0.2 + 0.004 + 0.015, 0.401), 90.0),
        ("west", (-2.0 + 0.2 + 0.004 + 0.015, 0.5, 0.401), 0.0),
    ],
)
def test_at_a_wall_the_front_looks_into_the_room(
    tmp_path: Path,
    library: SceneLibrary,
    wall: str,
    position: tuple[float, float, float],
    yaw: float,
) -> None:
    """The back is 4 mm from the skirting, +x looks away from the wall."""
    objects = (
        "  - {name: box, asset: cube, scale: [0.4, 0.6, 0.8], static: true,"
        f" wall: {wall}, at: 0.5, height: 0}}"
    )
    world = built(library, scene(tmp_path, objects))
    try:
        pose = pose_of(world, "box")
        expected = (*position[:2], pose.position_m[2])
        assert pose.position_m == pytest.approx(expected, abs=1e-9)
        assert abs(pose.rpy_deg[2]) == pytest.approx(abs(yaw), abs=1e-9)
    finally:
        world.close()


@pytest.mark.parametrize(
    ("objects", "room", "diagnostic"),
    [
        ("  - {name: a, asset: cube, on: b}", "", "there is no object 'b'|has no object 'b'"),
        (
            "  - {name: a, asset: cube, on: b}\n  - {name: b, asset: cube, on: a}",
            "",
            "must not be an object that this one carries",
        ),
        ("  - {name: a, asset: cube, on: a}", "", "must not be an object that this one carries"),
        ("  - {name: a, asset: cube, wall: north}", "", "needs a room"),
        ("  - {name: a, asset: cube, wall: nort}", "room: {size: [4, 3, 2.5]}", "north"),
        ("  - {name: a, asset: cube, at: 1}", "", "only beside wall"),
        (
            "  - {name: a, asset: cube, wall: north, position: [1, 1, 1]}",
            "room: {size: [4, 3, 2.5]}",
            "cannot stand beside",
        ),
    ],
)
def test_impossible_places_are_faults_with_their_line(
    tmp_path: Path, library: SceneLibrary, objects: str, room: str, diagnostic: str
) -> None:
    """What cannot be placed is told by the check, before anything is built."""
    with pytest.raises(SceneError, match=rf"test\.yaml:\d+:\d+: .*({diagnostic})"):
        library.load(scene(tmp_path, objects, room))
