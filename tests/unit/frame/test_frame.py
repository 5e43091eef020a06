"""A frame is a mapping of its views, and is equal to itself alone."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import pytest

from sailenv_ros.errors import UnknownName
from sailenv_ros.frame.frame import Frame
from tests.support.recordings import SMALL, noise_frame


@pytest.fixture
def frame() -> Frame:
    """Return a frame of two views."""
    return noise_frame(1, views=("depth", "rgb"))


def test_a_frame_is_a_mapping_of_its_views(frame: Frame) -> None:
    assert isinstance(frame, Mapping)
    assert "rgb" in frame
    assert "flow" not in frame
    assert 3 not in frame
    assert list(frame) == list(frame.keys()) == ["rgb", "depth"]
    assert len(frame) == 2
    assert all(frame[name] is array for name, array in frame.items())
    assert [array.shape for array in frame.values()] == [
        (SMALL.height, SMALL.width, 3),
        (SMALL.height, SMALL.width),
    ]
    assert dict(frame) == dict(frame.views)


def test_get_gives_the_default_where_a_view_is_missing(frame: Frame) -> None:
    assert frame.get("depth") is frame["depth"]
    assert frame.get("flow") is None
    assert frame.get("flow", 5) == 5


def test_an_unknown_view_is_told_with_those_that_there_are(frame: Frame) -> None:
    with pytest.raises(UnknownName, match="did you mean 'depth'"):
        _ = frame["dept"]


def test_a_frame_is_equal_to_itself_alone_and_always_true(frame: Frame) -> None:
    other = dataclasses.replace(frame)
    assert frame == frame
    assert frame != other
    assert len({frame, other}) == 2
    assert bool(dataclasses.replace(frame, views={}))
