"""Distances of convex solids against arithmetic, and against a linear program."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from sailenv_ros.space.outlines import Solid, solids_of
from sailenv_ros.space.solid_distances import collision_box, solid_distance_m, solids_overlap
from sailenv_ros.types.model import BoxShape, CylinderShape, SphereShape

CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def cube_at(x: float, y: float, z: float) -> Solid:
    """A cube with edges of 2 m."""
    return Solid(CORNERS + np.array([x, y, z]))


def test_distances_are_those_of_arithmetic() -> None:
    """Face to face, corner to corner, ball to face, ball to ball, inside."""
    cube = Solid(CORNERS)
    assert solid_distance_m(cube, cube_at(5.0, 0.5, 0.0)) == pytest.approx(3.0)
    assert solid_distance_m(cube, cube_at(3.0, 3.0, 3.0)) == pytest.approx(3.0**0.5)
    ball = Solid(np.array([(0.0, 0.0, 4.0)]), 0.5)
    assert solid_distance_m(cube, ball) == pytest.approx(2.5)
    assert solid_distance_m(ball, Solid(np.array([(3.0, 0.0, 0.0)]), 1.0)) == pytest.approx(3.5)
    assert solid_distance_m(cube, Solid(0.1 * CORNERS)) == pytest.approx(0.0, abs=1e-12)
    assert solids_overlap(cube, cube_at(2.0, 0.0, 0.0))
    assert not solids_overlap(cube, cube_at(2.0 + 1e-6, 0.0, 0.0))


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_hulls_overlap_where_a_point_is_in_both(seed: int) -> None:
    """A linear program finds the point, or that there is none."""
    random = np.random.default_rng(seed)
    first = random.normal(size=(12, 3))
    second = random.normal(size=(9, 3)) + random.normal(size=3) * 2.0
    both = np.vstack([np.hstack([first.T, -second.T]), np.eye(2)[:, np.repeat([0, 1], [12, 9])]])
    found = linprog(np.zeros(21), A_eq=both, b_eq=[0, 0, 0, 1, 1]).status == 0
    assert solids_overlap(Solid(first), Solid(second)) == found


def test_boxes_are_around_the_shapes() -> None:
    """Tight for boxes and balls; round shapes reach exactly their radius."""
    box = BoxShape(half_extents_m=(1.0, 2.0, 3.0), centre_m=(1.0, 0.0, 0.0))
    low, high = collision_box([box], (2.0, 1.0, 1.0)) or pytest.fail("no box")
    np.testing.assert_allclose((low, high), [(0.0, -2.0, -3.0), (4.0, 2.0, 3.0)])
    (solid,) = solids_of([box], (2.0, 1.0, 1.0), np.eye(4))
    np.testing.assert_allclose((solid.points.min(0), solid.points.max(0)), (low, high))
    round_ones = [SphereShape(radius_m=1.0), CylinderShape(radius_m=0.5, height_m=4.0)]
    low, high = collision_box(round_ones, (1.0, 1.0, 1.0)) or pytest.fail("no box")
    np.testing.assert_allclose((low, high), [(-1.0, -1.0, -2.0), (1.0, 1.0, 2.0)])
    assert collision_box([], (1.0, 1.0, 1.0)) is None
