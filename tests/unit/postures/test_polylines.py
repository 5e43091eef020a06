"""Lines with corners: places along them, and stops that are near where it turns."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.postures.polylines import Polyline

CORNER = Polyline(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]))


def test_places_and_directions_along_it() -> None:
    assert CORNER.length_m == 4.0
    assert CORNER.at(np.array([0.5, 2.0, 3.0])) == pytest.approx(
        np.array([[0.5, 0.0], [2.0, 0.0], [2.0, 1.0]])
    )
    headings = np.degrees(CORNER.headings(np.array([1.0, 2.0, 3.0])))
    assert headings == pytest.approx([0.0, 45.0, 90.0])


def test_on_a_straight_line_steps_are_equal() -> None:
    stops = Polyline(np.array([[1.0, 1.0], [1.0, 2.9]])).stops(0.5, 0.5)
    assert stops == pytest.approx([0.475, 0.95, 1.425, 1.9])


def test_steps_are_short_where_it_turns() -> None:
    stops = CORNER.stops(0.6, 0.5)
    steps = np.diff(np.concatenate([[0.0], stops]))
    assert stops[-1] == pytest.approx(4.0)
    assert steps.max() <= 0.6
    # By the middle of two stops next to each other the corner is cut by so much.
    middles = 0.5 * (CORNER.at(stops[1:]) + CORNER.at(stops[:-1]))
    cut = np.minimum(np.abs(middles[:, 1]), np.abs(middles[:, 0] - 2.0))
    assert cut.max() < 0.07
    plain = CORNER.stops(0.6, 1e9)
    middles = 0.5 * (CORNER.at(plain[1:]) + CORNER.at(plain[:-1]))
    assert np.minimum(np.abs(middles[:, 1]), np.abs(middles[:, 0] - 2.0)).max() > 0.12
