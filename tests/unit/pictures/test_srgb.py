"""Colours from 0 to 255 and linear ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.pictures.srgb import linear_from_srgb8, srgb8_from_linear

CHANNEL = st.integers(0, 255)


@given(colour=st.tuples(CHANNEL, CHANNEL, CHANNEL))
def test_every_colour_comes_back(colour: tuple[int, int, int]) -> None:
    """Linear and back is the identity."""
    assert srgb8_from_linear(linear_from_srgb8("colour", colour)) == colour


def test_known_values_and_limits() -> None:
    """Mid grey is 0.2140 linear (IEC 61966-2-1); what is brighter than white is white."""
    assert linear_from_srgb8("colour", (127, 0, 255)) == pytest.approx((0.2122, 0.0, 1.0), abs=1e-4)
    assert srgb8_from_linear((7.0, -1.0, 0.0)) == (255, 0, 0)


@pytest.mark.parametrize("colour", [(1, 2), (0, 0, 256), (-1, 0, 0), (0.5, 0, 0), "abc"])
def test_other_values_are_refused(colour: object) -> None:
    """Three integers from 0 to 255, nothing else."""
    with pytest.raises(InvalidRequest, match="three integers from 0 to 255"):
        linear_from_srgb8("colour", colour)  # type: ignore[arg-type]  # on purpose
