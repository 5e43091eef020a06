"""The tone curve that reference pictures are developed with."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.reference.curve import matched_stops, picture_of, radiance_of


def test_black_is_black_and_much_light_is_white() -> None:
    """The curve begins at 0 and ends at 255, and never falls."""
    light = np.concatenate([[0.0], np.geomspace(1e-4, 100.0, 500)])
    values = picture_of(light)
    assert values[0] == 0
    assert values[-1] == 255
    assert (np.diff(values.astype(int)) >= 0).all()


@given(st.floats(-2.0, 2.0))
def test_a_developed_picture_tells_its_radiance(stops: float) -> None:
    """Back from eight bits radiance is within 1 % where the curve is steep."""
    picture = np.arange(60, 231, dtype=np.uint8)
    radiance = radiance_of(picture, stops)
    assert np.array_equal(picture_of(radiance, stops), picture)
    step = np.diff(radiance_of(np.arange(60, 232, dtype=np.uint8), stops)) / radiance
    assert (step / 2.0 < 0.025).all()


@given(st.floats(-5.0, 5.0))
def test_the_exposure_of_a_picture_is_found(stops: float) -> None:
    """Radiance developed at some exposure is matched at that exposure."""
    radiance = np.random.default_rng(3).gamma(1.0, 0.3, (24, 32, 3)) * 2.0**-stops
    assert matched_stops(radiance, picture_of(radiance, stops)) == pytest.approx(stops, abs=0.02)
