"""Unity's axes and angles: against arithmetic by hand, and there and back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gateway.unity import (
    orientation_xyzw_from_unity,
    pose_from_unity,
    scale_from_unity,
    unity_angles_deg,
    unity_from_vector,
    vector_from_unity,
)
from sailenv_ros.types.geometry import Pose

COORDINATES = st.floats(-1e4, 1e4, width=32)
ANGLES = st.floats(-720.0, 720.0, width=32)
SEVERAL_RIGHT_ANGLES = st.sampled_from([k * 90.0 for k in range(-8, 9)])


def unity_rotation(x_deg: float, y_deg: float, z_deg: float) -> np.ndarray:
    """R_y R_x R_z from sines and cosines, as Unity's manual defines it."""
    (sx, cx), (sy, cy), (sz, cz) = (
        (math.sin(math.radians(a)), math.cos(math.radians(a))) for a in (x_deg, y_deg, z_deg)
    )
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_y @ about_x @ about_z


def test_the_axes_are_these() -> None:
    """Right, up, forward of Unity are our -y, z, x."""
    assert vector_from_unity("p", (1, 2, 3)) == (3.0, -1.0, 2.0)
    assert unity_from_vector((3.0, -1.0, 2.0)) == (1.0, 2.0, 3.0)
    assert scale_from_unity("s", (1, 2, 3)) == (3.0, 1.0, 2.0)


@pytest.mark.parametrize(
    ("angles", "forward", "up"),
    [
        ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
        ((0, 90, 0), (0, -1, 0), (0, 0, 1)),  # yaw: to the right
        ((90, 0, 0), (0, 0, -1), (1, 0, 0)),  # pitch: down
        ((0, 0, 90), (1, 0, 0), (0, 1, 0)),  # roll: the head to the left
        ((0, 180, 0), (-1, 0, 0), (0, 0, 1)),
    ],
)
def test_turns_by_right_angles_look_where_they_should(
    angles: tuple[float, ...], forward: tuple[float, ...], up: tuple[float, ...]
) -> None:
    """What a camera in Unity would see ahead and above, it sees here."""
    world_from_body = pose_from_unity((0, 0, 0), angles).matrix()[:3, :3]
    np.testing.assert_allclose(world_from_body[:, 0], forward, atol=1e-12)
    np.testing.assert_allclose(world_from_body[:, 2], up, atol=1e-12)


@given(st.tuples(ANGLES, ANGLES, ANGLES), st.tuples(COORDINATES, COORDINATES, COORDINATES))
def test_a_turned_point_is_the_same_point(
    angles: tuple[float, float, float], point: tuple[float, float, float]
) -> None:
    """To turn in Unity and then convert is to convert and then turn."""
    turned = unity_rotation(*angles) @ np.asarray(point)
    ours = pose_from_unity((0, 0, 0), angles).matrix()[:3, :3] @ vector_from_unity("p", point)
    np.testing.assert_allclose(unity_from_vector(ours), turned, atol=1e-7)


@given(st.tuples(*[st.one_of(ANGLES, SEVERAL_RIGHT_ANGLES)] * 3))
def test_angles_there_and_back_are_the_same_turn(angles: tuple[float, float, float]) -> None:
    """However the angles are told, straight up and down too, they mean the same; all within 360."""
    told = unity_angles_deg(Pose((0.0, 0.0, 0.0), orientation_xyzw_from_unity("r", angles)))
    assert all(0.0 <= angle < 360.0 for angle in told)
    # The sine of an angle near 90 tells the angle to the root of its precision.
    np.testing.assert_allclose(unity_rotation(*told), unity_rotation(*angles), atol=3e-6)


@given(
    st.floats(-85, 85, width=32), st.floats(1, 359, width=32), st.floats(1, 359, width=32)
)  # fmt: skip
def test_angles_that_unity_would_tell_come_back(x: float, y: float, z: float) -> None:
    """A script that reads what it set finds it, to a thousandth of a degree."""
    told = unity_angles_deg(pose_from_unity((0, 0, 0), (x, y, z)))
    apart = [math.remainder(a - b, 360.0) for a, b in zip(told, (x, y, z), strict=True)]
    np.testing.assert_allclose(apart, 0.0, atol=1e-3)


@given(st.tuples(COORDINATES, COORDINATES, COORDINATES))
def test_points_there_and_back_are_the_same_numbers(point: tuple[float, float, float]) -> None:
    """Axes change places and signs; no number is rounded."""
    assert unity_from_vector(vector_from_unity("p", point)) == point


@pytest.mark.parametrize("bad", [(math.nan, 0, 0), (0, math.inf, 0), (0, 0, 2e4)])
def test_what_is_no_place_is_refused(bad: tuple[float, ...]) -> None:
    """NaN, infinity and the far away have no place in a world."""
    with pytest.raises(InvalidRequest, match="position must be"):
        vector_from_unity("position", bad)
    with pytest.raises(InvalidRequest, match="rotation must be"):
        orientation_xyzw_from_unity("rotation", (math.nan, 0.0, 0.0))
