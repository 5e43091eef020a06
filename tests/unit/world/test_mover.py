"""The mover's track: equal times, straight lines, shorter arcs, hold and go on."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.mover_motion import WaypointTrack

SQUARE = (
    Pose((0.0, 0.0, 1.0)),
    Pose.from_rpy_deg((2.0, 0.0, 1.0), (0, 0, 90)),
    Pose.from_rpy_deg((2.0, 2.0, 1.0), (0, 0, 180)),
    Pose.from_rpy_deg((0.0, 2.0, 1.0), (0, 0, -90)),
)
TRACK = WaypointTrack(waypoints=SQUARE, total_time_s=8.0)


def test_each_leg_takes_the_same_time() -> None:
    """Four legs of a closed track in 8 s: a waypoint every 2 s."""
    for number, waypoint in enumerate(SQUARE):
        assert TRACK.pose_at(2.0 * number).position_m == pytest.approx(
            waypoint.position_m, abs=1e-12
        )


def test_halfway_is_the_middle_of_position_and_of_angle() -> None:
    """At half a leg the position is the mean, the yaw half the turn."""
    halfway = TRACK.pose_at(1.0)
    assert halfway.position_m == pytest.approx((1.0, 0.0, 1.0), abs=1e-12)
    assert halfway.rpy_deg == pytest.approx((0.0, 0.0, 45.0), abs=1e-9)


def test_the_last_leg_turns_the_short_way_home() -> None:
    """From yaw -90° to 0° the track turns by 90°, not by 270°."""
    assert TRACK.pose_at(7.0).rpy_deg[2] == pytest.approx(-45.0, abs=1e-9)


@given(time_s=st.floats(0.0, 1e4), cycles=st.integers(0, 50))
def test_a_loop_repeats_itself(time_s: float, cycles: int) -> None:
    """A closed track is periodic in its total time."""
    first, later = TRACK.pose_at(time_s), TRACK.pose_at(time_s + 8.0 * cycles)
    assert math.dist(first.position_m, later.position_m) < 1e-7


def test_an_open_track_stays_at_its_end() -> None:
    """Without a loop three legs share the time, and the end is final."""
    track = WaypointTrack(waypoints=SQUARE, total_time_s=3.0, loop=False)
    assert track.pose_at(1.0).position_m == pytest.approx((2.0, 0.0, 1.0))
    assert track.pose_at(3.0) == track.pose_at(1e6) == SQUARE[-1]


def test_a_held_mover_stays_until_waypoints_go_on_where_they_stopped() -> None:
    """Hold is for good; the track's time stands still meanwhile."""
    mover = Mover(name="mover", start=Pose(), track=TRACK, controller="waypoint")
    second = 1_000_000_000
    here = Pose((5.0, 5.0, 5.0))
    mover.hold(here, 1 * second)
    assert mover.controller == "rigidbody"
    assert mover.pose_at(9 * second) == here
    mover.control("waypoint", 10 * second)
    assert mover.pose_at(10 * second).position_m == pytest.approx((1.0, 0.0, 1.0))
    assert mover.pose_at(11 * second).position_m == pytest.approx((2.0, 0.0, 1.0))
