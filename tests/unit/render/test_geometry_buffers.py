"""Triangles by position alone: the same triangles of fewer points."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.native.mesh_kernels import corners_of


@given(seed=st.integers(0, 2**16), vertices=st.integers(1, 60), count=st.integers(1, 80))
def test_corners_are_the_places_of_vertices(seed: int, vertices: int, count: int) -> None:
    """Every triangle stays where it is; no place comes twice; places come in order of use."""
    random = np.random.default_rng(seed)
    positions = random.integers(-1, 2, (vertices, 3)).astype(np.float32) / np.float32(3.0)
    triangles = random.integers(0, vertices, (count, 3)).astype(np.uint32)
    corners, numbers = corners_of(positions, triangles)
    assert (corners[numbers] == positions[triangles]).all()
    assert len(np.unique(corners, axis=0)) == len(corners)
    assert set(numbers.reshape(-1).tolist()) == set(range(len(corners)))
    first = np.unique(numbers.reshape(-1), return_index=True)[1]
    assert (np.diff(first) > 0).all()


def test_no_triangles_have_no_corners() -> None:
    """And vertices that no triangle uses are no corners."""
    nothing = np.zeros((0, 3), np.uint32)
    corners, numbers = corners_of(np.ones((4, 3), np.float32), nothing)
    assert corners.shape == numbers.shape == (0, 3)
    corners, _ = corners_of(np.eye(4, 3, dtype=np.float32), np.array([[1, 1, 2]], np.uint32))
    assert corners.tolist() == [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
