"""The floor plan: boxes that meet or do not, ways between doors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_content.generation.plan import Area, Block, RoomPlan, WallSide

LENGTH = st.floats(0.1, 2.0)
PLACE = st.floats(-2.0, 2.0)
BLOCK = st.builds(
    Block, x=PLACE, y=PLACE, half_x=LENGTH, half_y=LENGTH, yaw_rad=st.floats(-4.0, 4.0)
)


@given(BLOCK, BLOCK)
def test_boxes_meet_if_a_point_of_one_lies_in_the_other(first: Block, second: Block) -> None:
    shares = np.linspace(-0.999, 0.999, 15)
    grid = np.stack(np.meshgrid(shares, shares), axis=-1).reshape(-1, 2)
    points = grid * (first.half_x, first.half_y) @ first.axes() + (first.x, first.y)
    if (second.distance_m(points) < 1e-9).any():
        assert first.meets(second)
        assert second.meets(first)


@given(BLOCK, BLOCK)
def test_boxes_that_do_not_meet_are_apart(first: Block, second: Block) -> None:
    if not first.meets(second):
        assert (second.distance_m(first.corners()) > -1e-9).all()
        assert not second.meets(first)


def test_boxes_meet_only_at_heights_that_both_have() -> None:
    low = Block(x=0, y=0, half_x=1, half_y=1, low=0.0, high=0.8)
    picture = Block(x=0, y=0, half_x=1, half_y=1, low=1.3, high=2.0)
    assert not low.meets(picture)
    assert low.meets(Block(x=0, y=0, half_x=1, half_y=1, low=0.7, high=2.0))


def test_a_margin_keeps_boxes_apart() -> None:
    first = Block(x=0, y=0, half_x=0.5, half_y=0.5)
    second = Block(x=1.1, y=0, half_x=0.5, half_y=0.5)
    assert not first.meets(second, 0.09)
    assert first.meets(second, 0.11)


def test_distance_is_that_to_the_nearest_edge() -> None:
    block = Block(x=1, y=2, half_x=0.5, half_y=0.25, yaw_rad=math.pi / 2)
    found = block.distance_m(np.array([[1.0, 2.0], [1.0, 3.0], [2.25, 2.5], [2.25, 3.5]]))
    assert found == pytest.approx([0.0, 0.5, 1.0, math.hypot(1.0, 1.0)])


def _plan() -> RoomPlan:
    area = Area(name="", kind="", low=(-2, -2), high=(2, 2), height=2.5, walls=())
    return RoomPlan(areas=[area], doors=[(-1.5, 0.0), (1.5, 0.0)])


def test_a_wall_of_furniture_parts_the_doors_and_a_gap_joins_them() -> None:
    whole = Block(x=0, y=0, half_x=0.3, half_y=2.0)
    gap = Block(x=0, y=-0.5, half_x=0.3, half_y=1.5)
    assert not _plan().connects([whole])
    assert _plan().connects([gap])


def test_one_walks_over_rugs_and_under_lamps() -> None:
    for low, high in ((-0.02, -0.01), (0.0, 0.04), (1.95, 2.4)):
        block = Block(x=0, y=0, half_x=0.3, half_y=2.0, low=low, high=high)
        assert _plan().connects([block])


def test_a_gap_as_wide_as_a_body_is_passed_and_a_narrower_one_is_not() -> None:
    for width, passed in ((0.7, True), (0.4, False)):
        half = (4.0 - width) / 2.0
        block = Block(x=0, y=-2.0 + half, half_x=0.3, half_y=half)
        assert _plan().connects([block]) is passed


def test_places_along_a_wall_count_from_its_start() -> None:
    side = WallSide(wall="north", start=(-2, 1.5), end=(2, 1.5), inward=(0, -1))
    assert side.length_m == 4.0
    assert side.yaw_deg == -90.0
    assert side.point(1.0, 0.25) == (-1.0, 1.25)
