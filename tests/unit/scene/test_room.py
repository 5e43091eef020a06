"""The `room:` section: short forms, defaults, and every error with its place."""

from __future__ import annotations

from pathlib import Path

import jsonschema
import pytest
import yaml
from pydantic import ValidationError

from sailenv_ros.scene import SceneSpec
from sailenv_ros.scene.room_rules import room_part_names
from sailenv_ros.scene.schema import scene_schema
from sailenv_ros.scene.spec_room import DoorSpec, RoomSpec, SkirtingSpec, SurfaceSpec, WindowSpec
from tests.unit.scene.reading import diagnostics, read

HEAD = "version: 1\nroom:\n  size: [4, 3, 2.5]\n"
WINDOW = "    - {type: window, wall: north, "


def _room(**keys: object) -> RoomSpec:
    return RoomSpec.model_validate({"size": [4.4, 3.6, 2.6], **keys})


def test_a_size_is_enough() -> None:
    room = _room()
    assert room.walls == room.ceiling == SurfaceSpec(material="plaster")
    assert room.floor.material == "oak_planks"
    assert room.skirting == SkirtingSpec(height=0.09, depth=0.015)
    assert room.openings == ()
    assert SceneSpec(version=1).room is None


def test_a_name_stands_for_a_surface() -> None:
    assert _room(walls="carpet") == _room(walls={"material": "carpet"})


def test_single_walls_may_differ() -> None:
    room = _room(walls="plaster", wall_materials={"north": "carpet"})
    materials = [room.surface_of(wall).material for wall in ("north", "east", "south", "west")]  # type: ignore[arg-type]
    assert materials == ["carpet", "plaster", "plaster", "plaster"]


def test_false_leaves_out_and_true_takes_the_defaults() -> None:
    assert _room(skirting=False, ceiling=False).skirting is None
    assert _room(skirting=False, ceiling=False).ceiling is None
    assert _room(skirting=True, ceiling=True) == _room(skirting={}, ceiling={})


def test_openings_have_the_sizes_that_are_usual() -> None:
    window, door = _room(
        openings=[{"type": "window", "wall": "north"}, {"type": "door", "wall": "east"}]
    ).openings
    assert isinstance(window, WindowSpec)
    assert isinstance(door, DoorSpec)
    assert (window.width, window.height, window.sill, window.curtains) == (1.2, 1.3, 0.9, None)
    assert (door.width, door.height, door.open, door.hinge) == (0.9, 2.05, 0.0, "left")


def test_a_rule_holds_for_models_made_in_code_too() -> None:
    with pytest.raises(ValidationError, match=r"must be at most 3\.6"):
        _room(openings=[{"type": "door", "wall": "east", "width": 3.7}])


def test_openings_may_touch_and_reach_the_ends_and_the_ceiling() -> None:
    entries = [
        {"type": "window", "wall": "north", "at": -1.1, "width": 2.2, "sill": 1.3, "height": 1.3},
        {"type": "window", "wall": "north", "at": 1.1, "width": 2.2},
        {"type": "window", "wall": "north", "at": 1.1, "width": 2.2, "sill": 0, "height": 0.9},
    ]
    assert len(_room(openings=entries).openings) == 3


def test_names_of_parts_count_windows_and_doors() -> None:
    listed = [{"type": "door"}, {"type": "window"}, {"type": "window"}, 3]
    names = set(room_part_names({"openings": listed}))
    assert {"door 1", "window 1", "window 2", "curtains 2", "north wall", "floor"} <= names
    assert "door 2" not in names


ERRORS = {
    "unknown material, short form": (
        "  walls: plastr",
        "4:10: room.walls: there is no material 'plastr'; did you mean 'plaster'?",
    ),
    "unknown material, long form": (
        "  floor: {material: oak, colour: '#aabbcc'}",
        "4:21: room.floor.material: there is no material 'oak'; "
        "known: plaster, oak_planks, white_tiles",
    ),
    "unknown material of one wall": (
        "  wall_materials: {north: white_tile}",
        "4:27: room.wall_materials.north: there is no material 'white_tile'; "
        "did you mean 'white_tiles'?",
    ),
    "a number for a surface": (
        "  ceiling: 3",
        "4:12: room.ceiling: must be a mapping (key: value), got 3",
    ),
    "unknown wall": (
        "  openings:\n    - {type: door, wall: nort}",
        "5:26: room.openings[0].wall: must be one of: north, east, south, west "
        "(did you mean 'north'?), got 'nort'",
    ),
    "unknown kind of opening": (
        "  openings:\n    - {type: windw, wall: north}",
        "5:14: room.openings[0].type: must be one of: window, door (did you mean 'window'?), "
        "got 'windw'",
    ),
    "unknown key": (
        f"  openings:\n{WINDOW}heigth: 1}}",
        "5:35: room.openings[0].heigth: is not a key that is known here; did you mean 'height'?",
    ),
    "wider than its wall": (
        "  openings:\n    - {type: window, wall: east, width: 3.5}",
        "5:41: room.openings[0].width: must be at most 3 [m], the length of the east wall, got 3.5",
    ),
    "leaves its wall": (
        f"  openings:\n{WINDOW}at: 1.5}}",
        "5:39: room.openings[0].at: must be from -1.4 to 1.4 [m], so that it lies in the north "
        "wall, got 1.5",
    ),
    "higher than the room": (
        f"  openings:\n{WINDOW}sill: 1.5}}",
        "5:7: room.openings[0].height: must be at most 1 [m], up to the ceiling, got 1.3",
    ),
    "overlapping": (
        f"  openings:\n{WINDOW}at: 0.5}}\n{WINDOW}at: -0.5}}",
        "6:7: room.openings[1]: overlaps openings[0] on the north wall",
    ),
    "walls too thin to hold things in": (
        "  thickness: 0.1",
        "4:14: room.thickness: must be a number from 0.15 to 1 [m], got 0.1",
    ),
    "a door that opens too far": (
        "  openings:\n    - {type: door, wall: north, open: 270}",
        "5:39: room.openings[0].open: must be a number from 0 to 170 [deg], got 270",
    ),
    "an object called as a part of the room": (
        "objects:\n  - {name: floor, asset: cube}",
        "5:12: objects[0].name: is the name of a part of the room: 'floor'",
    ),
}


@pytest.mark.parametrize("case", ERRORS)
def test_a_fault_is_told_with_its_place(tmp_path: Path, case: str) -> None:
    text, expected = ERRORS[case]
    assert diagnostics(tmp_path, HEAD + text) == [expected]


def test_openings_on_different_walls_never_overlap(tmp_path: Path) -> None:
    text = f"  openings:\n{WINDOW}at: 0}}\n    - {{type: window, wall: south, at: 0}}"
    room = read(tmp_path, HEAD + text).room
    assert room is not None
    assert len(room.openings) == 2


@pytest.mark.parametrize(
    ("text", "fits"),
    [
        ("  walls: plaster\n  ceiling: false\n  skirting: true", True),
        ("  walls: {material: plaster, colour: '#ffffff'}", True),
        ("  openings: [{type: window, wall: north, curtains: true}]", True),
        ("  walls: 3", False),
        ("  skirting: 3", False),
        ("  openings: [{type: door, wall: north, sill: 1}]", False),
    ],
)
def test_editors_accept_what_the_loader_accepts(text: str, fits: bool) -> None:
    validator = jsonschema.Draft7Validator(scene_schema({}))
    assert validator.is_valid(yaml.safe_load(HEAD + text)) == fits


def test_numbers_beyond_all_floats_are_faults_like_others(tmp_path: Path) -> None:
    """Integers may have any length in YAML; rules between keys keep silent about them."""
    endless = "9" * 400
    opening = f"  openings:\n    - {{type: door, wall: north, at: {endless}}}\n"
    cone = f"lights:\n  - {{name: a, type: spot, inner_cone: {endless}}}"
    at, inner = diagnostics(tmp_path, HEAD + opening + cone)
    assert at.startswith("5:37: room.openings[0].at: must be a number from -50 to 50 [m], got 999")
    assert inner.startswith("7:39: lights[0].inner_cone: must be a number from 0 to 89 [deg]")
