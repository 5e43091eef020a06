"""How simulated time follows a wall clock that the test holds in its hand."""

import pytest

from sailenv_ros.simulation.pacing import MAX_LAG_S, Pacer


class Clock:
    """A wall clock that moves when it is told to."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def test_a_second_of_wall_time_is_240_steps_times_the_factor() -> None:
    """Half speed gives half the steps."""
    clock = Clock()
    pacer = Pacer(0.5, clock)
    pacer.restart(1000)
    step = 1000
    for _ in range(10):
        clock.now_s += 0.1
        step = pacer.target(step)
    assert step == 1000 + 120


def test_what_lies_too_far_back_is_given_up_and_counted() -> None:
    """After a stall the simulation catches up a quarter of a second instead of racing."""
    clock = Clock()
    pacer = Pacer(1.0, clock)
    clock.now_s += MAX_LAG_S + 1.0
    assert pacer.target(0) == 60
    assert pacer.lost_s == pytest.approx(1.0, abs=0.01)
    clock.now_s += 0.1
    assert pacer.target(60) == 84


def test_waiting_ends_when_the_step_is_due() -> None:
    """24 steps ahead is 0.1 s at full speed; what is past needs no waiting."""
    clock = Clock()
    pacer = Pacer(1.0, clock)
    assert pacer.wait_s(24) == pytest.approx(0.1)
    clock.now_s += 1.0
    assert pacer.wait_s(24) == 0.0
