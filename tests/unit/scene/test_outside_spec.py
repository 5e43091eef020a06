"""The field `outside` of a room: a kind or its keys, and errors with their place."""

from __future__ import annotations

from pathlib import Path

import pytest

from sailenv_ros.scene.spec_room import RoomSpec
from tests.unit.scene.reading import diagnostics, read

HEAD = "version: 1\nroom:\n  size: [4, 3, 2.5]\n"


@pytest.mark.parametrize(
    ("line", "kind", "seed"),
    [
        ("  outside: street\n", "street", 0),
        ("  outside: {kind: garden, seed: 7}\n", "garden", 7),
        ("  outside: none\n", "none", 0),
        ("  outside: false\n", "none", 0),
        ("", "none", 0),
    ],
)
def test_a_name_stands_for_its_kind(tmp_path: Path, line: str, kind: str, seed: int) -> None:
    room = read(tmp_path, HEAD + line).room
    assert room is not None
    assert (room.outside.kind, room.outside.seed) == (kind, seed)


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (
            "  outside: stret\n",
            "4:12: room.outside: must be one of: none, garden, street "
            "(did you mean 'street'?), got 'stret'",
        ),
        (
            "  outside: {kind: garden, seed: -1}\n",
            "4:33: room.outside.seed: must be an integer from 0 to 2147483647, got -1",
        ),
        (
            "  outside: {kind: garden, trees: 3}\n",
            "4:27: room.outside.trees: is not a key that is known here; known: kind, seed",
        ),
    ],
)
def test_an_error_has_its_place(tmp_path: Path, line: str, error: str) -> None:
    assert diagnostics(tmp_path, HEAD + line) == [error]


def test_its_name_is_taken_where_there_is_one(tmp_path: Path) -> None:
    objects = "objects:\n  - {name: outside, asset: cube}\n"
    assert diagnostics(tmp_path, HEAD + objects) == []
    for line in ("  outside: garden\n", "  outside: {kind: garden}\n"):
        (error,) = diagnostics(tmp_path, HEAD + line + objects)
        assert error.startswith("6:12: objects[0].name: is the name of a part of the room")


def test_it_is_written_in_its_shortest_form() -> None:
    written = {"size": [4.0, 3.0, 2.5], "outside": "street"}
    assert RoomSpec.model_validate(written).model_dump(mode="json", exclude_unset=True) == written
    longer = {**written, "outside": {"kind": "street", "seed": 2}}
    assert RoomSpec.model_validate(longer).model_dump(mode="json", exclude_unset=True) == longer
