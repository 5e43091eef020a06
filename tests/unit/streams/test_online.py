"""Evaluation on a stream: test, then learn, with late labels and tests beside the stream."""

from __future__ import annotations

import numpy as np
import pytest

import sailenv_ros.streams as streams
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.streams import Course, LabelledPixels, OnlineProtocol


class Listener:
    """Answers from a table of what it was taught; keeps all that it was asked and told."""

    def __init__(self, shape: tuple[int, ...] = ()) -> None:
        self.asked: list[int] = []
        self.told: list[LabelledPixels] = []
        self.told_when: list[int] = []
        self._shape = shape

    def predict(self, rgb, rows, columns):  # type: ignore[no-untyped-def]
        self.asked.append(len(rows))
        return np.full(self._shape or len(rows), 1)

    def learn(self, pixels: LabelledPixels) -> None:
        self.told.append(pixels)
        self.told_when.append(len(self.asked))


@pytest.mark.parametrize("delay", [0, 3, 100])
def test_labels_come_late_and_in_order(course: Course, delay: int) -> None:
    """Of frame n after the predictions of frame n + delay; they are those of the frame."""
    learner = Listener()
    with streams.open(course, seed=5, length=8) as stream:
        scores = streams.evaluate(stream, {"it": learner}, OnlineProtocol(labels=3, delay=delay))
        assert [one.number for one in learner.told] == list(range(max(0, 8 - delay)))
        assert learner.told_when == list(range(delay + 1, 9))
        expected = [[label.category for label in frame.labels(3)] for frame in stream]
    assert learner.asked == [3] * 8
    for one in learner.told:
        assert one.categories.tolist() == expected[one.number]
        assert one.rgb.shape == (32, 48, 3)
    online = scores["it"].online
    assert online.count == 24
    assert online.accuracy == np.mean(np.array(expected) == 1)
    (end,) = scores["it"].checkpoints
    assert (end.at, end.tests) == (7, {})
    assert end.recent == online.recent


def test_tests_teach_nothing_and_know_the_drift(course: Course) -> None:
    """At each checkpoint, as many frames and pixels as were asked for, of the rooms asked for."""
    learner = Listener()
    protocol = OnlineProtocol(labels=2, every=4, test_frames=3, test_labels=5, rooms=("same",))
    shown = []
    with streams.open(course, seed=5, length=100, format="arrays") as stream:
        part = stream[10:22:2]
        with part:
            scores = streams.evaluate(
                part, {"it": learner}, protocol, on_frame=lambda: shown.append(1)
            )
    assert learner.asked == [2] * 4 + [5] * 3 + [2] * 2 + [5] * 3
    assert [one.number for one in learner.told] == [10, 12, 14, 16, 18, 20]
    assert len(shown) == 12
    points = scores["it"].checkpoints
    assert [point.at for point in points] == [16, 20]
    assert all(0.0 <= point.tests["same"] <= 1.0 for point in points)


def test_what_cannot_be_evaluated_is_told(course: Course) -> None:
    for wrong in ({"labels": 0}, {"delay": -1}, {"rooms": ("any",)}, {"fading": 0.0}):
        with pytest.raises(InvalidRequest, match=r"got"):
            OnlineProtocol(**wrong)
    with (
        streams.open(course, length=2) as stream,
        pytest.raises(InvalidRequest, match="predictions of 'it'"),
    ):
        streams.evaluate(stream, {"it": Listener(shape=(2, 2))})
    with (
        streams.open(course, length=2, views=("category", "instance")) as stream,
        pytest.raises(InvalidRequest, match="views with 'rgb'"),
    ):
        streams.evaluate(stream, {"it": Listener()})
