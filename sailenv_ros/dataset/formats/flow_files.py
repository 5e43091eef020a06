"""Our flow → that of other programs and file formats, and back; each one's definition stands here.

Our `flow` is the velocity v of the surface point in the image [px/s], u right, v down, NaN where
there is none: v = (p_t - p_{t-1}) / dt. Pure functions on arrays; files are bytes.
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest

__all__ = [
    "FLO_UNKNOWN",
    "backward_px",
    "carla_from_flow",
    "flo_from_backward",
    "backward_from_flo",
    "flow_from_backward",
    "flow_from_carla",
    "flow_from_kubric",
    "kitti_from_backward",
    "backward_from_kitti",
    "kubric_from_flow",
]

Flow = NDArray[np.float32]

FLO_UNKNOWN = 1e10
"""Value in a .flo file where there is no flow; readers take everything above 1e9 as unknown."""

_FLO_TAG = b"PIEH"
_KITTI_STEP_PX = 1.0 / 64.0
_KITTI_ZERO = 2**15


def backward_px(flow: Flow, dt_s: float) -> Flow:
    """Return the displacement to the previous frame, as OpenCV's backward flow has it.

    Parameters
    ----------
    flow : (H, W, 2) float32
        Velocity [px/s].
    dt_s : float
        Time since the previous frame [s].

    Returns
    -------
    backward : (H, W, 2) float32
        b = p_{t-1} - p_t [px]: the previous picture at x + b(x) shows what the present one shows
        at x. NaN stays.
    """
    return np.asarray(flow * np.float32(-dt_s), np.float32)


def flow_from_backward(backward: Flow, dt_s: float) -> Flow:
    """Return the velocity [px/s] of a displacement to the previous frame [px].

    Raises
    ------
    InvalidRequest
        If the time between the frames is not above 0 [s].
    """
    if not dt_s > 0.0:
        raise InvalidRequest("dt_s", dt_s, "above 0 [s]")
    return np.asarray(backward / np.float32(-dt_s), np.float32)


def kubric_from_flow(flow: Flow, dt_s: float) -> Flow:
    """Return what Kubric calls backward flow: (delta_row, delta_column) of p_t - p_{t-1} [px].

    Kubric's "backward" points the way the surface moved, as its forward flow does, and names
    rows first.
    """
    return np.ascontiguousarray(flow[..., ::-1] * np.float32(dt_s))


def flow_from_kubric(kubric: Flow, dt_s: float) -> Flow:
    """Return the velocity [px/s] of Kubric's backward flow [px].

    Raises
    ------
    InvalidRequest
        If the time between the frames is not above 0 [s].
    """
    return flow_from_backward(-kubric[..., ::-1], dt_s)


def carla_from_flow(flow: Flow, dt_s: float) -> Flow:
    """Return CARLA's optical flow: p_t - p_{t-1} in normalised device coordinates, y up.

    The picture is 2 wide and 2 high there: c = (2 d_u / W, -2 d_v / H).
    """
    height, width = flow.shape[:2]
    scale = np.array([2.0 / width, -2.0 / height]) * dt_s
    return np.asarray(flow * scale, np.float32)


def flow_from_carla(carla: Flow, dt_s: float) -> Flow:
    """Return the velocity [px/s] of CARLA's optical flow.

    Raises
    ------
    InvalidRequest
        If the time between the frames is not above 0 [s].
    """
    height, width = carla.shape[:2]
    scale = np.array([0.5 * width, -0.5 * height], np.float32)
    return flow_from_backward(-carla * scale, dt_s)


def flo_from_backward(backward: Flow) -> bytes:
    """Return a Middlebury .flo file: "PIEH", width, height, then u and v of each pixel, row by row.

    D. Scharstein, https://vision.middlebury.edu/flow/code/flow-code/README.txt
    """
    height, width = backward.shape[:2]
    known = np.where(np.isfinite(backward), backward, np.float32(FLO_UNKNOWN))
    return _FLO_TAG + struct.pack("<ii", width, height) + known.astype("<f4").tobytes()


def backward_from_flo(data: bytes) -> Flow:
    """Read a .flo file; NaN where it is unknown.

    Raises
    ------
    InvalidRequest
        If it is none, or cut off.
    """
    if data[:4] != _FLO_TAG or len(data) < 12:
        raise InvalidRequest(".flo file", data[:12], "begin with b'PIEH', width and height")
    width, height = struct.unpack_from("<ii", data, 4)
    if width < 1 or height < 1 or len(data) != 12 + 8 * width * height:
        accepted = f"{12 + 8 * max(width, 0) * max(height, 0)} bytes long, as its header says"
        raise InvalidRequest(".flo file", f"{len(data)} bytes", accepted)
    values = np.frombuffer(data, "<f4", offset=12).reshape(height, width, 2).astype(np.float32)
    values[(np.abs(values) > 1e9).any(axis=-1)] = np.nan
    return values


def kitti_from_backward(backward: Flow) -> NDArray[np.uint16]:
    """Return KITTI's picture of a flow: channels u, v, valid, of 16 bits.

    u = (R - 2^15) / 64 [px], so that steps are 1/64 px and ±512 px the ends; 0, 0, 0 where there
    is no flow or it does not fit. M. Menze, A. Geiger, "Object scene flow", 2015 (devkit).

    Returns
    -------
    picture : (H, W, 3) uint16
        Red, green, blue; OpenCV writes blue first.
    """
    with np.errstate(invalid="ignore"):
        steps = np.rint(backward.astype(np.float64) / _KITTI_STEP_PX) + _KITTI_ZERO
        valid = ((steps >= 0) & (steps <= 65535)).all(axis=-1)
    picture = np.zeros((*backward.shape[:2], 3), np.uint16)
    picture[valid, :2] = steps[valid].astype(np.uint16)
    picture[valid, 2] = 1
    return picture


def backward_from_kitti(picture: NDArray[np.uint16]) -> Flow:
    """Read what `kitti_from_backward` gives; NaN where it is not valid."""
    values = (picture[..., :2].astype(np.float32) - _KITTI_ZERO) * np.float32(_KITTI_STEP_PX)
    values[picture[..., 2] == 0] = np.nan
    return values
