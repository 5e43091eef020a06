"""Forces and contacts against arithmetic: pushes, twists, levers; a ball that strikes a wall."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sailenv_ros.behaviours import RunningBehaviour, start_behaviour
from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import BoxShape
from sailenv_ros.world.bodies import MAX_WRENCHES
from tests.support.simple_solids import UNIT_BALL, placed, solid
from tests.unit.world.test_world import make_world

STEP_S = 1.0 / 240.0


def wrench(**parameters: Any) -> RunningBehaviour:
    """A wrench from time 0 on."""
    return start_behaviour("wrench", parameters, seed=0, object_name="box", place=0)


def test_a_push_gives_impulse_over_mass() -> None:
    """0.5 s of 6 N on 2 kg: 1.5 m/s, and no more afterwards; nothing turns."""
    world = make_world(placed("box", gravity=False, mass_kg=2.0))
    world.body(1).push(wrench(force=[6.0, 0.0, 0.0], duration=0.5))
    world.step(300)
    state = world.object_state(1)
    np.testing.assert_allclose(state.linear_velocity, (1.5, 0, 0), rtol=0, atol=1e-9)
    np.testing.assert_allclose(state.angular_velocity, 0.0, rtol=0, atol=1e-12)
    assert world.body(1).forces() == ()


def test_a_twist_gives_torque_over_inertia() -> None:
    """0.1 N m about z for 0.25 s on a cube of 2 kg with 1 m edges: I = m/6 = 1/3."""
    for turn in (0.0, 90.0):
        pose = Pose.from_rpy_deg((0, 0, 0), (turn, 0, 0))
        world = make_world(placed("box", pose=pose, gravity=False, mass_kg=2.0))
        world.body(1).push(wrench(torque=[0.0, 0.0, 0.1], duration=0.25))
        world.step(61)
        rate = world.object_state(1).angular_velocity
        np.testing.assert_allclose(rate, (0, 0, 0.1 * 0.25 * 3.0), rtol=1e-3, atol=1e-9)


def test_a_force_at_a_point_is_a_lever() -> None:
    """One step of 3 N along y at x = 0.5 m: the spin of 1.5 N m, the speed of 3 N."""
    world = make_world(placed("box", gravity=False, mass_kg=2.0))
    world.body(1).push(wrench(force=[0.0, 3.0, 0.0], point=[0.5, 0.0, 0.0], duration=STEP_S))
    world.step(2)
    state = world.object_state(1)
    np.testing.assert_allclose(state.linear_velocity, (0, 1.5 * STEP_S, 0), atol=1e-9)
    np.testing.assert_allclose(state.angular_velocity, (0, 0, 4.5 * STEP_S), rtol=1e-6, atol=1e-9)


def test_a_lever_counts_from_the_centre_of_mass() -> None:
    """A force through a centre of mass that is not the origin turns nothing."""
    lopsided = solid(BoxShape(half_extents_m=(0.5, 0.5, 0.5)), centre_of_mass_m=(0.2, 0.0, 0.0))
    world = make_world(placed("box", asset=lopsided, gravity=False, mass_kg=2.0))
    world.body(1).push(wrench(force=[0.0, 3.0, 0.0], point=[0.2, 0.0, 0.0], duration=0.1))
    world.step(30)
    np.testing.assert_allclose(world.object_state(1).angular_velocity, 0.0, atol=1e-9)


def test_what_cannot_be_pushed_is_refused() -> None:
    """Static bodies and one wrench too many; a push wakes what sleeps."""
    floor = placed("floor", (0, 0, -1.0), static=True, scale=(10.0, 10.0, 1.0))
    world = make_world(floor, placed("box", mass_kg=2.0))
    with pytest.raises(InvalidRequest, match="static"):
        world.body(1).push(wrench(force=[1.0, 0.0, 0.0]))
    for _ in range(MAX_WRENCHES):
        world.body(2).push(wrench(force=[10.0, 0.0, 0.0], duration=0.1))
    with pytest.raises(InvalidState, match="64"):
        world.body(2).push(wrench())
    world.step(60)
    assert world.object_state(2).pose.position_m[0] > 0.05
    world.body(2).push(wrench())


@pytest.mark.parametrize("value", [math.nan, math.inf, 2e6])
def test_forces_beyond_measure_are_refused(value: float) -> None:
    with pytest.raises(InvalidRequest, match="force"):
        wrench(force=[0.0, value, 0.0])


def test_a_strike_is_felt_with_its_momentum() -> None:
    """A ball of 2 kg at 3 m/s stops at a box: 6 N s along x, at the place where it touched."""
    wall = placed("wall", (0.0, 0.0, 0.0), static=True)
    ball = placed(
        "ball", (-1.5, 0, 0), asset=UNIT_BALL, gravity=False, mass_kg=2.0, linear_velocity=(3, 0, 0)
    )
    world = make_world(wall, ball)
    assert world.contacts() == ()
    world.step(30)
    assert world.contacts() == ()
    world.step(150)
    (contact,) = world.contacts(1.0)
    assert (contact.first, contact.second, contact.mover) == (1, 2, "")
    left = world.object_state(2).linear_velocity[0]
    assert contact.impulse_n_s == pytest.approx(2.0 * (3.0 - left), rel=0.02)
    np.testing.assert_allclose(contact.normal, (1.0, 0.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(contact.position_m, (-0.5, 0.0, 0.0), atol=0.03)
    assert 30 * STEP_S < contact.sim_time_ns * 1e-9 < 180 * STEP_S


def test_a_weight_presses_all_the_time() -> None:
    """What stands gives its support its weight times the time, also before it sleeps."""
    floor = placed("floor", (0, 0, -1.0), static=True, scale=(10.0, 10.0, 1.0))
    world = make_world(floor, placed("box", mass_kg=2.0))
    world.body(2).wake()
    world.contacts()
    world.step(240)
    (contact,) = world.contacts(0.5)
    assert contact.impulse_n_s == pytest.approx(2.0 * 9.81 * 0.5, rel=0.05)
    assert contact.normal[2] == pytest.approx(-1.0)


def test_a_driven_mover_feels_a_wall() -> None:
    """A mover that walks into a wall is told with the id 0 and its name."""
    world = make_world(placed("wall", (1.5, 0.0, 0.0), static=True))
    world.contacts()
    for _ in range(6):
        world.drive("mover", (2.0, 0.0, 0.0))
        world.step(60)
    (contact,) = world.contacts(1.0)
    assert (contact.first, contact.second, contact.mover) == (0, 1, "mover")
    np.testing.assert_allclose(contact.normal, (-1.0, 0.0, 0.0), atol=1e-6)
    assert contact.impulse_n_s > 0.0
