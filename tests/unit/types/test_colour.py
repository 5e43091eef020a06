"""Colours from 0 to 255 and linear ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.colour import (
    LINEAR_OF_SRGB8,
    hex_from_linear,
    linear_from_hex,
    linear_from_srgb,
    linear_from_srgb8,
    srgb8_from_linear,
    srgb_from_linear,
)

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


def test_arrays_and_single_colours_are_on_one_curve() -> None:
    """All 256 codes, as an array, as integers and as ``#rrggbb``; and each comes back."""
    codes = np.arange(256)
    singly = [linear_from_srgb8("colour", (code, code, code))[0] for code in codes]
    np.testing.assert_allclose(LINEAR_OF_SRGB8, singly, rtol=1e-15)
    assert [linear_from_hex(f"#{code:02x}0000")[0] for code in codes] == singly
    assert (np.round(255.0 * srgb_from_linear(LINEAR_OF_SRGB8)) == codes).all()
    assert hex_from_linear(linear_from_hex("#c0ffee")) == "#c0ffee"


def test_what_is_outside_of_the_curve_is_clipped() -> None:
    """Beyond black and white there is nothing to store."""
    assert srgb_from_linear([-1.0, 0.0, 1.0, 7.0]) == pytest.approx([0.0, 0.0, 1.0, 1.0])
    assert linear_from_srgb([-1.0, 0.0, 1.0, 7.0]) == pytest.approx([0.0, 0.0, 1.0, 1.0])
