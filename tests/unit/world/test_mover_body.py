"""Movers that are bodies against arithmetic: flight with drag, bounces, momentum, rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_motion import WaypointTrack
from sailenv_ros.world.world import World
from tests.support.plain_doors import DOOR_INERTIA, door
from tests.support.simple_solids import UNIT_BALL, placed
from tests.unit.world.test_motion import HALF_M, closed_box
from tests.unit.world.test_world import CATEGORIES
from tests.unit.world.test_wrenches import wrench

STEP_S = 1.0 / 240.0
FLOAT = {"gravity": False, "mass_kg": 0.2, "radius_m": 0.1}

Vector3 = tuple[float, float, float]


def body_world(
    *placements: Any,
    rigid: RigidBody,
    pose: Pose | None = None,
    velocity: Vector3 = (0.0, 0.0, 0.0),
    spin: Vector3 = (0.0, 0.0, 0.0),
    gravity: Vector3 = (0.0, 0.0, -9.81),
    more: tuple[Mover, ...] = (),
) -> World:
    mover = Mover(
        name="mover",
        start=pose or Pose(),
        track=None,
        controller="waypoint",
        begins_as=(rigid, (velocity, spin)),
    )
    return World(
        scene="test",
        epoch=1,
        placements=placements,
        movers=[mover, *more],
        categories=CATEGORIES,
        gravity=gravity,
    )


def where(world: World, name: str = "") -> Vector3:
    return world.mover(name).pose_at(world.sim_time_ns).position_m


def motion(world: World, name: str = "") -> tuple[Vector3, Vector3]:
    return world.mover(name).require_body().motion


# -- free flight -------------------------------------------------------------------------------


@pytest.mark.parametrize("drag", [0.0, 5e-4, 0.7, 40.0])
def test_free_flight_decays_as_the_formula_says(drag: float) -> None:
    """v = v0 exp(-kt) exactly; x = v0 (1 - exp(-kt)) / k within the way of one step."""
    rigid = RigidBody(drag_per_s=drag, **FLOAT)
    world = body_world(rigid=rigid, velocity=(1.5, -0.5, 0.25))
    world.step(480)
    share = math.exp(-2.0 * drag)
    np.testing.assert_allclose(motion(world)[0], np.array([1.5, -0.5, 0.25]) * share, rtol=1e-12)
    way = 2.0 if not drag else (1.0 - share) / drag
    off = np.subtract(where(world), np.array([1.5, -0.5, 0.25]) * way)
    assert np.abs(off).max() <= (1.0 - share) * 1.5 * STEP_S + 1e-9
    # Term by term, as the engine adds it up.
    steps = sum(math.exp(-drag * STEP_S * number) for number in range(1, 481)) * STEP_S
    np.testing.assert_allclose(where(world), np.array([1.5, -0.5, 0.25]) * steps, rtol=1e-9)
    world.close()


def test_it_falls_as_everything_does() -> None:
    """Half a second: g t, and g t²/2 within a step's way."""
    world = body_world(rigid=RigidBody(), pose=Pose((0.0, 0.0, 5.0)))
    world.step(120)
    np.testing.assert_allclose(motion(world)[0], (0, 0, -9.81 * 0.5), atol=1e-9)
    assert where(world)[2] == pytest.approx(5.0 - 9.81 * 0.125, abs=9.81 * 0.5 * STEP_S)
    world.close()


def test_a_spin_decays_on_its_own_and_turns_what_sees() -> None:
    """90°/s about z for a second without drag; with drag k the rate is exp(-k t) of it."""
    turning = (0.0, 0.0, math.pi / 2)
    world = body_world(rigid=RigidBody(**FLOAT), spin=turning)
    world.step(240)
    yaw = world.mover("").pose_at(world.sim_time_ns).rpy_deg[2]
    assert yaw == pytest.approx(90.0, abs=0.01)
    world.close()
    slowed = body_world(rigid=RigidBody(angular_drag_per_s=2.0, **FLOAT), spin=turning)
    slowed.step(240)
    np.testing.assert_allclose(motion(slowed)[1], np.multiply(turning, math.exp(-2)), rtol=1e-9)
    slowed.close()


def test_what_nothing_pushes_stands_exactly_still() -> None:
    """Its pose is the same bits after 20 s, under gravity that does not pull it."""
    start = Pose.from_rpy_deg((0.1, 0.2, 1.3), (0, 10, 20))
    world = body_world(rigid=RigidBody(**FLOAT), pose=start)
    first = world.mover("").pose_at(0)
    world.step(4800)
    assert world.mover("").pose_at(world.sim_time_ns) == first
    assert motion(world) == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    world.close()


@pytest.mark.parametrize("speed", [0.3, 0.01, 1e-4])
def test_however_slow_it_flies_it_does_not_fall_asleep(speed: float) -> None:
    world = body_world(rigid=RigidBody(**FLOAT), velocity=(speed, 0.0, 0.0))
    world.step(2400)
    assert where(world)[0] == pytest.approx(10.0 * speed, rel=1e-9)
    world.close()


def test_a_ball_on_the_floor_comes_to_rest_and_wakes() -> None:
    """It keeps its very pose; when the floor is taken away, it falls."""
    floor = placed("floor", (0, 0, -5), static=True, scale=(10.0, 10.0, 10.0))
    world = body_world(floor, rigid=RigidBody(radius_m=0.1), pose=Pose((0, 0, 0.12)))
    world.step(960)
    rests = world.mover("").pose_at(world.sim_time_ns)
    world.step(960)
    assert world.mover("").pose_at(world.sim_time_ns) == rests
    assert rests.position_m[2] == pytest.approx(0.1, abs=1e-4)
    world.despawn(1)
    world.step(120)
    assert where(world)[2] < -1.0
    world.close()


# -- wrenches ----------------------------------------------------------------------------------


def test_a_push_gives_impulse_over_mass() -> None:
    """0.5 s of 3 N on 2 kg with a torque of 0.01 N m; then it flies on."""
    rigid = RigidBody(mass_kg=2.0, radius_m=0.5, gravity=False)
    world = body_world(rigid=rigid)
    push = wrench(force=[3.0, 0.0, 0.0], torque=[0.0, 0.0, 0.01], duration=0.5)
    world.pushed("mover").push(push)
    world.step(300)
    linear, angular = motion(world)
    np.testing.assert_allclose(linear, (0.75, 0, 0), atol=1e-12)
    np.testing.assert_allclose(angular, (0, 0, 0.01 * 0.5 / (0.4 * 2.0 * 0.25)), rtol=1e-9)
    world.close()


def test_drag_holds_a_push_up() -> None:
    """F on m with drag k tends to F/m Δt / (1 - exp(-k Δt)), which is F/(m k) for short steps."""
    world = body_world(rigid=RigidBody(drag_per_s=5.0, **FLOAT))
    world.pushed("mover").push(wrench(force=[0.4, 0.0, 0.0]))
    world.step(2400)
    terminal = 0.4 / 0.2 * STEP_S / (1.0 - math.exp(-5.0 * STEP_S))
    assert motion(world)[0][0] == pytest.approx(terminal, rel=1e-9)
    assert terminal == pytest.approx(0.4 / (0.2 * 5.0), rel=0.011)
    world.close()


# -- collisions --------------------------------------------------------------------------------


@pytest.mark.parametrize("restitution", [0.0, 0.25, 0.4, 0.8, 1.0])
def test_it_bounces_as_high_as_its_restitution_says(restitution: float) -> None:
    """From 1 m onto a floor that has none of its own: to e² m, within what a step makes of it."""
    floor = placed("floor", (0, 0, -5), static=True, scale=(10.0, 10.0, 10.0))
    rigid = RigidBody(restitution=restitution, radius_m=0.1)
    world = body_world(floor, rigid=rigid, pose=Pose((0.0, 0.0, 1.1)))
    lowest = highest = 1.1
    struck = False
    for _ in range(360):
        before = motion(world)[0][2]
        world.step()
        after = motion(world)[0][2]
        if not struck and after > before + 0.1:
            struck = True
            # The speed of the strike is that of the step without the floor.
            assert after == pytest.approx(-restitution * (before - 9.81 * STEP_S), abs=1e-9)
        lowest = min(lowest, where(world)[2])
        highest = where(world)[2] if not struck else max(highest, where(world)[2])
    assert struck
    assert lowest > 0.1 - 9.81 * 0.5 * STEP_S
    assert highest - 0.1 == pytest.approx(restitution**2, abs=0.004)
    world.close()


def test_it_bounces_off_walls_however_slowly_it_comes() -> None:
    """At 0.1 m/s, half the speed from which the engine itself bounces anything."""
    wall = placed("wall", (1.0, 0.0, 0.0), static=True)
    rigid = RigidBody(restitution=0.4, **FLOAT)
    world = body_world(wall, rigid=rigid, velocity=(0.1, 0.05, 0.0))
    world.step(1200)
    np.testing.assert_allclose(motion(world)[0], (-0.04, 0.05, 0.0), atol=1e-9)
    world.close()


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_a_strike_exchanges_momentum(restitution: float) -> None:
    """Head-on at a free ball: the textbook's velocities, and the impulse that contacts tell."""
    ball = placed("ball", (1.5, 0, 0), asset=UNIT_BALL, gravity=False, mass_kg=0.5)
    rigid = RigidBody(restitution=restitution, **FLOAT)
    still = (0.0, 0.0, 0.0)
    world = body_world(ball, rigid=rigid, velocity=(2.0, 0, 0), gravity=still)
    world.contacts()
    world.step(220)
    one, two = (0.2 - restitution * 0.5) * 2 / 0.7, 0.2 * (1 + restitution) * 2 / 0.7
    np.testing.assert_allclose(motion(world)[0], (one, 0, 0), atol=1e-9)
    np.testing.assert_allclose(world.object_state(1).linear_velocity, (two, 0, 0), atol=1e-9)
    momentum = 0.2 * np.array(motion(world)[0]) + 0.5 * world.body(1).velocity()[0]
    np.testing.assert_allclose(momentum, (0.4, 0, 0), atol=1e-12)
    (contact,) = world.contacts(1.0)
    assert (contact.first, contact.second, contact.mover) == (0, 1, "mover")
    assert contact.impulse_n_s == pytest.approx(0.2 * (2.0 - motion(world)[0][0]), rel=1e-6)
    np.testing.assert_allclose(contact.normal, (-1, 0, 0), atol=1e-9)
    world.close()


def test_a_strike_beside_the_middle_keeps_momentum_and_energy() -> None:
    """A bounce of all the speed off the edge of a free box, which it turns: nothing is lost."""
    box = placed("box", (1.5, 0.3, 0.1), gravity=False, mass_kg=0.5)
    rigid = RigidBody(restitution=1.0, **FLOAT)
    world = body_world(box, rigid=rigid, velocity=(2.0, 0, 0), gravity=(0.0, 0.0, 0.0))
    world.step(220)
    linear, spin = world.body(1).velocity()
    assert abs(spin[2]) > 0.1
    own = np.array(motion(world)[0])
    np.testing.assert_allclose(0.2 * own + 0.5 * linear, (0.4, 0, 0), atol=1e-9)
    inertia = world.body(1).inertia_kg_m2  # of a cube, equal about all axes
    energy = 0.1 * own @ own + 0.25 * linear @ linear + 0.5 * inertia[0] * spin @ spin
    assert energy == pytest.approx(0.4, rel=1e-5)
    world.close()


@pytest.mark.parametrize("restitution", [0.0, 0.6, 1.0])
def test_a_strike_opens_a_door(restitution: float) -> None:
    """0.7 m from the hinge: angular momentum about it, and the speeds after, of the textbook."""
    rigid = RigidBody(mass_kg=1.0, radius_m=0.1, gravity=False, restitution=restitution)
    world = body_world(door(), rigid=rigid, pose=Pose((0.3, -1, 0)), velocity=(0, 2.0, 0))
    world.step(150)
    rate = (1 + restitution) * 1.0 * 2.0 * 0.7 / (DOOR_INERTIA + 0.49)
    assert world.joints()[0].velocity == pytest.approx(rate, rel=2e-3)
    expected = (0, 0.7 * rate - restitution * 2.0, 0)
    np.testing.assert_allclose(motion(world)[0], expected, atol=2e-3)
    world.close()


def test_two_movers_that_are_bodies_strike_each_other() -> None:
    """Equal masses and the greater restitution of 1: they exchange velocities; both are named."""
    other = Mover(
        name="other",
        start=Pose((1.0, 0, 0)),
        track=None,
        controller="rigidbody",
        begins_as=(RigidBody(restitution=0.3, **FLOAT), ((-1.0, 0, 0), (0.0, 0.0, 0.0))),
    )
    rigid = RigidBody(restitution=1.0, **FLOAT)
    world = body_world(rigid=rigid, velocity=(1.0, 0, 0), more=(other,))
    world.contacts()
    world.step(200)
    np.testing.assert_allclose(motion(world)[0], (-1.0, 0, 0), atol=1e-9)
    np.testing.assert_allclose(motion(world, "other")[0], (1.0, 0, 0), atol=1e-9)
    (contact,) = world.contacts(1.0)
    assert (contact.first, contact.second) == (0, 0)
    assert (contact.mover, contact.other_mover) == ("mover", "other")
    assert contact.normal[0] == pytest.approx(-1.0)
    assert contact.impulse_n_s == pytest.approx(0.4, rel=1e-6)
    world.close()


@pytest.mark.parametrize("velocity", [(9.0, 0, 0), (0, -9.0, 0), (0, 0, 9.0), (-5.0, 5.0, 5.0)])
def test_walls_hold_it(velocity: Vector3) -> None:
    """A bouncing ball never leaves the box, to a centimetre after the strikes."""
    rigid = RigidBody(restitution=0.9, **FLOAT)
    world = body_world(*closed_box(), rigid=rigid, velocity=velocity)
    for _ in range(60):
        world.step(8)
        assert np.abs(where(world)).max() < HALF_M
    world.step(960)
    assert np.abs(where(world)).max() < HALF_M - 0.1 + 0.01
    world.close()


# -- what is asked of it -----------------------------------------------------------------------


def test_it_is_put_turned_and_faces_things() -> None:
    """A set pose stops it, a turn does not; facing turns what sees, and ends as it is turned."""
    world = body_world(rigid=RigidBody(**FLOAT), velocity=(1.0, 0, 0))
    mover = world.mover("")
    mover.turn(0.0, math.pi / 2)
    world.step(240)
    pose = mover.pose_at(world.sim_time_ns)
    np.testing.assert_allclose((*pose.position_m, pose.rpy_deg[2]), (1, 0, 0, 90), atol=1e-6)
    mover.face(world.gaze(LookAt(point_m=(1.0, -5.0, 0.0))), world.sim_time_ns)
    assert mover.pose_at(world.sim_time_ns).rpy_deg[2] == pytest.approx(-90.0, abs=1e-6)
    mover.face(None, world.sim_time_ns)
    world.step(240)
    pose = mover.pose_at(world.sim_time_ns)
    np.testing.assert_allclose((*pose.position_m, pose.rpy_deg[2]), (2, 0, 0, -90), atol=1e-6)
    mover.hold(Pose((7.0, 0, 0)), world.sim_time_ns)
    world.step(240)
    assert mover.pose_at(world.sim_time_ns) == Pose((7.0, 0, 0))
    world.close()


def test_it_becomes_a_body_and_none_again() -> None:
    """Another body keeps its motion and its pushes; none stays where it is, and can be driven."""
    world = body_world(rigid=RigidBody(**FLOAT), velocity=(1.0, 0, 0))
    world.pushed("mover").push(wrench(force=[0.0, 0.4, 0.0]))
    world.step(25)
    assert not world.set_mover_body("mover", RigidBody(**FLOAT))
    assert world.set_mover_body("mover", RigidBody(gravity=False, mass_kg=0.4))
    before = motion(world)[0]
    world.step(24)
    np.testing.assert_allclose(motion(world)[0], np.add(before, (0, 0.1, 0)), atol=1e-9)
    assert world.set_mover_body("", None)
    stays = where(world)
    world.step(24)
    assert where(world) == stays
    assert not world.set_mover_body("", None)
    world.drive("", (1.0, 0.0, 0.0))
    world.step(24)
    assert math.dist(where(world), stays) == pytest.approx(0.1, abs=1e-6)
    world.close()


def refused(world: World, ask: Callable[[], object], error: type[Exception], words: str) -> None:
    """Check that a request is refused, and that nothing of the world is another then."""
    before = (where(world), motion(world), world.mover("").controller)
    with pytest.raises(error, match=words):
        ask()
    assert (where(world), motion(world), world.mover("").controller) == before


def test_what_a_body_cannot_do_is_refused() -> None:
    """Commands and waypoints, which would move it too; a push at what is none."""
    track = WaypointTrack(waypoints=(Pose(), Pose((1, 0, 0))), total_time_s=2.0)
    rail = Mover(name="rail", start=Pose(), track=track, controller="waypoint")
    world = body_world(rigid=RigidBody(**FLOAT), velocity=(1.0, 0, 0), more=(rail,))
    mover, body = world.mover(""), RigidBody()
    refused(world, lambda: world.drive("", (1, 0, 0)), InvalidState, "apply_wrench")
    refused(world, lambda: mover.control("waypoint", 0), InvalidState, "set_mover_body")
    refused(world, lambda: world.set_mover_body("rail", body), InvalidState, "set_mover_controller")
    refused(world, lambda: world.set_mover_body("nobody", body), UnknownName, "nobody")
    refused(world, lambda: world.pushed("rail"), InvalidState, "set_mover_body")
    refused(world, lambda: world.pushed("nobody"), UnknownName, "nobody")
    world.close()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("mass_kg", 0.0),
        ("mass_kg", -1.0),
        ("mass_kg", math.nan),
        ("radius_m", math.inf),
        ("drag_per_s", -0.1),
        ("angular_drag_per_s", math.nan),
        ("friction", -1.0),
        ("restitution", 1.1),
        ("gravity", 1),
    ],
)
def test_bodies_beyond_measure_are_refused(name: str, value: float) -> None:
    with pytest.raises(InvalidRequest, match=name):
        RigidBody(**{name: value})


def test_runs_are_the_same_bytes() -> None:
    """A pile of strikes among loose boxes, twice."""

    def run() -> bytes:
        boxes = [placed(f"box {n}", (0.8, 0.0, 1.1 * n - 1.0), mass_kg=0.3) for n in range(2)]
        rigid = RigidBody(mass_kg=0.5, restitution=0.7, friction=0.3)
        world = body_world(*closed_box(), *boxes, rigid=rigid, velocity=(4.0, 1.0, 2.0))
        world.step(480)
        found = np.array([*where(world), *motion(world)[0]]).tobytes()
        found += world.snapshot().world_from_body.tobytes()
        world.close()
        return found

    assert run() == run()
