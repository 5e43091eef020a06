"""Driven movers: free ones on exact paths, others stopped by walls; never seen."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.collision_proxy import PROXY_RADIUS_M
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_motion import MoverCommand, WaypointTrack
from sailenv_ros.world.world import World
from tests.support.simple_solids import UNIT_BALL, placed
from tests.unit.world.test_motion import HALF_M, closed_box
from tests.unit.world.test_world import make_world


def drive(world: World, seconds: float, **command: tuple[float, float, float]) -> Pose:
    """Repeat a command ten times a second, as a joystick does; return the pose at the end."""
    for _ in range(round(10 * seconds)):
        world.drive("", **command)
        world.step(24)
    return world.mover("").pose_at(world.sim_time_ns)


def test_a_free_mover_walks_as_it_is_told() -> None:
    """2 s at 1.5 m/s along its yaw and 0.5 m/s up; what it looks at does not matter."""
    world = make_world(*closed_box())
    start = Pose.from_rpy_deg((-1.0, -1.0, 0.0), (0, 30, 45))
    world.mover("").hold(start, 0)
    end = drive(world, 1.0, linear_m_s=(1.5, 0.0, 0.5))
    diagonal = -1.0 + 1.5 / math.sqrt(2.0)
    assert end.position_m == pytest.approx((diagonal, diagonal, 0.5), abs=1e-6)
    assert end.orientation_xyzw == start.orientation_xyzw
    left = drive(world, 0.5, linear_m_s=(0.0, 1.0, 0.0))
    shift = np.subtract(left.position_m, end.position_m)
    assert shift == pytest.approx((-0.5 / math.sqrt(2), 0.5 / math.sqrt(2), 0.0), abs=1e-6)
    world.close()


def test_a_mover_turns_and_nods_without_falling_over() -> None:
    """1 rad of yaw in a second; pitch ends below the vertical."""
    world = make_world()
    assert drive(world, 1.0, angular_rad_s=(0, 0, 1.0)).rpy_deg == pytest.approx(
        (0, 0, math.degrees(1.0)), abs=1e-6
    )
    assert drive(world, 3.0, angular_rad_s=(0, 2.0, 0)).rpy_deg[1] == pytest.approx(89.0)
    world.close()


@pytest.mark.parametrize("velocity", [(5.0, 0, 0), (0, -5.0, 0), (0, 0, 5.0), (-3.0, 3.0, 2.0)])
def test_walls_stop_a_mover(velocity: tuple[float, float, float]) -> None:
    """However long it is driven, its ball stays in the box, to a centimetre."""
    world = make_world(*closed_box())
    for _ in range(20):
        end = drive(world, 0.5, linear_m_s=velocity)
        assert np.abs(end.position_m).max() < HALF_M - PROXY_RADIUS_M + 0.01
    furthest = np.abs(end.position_m).max()
    assert furthest > HALF_M - PROXY_RADIUS_M - 0.05
    world.close()


def test_a_mover_slides_along_a_wall() -> None:
    """Aslant at a wall, what is along it remains of its speed."""
    world = make_world(*closed_box())
    end = drive(world, 1.0, linear_m_s=(5.0, 1.0, 0.0))
    assert end.position_m[0] == pytest.approx(HALF_M - PROXY_RADIUS_M, abs=0.01)
    assert end.position_m[1] == pytest.approx(1.0, abs=0.02)
    world.close()


def test_a_driven_mover_pushes_what_is_loose_and_is_never_seen() -> None:
    """A ball rolls away before it; snapshots hold the objects alone."""
    world = make_world(placed("ball", (1.2, 0, 0), asset=UNIT_BALL, gravity=False, mass_kg=0.5))
    drive(world, 2.0, linear_m_s=(1.0, 0.0, 0.0))
    snapshot = world.snapshot()
    assert len(snapshot.contents.instances) == len(snapshot.world_from_body) == 1
    assert snapshot.world_from_body[0, 0, 3] > 1.5
    world.close()


def test_a_standing_mover_is_in_nobodys_way() -> None:
    """After its command has ended a ball passes through the place where it stands, unmoved."""
    world = make_world(
        placed(
            "ball",
            (-3.0, 0, 0),
            asset=UNIT_BALL,
            gravity=False,
            linear_velocity=(2.0, 0.0, 0.0),
        )
    )
    stands = drive(world, 0.1, linear_m_s=(0.1, 0.0, 0.0))
    world.drive("")
    world.step(24 * 29)
    assert world.snapshot().world_from_body[0, 0, 3] == pytest.approx(3.0, abs=1e-6)
    assert world.mover("").pose_at(world.sim_time_ns) == stands
    world.close()


def test_a_command_ends_after_half_a_second() -> None:
    """Whoever drives and goes away leaves a mover that stops: 120 steps of 1 m/s."""
    world = make_world()
    world.drive("", linear_m_s=(1.0, 0.0, 0.0))
    world.step(480)
    assert world.mover("").pose_at(world.sim_time_ns).position_m[0] == pytest.approx(0.5, abs=1e-6)
    world.close()


def test_a_mover_that_is_put_elsewhere_goes_on_from_there() -> None:
    """A set pose while it is driven is taken exactly."""
    world = make_world()
    drive(world, 0.5, linear_m_s=(1.0, 0.0, 0.0))
    world.mover("").hold(Pose((7.0, 0.0, 0.0)), world.sim_time_ns)
    assert drive(world, 0.5, linear_m_s=(1.0, 0.0, 0.0)).position_m[0] == pytest.approx(7.5)
    world.close()


def test_commands_are_refused_while_waypoints_drive() -> None:
    """The sentence says what to change; an unknown controller is refused, too."""
    track = WaypointTrack(waypoints=(Pose(), Pose((1, 0, 0))), total_time_s=2.0)
    mover = Mover(name="rail", start=Pose(), track=track, controller="waypoint")
    with pytest.raises(InvalidState, match="set_mover_controller"):
        mover.command(MoverCommand(), 0)
    with pytest.raises(UnknownName, match="rigidbody"):
        mover.control("autopilot", 0)  # type: ignore[arg-type]  # what is refused
    assert mover.controller == "waypoint"


@pytest.mark.parametrize(
    "command",
    [
        {"linear_m_s": (math.nan, 0, 0)},
        {"linear_m_s": (50.0, 0, 0)},
        {"angular_rad_s": (0, 0, -6.0)},
        {"angular_rad_s": (1.0, 0, 0)},
    ],
)
def test_commands_out_of_range_are_refused(command: dict[str, tuple[float, ...]]) -> None:
    """Not finite, too fast, rolling: one sentence each."""
    with pytest.raises(InvalidRequest, match="command's"):
        MoverCommand(**command)  # type: ignore[arg-type]  # what is refused
