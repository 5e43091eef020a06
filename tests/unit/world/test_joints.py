"""Joints against arithmetic: hinges and slides that are pushed, held, driven, carried and asked."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.world import World
from tests.support.plain_doors import DOOR_INERTIA, DOOR_KG, door, joined
from tests.support.simple_solids import UNIT_BALL, placed
from tests.unit.world.test_world import make_world

STEP_S = 1.0 / 240.0
LIMITS = {"limits": [-1.0, 1.5]}


def position(world: World, instance_id: int = 1) -> float:
    """Position of an object's joint."""
    state = world.joint(instance_id)
    assert state is not None
    return state.position


def rate(world: World, instance_id: int = 1) -> float:
    """Velocity of an object's joint."""
    state = world.joint(instance_id)
    assert state is not None
    return state.velocity


def push(world: World, instance_id: int = 1, **parameters: Any) -> None:
    """Let a wrench act from the next step but one on."""
    wrench = start_behaviour("wrench", parameters, seed=0, object_name="it", place=0)
    wrench.start_s = world.step_count * STEP_S
    world.body(instance_id).push(wrench)


def turned(x: float, y: float, angle: float) -> tuple[float, float]:
    """A point turned about the vertical."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return x * cosine - y * sine, x * sine + y * cosine


def test_a_twist_gives_a_door_torque_over_inertia() -> None:
    """0.1 s of 5 N m about the hinge's axis, without friction: ω = M t / I."""
    world = make_world(door())
    push(world, torque=[0, 0, 5.0], duration=0.1)
    world.step(40)
    assert rate(world) == pytest.approx(5.0 * 0.1 / DOOR_INERTIA, rel=1e-9)


def test_a_push_at_the_handle_is_a_lever() -> None:
    """10 N across the leaf, 0.7 m from the hinge, in one step: 7 N m."""
    world = make_world(door())
    push(world, force=[0, 10.0, 0], point=[0.3, 0, 0], duration=STEP_S)
    world.step(3)
    assert rate(world) == pytest.approx(7.0 * STEP_S / DOOR_INERTIA, rel=1e-6)


def test_friction_stops_a_door_where_arithmetic_says() -> None:
    """From 1 rad/s with 4 N m: it turns by ω² I / (2 M), within a step's way, and stays there."""
    world = make_world(door(spec={"velocity": 1.0, "friction": 4.0}))
    world.step(480)
    way = 0.5 * DOOR_INERTIA / 4.0
    assert position(world) == pytest.approx(way, abs=STEP_S)
    assert rate(world) == 0.0
    rests = world.snapshot().world_from_body.copy()
    world.step(240)
    np.testing.assert_array_equal(world.snapshot().world_from_body, rests)


def test_damping_takes_speed_off_by_an_exponential() -> None:
    """ω = ω0 exp(-d t / I), to the integrator's order."""
    world = make_world(door(spec={"velocity": 1.0, "damping": 4.0}))
    world.step(120)
    assert rate(world) == pytest.approx(math.exp(-4.0 * 0.5 / DOOR_INERTIA), rel=2e-3)


def test_limits_hold_exactly_and_nothing_bounces() -> None:
    """A door that swings with 3 rad/s ends at its limit, at rest."""
    world = make_world(door(spec={"velocity": 3.0, **LIMITS}))
    furthest = 0.0
    for _ in range(240):
        world.step()
        furthest = max(furthest, position(world))
    assert furthest == 1.5
    assert (position(world), rate(world)) == (1.5, 0.0)


@pytest.mark.parametrize(("held", "falls"), [(1.05, False), (0.95, True)])
def test_friction_above_the_weight_holds_a_flap(held: float, falls: bool) -> None:
    """A leaf on a level hinge: its weight at half its width is held by as much torque."""
    weight = DOOR_KG * 9.81 * 0.4
    flap = door(spec={"axis": [0, 1, 0], "friction": held * weight, "limits": [-0.1, 1.5]})
    world = make_world(flap)
    world.step(240)
    assert (position(world) > 0.05) == falls
    if not falls:
        assert position(world) == 0.0


def test_a_slide_falls_as_free_bodies_do() -> None:
    """An upright slide without friction: semi-implicit Euler of free fall."""
    world = make_world(joined("lift", {"type": "slide", "friction": 0.0}, mass_kg=3.0))
    world.step(60)
    assert position(world) == pytest.approx(-9.81 / 240**2 * 60 * 61 / 2, rel=1e-9)


def test_poses_are_those_of_the_joint() -> None:
    """Hinge: R(q)(x - o) + o. Slide: x + a q. At 0 the pose is to the bit what was given."""
    pose = Pose.from_rpy_deg((1.0, 2.0, 3.0), (0, 0, 90))
    world = make_world(
        door(pose=pose, spec=LIMITS),
        joined("drawer", {"type": "slide", "axis": [2, 0, 0], "limits": [0, 0.5]}, pose),
    )
    np.testing.assert_array_equal(world.snapshot().world_from_body[0], pose.matrix())
    world.set_joint(1, 0.7)
    world.set_joint(2, 0.3)
    leaf, drawer = world.snapshot().world_from_body
    x, y = turned(0.4, 0.0, 0.7)
    # The pose's quarter turn takes x to y, and y to -x.
    np.testing.assert_allclose(leaf[:3, 3], (1.0 - y, 2.0 + x - 0.4, 3.0), atol=1e-14)
    angle = math.pi / 2 + 0.7
    np.testing.assert_allclose(leaf[:2, 0], (math.cos(angle), math.sin(angle)), atol=1e-14)
    np.testing.assert_allclose(drawer[:3, 3], (1.0, 2.3, 3.0), atol=1e-14)


def test_velocities_are_the_derivative_of_poses() -> None:
    """Of an arm on an arm on a slide: central differences of poses, 1e-7 apart."""
    arm = {"type": "hinge", "origin": [-0.5, 0.1, 0], "friction": 0.0}
    tilted = Pose.from_rpy_deg((0.5, 0.2, 0.1), (20, 30, 40))
    world = make_world(
        joined("rail", {"type": "slide", "axis": [1, 1, 0], "friction": 0.0}),
        joined("upper", {**arm, "axis": [0, 1, 1]}, tilted, "rail"),
        joined("lower", {**arm, "axis": [1, 0, 0.3]}, tilted, "upper"),
        gravity=(0.0, 0.0, 0.0),
    )
    bodies = [world.body(number) for number in (1, 2, 3)]
    at, rates = (0.2, 0.5, -0.4), (0.3, -0.7, 1.1)

    def place(offset: float) -> Any:
        for body, q, speed in zip(bodies, at, rates, strict=True):
            assert isinstance(body, JointedBody)
            assert body.tree is not None
            body.tree.set(body.link, q + offset * speed, speed)
        return [body.world_from_body() for body in bodies]

    h = 1e-6
    before, after = place(-h), place(h)
    here = place(0.0)
    for body, first, last, now in zip(bodies, before, after, here, strict=True):
        linear, angular = body.origin_velocity(now)
        np.testing.assert_allclose(linear, (last - first)[:3, 3] / (2 * h), atol=1e-9)
        spin = (last - first)[:3, :3] / (2 * h) @ now[:3, :3].T
        np.testing.assert_allclose(angular, (spin[2, 1], spin[0, 2], spin[1, 0]), atol=1e-9)


def test_the_engine_and_our_arithmetic_agree_on_a_chain() -> None:
    """Of three links that swing, the engine's own link frames are ours but for rounding."""
    arm = {"type": "hinge", "origin": [-0.5, 0.1, 0], "friction": 0.0, "axis": [0, 1, 0.2]}
    tilted = Pose.from_rpy_deg((0.9, 0.2, 0.1), (20, 30, 40))
    world = make_world(
        joined("a", arm, tilted), joined("b", arm, tilted, "a"), joined("c", arm, tilted, "b")
    )
    world.step(100)
    assert min(abs(position(world, number)) for number in (1, 2, 3)) > 0.1
    for number in (1, 2, 3):
        body = world.body(number)
        state = world.client.getLinkState(body.bullet_id, body.link, 0, 1)
        ours = body.world_from_body()
        origin = ours[:3, :3] @ (-0.5, 0.1, 0) + ours[:3, 3]
        np.testing.assert_allclose(state[4], origin, atol=1e-7)
        turn = Pose((0, 0, 0), state[5]).matrix()[:3, :3]
        np.testing.assert_allclose(turn, ours[:3, :3], atol=1e-7)


def test_a_motion_ends_exactly_and_on_time() -> None:
    """Half way at half the time, as least jerk does, there at the end, and at rest."""
    world = make_world(door(spec={**LIMITS, "effort": 200.0, "friction": 1.0}))
    world.set_joint(1, 1.0, 2.0)
    assert position(world) == 0.0
    world.step(240)
    assert position(world) == pytest.approx(0.5, abs=1e-3)
    world.step(241)
    assert (position(world), rate(world)) == (1.0, 0.0)
    world.step(100)
    assert position(world) == 1.0


def test_a_motion_has_no_more_than_its_effort() -> None:
    """What weighs more than the effort stays down; what holds a door up is pushed or holds it."""
    heavy = joined("lift", {"type": "slide", "effort": 20.0, "limits": [0, 1]}, mass_kg=3.0)
    world = make_world(heavy)
    world.set_joint(1, 0.5, 1.0)
    world.step(300)
    assert position(world) < 0.01
    wall = placed("wall", (0, 0.72, 0), static=True)  # 0.2 m beside the leaf
    world = make_world(door(spec={"limits": [0, 1.5]}), wall)
    world.set_joint(1, 1.4, 1.0)
    world.step(300)
    assert 0.2 < position(world) < 0.3


def test_a_ball_pushes_a_door_open_and_keeps_momentum() -> None:
    """Angular momentum about the hinge before and after a ball has struck, with no friction."""
    ball = placed(
        "ball", (0.2, -1.0, 0), asset=UNIT_BALL, scale=(0.2, 0.2, 0.2), mass_kg=2.0,
        gravity=False, linear_velocity=(0.0, 3.0, 0.0), friction=0.0,
    )  # fmt: skip
    world = make_world(door(spec=LIMITS, friction=0.0), ball)
    world.step(100)
    assert rate(world) > 0.1
    state = world.object_state(2)
    x, y = state.pose.position_m[0] + 0.4, state.pose.position_m[1]
    vx, vy, _ = state.linear_velocity
    after = DOOR_INERTIA * rate(world) + 2.0 * (x * vy - y * vx)
    assert after == pytest.approx(2.0 * 0.6 * 3.0, rel=2e-3)


def test_a_sleeping_door_wakes_when_it_is_struck() -> None:
    """A door at rest sleeps and keeps its pose to the bit; a ball wakes it."""
    ball = placed("ball", (0.2, -1.0, 0), asset=UNIT_BALL, scale=(0.2, 0.2, 0.2), gravity=False)
    world = make_world(door(spec={"friction": 1.0, **LIMITS}), ball)
    rests = world.snapshot().world_from_body[0].copy()
    world.step(1000)
    np.testing.assert_array_equal(world.snapshot().world_from_body[0], rests)
    push(world, 2, force=[0, 60.0, 0], duration=0.2)
    world.step(200)
    assert position(world) > 0.05


def test_what_is_carried_follows_its_parent() -> None:
    """A cabinet that is moved takes its door, and the knob on that, along, opened as they are."""
    half = Pose((0.0, 0.02, 0.0))
    world = make_world(
        placed("cabinet", (5, 0, 0), static=True),
        door(parent="cabinet", spec=LIMITS),
        joined("knob", {"type": "fixed"}, half, "door", scale=(0.02, 0.02, 0.02)),
    )
    world.set_joint(2, 0.5)
    before = world.snapshot()
    moved = Pose.from_rpy_deg((1.0, -2.0, 0.5), (0, 0, 30))
    shift = moved.matrix() @ np.linalg.inv(before.world_from_body[0])
    world.put_body(1, moved, teleport=True)
    now = world.snapshot()
    np.testing.assert_allclose(now.world_from_body, shift @ before.world_from_body, atol=1e-14)
    assert (now.histories != before.histories).all()
    world.step(10)
    np.testing.assert_array_equal(world.snapshot().world_from_body, now.world_from_body)
    assert [d.instance.parent for d in world.contents.instances] == [0, 1, 2]


def test_requests_that_cannot_be_done_change_nothing() -> None:
    """Beyond limits, no number, no joint, fixed, joints to what moves, moves beside a joint."""
    world = make_world(
        placed("cabinet", (5, 0, 0), static=True),
        door(parent="cabinet", spec=LIMITS),
        joined("knob", {"type": "fixed"}, parent="door"),
    )
    before = world.snapshot()
    for wrong in (1.6, -1.1, math.nan, math.inf):
        with pytest.raises(InvalidRequest, match=r"-1 to 1\.5"):
            world.set_joint(2, wrong)
    with pytest.raises(InvalidRequest, match="seconds"):
        world.set_joint(2, 1.0, -1.0)
    with pytest.raises(InvalidRequest, match="fixed"):
        world.set_joint(3, 0.1)
    with pytest.raises(InvalidRequest, match="one on a joint: door"):
        world.set_joint(1, 0.1)
    with pytest.raises(InvalidRequest, match="set_joint_position"):
        world.put_body(2, Pose())
    with pytest.raises(InvalidRequest, match="carries 'door'"):
        world.despawn(1)
    with pytest.raises(UnknownName, match="wardrobe"):
        world.spawn(door("other", parent="wardrobe"))
    loose = world.spawn(placed("box", (0, 0, 50)))
    with pytest.raises(InvalidRequest, match="static or has a joint"):
        world.spawn(door("other", parent="box"))
    world.despawn(loose)
    np.testing.assert_array_equal(world.snapshot().world_from_body, before.world_from_body)
    assert [body.placement.name for body in world.bodies] == ["cabinet", "door", "knob"]


def test_objects_come_and_go_on_joints_that_move() -> None:
    """A knob on a door that swings: the door keeps position and speed; gone, it is as before."""
    world = make_world(door(spec={"velocity": 0.5, "friction": 0.0}))
    world.step(24)
    at, speed = position(world), rate(world)
    knob = world.spawn(joined("knob", {"type": "fixed"}, Pose((0.3, 0.1, 0)), "door", mass_kg=0.1))
    assert (position(world), rate(world)) == (at, speed)
    world.step(24)
    assert position(world) == pytest.approx(at + 0.5 * 24 * STEP_S, rel=0.05)
    world.despawn(knob)
    world.step(1)
    assert rate(world) == pytest.approx(0.5, rel=0.05)


def test_contacts_name_what_moves_on_joints() -> None:
    """Of a tree of two, the one that is touched."""
    ball = placed("ball", (0.2, -0.6, 0), asset=UNIT_BALL, scale=(0.2, 0.2, 0.2), gravity=False,
                  linear_velocity=(0.0, 3.0, 0.0))  # fmt: skip
    far = joined("sign", {"type": "fixed"}, Pose((0, 0, 5)), "door")
    world = make_world(door(spec=LIMITS), far, ball)
    world.contacts()
    world.step(60)
    assert {(c.first, c.second) for c in world.contacts(1.0)} == {(1, 3)}


def test_two_runs_are_equal_byte_for_byte() -> None:
    """Doors, balls and motions, 400 steps."""

    def run() -> bytes:
        ball = placed("ball", (0.2, -1.0, 0), asset=UNIT_BALL, scale=(0.2, 0.2, 0.2),
                      linear_velocity=(0.0, 3.0, 2.0))  # fmt: skip
        chain = joined("flap", {"type": "hinge", "axis": [1, 0, 0]}, Pose((0, 0, 1)), "door")
        world = make_world(door(spec=LIMITS), chain, ball)
        world.step(100)
        world.set_joint(1, 1.2, 1.0)
        world.step(300)
        return world.states().positions.tobytes() + world.states().orientations.tobytes()

    assert run() == run()


def test_open_and_close_goes_between_the_limits() -> None:
    """From one limit to the other and back in a period, as a cosine."""
    swing = start_behaviour("open_and_close", {"period": 2.0}, seed=0, object_name="door", place=0)
    limits = {"limits": [0.0, 1.5], "effort": 1000.0}
    world = make_world(door(spec=limits, behaviours=(swing,)))
    for steps, share in ((120, 0.5), (120, 1.0), (120, 0.5), (120, 0.0)):
        world.step(steps)
        assert position(world) == pytest.approx(1.5 * share, abs=0.02)
    world.body(1).detach()
    world.step(240)
    assert rate(world) == pytest.approx(0.0, abs=1e-3)


def test_velocities_of_behaviours_count_along_the_joint() -> None:
    """What turns freely at 45 deg/s about all axes turns on a hinge about that alone."""
    turn = start_behaviour(
        "rotate_rigidbody", {"angular_velocity": [45, 45, 45]}, seed=0, object_name="it", place=0
    )
    world = make_world(door(spec={"effort": 1e4}, behaviours=(turn,)))
    world.step(240)
    assert position(world) == pytest.approx(math.pi / 4, rel=0.01)


def test_a_pose_is_that_of_its_joint_whoever_moves_it() -> None:
    """After steps, between a step and a state that is restored, and after it was set."""
    world = make_world(door(spec={"velocity": 1.0, "friction": 0.0}))
    body = world.body(1)
    assert isinstance(body, JointedBody)

    def pose_is_right() -> bool:
        angle = body.joint_state()[0]
        return body.pose().rpy_deg[2] == pytest.approx(math.degrees(angle), abs=1e-9)

    world.step(24)
    assert pose_is_right()
    first = body.joint_state()
    state = world.client.saveState()
    for _ in range(24):
        world.client.stepSimulation()
    assert body.joint_state()[0] > first[0] + 0.05
    assert pose_is_right()
    world.client.restoreState(state)
    assert body.joint_state() == first
    assert pose_is_right()
    world.step(1)
    assert pose_is_right()
    body.set_joint(0.5, 0.0, 0.0)
    assert body.joint_state()[0] == 0.5
    assert pose_is_right()
