"""Intrinsics of a pin-hole camera to and from `sensor_msgs/CameraInfo`.

Integer pixels are pixel centres, so a central optical axis meets the picture at ((W - 1)/2,
(H - 1)/2), as `image_geometry` and `depth_image_proc` read it. The near and far plane have no place
there.
"""

from __future__ import annotations

import math

import numpy as np
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["camera_info_from_intrinsics", "intrinsics_from_camera_info"]


def camera_info_from_intrinsics(intrinsics: CameraIntrinsics, header: Header) -> CameraInfo:
    """Make the message: no distortion, no rectification, P = [K | 0]."""
    k = intrinsics.K
    projection = np.hstack([k, np.zeros((3, 1))])
    return CameraInfo(
        header=header,
        height=intrinsics.height,
        width=intrinsics.width,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=k.ravel(),
        r=np.eye(3).ravel(),
        p=projection.ravel(),
    )


def intrinsics_from_camera_info(
    msg: CameraInfo, *, near_m: float = 0.05, far_m: float = 100.0
) -> CameraIntrinsics:
    """Read intrinsics.

    Raises
    ------
    InvalidRequest
        If the camera is distorted, its pixels are not square or its axis is out of bounds: this
        package has no such cameras.
    """
    fx, fy, cx, cy = msg.k[0], msg.k[4], msg.k[2], msg.k[5]
    if any(msg.d):
        raise InvalidRequest("distortion", list(msg.d), "none")
    if not fy > 0.0 or not math.isclose(fx, fy, rel_tol=1e-9):
        raise InvalidRequest("focal lengths fx, fy", (fx, fy), "equal and above 0 [px]")
    return CameraIntrinsics(
        width=msg.width,
        height=msg.height,
        # Its last bits come from rounding, which must not push 1 degree below the least angle.
        vertical_fov_deg=round(math.degrees(2.0 * math.atan(0.5 * msg.height / fy)), 12),
        near_m=near_m,
        far_m=far_m,
        # As above: an axis in the centre stays there.
        cx_offset_px=round(cx - 0.5 * (msg.width - 1), 6),
        cy_offset_px=round(cy - 0.5 * (msg.height - 1), 6),
    )
