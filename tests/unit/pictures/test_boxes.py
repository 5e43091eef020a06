"""Boxes and pixel counts of an instance view, against a plain loop."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from sailenv_ros.pictures.boxes import instance_boxes

VIEWS = arrays.arrays(
    np.uint16,
    arrays.array_shapes(min_dims=2, max_dims=2, max_side=12),
    elements=st.sampled_from([0, 1, 2, 7, 65535]),
)


@given(instance=VIEWS)
def test_boxes_are_those_of_a_plain_loop(instance: np.ndarray) -> None:  # type: ignore[type-arg]  # any shape
    """Every id that is seen has its box, the last row and column included, and its count."""
    expected = {}
    for id_ in np.unique(instance[instance > 0]).tolist():
        rows, columns = np.nonzero(instance == id_)
        box = (columns.min(), rows.min(), columns.max(), rows.max())
        expected[id_] = (tuple(map(int, box)), len(rows))
    boxes = instance_boxes(instance)
    assert {id_: (box, pixels) for id_, box, pixels in boxes} == expected
    assert len(boxes) == len(expected)
    assert boxes.corners.shape == (len(expected), 4)


def test_nothing_seen_gives_no_boxes() -> None:
    """An empty view has none, and the arrays keep their shapes."""
    boxes = instance_boxes(np.zeros((4, 5), np.uint16))
    assert (len(boxes), boxes.corners.shape, boxes.pixels.shape) == (0, (0, 4), (0,))
