"""Transforms: group axioms, conversions there and back, agreement with SciPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.geometry import (
    BODY_FROM_OPTICAL,
    QUAT_BODY_FROM_OPTICAL,
    Pose,
    interpolate,
    invert,
    look_at,
    quat_xyzw_from_rpy_deg,
    rpy_deg_from_quat_xyzw,
)

COORDINATE = st.floats(-100.0, 100.0)
ANGLE = st.floats(-180.0, 180.0)
POSES = st.builds(
    Pose.from_rpy_deg, st.tuples(COORDINATE, COORDINATE, COORDINATE), st.tuples(ANGLE, ANGLE, ANGLE)
)


@given(POSES)
def test_inverse_undoes(pose: Pose) -> None:
    """A transform times its inverse is the identity."""
    matrix = pose.matrix()
    np.testing.assert_allclose(invert(matrix) @ matrix, np.eye(4), atol=1e-12)


@given(POSES, POSES)
def test_rotations_stay_rotations(first: Pose, second: Pose) -> None:
    """Products are rigid: orthonormal with determinant 1."""
    rotation = (first.matrix() @ second.matrix())[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@given(POSES)
def test_matrices_and_poses_are_the_same(pose: Pose) -> None:
    """Pose to matrix and back gives the same place and turn."""
    again = Pose.from_matrix(pose.matrix())
    np.testing.assert_allclose(again.matrix(), pose.matrix(), atol=1e-12)


@given(POSES)
def test_a_turned_pose_is_the_product_of_matrices(pose: Pose) -> None:
    """The optical frame by its quaternion is that by its matrix, and the turn back undoes it."""
    optical = pose.turned(QUAT_BODY_FROM_OPTICAL)
    np.testing.assert_allclose(optical.matrix(), pose.matrix() @ BODY_FROM_OPTICAL, atol=1e-14)
    x, y, z, w = QUAT_BODY_FROM_OPTICAL
    back = optical.turned((-x, -y, -z, w))
    np.testing.assert_allclose(back.orientation_xyzw, pose.orientation_xyzw, rtol=0, atol=1e-15)
    assert back.position_m == pose.position_m


@given(ANGLE, st.floats(-89.9, 89.9), ANGLE)
def test_angles_survive_the_quaternion(roll: float, pitch: float, yaw: float) -> None:
    """Away from the poles roll, pitch and yaw come back, modulo a full turn."""
    back = rpy_deg_from_quat_xyzw(quat_xyzw_from_rpy_deg((roll, pitch, yaw)))
    for given_deg, got_deg in zip((roll, pitch, yaw), back, strict=True):
        assert abs(math.remainder(given_deg - got_deg, 360.0)) < 1e-6


@given(ANGLE, st.sampled_from([-90.0, 90.0]), ANGLE)
def test_at_the_poles_the_rotation_itself_comes_back(roll: float, pitch: float, yaw: float) -> None:
    """Angles are not unique there, but they describe the same rotation."""
    quat = quat_xyzw_from_rpy_deg((roll, pitch, yaw))
    again = quat_xyzw_from_rpy_deg(rpy_deg_from_quat_xyzw(quat))
    difference = Rotation.from_quat(quat).inv() * Rotation.from_quat(again)
    assert difference.magnitude() < 1e-6


def test_fixed_axes_mean_roll_first_and_yaw_last() -> None:
    """REP 103: yaw turns what pitch and roll have made."""
    turned = Pose.from_rpy_deg((0, 0, 0), (90.0, 0.0, 90.0)).matrix()[:3, :3]
    np.testing.assert_allclose(turned @ [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(turned @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-12)


def test_optical_axes_are_right_down_forward() -> None:
    """In the body frame the optical x is right (-y), y down (-z), z forward (x)."""
    axes = BODY_FROM_OPTICAL[:3, :3].T
    np.testing.assert_array_equal(axes, [[0, -1, 0], [0, 0, -1], [1, 0, 0]])


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE), st.tuples(COORDINATE, COORDINATE, COORDINATE))
def test_look_at_faces_the_target_with_its_head_up(eye, target) -> None:  # type: ignore[no-untyped-def]  # drawn tuples
    """Body x points at the target, body y stays level."""
    if math.dist(eye, target) < 1e-3:
        return
    rotation = look_at(eye, target).matrix()[:3, :3]
    direction = np.subtract(target, eye) / math.dist(eye, target)
    np.testing.assert_allclose(rotation[:, 0], direction, atol=1e-6)
    assert abs(rotation[2, 1]) < 1e-9


@given(POSES, POSES)
def test_interpolation_begins_and_ends_where_it_should(start: Pose, end: Pose) -> None:
    """Fractions 0 and 1 are the ends, one half lies as far from both."""
    for fraction, expected in ((0.0, start), (1.0, end)):
        np.testing.assert_allclose(
            interpolate(start, end, fraction).matrix(), expected.matrix(), atol=1e-9
        )
    half = Rotation.from_quat(interpolate(start, end, 0.5).orientation_xyzw)
    to_start = (half.inv() * Rotation.from_quat(start.orientation_xyzw)).magnitude()
    to_end = (half.inv() * Rotation.from_quat(end.orientation_xyzw)).magnitude()
    assert to_start == pytest.approx(to_end, abs=1e-6)
    assert to_start <= math.pi / 2 + 1e-6


@given(POSES, POSES, st.floats(0.0, 1.0))
def test_interpolation_turns_bit_for_bit_as_scipy(start: Pose, end: Pose, share: float) -> None:
    turn = Rotation.from_quat(start.orientation_xyzw)
    whole = (turn.inv() * Rotation.from_quat(end.orientation_xyzw)).as_rotvec()
    expected = Pose((0.0, 0.0, 0.0), (turn * Rotation.from_rotvec(whole * share)).as_quat())
    assert interpolate(start, end, share).orientation_xyzw == expected.orientation_xyzw


BAD = [
    ({"position_m": (0, 0)}, "position must be three finite numbers within ±10000, got (0, 0)"),
    ({"position_m": (0, math.nan, 0)}, "position must be three finite numbers within ±10000"),
    ({"position_m": (0, 0, math.inf)}, "position must be three finite numbers within ±10000"),
    ({"position_m": "here"}, "position must be three finite numbers within ±10000, got 'here'"),
    ({"orientation_xyzw": (0, 0, 0, 2)}, "orientation must be a quaternion x, y, z, w of unit"),
    ({"orientation_xyzw": (0, 0, 0, 0)}, "orientation must be a quaternion x, y, z, w of unit"),
    ({"orientation_xyzw": (0, 0, 1)}, "orientation must be a quaternion x, y, z, w of unit"),
    ({"orientation_xyzw": (0, 0, math.nan, 1)}, "orientation must be a quaternion x, y, z, w"),
]


@pytest.mark.parametrize(("arguments", "sentence"), BAD)
def test_what_is_no_pose_is_refused_in_words(arguments: dict[str, object], sentence: str) -> None:
    """Wrong lengths, NaN, infinities and non-unit quaternions."""
    with pytest.raises(InvalidRequest) as caught:
        Pose(**arguments)  # type: ignore[arg-type]  # wrong on purpose
    assert str(caught.value).startswith(sentence)


@given(st.tuples(*[st.floats(-1e5, 1e5)] * 3))
def test_angles_become_the_quaternion_that_scipy_makes(angles: tuple[float, float, float]) -> None:
    """Bit for bit."""
    scipys = Rotation.from_euler("xyz", angles, degrees=True).as_quat()
    assert np.array_equal(quat_xyzw_from_rpy_deg(angles), scipys)


@given(
    st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(lambda q: np.hypot(*q[:2]) > 0.1),
    st.floats(-180.0, 180.0),
    st.sampled_from([0.0, 1e-14, 1e-9, 1e-3]),
)
def test_the_orientation_of_a_matrix_is_scipys(quat: list[float], yaw: float, skew: float) -> None:
    """Bit for bit, and whether the matrix is orthogonal or not."""
    turn = Rotation.from_quat(quat) * Rotation.from_euler("z", yaw, degrees=True)
    matrix = np.eye(4)
    matrix[:3, :3] = turn.as_matrix() @ Rotation.from_euler("x", yaw, degrees=True).as_matrix()
    matrix[0, 1] += skew
    x, y, z, w = Rotation.from_matrix(matrix[:3, :3]).as_quat().tolist()
    expected = Pose((0.0, 0.0, 0.0), (x, y, z, w))
    assert Pose.from_matrix(matrix).orientation_xyzw == expected.orientation_xyzw
