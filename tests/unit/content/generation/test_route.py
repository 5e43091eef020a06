"""The camera's way: through free floor, past furniture at a distance, there and back again."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_content.generation.items import Item
from sailenv_content.generation.plan import Area, Block, RoomPlan
from sailenv_content.generation.route import mover_entry
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_models import FurnitureRule

RULE = FurnitureRule(assets=("chair_01",))
HALF = (2.6, 2.1)
CELL_M = 0.05
RADIUS_M = 0.32
"""Of the camera. Corners of the way are middles of cells; lines between are judged by cells."""

BLOCK = st.builds(
    Block,
    x=st.floats(-2.2, 2.2),
    y=st.floats(-1.8, 1.8),
    half_x=st.floats(0.1, 0.6),
    half_y=st.floats(0.1, 0.6),
    yaw_rad=st.floats(-3.2, 3.2),
    high=st.floats(0.3, 2.0),
)


def item(number: int, block: Block) -> Item:
    return Item(
        name=f"piece {number}", asset="chair_01", entry={}, block=block, x=block.x, y=block.y,
        yaw_deg=0.0, rule=RULE,
    )  # fmt: skip


def planned(blocks: list[Block], *walls: Block) -> tuple[RoomPlan, list[Item]]:
    low, high = (-HALF[0], -HALF[1]), HALF
    area = Area(name="", kind="", low=low, high=high, height=2.5, walls=())
    plan = RoomPlan(areas=[area], doors=[(-2.2, 0.0)], walls=walls)
    plan.stand(blocks)
    return plan, [item(number, block) for number, block in enumerate(blocks)]


def way_of(mover: dict) -> np.ndarray:  # type: ignore[type-arg]
    """Points of the closed way, 2 cm apart at most."""
    corners = np.array([one["position"] for one in mover["waypoints"]])
    pieces = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        count = 2 + int(np.linalg.norm(end - start) / 0.02)
        pieces.append(start + np.linspace(0.0, 1.0, count)[:, None] * (end - start))
    return np.concatenate(pieces)


@given(blocks=st.lists(BLOCK, max_size=6), seed=st.integers(0, 1000))
def test_the_way_keeps_its_distance_all_along(blocks: list[Block], seed: int) -> None:
    """From walls and from furniture, on the lines between waypoints and on the one back."""
    plan, items = planned(blocks)
    try:
        mover = mover_entry(plan, items, RandomStream(seed), 0.5)
    except (AssertionError, ValueError):  # the door is blocked, or there is no room for a camera
        return
    points = way_of(mover)
    # A line passes at most half a diagonal from the middle of a cell that it was looked at in.
    least = RADIUS_M - CELL_M * math.sqrt(0.5) - 1e-3
    assert (np.abs(points[:, :2]) <= np.subtract(HALF, least)).all()
    for block in blocks:
        assert block.distance_m(points[:, :2]).min() >= least
    for one in mover["waypoints"]:
        assert 1.45 <= one["position"][2] <= 1.65
        assert math.dist(one["position"], one["look_at"]) > 0.5


@pytest.mark.parametrize("seed", range(5))
def test_it_comes_by_both_sides_of_a_wall(seed: int) -> None:
    """Through the gap in it; its time is that of its length at the speed, or 20 s."""
    wall = Block(x=0.0, y=-0.5, half_x=0.06, half_y=1.6, high=2.5)
    plan, items = planned([], wall)
    mover = mover_entry(plan, items, RandomStream(seed), 0.25)
    points = way_of(mover)
    assert points[:, 0].min() < -1.0
    assert points[:, 0].max() > 1.0
    length = np.linalg.norm(np.diff(np.vstack([points, points[:1]]), axis=0), axis=1).sum()
    count = len(mover["waypoints"])
    assert mover["total_time"] == pytest.approx(max(20.0, 3.0 * count, length / 0.25), abs=0.51)


def test_without_room_there_is_no_way() -> None:
    """A sentence for the generator, which draws again."""
    full = Block(x=0.3, y=0.0, half_x=2.3, half_y=2.1)
    plan, items = planned([])
    crowded = [*items, item(9, full)]
    with pytest.raises(ValueError, match="no place for a camera"):
        mover_entry(plan, crowded, RandomStream(1), 0.5)
