"""The world: physics against closed forms, ids, snapshots, histories, determinism."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest, NameTaken, PhysicsError
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Category, CategoryTable
from sailenv_ros.types.model import BoxShape, TriangleShape
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World
from tests.support.simple_solids import UNIT_BALL, placed, solid

CATEGORIES = CategoryTable([Category(id=1, name="solid", colour=(200, 30, 30))])


def make_world(*placements: Any, **kwargs: Any) -> World:
    return World(
        scene="test",
        epoch=1,
        placements=placements,
        movers=[Mover(name="mover", start=Pose(), track=None, controller="rigidbody")],
        categories=CATEGORIES,
        **kwargs,
    )


def height(world: World, row: int = 0) -> float:
    return float(world.snapshot().world_from_body[row, 2, 3])


def test_a_body_falls_as_the_integrator_says() -> None:
    """Semi-implicit Euler: after n steps z = z0 - g h² n (n + 1) / 2."""
    world = make_world(placed("ball", (0, 0, 10), asset=UNIT_BALL))
    steps = 120
    world.step(steps)
    fallen = 9.81 / 240**2 * steps * (steps + 1) / 2
    assert 10 - height(world) == pytest.approx(fallen, rel=1e-9)
    assert world.sim_time_ns == 500_000_000


def test_time_does_not_drift() -> None:
    """Simulated time is counted in steps: 240 of them are a second, whatever the rounding."""
    world = make_world()
    world.step(1)
    assert world.sim_time_ns == 4_166_666
    world.step(239)
    assert world.sim_time_ns == 1_000_000_000


def test_a_body_without_gravity_floats() -> None:
    """gravity=False gives the weight back: it stays where it is to rounding."""
    world = make_world(placed("floater", (0, 0, 3), gravity=False, mass_kg=7.0))
    world.step(480)
    assert height(world) == pytest.approx(3.0, abs=1e-9)


def test_a_box_comes_to_rest_on_the_floor() -> None:
    """A unit box dropped on a slab ends with its centre half a metre above it."""
    floor = solid(BoxShape(half_extents_m=(5, 5, 0.5), centre_m=(0, 0, -0.5)))
    world = make_world(placed("floor", asset=floor, static=True), placed("box", (0, 0, 1.0)))
    world.step(480)
    assert height(world, 1) == pytest.approx(0.5, abs=2e-3)


POST = solid(
    BoxShape(half_extents_m=(0.5, 0.5, 1.0), centre_m=(0, 0, 1)), centre_of_mass_m=(0, 0, 1)
)
"""A box whose centre of mass is not its origin."""
TURNED = Pose.from_rpy_deg((1, 2, 3), (20, 30, 40))


def test_a_displaced_centre_of_mass_leaves_the_body_frame_alone() -> None:
    """Poses are of the body frame, wherever the centre of mass lies, also when turned."""
    world = make_world(placed("post", asset=POST, pose=TURNED, gravity=False))
    np.testing.assert_allclose(world.snapshot().world_from_body[0], TURNED.matrix(), atol=1e-12)
    moved = Pose.from_rpy_deg((-1, 0, 2), (0, 80, 10))
    world.put_body(1, moved)
    np.testing.assert_allclose(world.snapshot().world_from_body[0], moved.matrix(), atol=1e-12)


def test_states_are_those_of_the_snapshot_and_velocities_their_differences() -> None:
    """The same matrices bit for bit; the origin's velocity is not that of the centre of mass."""
    spin = {"linear_velocity": (0.5, -1.0, 2.0), "angular_velocity": (0.3, 2.0, -1.0)}
    thrown = replace(placed("post", asset=POST, pose=TURNED, gravity=False), **spin)
    slab = replace(placed("slab", (5, 0, 0), static=True), scale=(2.0, 2.0, 2.0))
    world = make_world(thrown, slab)
    world.step(3)
    before = world.states()
    assert before is world.states()
    assert before.matrices.tobytes() == world.snapshot().world_from_body.tobytes()
    assert before.ids.tolist() == [1, 2]
    assert before.scales.tolist() == [[1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]
    assert before.histories.tolist() == world.snapshot().histories.tolist()
    assert not before.linear_velocities[1].any()
    assert not before.angular_velocities[1].any()
    np.testing.assert_allclose(before.angular_velocities[0], (0.3, 2.0, -1.0), atol=0.02)
    world.step(1)
    after = world.states()
    speed = (after.positions[0] - before.positions[0]) * 240
    mean = 0.5 * (before.linear_velocities[0] + after.linear_velocities[0])
    np.testing.assert_allclose(speed, mean, atol=2e-3)
    world.put_body(1, Pose((0, 0, 1)), teleport=True)
    put = world.states()
    assert put.histories[0] != after.histories[0]
    assert put.positions[0].tolist() == [0.0, 0.0, 1.0]
    assert not put.linear_velocities.any()


def test_a_rotating_body_turns_at_the_rate_asked() -> None:
    """rotate_rigidbody with 90 deg/s about z: a quarter turn in a second."""
    spin = start_behaviour(
        "rotate_rigidbody", {"angular_velocity": [0, 0, 90]}, seed=0, object_name="box", place=0
    )
    world = make_world(placed("box", gravity=False, behaviours=(spin,)))
    world.step(240)
    yaw = Pose.from_matrix(world.snapshot().world_from_body[0]).rpy_deg[2]
    assert yaw == pytest.approx(90.0, abs=0.1)
    assert world.moving_ids == {1}


def test_ids_count_from_one_and_are_never_used_again() -> None:
    """A despawned object's id stays free for ever; the next gets a new one."""
    world = make_world(placed("a"), placed("b", (3, 0, 0)))
    assert world.contents.instance_ids.tolist() == [1, 2]
    world.despawn(2)
    assert world.spawn(placed("b", (3, 0, 0))) == 3
    assert world.contents.instance_ids.tolist() == [1, 3]
    assert world.contents.category_of_instance[3] == 1
    assert world.contents.category_of_instance[2] == 0


def test_a_refused_spawn_changes_nothing() -> None:
    """A second object of one name is refused and the world is as before."""
    world = make_world(placed("a"))
    contents, snapshot = world.contents, world.snapshot()
    with pytest.raises(
        NameTaken, match="object name must be a name that is not in use yet, got 'a'"
    ):
        world.spawn(placed("a"))
    assert world.contents is contents
    assert world.snapshot() is snapshot


def test_a_move_is_motion_but_a_teleport_cuts_the_past_off() -> None:
    """Histories stay equal across a move and differ after a teleport, for that object alone."""
    world = make_world(placed("a"), placed("b", (3, 0, 0)))
    before = world.snapshot().histories
    world.put_body(1, Pose((0, 0, 1)))
    assert world.snapshot().histories.tolist() == before.tolist()
    world.put_body(1, Pose((0, 0, 2)), teleport=True)
    after = world.snapshot().histories
    assert after[0] != before[0]
    assert after[1] == before[1]


def test_snapshots_are_frozen() -> None:
    """What was handed out does not change when the world goes on, nor can it be written."""
    world = make_world(placed("ball", (0, 0, 5), asset=UNIT_BALL))
    first = world.snapshot()
    copy = first.world_from_body.copy()
    world.step(24)
    assert world.snapshot() is not first
    np.testing.assert_array_equal(first.world_from_body, copy)
    with pytest.raises(ValueError, match="read-only"):
        first.world_from_body[0, 0, 3] = 1.0


def test_the_same_calls_give_the_same_bytes() -> None:
    """Two worlds of one description agree in every bit after collisions."""

    def run() -> bytes:
        floor = solid(BoxShape(half_extents_m=(5, 5, 0.5), centre_m=(0, 0, -0.5)))
        pile = [placed(f"box{i}", (0.1 * i, 0.05 * i, 1.0 + 1.1 * i)) for i in range(6)]
        world = make_world(placed("floor", asset=floor, static=True), *pile)
        world.step(600)
        result = world.snapshot().world_from_body.tobytes()
        world.close()
        return result

    assert run() == run()


def test_what_cannot_move_is_refused_a_motion() -> None:
    """Hollow geometry must be static; static objects take no behaviours."""
    hollow = solid(TriangleShape(positions=np.eye(3), triangles=np.array([[0, 1, 2]])))  # type: ignore[arg-type]
    with pytest.raises(InvalidRequest, match="hollow"):
        placed("shell", asset=hollow)
    spin = start_behaviour("rotate_rigidbody", {}, seed=0, object_name="box", place=0)
    with pytest.raises(InvalidRequest, match="behaviours"):
        placed("box", static=True, behaviours=(spin,))


def test_unequal_scale_of_a_ball_is_refused_by_name() -> None:
    """A ball stretched along one axis would collide as something else."""
    with pytest.raises(InvalidRequest, match="scale of 'egg' must be equal along x, y, z"):
        make_world(placed("egg", asset=UNIT_BALL, scale=(1, 1, 2)))


def test_a_closed_world_says_so() -> None:
    """Stepping after close is an error of ours, and close may be called twice."""
    world = make_world(placed("a"))
    world.close()
    world.close()
    with pytest.raises(PhysicsError, match="closed world"):
        world.step()


def test_what_falls_out_of_the_world_stays_at_its_edge() -> None:
    """An object 10 km below does not end the simulation: behaviours and clients see the edge."""
    turning = start_behaviour("rotate_rigidbody", {}, seed=0, object_name="ball", place=0)
    world = make_world(placed("ball", (0, 0, -9999.0), asset=UNIT_BALL, behaviours=(turning,)))
    world.step(480)
    assert height(world) < -1e4
    assert world.object_state(1).pose.position_m[2] == -1e4
