"""Soft closes and detents in the engine: drawers, lids, knobs and doors that are let go."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.world import World
from tests.support.plain_doors import door, joined
from tests.support.simple_solids import placed
from tests.unit.world.test_joints import position, push, rate
from tests.unit.world.test_world import make_world

SPEED, WITHIN, CLICK = 0.05, 0.08, math.radians(30.0)
SOFT = {"within": WITHIN, "speed": SPEED, "strength": 3.0}


def drawer(mass_kg: float = 4.0, **spec: Any) -> Placement:
    """A drawer that comes out by 0.5 m along x."""
    whole = {
        "type": "slide", "axis": [1, 0, 0], "limits": [0, 0.5], "friction": 2.0,
        "soft_close": SOFT, **spec,
    }  # fmt: skip
    return joined("drawer", whole, mass_kg=mass_kg, scale=(0.2, 0.2, 0.2))


def knob(**spec: Any) -> Placement:
    """A knob of 100 g that clicks each 30°; its inertia is 2.7e-5 kg m²."""
    whole = {
        "type": "hinge", "friction": 0.02, "damping": 0.02,
        "detents": {"every": CLICK, "strength": 0.05}, **spec,
    }  # fmt: skip
    return joined("knob", whole, mass_kg=0.1, scale=(0.04, 0.04, 0.04))


def watched(world: World, steps: int) -> list[tuple[float, float]]:
    """Position and velocity after each step."""
    found = []
    for _ in range(steps):
        world.step()
        found.append((position(world), rate(world)))
    return found


@pytest.mark.parametrize("mass_kg", [0.05, 4.0, 40.0])
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_drawer_that_is_slammed_arrives_slowly_and_stays_shut(
    mass_kg: float, speed: float
) -> None:
    """Whatever it weighs, and as fast as it was outside of the zone."""
    world = make_world(drawer(mass_kg, position=0.2, velocity=-speed, friction=0.0))
    seen = watched(world, 400)
    inside = next(step for step, (at, _) in enumerate(seen) if at <= WITHIN)
    assert seen[inside][1] == pytest.approx(-speed, rel=1e-6)
    end = next(step for step, (at, _) in enumerate(seen) if at == 0.0)
    assert -SPEED * (1.0 + 1e-6) <= seen[end - 1][1] < 0.0
    assert set(seen[end:]) == {(0.0, 0.0)}


def test_a_drawer_left_ajar_shuts_within_the_zone_alone() -> None:
    """With its speed: 0.07 m take 1.4 s, and a moment to get there."""
    world = make_world(drawer(position=0.07))
    world.step(int(240 * 0.07 / SPEED) - 10)
    assert 0.0 < position(world) < 0.02
    assert rate(world) == pytest.approx(-SPEED, rel=1e-6)
    world.step(60)
    assert (position(world), rate(world)) == (0.0, 0.0)
    for place in (0.0801, 0.3):
        world.set_joint(1, place)
        world.step(480)
        assert position(world) == place


def test_a_spring_is_overcome_and_stopped_by_what_is_stronger() -> None:
    """It gives way above its strength alone, and waits for what stands in its way."""
    for force, opens in ((2.9, False), (3.5, True)):
        world = make_world(drawer())
        push(world, force=[force, 0, 0], duration=0.5)
        world.step(120)
        assert (position(world) > 1e-3) == opens
    wall = placed("wall", (-0.17, 0, 0), static=True, scale=(0.2, 0.2, 0.2))
    world = make_world(drawer(position=0.07), wall)
    world.step(240)
    assert position(world) == pytest.approx(0.03, abs=1e-3)


def test_a_lid_falls_with_its_speed_once_it_is_in_the_zone() -> None:
    """Though its weight would make it faster at each step; up, it stands by itself."""
    spec = {
        "type": "hinge", "axis": [0, -1, 0], "origin": [-0.2, 0, 0], "limits": [0, 1.62],
        "friction": 0.1, "soft_close": {"within": 1.3, "speed": 0.5, "strength": 0.1},
    }  # fmt: skip
    flat = (0.4, 0.4, 0.02)
    world = make_world(joined("lid", {**spec, "position": 1.2}, mass_kg=2.0, scale=flat))
    seen = watched(world, 720)
    # One step of free fall, 13 rad/s² there, goes by before the damper is told.
    assert min(speed for _, speed in seen) > -0.5 - 13.5 / 240
    last = [speed for at, speed in seen if 0.0 < at < 0.12]
    assert len(last) > 50
    assert min(last) > -0.5 * (1.0 + 1e-6)
    assert seen[-1] == (0.0, 0.0)
    world = make_world(joined("lid", {**spec, "position": 1.6}, mass_kg=2.0, scale=flat))
    world.step(240)
    assert position(world) > 1.55


@pytest.mark.parametrize("share", [0.1, 0.45, 0.55, 1.8])
def test_a_knob_let_go_settles_in_the_nearer_detent(share: float) -> None:
    world = make_world(knob(position=share * CLICK))
    world.step(240)
    near = round(share) * CLICK
    assert position(world) == pytest.approx(near, abs=1e-3)
    world.step(240)
    assert (position(world), rate(world)) == (pytest.approx(near, abs=1e-9), 0.0)


def test_a_heavy_joint_settles_too() -> None:
    """A leaf of 20 kg, for which the strength is little: it swings about the detent, ever less."""
    world = make_world(door(spec={"position": 0.2, "detents": {"every": 0.6, "strength": 2.0}}))
    world.step(1200)
    assert (position(world), rate(world)) == (0.0, 0.0)


@pytest.mark.parametrize(("torque", "out"), [(0.045, False), (0.06, True)])
def test_more_than_the_strength_takes_a_knob_out_of_a_detent(torque: float, out: bool) -> None:
    world = make_world(knob(damping=0.0))
    push(world, torque=[0, 0, torque], duration=0.1)
    world.step(20)
    assert (abs(position(world)) > CLICK) == out
    world.step(480)
    assert rate(world) == 0.0
    clicks = position(world) / CLICK
    assert clicks == pytest.approx(round(clicks), abs=1e-3)


def test_a_magnet_catches_a_door_and_lets_go() -> None:
    """Caught in 3° of its closed end; a motion of its own is stronger."""
    catch = {"at": [0.0], "within": math.radians(3.0), "strength": 1.5}
    keys = {"limits": [0, 1.9], "friction": 0.3, "detents": catch, "effort": 100.0}
    world = make_world(door(spec={**keys, "position": 0.05}))
    world.step(480)
    assert position(world) == pytest.approx(0.0, abs=1e-9)
    world.set_joint(1, 1.0, 1.0)
    world.step(300)
    assert position(world) == 1.0
    world.set_joint(1, 0.06)
    world.step(240)
    assert position(world) == 0.06


def test_two_runs_are_equal_byte_for_byte() -> None:
    """A drawer, a knob and a catch, pushed and moved, 600 steps."""

    def run() -> bytes:
        catch = {"at": [0.0], "within": 0.05, "strength": 1.5}
        shut = door(pose=Pose((0, 3, 0)), spec={"limits": [0, 1.9], "detents": catch})
        world = make_world(drawer(position=0.3, velocity=-1.0), knob(position=0.3), shut)
        push(world, 2, torque=[0, 0, 0.1], duration=0.05)
        world.step(300)
        world.set_joint(3, 1.2, 1.0)
        world.set_joint(1, 0.06)
        world.step(300)
        return world.states().positions.tobytes() + world.states().orientations.tobytes()

    assert run() == run()


def test_outside_its_zone_a_joint_moves_as_one_that_has_none() -> None:
    """To the bit: with friction and damping, and driven."""

    def run(**keys: Any) -> list[tuple[float, float]]:
        world = make_world(drawer(position=0.2, velocity=0.5, damping=3.0, **keys))
        seen = watched(world, 120)
        world.set_joint(1, 0.45, 0.5)
        return seen + watched(world, 140)

    assert run() == run(soft_close=None)


def test_damping_is_bounded_by_the_inertia_of_shapes() -> None:
    """A knob of 2.7e-5 kg m² with a door's damping comes to rest, and does not tremble."""
    world = make_world(knob(detents=None, damping=0.3, friction=0.0, velocity=5.0))
    speeds = [speed for _, speed in watched(world, 60)]
    assert all(0.0 <= after <= before for before, after in pairwise(speeds))
    assert speeds[-1] < 1e-3
