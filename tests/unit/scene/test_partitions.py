"""Walls inside a room and parts of its floor in scene files: what is accepted, what is told."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.unit.scene.reading import diagnostics, read

HEAD = "version: 1\nroom:\n  size: [5, 4, 2.5]\n"
WALL = "  partitions:\n    - {name: inner wall, "
FLOOR = "  floors:\n    - {name: bath, "


def test_a_wall_takes_the_material_of_the_walls_and_usual_doorways(tmp_path: Path) -> None:
    text = HEAD + WALL + "start: [1, -2], end: [1, 2], doorways: [{at: 0.5}], east: white_tiles}\n"
    room = read(tmp_path, text).room
    assert room is not None
    wall = room.partitions[0]
    assert (wall.thickness, wall.west, wall.doorways[0].width) == (0.12, None, 0.9)
    assert wall.east is not None
    assert wall.east.material == "white_tiles"


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (WALL + "start: [1, -2], end: [2, 2]}", "must have the same x or the same y as start"),
        (WALL + "start: [1, 1], end: [1, 1]}", "must lie 0.1 [m] or more from start"),
        (WALL + "start: [1, -2], end: [1, 3]}", "must lie in the room"),
        (
            WALL + "start: [1, -1], end: [1, 1], doorways: [{at: 0.7}]}",
            "must be from -0.55 to 0.55 [m], so that it lies in the wall, got 0.7",
        ),
        (
            WALL + "start: [1, -2], end: [1, 2], doorways: [{at: 0}, {at: 0.5}]}",
            "overlaps doorways[0]",
        ),
        (
            WALL + "start: [1, -2], end: [1, 2], doorways: [{height: 2.6}]}",
            "must be at most 2.5 [m], got 2.6",
        ),
        (WALL + "start: [1, -2], end: [1, 2], east: velvet}", "there is no material 'velvet'"),
        (FLOOR + "start: [0, 0], end: [0, 1], surface: plaster}", "along x and along y"),
        (FLOOR + "start: [0, 0], end: [1, 1], surface: velvet}", "there is no material 'velvet'"),
        (
            FLOOR + "start: [0, 0], end: [1, 1], surface: plaster}\n"
            "    - {name: b, start: [0.5, 0.5], end: [2, 2], surface: plaster}",
            "overlaps floors[0]",
        ),
        (WALL.replace("inner wall", "floor") + "start: [1, -2], end: [1, 2]}", "another part"),
    ],
)
def test_what_cannot_be_is_told_with_its_place(tmp_path: Path, line: str, told: str) -> None:
    errors = diagnostics(tmp_path, f"{HEAD}{line}\n")
    assert len(errors) == 1
    assert told in errors[0]
    assert errors[0].split(":")[0] in ("5", "6")


def test_an_object_is_not_called_as_a_wall(tmp_path: Path) -> None:
    text = HEAD + WALL + "start: [1, -2], end: [1, 2]}\n"
    errors = diagnostics(tmp_path, text + "objects:\n  - {name: inner wall, asset: cube}\n")
    assert [error for error in errors if "is the name of a part of the room" in error]
