"""Rigid transforms: poses, quaternions, Euler angles, axes.

The only place where body axes (x forward, y left, z up; REP 103) and camera optical axes
(x right, y down, z forward) are exchanged. Transforms are (4, 4) float64 matrices named
``a_from_b``; quaternions are in the order x, y, z, w.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.validation import vector

__all__ = [
    "BODY_FROM_OPTICAL",
    "IDENTITY",
    "POSITION_LIMIT_M",
    "QUAT_BODY_FROM_OPTICAL",
    "Pose",
    "facing",
    "interpolate",
    "invert",
    "look_at",
    "matrix_angle_deg",
    "pose_angle_deg",
    "quat_xyzw_from_rpy_deg",
    "rpy_deg_from_quat_xyzw",
]

Matrix = NDArray[np.float64]

Quaternion: TypeAlias = tuple[float, float, float, float]
"""x, y, z, w."""

UNIT_TOLERANCE = 1e-3
"""Greatest difference of a quaternion's norm from 1; others are refused."""

POSITION_LIMIT_M = 1e4
"""Coordinates beyond this [m] lose the precision that ground truth needs, and are refused."""

SAME_PLACE_M = 1e-9
"""A point that is nearer has no direction [m]."""

SAME_DIRECTION = 1e-9
"""Sine of the angle to the vertical below which a direction has no heading."""

_ORTHOGONAL = 1e-13
"""Rows of a rotation whose products differ less from those of unit vectors need no correction."""

BODY_FROM_OPTICAL: Matrix = np.array(
    [[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""(4, 4) a camera's body axes from its optical axes."""
BODY_FROM_OPTICAL.flags.writeable = False

QUAT_BODY_FROM_OPTICAL = (-0.5, 0.5, -0.5, 0.5)
"""The same turn as a quaternion, x, y, z, w."""

IDENTITY: Matrix = np.eye(4)
IDENTITY.flags.writeable = False


@dataclass(frozen=True, slots=True)
class Pose:
    """Position and orientation in the world frame.

    Attributes
    ----------
    position_m : (3,) tuple of float
        World coordinates [m].
    orientation_xyzw : (4,) tuple of float
        Unit quaternion, x, y, z, w; normalised on construction.

    Raises
    ------
    InvalidRequest
        If a number is not finite, a coordinate exceeds 10 km, or the quaternion is not of
        unit length within 1e-3.
    """

    position_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        position = vector("position", self.position_m, limit=POSITION_LIMIT_M)
        quat = _unit_quat_xyzw(self.orientation_xyzw)
        object.__setattr__(self, "position_m", position)
        object.__setattr__(self, "orientation_xyzw", quat)

    @classmethod
    def from_rpy_deg(cls, position_m: ArrayLike, rpy_deg: ArrayLike) -> Pose:
        """Make a pose from a position [m] and roll, pitch, yaw [deg] about fixed axes."""
        position = vector("position", position_m, limit=POSITION_LIMIT_M)
        return cls(position, quat_xyzw_from_rpy_deg(rpy_deg))

    @classmethod
    def from_matrix(cls, world_from_body: ArrayLike) -> Pose:
        """Make a pose from a (4, 4) rigid transform."""
        matrix = np.asarray(world_from_body, dtype=np.float64)
        x, y, z = (float(v) for v in matrix[:3, 3])
        return cls((x, y, z), _quat_xyzw_from_turn(matrix[:3, :3]))

    def turned(self, quat_xyzw: tuple[float, float, float, float]) -> Pose:
        """Return the pose in the same place whose axes are turned by a quaternion in its frame."""
        ax, ay, az, aw = self.orientation_xyzw
        bx, by, bz, bw = quat_xyzw
        orientation = (
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
            aw * bw - ax * bx - ay * by - az * bz,
        )
        return Pose(self.position_m, orientation)

    def carried(self, pose: Pose) -> Pose:
        """Return the pose in the world of what has a pose in this one's frame."""
        turned = self.turned(pose.orientation_xyzw)
        offset = _rotation_matrix(self.orientation_xyzw) @ np.asarray(pose.position_m)
        x, y, z = (float(a + b) for a, b in zip(self.position_m, offset, strict=True))
        return Pose((x, y, z), turned.orientation_xyzw)

    @property
    def rpy_deg(self) -> tuple[float, float, float]:
        """Roll, pitch, yaw [deg] about fixed axes (REP 103)."""
        return rpy_deg_from_quat_xyzw(self.orientation_xyzw)

    def matrix(self) -> Matrix:
        """Return the (4, 4) float64 transform world_from_body; a new array."""
        result = np.zeros((4, 4))
        result[3, 3] = 1.0
        result[:3, :3] = _rotation_matrix(self.orientation_xyzw)
        result[:3, 3] = self.position_m
        return result


def quat_xyzw_from_rpy_deg(rpy_deg: ArrayLike) -> tuple[float, float, float, float]:
    """Turn roll, pitch, yaw [deg] about the fixed axes x, y, z (REP 103) into a quaternion."""
    angles = vector("rotation (roll, pitch, yaw)", rpy_deg, limit=1e6)
    roll, pitch, yaw = (0.5 * math.radians(angle) for angle in angles)
    turn = (math.sin(roll), 0.0, 0.0, math.cos(roll))
    turn = _product((0.0, math.sin(pitch), 0.0, math.cos(pitch)), turn)
    return _product((0.0, 0.0, math.sin(yaw), math.cos(yaw)), turn)


def rpy_deg_from_quat_xyzw(quat_xyzw: Iterable[float]) -> tuple[float, float, float]:
    """Turn a unit quaternion into roll, pitch, yaw [deg] about fixed axes.

    At pitch ±90° roll and yaw are not unique; yaw is then reported as the rest of the turn
    and roll as 0.
    """
    x, y, z, w = quat_xyzw
    sin_pitch = 2.0 * (w * y - z * x)
    if abs(sin_pitch) > 1.0 - 1e-12:
        yaw = -math.copysign(2.0, sin_pitch) * math.atan2(x, w)
        return 0.0, math.copysign(90.0, sin_pitch), math.degrees(math.remainder(yaw, math.tau))
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return math.degrees(roll), math.degrees(math.asin(sin_pitch)), math.degrees(yaw)


def invert(a_from_b: Matrix) -> Matrix:
    """Invert a rigid transform, or a stack (..., 4, 4) of them; exact transpose, no solve."""
    rotation_t = np.swapaxes(a_from_b[..., :3, :3], -1, -2)
    result = np.zeros_like(a_from_b)
    result[..., :3, :3] = rotation_t
    result[..., :3, 3] = -np.einsum("...ij,...j->...i", rotation_t, a_from_b[..., :3, 3])
    result[..., 3, 3] = 1.0
    return result


def look_at(eye_m: ArrayLike, target_m: ArrayLike) -> Pose:
    """Return the body pose (x forward, z as far up as can be) at `eye_m` that faces `target_m`."""
    eye = np.asarray(vector("eye", eye_m))
    forward = np.asarray(vector("target", target_m)) - eye
    distance = float(np.linalg.norm(forward))
    if distance < 1e-9:
        raise InvalidRequest("target", target_m, "a point away from the eye")
    forward /= distance
    yaw = math.atan2(forward[1], forward[0])
    pitch = -math.asin(float(np.clip(forward[2], -1.0, 1.0)))
    return Pose.from_rpy_deg(eye, (0.0, math.degrees(pitch), math.degrees(yaw)))


def facing(pose: Pose, target_m: tuple[float, float, float]) -> Pose:
    """Turn a pose's x axis to a point, without a roll.

    Yaw and pitch are arctangents of the offset: exact to rounding, close to the vertical too.

    Parameters
    ----------
    pose : Pose
    target_m : (3,) tuple of float
        World frame [m].

    Returns
    -------
    turned : Pose
        In the same place. Straight below or above the point it has the heading that `pose` has;
        at the point itself it is `pose`.
    """
    x, y, z = (t - p for t, p in zip(target_m, pose.position_m, strict=True))
    flat = math.hypot(x, y)
    distance = math.hypot(flat, z)
    if distance < SAME_PLACE_M:
        return pose
    upright = flat <= SAME_DIRECTION * distance
    half_yaw = 0.5 * (math.radians(pose.rpy_deg[2]) if upright else math.atan2(y, x))
    half_pitch = -0.5 * math.atan2(z, flat)
    cos_yaw, sin_yaw = math.cos(half_yaw), math.sin(half_yaw)
    cos_pitch, sin_pitch = math.cos(half_pitch), math.sin(half_pitch)
    quat = (-sin_yaw * sin_pitch, cos_yaw * sin_pitch, sin_yaw * cos_pitch, cos_yaw * cos_pitch)
    return Pose(pose.position_m, quat)


def interpolate(start: Pose, end: Pose, fraction: float) -> Pose:
    """Interpolate two poses: position linearly, orientation along the shorter great arc.

    Parameters
    ----------
    fraction : float
        0 gives `start`, 1 gives `end`.
    """
    first, second = np.asarray(start.position_m), np.asarray(end.position_m)
    x_m, y_m, z_m = (first + (second - first) * fraction).tolist()
    turn = _unit(start.orientation_xyzw)
    x, y, z, w = turn
    x, y, z, w = _unit(_product((-x, -y, -z, w), _unit(end.orientation_xyzw)))
    part = _part_of_turn((x, y, z, w) if w >= 0.0 else (-x, -y, -z, -w), fraction)
    return Pose((x_m, y_m, z_m), _unit(_product(turn, part)))


def _part_of_turn(quat_xyzw: Quaternion, share: float) -> Quaternion:
    """Return a share of a turn, bit for bit as by the rotation vectors of SciPy's `Rotation`.

    Every start needs some, and importing SciPy's takes 0.4 s.
    """
    x, y, z, w = quat_xyzw
    angle = 2.0 * math.atan2(math.sqrt(x * x + y * y + z * z), w)
    square = angle * angle
    scale = 2.0 + square / 12.0 + 7.0 * square * square / 2880.0
    if angle > 1e-3:
        scale = angle / math.sin(angle / 2.0)
    x, y, z = x * scale * share, y * scale * share, z * scale * share
    angle = math.sqrt(x * x + y * y + z * z)
    square = angle * angle
    scale = 0.5 - square / 48.0 + square * square / 3840.0
    if angle > 1e-3:
        scale = math.sin(angle / 2.0) / angle
    return x * scale, y * scale, z * scale, math.cos(angle / 2.0)


def _quat_xyzw_from_turn(turn: Matrix) -> Quaternion:
    """Return the quaternion of a (3, 3) rotation, bit for bit that of SciPy's `Rotation`.

    Every start needs some, and importing SciPy's takes 0.2 s. It is asked where the matrix is not
    orthogonal, and so has to be corrected.
    """
    skewed = np.abs(turn @ turn.T - np.eye(3)).max() > _ORTHOGONAL
    if skewed or np.linalg.det(turn) < 0.0:
        from scipy.spatial.transform import Rotation

        x, y, z, w = (float(v) for v in Rotation.from_matrix(turn).as_quat())
        return x, y, z, w
    # F. L. Markley, "Unit Quaternion from Rotation Matrix", Journal of Guidance, Control, and
    # Dynamics 31 (2008): by the largest of the four components.
    m = turn.tolist()
    trace = m[0][0] + m[1][1] + m[2][2]
    sizes = (m[0][0], m[1][1], m[2][2], trace)
    largest = sizes.index(max(sizes))
    if largest == 3:
        quat = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1.0 + trace]
    else:
        i, j, k = largest, (largest + 1) % 3, (largest + 2) % 3
        quat = [0.0, 0.0, 0.0, m[k][j] - m[j][k]]
        quat[i] = 1.0 - trace + 2.0 * m[i][i]
        quat[j] = m[j][i] + m[i][j]
        quat[k] = m[k][i] + m[i][k]
    return _unit((quat[0], quat[1], quat[2], quat[3]))


def _unit(quat_xyzw: Quaternion) -> Quaternion:
    """Return a quaternion with the length 1."""
    x, y, z, w = quat_xyzw
    # In this order: other sums round otherwise.
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return x / length, y / length, z / length, w / length


def _unit_quat_xyzw(values: ArrayLike) -> Quaternion:
    accepted = "a quaternion x, y, z, w of unit length (within 1e-3)"
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidRequest("orientation", values, accepted) from None
    if array.shape != (4,):
        raise InvalidRequest("orientation", values, accepted)
    norm = math.sqrt(float(array.dot(array)))  # as of `linalg.norm`, without its overhead
    if not abs(norm - 1.0) <= UNIT_TOLERANCE:  # nor is it, if a number is not finite
        raise InvalidRequest("orientation", values, accepted)
    # A norm that is 1 to rounding is left alone, so that a pose survives copying bit for bit.
    if abs(norm - 1.0) > 1e-15:
        array = array / norm
    return float(array[0]), float(array[1]), float(array[2]), float(array[3])


def _product(p: Quaternion, q: Quaternion) -> Quaternion:
    """Hamilton product of two quaternions x, y, z, w: first the turn q, then p."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (
        pw * qx + qw * px + (py * qz - pz * qy),
        pw * qy + qw * py + (pz * qx - px * qz),
        pw * qz + qw * pz + (px * qy - py * qx),
        pw * qw - px * qx - py * qy - pz * qz,
    )


def _rotation_matrix(quat_xyzw: Quaternion) -> Matrix:
    """Rotation matrix of a unit quaternion (the textbook form; no library call per body)."""
    x, y, z, w = quat_xyzw
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def matrix_angle_deg(rotation: Matrix) -> float:
    """Return by how much a (3, 3) rotation turns [deg], 0 to 180."""
    return math.degrees(math.acos(min(1.0, max(-1.0, (float(np.trace(rotation)) - 1.0) / 2.0))))


def pose_angle_deg(first: Pose, second: Pose) -> float:
    """Return by how much one pose is turned from another [deg], 0 to 180."""
    share = abs(float(np.dot(first.orientation_xyzw, second.orientation_xyzw)))
    return math.degrees(2.0 * math.acos(min(1.0, share)))
