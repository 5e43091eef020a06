"""Stereo: disparity of a rectified pair of frames, and what only one of the two cameras sees.

Two frames of one instant in, arrays of the left one's pixels out. Arithmetic on depth, ids and
poses; conventions are those of `cv2.stereoRectify` and `stereo_image_proc`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.motion.between import motion
from sailenv_ros.frame.motion.frame_state import AnyFrame, FrameState, frame_state_of
from sailenv_ros.types.rigs import rectified_baseline_m

__all__ = ["Disparity", "disparity"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Disparity:
    """Disparity of the left picture of a rectified pair; arrays are the caller's own.

    Of each pixel that has a disparity exactly one is true: `visible`, `occluded`, `out_of_view`.

    Attributes
    ----------
    disparity : (H, W) float32
        d = fx B / z [px]: the point at (u, v) on the left is at (u - d, v) on the right. 0 where
        nothing was hit; nan where the surface is nearer than the near plane.
    visible : (H, W) bool
        The right picture shows the same surface point.
    occluded : (H, W) bool
        The right picture shows another surface there.
    out_of_view : (H, W) bool
        The point lies beside the right picture.
    focal_px : float
        Focal length fx of both cameras [px].
    baseline_m : float
        How far the right camera is to the right of the left one [m].
    Q : (4, 4) float64
        Point in the left optical frame, homogeneous [m], from (u, v, d, 1), for
        `cv2.reprojectImageTo3D`.
    """

    disparity: NDArray[np.float32]
    visible: NDArray[np.bool_]
    occluded: NDArray[np.bool_]
    out_of_view: NDArray[np.bool_]
    focal_px: float
    baseline_m: float
    Q: NDArray[np.float64]


def disparity(left: AnyFrame, right: AnyFrame) -> Disparity:
    """Return the true disparity of a rectified pair.

    Parameters
    ----------
    left, right : Frame or dict
        Of one instant, as `capture_rig` and `get_frames` give them, or recorded. Both need the
        views ``depth`` and ``instance``.

    Raises
    ------
    InvalidRequest
        If the frames are of two instants, a view is missing, or the pair is not rectified: two
        pin-holes with equal intrinsics and axes, the right one straight to the right.

    Notes
    -----
    What is occluded is decided as `motion` does.
    """
    first, second = frame_state_of(left, "left frame"), frame_state_of(right, "right frame")
    if first.stamp_ns != second.stamp_ns:
        stamps = f"stamps {first.stamp_ns} and {second.stamp_ns} ns"
        raise InvalidRequest("frames of a stereo pair", stamps, "of one instant, as capture_rig")
    lens, baseline_m = first.camera.intrinsics, _baseline_m(first, second)
    seen = motion(left, right)
    assert first.depth is not None  # or there would be no motion
    with np.errstate(divide="ignore"):
        shift = (lens.fx * baseline_m / first.depth.astype(np.float64)).astype(np.float32)
    back = np.zeros((4, 4))
    back[:3, 3] = (-lens.cx, -lens.cy, lens.fx)
    # Rows have the scale of pixels across: where these are not square, y is not measured in them.
    back[0, 0], back[1, 1] = 1.0, lens.fx / lens.fy
    back[1, 3] *= lens.fx / lens.fy
    back[3, 2] = 1.0 / baseline_m
    return Disparity(
        disparity=shift,
        visible=seen.visible,
        occluded=seen.occluded,
        out_of_view=seen.out_of_view,
        focal_px=lens.fx,
        baseline_m=baseline_m,
        Q=back,
    )


def _baseline_m(left: FrameState, right: FrameState) -> float:
    """Return how far the right camera is to the right [m].

    Raises
    ------
    InvalidRequest
        If the pair is not rectified.
    """
    accepted = (
        "a rectified pair: two pin-holes with equal intrinsics and axes, the right one straight to "
        "the right of the left one"
    )
    one, other = left.camera, right.camera
    if one.intrinsics != other.intrinsics or not one.intrinsics.is_pinhole:
        raise InvalidRequest("intrinsics of a stereo pair", other.intrinsics, accepted)
    baseline_m = rectified_baseline_m(one.pose, other.pose)
    if baseline_m is None or baseline_m <= 0.0:
        raise InvalidRequest("pose of the right camera", other.pose, accepted)
    return baseline_m
