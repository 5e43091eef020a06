"""Unity's axes and Euler angles to ours and back; the only place outside of which they are unknown.

Unity's world is left-handed: x right, y up, z forward [m]; ours is REP 103's: x forward, y left,
z up. Unity's rotations are angles about x, y, z [deg], applied in the order z, x, y about fixed
axes, which is to say R = R_y R_x R_z.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.geometry import POSITION_LIMIT_M, Pose
from sailenv_ros.types.validation import vector

__all__ = [
    "orientation_xyzw_from_unity",
    "pose_from_unity",
    "scale_from_unity",
    "unity_angles_deg",
    "unity_from_vector",
    "vector_from_unity",
]

Vector3 = tuple[float, float, float]

_ROS_FROM_UNITY: NDArray[np.float64] = np.array([[0.0, 0, 1], [-1, 0, 0], [0, 1, 0]])
"""(3, 3) a reflection: its determinant is -1."""

_LEVEL = 1.0 - 1e-12
"""A sine beyond this is that of a right angle: the other two angles are then not unique."""


def vector_from_unity(what: str, unity: ArrayLike, *, limit: float = POSITION_LIMIT_M) -> Vector3:
    """Turn a point [m] or a direction into ours.

    Raises
    ------
    InvalidRequest
        If a number is not finite or beyond the limit.
    """
    x, y, z = vector(what, unity, limit=limit)
    return z, -x, y


def unity_from_vector(ours: ArrayLike) -> Vector3:
    """Turn a point [m] or a direction of ours into Unity's."""
    x, y, z = (float(value) for value in np.asarray(ours, dtype=np.float64))
    return -y, z, x


def scale_from_unity(what: str, unity: ArrayLike) -> Vector3:
    """Turn factors along an object's axes into ours."""
    x, y, z = vector(what, unity)
    return z, x, y


def orientation_xyzw_from_unity(
    what: str, angles_deg: ArrayLike
) -> tuple[float, float, float, float]:
    """Turn Unity's angles about x, y, z [deg] into our quaternion.

    Raises
    ------
    InvalidRequest
        If an angle is not finite or beyond a million degrees.
    """
    from scipy.spatial.transform import Rotation  # takes long to import, and few need it

    pitch, yaw, roll = vector(what, angles_deg, limit=1e6)
    unity = Rotation.from_euler("YXZ", (yaw, pitch, roll), degrees=True).as_matrix()
    # The same turn seen in the mirror: M R M^-1, of which M^-1 is the transpose.
    ours = Rotation.from_matrix(_ROS_FROM_UNITY @ unity @ _ROS_FROM_UNITY.T)
    x, y, z, w = (float(value) for value in ours.as_quat())
    return x, y, z, w


def pose_from_unity(position: ArrayLike, angles_deg: ArrayLike) -> Pose:
    """Turn Unity's position [m] and angles [deg] into a pose of ours.

    Raises
    ------
    InvalidRequest
        If a number is not finite or beyond its limit.
    """
    return Pose(
        vector_from_unity("position", position),
        orientation_xyzw_from_unity("rotation", angles_deg),
    )


def unity_angles_deg(pose: Pose) -> Vector3:
    """Return Unity's angles about x, y, z of a pose [deg], each from 0 to 360 as Unity tells them.

    Looking straight up or down, the turn about z is told as 0.
    """
    ours = pose.matrix()[:3, :3]
    r = _ROS_FROM_UNITY.T @ ours @ _ROS_FROM_UNITY
    sin_x = -float(r[1, 2])
    if abs(sin_x) > _LEVEL:
        x = math.copysign(90.0, sin_x)
        y, z = math.degrees(math.atan2(-r[2, 0], r[0, 0])), 0.0
    else:
        x = math.degrees(math.asin(sin_x))
        y = math.degrees(math.atan2(r[0, 2], r[2, 2]))
        z = math.degrees(math.atan2(r[1, 0], r[1, 1]))
    return _turned(x), _turned(y), _turned(z)


def _turned(angle_deg: float) -> float:
    # A tiny negative angle plus 360 rounds to 360 itself, hence the second remainder.
    return angle_deg % 360.0 % 360.0
