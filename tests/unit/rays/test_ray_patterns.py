"""Points of the unit square, counted in boxes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.rays.ray_patterns import low_discrepancy_points, sequence_points


@pytest.mark.parametrize("count", [1, 16, 64, 256])
def test_the_first_points_of_a_sequence_are_even_too(count: int) -> None:
    """A power of two of them have one in each box of that share, of whatever shape."""
    points = sequence_points(count)
    assert points.shape == (count, 2)
    assert points.dtype == np.float32
    bits = count.bit_length() - 1
    for first_bits in range(bits + 1):
        first = points[: 2**first_bits]
        for across in range(first_bits + 1):
            box = np.floor(first * (2**across, 2 ** (first_bits - across)))
            assert len(np.unique(box, axis=0)) == len(first)


@pytest.mark.parametrize("points", [low_discrepancy_points, sequence_points])
def test_shared_points_cannot_be_written_to(points: Callable[[int], NDArray[np.float32]]) -> None:
    with pytest.raises(ValueError, match="read-only"):
        points(16)[0] = 0.0
