"""Pictures through a lens, which OpenCV rectifies by our CameraInfo, beside those of a pin-hole."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from std_msgs.msg import Header

from sailenv_msgs_py.camera_info import camera_info_from_intrinsics
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings
from tests.support.tiny_scenes import Thing, model_of, snapshot_of, wall_mesh

SIZE: dict[str, Any] = {"width": 640, "height": 480, "cx_offset_px": 4.3, "cy_offset_px": -3.1}
PICTURE = PictureSettings(smooth_edges=False, tone_curve="linear")
SQUARES, SQUARE_TEXELS = 8, 64
INNER = SQUARES - 1, SQUARES - 1

LENSES: dict[str, dict[str, Any]] = {
    "plumb_bob": {"fx_px": 458.6, "fy_px": 457.3, "distortion": (-0.2834, 0.0739, 2e-4, 2e-5)},
    "rational_polynomial": {
        "fx_px": 430.0,
        "fy_px": 433.0,
        "distortion": (0.5285, -2.6231, 0.00057, -0.00019, 1.5135, 0.4061, -2.4526, 1.4466),
    },
    "thin prism": {
        "fx_px": 430.0,
        "fy_px": 433.0,
        "distortion_model": "rational_polynomial",
        "distortion": (
            *(0.2, -0.1, 0.00057, -0.00019, 0.01, 0.3, -0.05, 0.01),
            *(0.004, -0.001, -0.003, 0.0008),
        ),
    },
    "equidistant": {
        "fx_px": 300.0,
        "fy_px": 301.0,
        "distortion": (-0.0132, 0.0421, -0.0395, 0.0069),
    },
}


def chessboard() -> NDArray[np.uint8]:
    """A texture of 8 x 8 squares, whose edges are soft enough for pixels to tell their places."""
    squares = np.indices((SQUARES, SQUARES)).sum(axis=0) % 2
    sharp = np.kron(squares, np.ones((SQUARE_TEXELS, SQUARE_TEXELS)))
    grey = cv2.GaussianBlur(sharp, (0, 0), 2.0, borderType=cv2.BORDER_REPLICATE) * 200.0 + 20.0
    return np.dstack([grey, grey, grey, np.full_like(grey, 255.0)]).astype(np.uint8)


def corners_of(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    """All inner corners of the board."""
    grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    found, corners = cv2.findChessboardCorners(grey, INNER)
    assert found
    stop = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 100, 1e-4)
    corners = cv2.cornerSubPix(grey, corners, (12, 12), (-1, -1), stop)
    return np.asarray(corners, np.float64).reshape(-1, 2)


@pytest.mark.parametrize("name", LENSES)
def test_a_rectified_picture_is_that_of_a_pin_hole(name: str) -> None:
    """By K, D, R and P of the message: corners to 0.05 px, and half of the pixels to 2 of 255."""
    model = {"distortion_model": name} | LENSES[name]
    lens = CameraIntrinsics(**SIZE, **model)
    info = camera_info_from_intrinsics(lens, Header())
    K, R, P = (np.reshape(part, (3, -1)) for part in (info.k, info.r, info.p))
    D = np.array(info.d)
    flat = CameraIntrinsics(**SIZE, fx_px=float(P[0, 0]), fy_px=float(P[1, 1]))
    np.testing.assert_array_equal(flat.P, P)
    board = model_of(wall_mesh(2.0, 2.0), base_colour_texture=chessboard(), roughness=1.0)
    scene = snapshot_of([Thing(board, Pose.from_rpy_deg((1.9, 0.1, 0.05), (4.0, 9.0, 12.0)))])
    size = (lens.width, lens.height)
    if info.distortion_model == "equidistant":
        maps = cv2.fisheye.initUndistortRectifyMap(K, D, R, P, size, cv2.CV_32FC1)
    else:
        maps = cv2.initUndistortRectifyMap(K, D, R, P[:, :3], size, cv2.CV_32FC1)
    renderer = NativeRenderer()
    bent, straight = (
        np.asarray(
            renderer.render(
                RenderRequest(scene, Camera(intrinsics=each, picture=PICTURE), ("rgb",))
            ).views["rgb"]
        )
        for each in (lens, flat)
    )
    renderer.close()
    rectified = np.asarray(cv2.remap(bent, *maps, cv2.INTER_LANCZOS4), np.uint8)
    off = corners_of(rectified) - corners_of(straight)
    assert np.sqrt((off**2).sum(axis=1)).max() <= 0.05
    whole = cv2.remap(np.full(bent.shape[:2], 255, np.uint8), *maps, cv2.INTER_LINEAR) == 255
    steps = np.abs(rectified.astype(int) - straight)[whole]
    assert whole.mean() > 0.5
    assert np.median(steps) <= 2.0
    assert np.abs(corners_of(bent) - corners_of(straight)).max() > 2.0
