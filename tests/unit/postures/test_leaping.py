"""Leaps: bodies in the air fall as thrown ones do, and down is up backwards."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.postures.leaping import Leap

UP = Leap(ahead_m=0.6, up_m=0.43, arc_m=0.12)
STEP_S = 1.0 / 240.0


def path(leap: Leap) -> np.ndarray:
    """(T, 2): how far ahead and above it is at each step [m]."""
    times = np.arange(0.0, leap.duration_s, STEP_S)
    return np.array([(now.ahead_m, now.above_m) for now in map(leap.at, times.tolist())])


def test_a_leap_leads_from_one_end_to_the_other() -> None:
    for leap, begin, end in (
        (UP, (0.0, 0.0), (0.6, 0.43)),
        (Leap(ahead_m=0.6, up_m=0.43, arc_m=0.12, down=True), (0.0, 0.43), (0.6, 0.0)),
    ):
        first, last = leap.at(0.0), leap.at(leap.duration_s)
        assert (first.ahead_m, first.above_m) == pytest.approx(begin)
        assert (last.ahead_m, last.above_m) == pytest.approx(end)
        for still in (first, last):
            assert np.abs([still.pitch_deg, still.crouch, *np.ravel(still.offsets)]).max() < 1e-9


@pytest.mark.parametrize("down", [False, True])
def test_in_the_air_it_falls_as_a_thrown_body_does(down: bool) -> None:
    places = path(Leap(ahead_m=0.6, up_m=0.43, arc_m=0.12, down=down))
    flies = (places[2:, 0] > 0.0) & (places[:-2, 0] < 0.6)
    flies &= (places[:-2, 0] > 0.0) & (places[2:, 0] < 0.6)
    assert flies.sum() > 50
    accelerations = np.diff(places, 2, axis=0)[flies] / STEP_S**2
    assert np.abs(accelerations - [0.0, -9.81]).max() < 1e-6


def test_down_is_up_backwards_with_the_other_legs() -> None:
    down = Leap(ahead_m=0.6, up_m=0.43, arc_m=0.12, down=True)
    for time_s in np.linspace(0.0, UP.duration_s, 40).tolist():
        one, other = UP.at(time_s), down.at(UP.duration_s - time_s)
        assert other.ahead_m == pytest.approx(0.6 - one.ahead_m)
        assert other.above_m == pytest.approx(one.above_m)
        assert other.pitch_deg == pytest.approx(-one.pitch_deg)
        fore, hind = one.offsets
        swapped = ((hind.up, -hind.ahead), (fore.up, -fore.ahead))
        assert np.ravel(other.offsets) == pytest.approx(np.ravel(swapped))
