"""Boxes, pixel counts and mean flow of an instance view, against plain loops."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from sailenv_ros.frame.truth.visible_parts import visible_parts
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.native.view_kernels import measure_instances
from tests.support.reference_measures import measure_with_numpy

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
    boxes = visible_parts(instance)
    assert {id_: (box, pixels) for id_, box, pixels in boxes} == expected
    assert len(boxes) == len(expected)
    assert boxes.corners.shape == (len(expected), 4)


def test_nothing_seen_gives_no_boxes() -> None:
    """An empty view has none, and the arrays keep their shapes."""
    boxes = visible_parts(np.zeros((4, 5), np.uint16))
    assert (len(boxes), boxes.corners.shape, boxes.pixels.shape) == (0, (0, 4), (0,))


@pytest.mark.parametrize("instruction_set", load_library().instruction_sets)
@pytest.mark.parametrize("size", [(1, 1), (8, 8), (9, 13), (61, 97), (480, 640)])
def test_the_kernel_measures_what_numpy_does(size: tuple[int, int], instruction_set: str) -> None:
    """Every number, also where flow is none, endless or negative; on every instruction set."""
    rng = np.random.default_rng(size)
    rows, columns = -(-size[0] // 5), -(-size[1] // 7)
    ids = rng.integers(0, 30, (rows, columns)).astype(np.uint16)
    instance = np.ascontiguousarray(np.repeat(np.repeat(ids, 5, 0), 7, 1)[: size[0], : size[1]])
    instance[rng.random(size) < 0.05] = 65535
    flow = rng.normal(0.0, 300.0, (*size, 2)).astype(np.float32)
    flow[rng.random(size) < 0.1] = np.nan
    flow[rng.random(size) < 0.02] = [np.inf, 0.0]
    flow[rng.random(size) < 0.02] = [0.0, -2e7]
    with using_instruction_set(instruction_set):
        for given in (flow, None):
            measured = measure_instances(instance, given)
            for got, wanted in zip(measured, measure_with_numpy(instance, given), strict=True):
                np.testing.assert_array_equal(got, wanted)
                assert got.dtype == wanted.dtype


def test_mean_flow_is_that_of_the_pixels_that_have_any() -> None:
    """An object of which no pixel has flow has none."""
    instance = np.array([[1, 1, 2], [1, 0, 3]], np.uint16)
    flow = np.full((2, 3, 2), np.nan, np.float32)
    flow[0, 0], flow[1, 0], flow[0, 2] = (3.0, -1.0), (5.0, 2.0), (0.25, 0.0)
    parts = visible_parts(instance, flow)
    np.testing.assert_allclose(parts.flow[:2], [[4.0, 0.5], [0.25, 0.0]], atol=1e-6)
    assert np.isnan(parts.flow[2]).all()
    assert np.isnan(visible_parts(instance).flow).all()
