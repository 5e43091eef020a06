"""Looks that change: smoothly, from where the head is."""

from __future__ import annotations

import pytest

from sailenv_ros.postures.look import AHEAD, Look

STEP_S = 1.0 / 240.0


def test_a_look_gets_there_without_a_jump() -> None:
    wanted = Look(60.0, -20.0, 1.0, 1.0)
    now, before = AHEAD, AHEAD.within((75.0, 40.0))
    for _ in range(720):
        now = now.towards(wanted, STEP_S)
        angles = now.within((75.0, 40.0))
        assert abs(angles[0] - before[0]) < 2.0
        before = angles
    assert now == pytest.approx(wanted, abs=2e-2)
    assert before == pytest.approx((60.0, -20.0), abs=0.1)


def test_where_nobody_is_looked_at_the_head_goes_back_the_same_way() -> None:
    now = Look(60.0, 0.0, 1.0, 0.0)
    for _ in range(12):
        now = now.towards(AHEAD, STEP_S)
    assert now.left_deg == 60.0  # what is no longer wanted does not turn it
    assert 0.0 < now.within((75.0, 40.0))[0] < 60.0


def test_a_head_turns_so_far_at_most_and_rests_elsewhere() -> None:
    look = Look(170.0, 10.0, 1.0, 0.0)
    assert look.within((75.0, 40.0), (5.0, 5.0)) == (75.0, 10.0)
    assert AHEAD.within((75.0, 40.0), (5.0, -5.0)) == (5.0, -5.0)


def test_steps_of_any_length_lead_to_the_same_look() -> None:
    wanted = Look(30.0, 5.0, 1.0, 0.5)
    start = Look(-10.0, 0.0, 0.5, 0.0)
    once = start.towards(wanted, 0.1)
    twice = start.towards(wanted, 0.05).towards(wanted, 0.05)
    assert once == pytest.approx(twice, abs=1e-12)
