"""Scenes begin at rest: what stands still sleeps from the first step on."""

from __future__ import annotations

import numpy as np

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.physics_check import shifts
from sailenv_ros.world.placement import Placement
from tests.support.simple_solids import UNIT_BALL, UNIT_BOX, placed
from tests.unit.world.test_world import make_world


def floor() -> Placement:
    """A static cube whose top is the plane z = 0."""
    return placed("floor", (0.0, 0.0, -5.0), asset=UNIT_BOX, static=True, scale=(10.0, 10.0, 10.0))


def test_what_stands_never_moves_and_what_hangs_in_the_air_falls() -> None:
    """A pile keeps its very poses; a ball above it falls as it would have."""
    pile = [placed(f"box {n}", (0.0, 0.0, 0.5 + n), asset=UNIT_BOX) for n in range(3)]
    ball = placed("ball", (3.0, 0.0, 3.0), asset=UNIT_BALL)
    world = make_world(floor(), *pile, ball)
    first = world.snapshot().world_from_body
    np.testing.assert_array_equal(first[1:5, :3, 3], [p.pose.position_m for p in (*pile, ball)])
    world.step(1)
    after = world.snapshot().world_from_body
    np.testing.assert_array_equal(after[:4], first[:4])
    # One step of the engine: v = g dt, then x = v dt.
    np.testing.assert_allclose(after[4, 2, 3], 3.0 - 9.81 / 240**2, rtol=0, atol=1e-12)
    world.step(480)
    np.testing.assert_array_equal(world.snapshot().world_from_body[:4], first[:4])


def test_what_is_hit_wakes_up() -> None:
    """A ball that is thrown at a sleeping box pushes it away."""
    box = placed("box", (0.0, 0.0, 0.5), asset=UNIT_BOX)
    ball = placed("ball", (-3.0, 0.0, 0.5), asset=UNIT_BALL, linear_velocity=(6.0, 0.0, 0.0))
    world = make_world(floor(), box, ball)
    world.step(240)
    assert world.object_state(2).pose.position_m[0] > 0.1


def test_what_its_support_leaves_wakes_up() -> None:
    """The upper of two boxes falls when the lower one is taken away."""
    boxes = [placed(f"box {n}", (0.0, 0.0, 0.5 + n), asset=UNIT_BOX) for n in range(2)]
    world = make_world(floor(), *boxes)
    world.step(10)
    world.despawn(2)
    world.step(240)
    assert abs(world.object_state(3).pose.position_m[2] - 0.5) < 0.01


def test_the_check_of_a_scene_wakes_what_sleeps() -> None:
    """A slow creep that the trial does not see is told by the check, which looks for 2 s."""
    steady = placed("box", (0.0, 0.0, 0.5), asset=UNIT_BOX)
    world = make_world(floor(), steady)
    assert list(shifts(world)) == []
    assert world.step_count == 480


def test_a_high_pile_stands_firmly_while_it_is_awake() -> None:
    """Ten cubes of 30 cm, one upon another, get less than 2 mm away within ten seconds."""
    pile = [
        placed(f"cube {n}", (0.0, 0.0, 0.3 * (n + 0.5)), asset=UNIT_BOX, scale=(0.3, 0.3, 0.3))
        for n in range(10)
    ]
    world = make_world(floor(), *pile)
    first = world.snapshot().world_from_body[1:, :3, 3]
    for body in world.bodies:
        body.wake()
    world.step(2400)
    away = np.linalg.norm(world.snapshot().world_from_body[1:, :3, 3] - first, axis=1)
    assert away.max() < 0.002


def test_what_is_light_bears_what_is_heavy() -> None:
    """A cube of 100 g under one of 50 kg sinks into the floor by less than 5 mm in five seconds."""
    small = (0.2, 0.2, 0.2)
    light = placed("light", (0.0, 0.0, 0.1), asset=UNIT_BOX, scale=small, mass_kg=0.1)
    heavy = placed("heavy", (0.0, 0.0, 0.3), asset=UNIT_BOX, scale=small, mass_kg=50.0)
    world = make_world(floor(), light, heavy)
    for body in world.bodies:
        body.wake()
    world.step(1200)
    heights = world.snapshot().world_from_body[1:, 2, 3]
    assert heights[0] > 0.1 - 0.005
    assert heights[1] > 0.3 - 0.005


def test_what_sleeps_follows_a_gravity_that_is_changed() -> None:
    """What sleeps falls by a gravity that was changed meanwhile, as soon as it wakes."""
    world = make_world(floor(), placed("box", (0.0, 0.0, 0.5), asset=UNIT_BOX))
    world.step(480)
    world.set_gravity((0.0, 0.0, 2.0))
    world.step(120)
    rise = 2.0 / 240**2 * 120 * 121 / 2
    np.testing.assert_allclose(world.object_state(2).pose.position_m[2], 0.5 + rise, atol=1e-4)


def test_what_a_request_has_put_somewhere_has_not_settled_for_half_a_second() -> None:
    """What is seen of it then depends on the world alone, not on which frames were rendered."""
    ball = placed("ball", (0, 0, 1), gravity=False, asset=UNIT_BALL)
    world = make_world(ball, placed("other", (3, 0, 1), gravity=False, asset=UNIT_BALL))
    assert not world.snapshot().moving.any()
    world.step(10)
    world.put_body(1, Pose((0, 1, 1)))
    assert world.snapshot().moving.tolist() == [True, False]
    world.step(119)
    assert world.snapshot().moving.tolist() == [True, False]
    world.step(1)
    assert not world.snapshot().moving.any()
    spawned = world.spawn(placed("third", (0, 0, 3), gravity=False, asset=UNIT_BALL))
    assert world.snapshot().moving.tolist() == [False, False, True]
    world.step(120)
    assert not world.snapshot().moving.any()
    assert spawned == 3
    world.close()
