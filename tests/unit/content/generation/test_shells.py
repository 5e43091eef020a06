"""Rooms before they are furnished, of many seeds: sizes, openings, walls between, doors."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from sailenv_content.generation.plan import RoomPlan
from sailenv_content.generation.shells import Shell, shell_of
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules, room_kinds, rules_of
from sailenv_ros.simulation.scenes import SceneLibrary
from tests.support.built_world import corners_of

SEEDS = range(30)
WALL_M = 0.12
"""Thickness of walls between rooms."""

KIND = pytest.mark.parametrize("kind", room_kinds())


@pytest.fixture(scope="module")
def rules() -> Rules:
    return rules_of()


def drawn(kind: str, rules: Rules) -> list[Shell]:
    """The shells of all seeds."""
    return [shell_of(kind, rules, RandomStream(kind, seed, 0, "shell")) for seed in SEEDS]


@KIND
def test_sizes_are_within_the_rules(kind: str, rules: Rules) -> None:
    """And differ: lengths are rounded to 10 cm, heights to 1 cm."""
    shape = rules.kind(kind).shape
    sizes = [tuple(shell.entry["size"]) for shell in drawn(kind, rules)]
    for size in sizes:
        spans = (shape.width, shape.depth, shape.height)
        for length, span, rounded in zip(size, spans, (0.1, 0.1, 0.01), strict=True):
            assert span[0] - rounded / 2 <= length <= span[1] + rounded / 2
    assert len(set(sizes)) > len(SEEDS) / 2


@KIND
def test_openings_keep_from_corners_and_from_each_other(kind: str, rules: Rules) -> None:
    """By 30 and by 25 cm, within the height; no more of them than the rules ask for."""
    rounding = 0.01
    for shell in drawn(kind, rules):
        sides = [side for area in shell.areas for side in area.walls if side.wall]
        for side in sides:
            spans = sorted(hole.along for hole in side.holes)
            for low, high in spans:
                assert low >= 0.3 - rounding
                assert high <= side.length_m - 0.3 + rounding
            for (_, end), (start, _) in itertools.pairwise(spans):
                assert start - end >= 0.25 - 2 * rounding
            assert all(
                0.0 <= hole.up[0] < hole.up[1] < shell.entry["size"][2] for hole in side.holes
            )
        held = Counter(hole.kind for side in sides for hole in side.holes)
        assert held == Counter(entry["type"] for entry in shell.entry["openings"])
        if not rules.kind(kind).layouts:
            assert 1 <= held["door"] <= rules.kind(kind).doors.count[1]
            assert held["window"] <= rules.kind(kind).windows.count[1]


@KIND
def test_every_place_of_the_floor_belongs_to_one_room_or_to_a_wall(kind: str, rules: Rules) -> None:
    """Rooms of an apartment fill it and do not overlap; so does one room with a corner cut out."""
    for shell in drawn(kind, rules):
        x, y = (0.5 * side - 0.005 for side in shell.entry["size"][:2])
        axes = np.linspace(-x, x, 61), np.linspace(-y, y, 59)
        points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
        held = np.zeros(len(points), int)
        for area in shell.areas:
            inside = ((points > area.low) & (points < area.high)).all(axis=1)
            if area.cut is not None:
                inside &= area.cut.distance_m(points) > 0.0
            held += inside
        walls = np.zeros(len(points), bool)
        for entry in shell.entry.get("partitions", ()):
            ends = np.sort([entry["start"], entry["end"]], axis=0)
            thick = ((points >= ends[0] - WALL_M / 2) & (points <= ends[1] + WALL_M / 2)).all(
                axis=1
            )
            walls |= thick
        if len(shell.areas) == 1 and shell.areas[0].cut is not None:
            walls |= shell.areas[0].cut.distance_m(points) == 0.0
        assert held.max() == 1
        assert walls[held == 0].all()


@KIND
def test_one_can_walk_between_all_doors_of_an_empty_room(kind: str, rules: Rules) -> None:
    """Each room of an apartment has a door, or a doorway that leads to one."""
    for shell in drawn(kind, rules):
        assert RoomPlan(areas=shell.areas, doors=shell.doors, walls=shell.walls).connects(())
        doorways = [each for wall in shell.entry.get("partitions", ())
                    for each in wall.get("doorways", ())]  # fmt: skip
        assert len(doorways) == len(shell.areas) - 1


def test_open_leaves_stand_where_the_plan_keeps_room_for_them(rules: Rules, tmp_path: Path) -> None:
    """The world builds each leaf within 10 cm of its box, handles included, and as wide as that."""
    kind = rules.kind("living_room")
    ajar = kind.model_copy(update={"doors": kind.doors.model_copy(update={"open_chance": 1.0})})
    opened = replace(rules, kinds={**rules.kinds, "living_room": ajar})
    tried = 0
    for shell in drawn("living_room", opened)[:8]:
        room = {key: shell.entry[key] for key in ("size", "openings", "partitions")
                if key in shell.entry}  # fmt: skip
        plain = [{k: v for k, v in one.items() if k != "curtains"} for one in room["openings"]]
        path = tmp_path / "shell.yaml"
        path.write_text(yaml.safe_dump({"version": 1, "room": {**room, "openings": plain}}))
        world = SceneLibrary().build(path)
        open_doors = [
            number
            for number, entry in enumerate((one for one in plain if one["type"] == "door"), start=1)
            if entry.get("open")
        ]
        for number, block in zip(open_doors, shell.leaves, strict=True):
            points = corners_of(world, f"door {number} leaf")
            assert block.distance_m(points[:, :2]).max() < 0.1
            along = (points[:, :2] - (block.x, block.y)) @ block.axes()[0]
            assert along.min() < 0.1 - block.half_x
            assert along.max() > block.half_x - 0.1
            tried += 1
        world.close()
    assert tried >= 8
