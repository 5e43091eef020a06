"""Intrinsics of a camera to and from `sensor_msgs/CameraInfo`.

Integer pixels are pixel centres, so a central optical axis meets the picture at ((W - 1)/2,
(H - 1)/2), as `image_geometry` and `depth_image_proc` read it. The near and far plane and the image
circle have no place there.
"""

from __future__ import annotations

import math
from typing import Any

from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.agents import stereo_baseline_m
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.lens_settings import PINHOLE_FOV

__all__ = ["camera_info_from_intrinsics", "camera_info_of_frame", "intrinsics_from_camera_info"]

_PLUMB_BOB = "plumb_bob"
_COEFFICIENTS = 5
"""Of `plumb_bob`, as `image_geometry` reads them; a lens may have the first four alone."""

_TILTED = 14
"""Coefficients of OpenCV's law with a tilted sensor, the last two; without the tilt it is ours."""


def camera_info_of_frame(frame: Frame, header: Header) -> CameraInfo:
    """Make the message of a frame's camera; in a rig it knows how far it is from the first."""
    agents = () if frame.info is None else frame.info.agents
    own = next((spec for spec in agents if spec.name == frame.agent), None)
    baseline_m = 0.0 if own is None else stereo_baseline_m(own, agents)
    return camera_info_from_intrinsics(frame.camera.intrinsics, header, baseline_m)


def camera_info_from_intrinsics(
    intrinsics: CameraIntrinsics, header: Header, baseline_m: float = 0.0
) -> CameraInfo:
    """Make the message: model, D and K of the lens, no rectification, P = [K | (-fx B, 0, 0)].

    A pin-hole is a `plumb_bob` without distortion. Models that ROS has no name for have ours.

    Parameters
    ----------
    intrinsics : CameraIntrinsics
    header : Header
    baseline_m : float
        B, by which it is to the right of the first camera of a rectified rig [m].
    """
    model, coefficients = intrinsics.distortion_model, [*intrinsics.distortion]
    if model == "pinhole":
        model = _PLUMB_BOB
    if model == _PLUMB_BOB:
        coefficients += [0.0] * (_COEFFICIENTS - len(coefficients))
    projection = intrinsics.P.copy()
    # The other sign of zero is another byte.
    projection[0, 3] = -intrinsics.fx * baseline_m if baseline_m else 0.0
    return CameraInfo(
        header=header,
        height=intrinsics.height,
        width=intrinsics.width,
        distortion_model=model,
        d=coefficients,
        k=intrinsics.K.ravel(),
        r=intrinsics.R.ravel(),
        p=projection.ravel(),
    )


def intrinsics_from_camera_info(
    msg: CameraInfo, *, near_m: float = 0.05, far_m: float = 100.0, max_angle_deg: float = 0.0
) -> CameraIntrinsics:
    """Read intrinsics.

    Parameters
    ----------
    msg : CameraInfo
    near_m, far_m : float
        Clip distances [m].
    max_angle_deg : float
        Where the image circle ends [deg]; 0 if it ends where the law does.

    Raises
    ------
    InvalidRequest
        If the model is not known, its coefficients do not fit it, or the axis is out of bounds.
    """
    fx, fy, cx, cy = msg.k[0], msg.k[4], msg.k[2], msg.k[5]
    if not (fx > 0.0 and fy > 0.0):
        raise InvalidRequest("focal lengths fx, fy", (fx, fy), "above 0 [px]")
    lens: dict[str, Any] = {
        "width": msg.width,
        "height": msg.height,
        "near_m": near_m,
        "far_m": far_m,
        "max_angle_deg": max_angle_deg,
        # Its last bits come from rounding: an axis in the centre stays there.
        "cx_offset_px": round(cx - 0.5 * (msg.width - 1), 6),
        "cy_offset_px": round(cy - 0.5 * (msg.height - 1), 6),
    }
    coefficients = [*msg.d]
    if any(coefficients) or msg.distortion_model not in ("", _PLUMB_BOB):
        if len(coefficients) == _TILTED and not any(coefficients[12:]):
            coefficients = coefficients[:12]
        lens |= {"distortion_model": msg.distortion_model, "distortion": tuple(coefficients)}
    # As above: rounding must not push 1 degree below the least angle.
    fov_deg = round(math.degrees(2.0 * math.atan(0.5 * msg.height / fy)), 12)
    is_square = math.isclose(fx, fy, rel_tol=1e-9)
    if "distortion_model" in lens or not is_square or PINHOLE_FOV.refused(fov_deg):
        return CameraIntrinsics(**lens, fx_px=fx, fy_px=fy)
    return CameraIntrinsics(**lens, vertical_fov_deg=fov_deg)
