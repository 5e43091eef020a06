"""Labels of single pixels, and scores of predictions as they come."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.streams import Prequential, Stream, pixel_labels

VIEWS = {
    "category": np.arange(48, dtype=np.uint16).reshape(6, 8) // 12,
    "instance": np.arange(48, dtype=np.uint16).reshape(6, 8),
}


@given(frame=st.integers(0, 10**7), seed=st.integers(0, 99), count=st.integers(1, 60))
def test_labels_are_of_different_pixels_and_true(frame: int, seed: int, count: int) -> None:
    labels = pixel_labels(VIEWS, frame, seed=seed, count=count)
    assert labels == pixel_labels(VIEWS, frame, seed=seed, count=count)
    assert len({label[:2] for label in labels}) == min(count, 48)
    for row, column, category, instance in labels:
        assert (category, instance) == (VIEWS["category"][row, column], 8 * row + column)


def test_labels_of_some_categories_alone() -> None:
    labels = pixel_labels(VIEWS, 3, count=100, of=(1, 3))
    assert len(labels) == 24
    assert {label.category for label in labels} == {1, 3}
    assert pixel_labels(VIEWS, 3, of=(9,)) == ()


def test_all_pixels_get_their_turn() -> None:
    seen = {pixel_labels(VIEWS, frame)[0][:2] for frame in range(600)}
    assert len(seen) == 48


def test_what_is_missing_is_told(stream: Stream) -> None:
    with pytest.raises(InvalidRequest, match="instance"):
        pixel_labels({"category": VIEWS["category"]}, 0)
    with pytest.raises(InvalidRequest, match="count"):
        stream[1].labels(0)
    (label,) = stream[1].labels()
    assert label.instance == stream[1]["instance"][label.row, label.column]


@given(
    st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3)), min_size=1, max_size=60),
    st.floats(0.5, 1.0),
)
def test_scores_equal_arithmetic(pairs: list[tuple[int, int]], fading: float) -> None:
    scores = Prequential(fading)
    for predicted, label in pairs:
        scores.add(predicted, label)
    hits = np.array([predicted == label for predicted, label in pairs], float)
    labels = np.array([label for _, label in pairs])

    def faded(values: np.ndarray) -> float:
        weights = fading ** np.arange(len(values))[::-1]
        return float((values * weights).sum() / weights.sum())

    assert scores.count == len(pairs)
    assert scores.accuracy == pytest.approx(hits.mean())
    assert scores.recent == pytest.approx(faded(hits))
    for label in set(labels.tolist()):
        own = hits[labels == label]
        path = [faded(own[: end + 1]) for end in range(len(own))]
        assert scores.of_classes[label] == pytest.approx(path[-1])
        assert scores.forgetting[label] == pytest.approx(max(path) - path[-1])


def test_nothing_is_scored_before_the_first() -> None:
    assert math.isnan(Prequential().accuracy)
    assert math.isnan(Prequential().recent)
    with pytest.raises(InvalidRequest, match="fading"):
        Prequential(0.0)
