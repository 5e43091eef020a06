"""Calibrates from the pictures of `lens_views.py` with OpenCV, and compares with the truth.

    python lens_judges.py FOLDER      needs opencv-contrib-python 4.x, nothing of this project

A row for each model: views, corners, the calibrator's residual [px], the errors of focal lengths
and axis, and how far the two laws are apart over all pixels: median, 95 %, greatest [px].
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np

COLUMNS, ROWS, SQUARE_M, MARKER_M = 12, 9, 0.1, 0.075
LEAST_CORNERS = 12

Array: TypeAlias = Any
Found: TypeAlias = list[tuple[Array, Array]]
"""Points of the board and their pixels, for each picture."""

Calibrated: TypeAlias = tuple[float, Array, Callable[[Array], Array]]
"""Residual, matrix, and the law: rays to pixels."""

ACCURATE = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 500, 1e-12)
CV: Any = cv2


def detect(folder: Path) -> Found:
    """Return what was found in each picture in which enough corners were."""
    dictionary = CV.aruco.getPredefinedDictionary(CV.aruco.DICT_5X5_250)
    board = CV.aruco.CharucoBoard((COLUMNS, ROWS), SQUARE_M, MARKER_M, dictionary)
    parameters = CV.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMax = 43
    detector = CV.aruco.CharucoDetector(board)
    detector.setDetectorParameters(parameters)
    stop = (CV.TERM_CRITERIA_EPS | CV.TERM_CRITERIA_COUNT, 50, 1e-4)
    found = []
    for path in sorted(folder.glob("*.png")):
        picture = CV.imread(str(path), CV.IMREAD_GRAYSCALE)
        corners, ids, _, _ = detector.detectBoard(picture)
        if ids is None or len(ids) < LEAST_CORNERS:
            continue
        corners = CV.cornerSubPix(picture, corners, (5, 5), (-1, -1), stop)
        points = board.getChessboardCorners()[ids.ravel()].astype(np.float64)
        found.append((points, corners.reshape(-1, 2).astype(np.float64)))
    return found


def brown(found: Found, size: tuple[int, int], flags: int) -> Calibrated:
    """Calibrate by `cv2.calibrateCamera`."""
    objects = [points.astype(np.float32).reshape(-1, 1, 3) for points, _ in found]
    images = [pixels.astype(np.float32).reshape(-1, 1, 2) for _, pixels in found]
    rms, matrix, law, _, _ = CV.calibrateCamera(
        objects, images, size, None, None, flags=flags, criteria=ACCURATE
    )
    still = np.zeros(3)
    return (
        rms,
        matrix,
        lambda rays: CV.projectPoints(rays, still, still, matrix, law)[0].reshape(-1, 2),
    )


def pinhole(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate without distortion."""
    fixed = CV.CALIB_FIX_K1 | CV.CALIB_FIX_K2 | CV.CALIB_FIX_K3
    return brown(found, size, fixed | CV.CALIB_ZERO_TANGENT_DIST)


def plumb_bob(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate with five coefficients."""
    return brown(found, size, 0)


def rational_polynomial(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate with eight coefficients."""
    return brown(found, size, CV.CALIB_RATIONAL_MODEL)


def equidistant(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate by `cv2.fisheye.calibrate`.

    It begins in the plane at depth 1, so it gets a first guess and no points near 90°.
    """
    guess, middle = size[1] / math.radians(150.0), 0.5 * np.array(size)
    reach = guess * math.radians(80.0)
    objects, images = [], []
    for points, pixels in found:
        near = np.hypot(*(pixels - middle).T) < reach
        if near.sum() >= LEAST_CORNERS:
            objects.append(points[near].reshape(1, -1, 3))
            images.append(pixels[near].reshape(1, -1, 2))
    options = CV.fisheye
    flags = options.CALIB_RECOMPUTE_EXTRINSIC | options.CALIB_FIX_SKEW
    matrix, law = np.diag([guess, guess, 1.0]), np.zeros((4, 1))
    matrix[:2, 2] = middle
    rms, matrix, law, _, _ = options.calibrate(
        objects,
        images,
        size,
        matrix,
        law,
        flags=flags | options.CALIB_USE_INTRINSIC_GUESS,
        criteria=ACCURATE,
    )

    def project(rays: Array) -> Array:
        # Its own projectPoints divides by z, which is 0 at 90°; its law does not.
        x, y, z = rays.T
        across = np.hypot(x, y)
        angle = np.arctan2(across, z)
        bent = angle * (1 + sum(law[k, 0] * angle ** (2 * k + 2) for k in range(4)))
        scale = np.where(across > 1e-12, bent / np.maximum(across, 1e-12), 1.0)
        places = np.stack([x * scale, y * scale], axis=1)
        return places * matrix[[0, 1], [0, 1]] + matrix[:2, 2]

    return rms, matrix, project


def mei(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate by `cv2.omnidir.calibrate`."""
    objects = [points.reshape(1, -1, 3) for points, _ in found]
    images = [pixels.reshape(1, -1, 2) for _, pixels in found]
    rms, matrix, xi, law, _, _, _ = CV.omnidir.calibrate(
        objects, images, size, None, None, None, CV.omnidir.CALIB_FIX_SKEW, ACCURATE
    )
    mirror, still = float(np.ravel(xi)[0]), np.zeros(3)

    def project(rays: Array) -> Array:
        places, _ = CV.omnidir.projectPoints(
            rays.reshape(1, -1, 3), still, still, matrix, mirror, law.reshape(1, 4)
        )
        return places.reshape(-1, 2)

    return rms, matrix, project


CALIBRATORS = (pinhole, plumb_bob, rational_polynomial, equidistant, mei)


def main() -> None:
    """Judge all models that have pictures."""
    print("|model|views|corners|residual|focal lengths|axis|laws apart|\n" + 7 * "|---" + "|")
    for calibrate in CALIBRATORS:
        folder = Path(sys.argv[1]) / calibrate.__name__
        if not (folder / "truth.json").exists():
            continue
        lens = json.loads((folder / "truth.json").read_text())["lens"]
        found = detect(folder)
        rms, matrix, project = calibrate(found, (lens["width"], lens["height"]))
        truth = np.array(lens["K"])
        focal = max(abs(matrix[k, k] / truth[k, k] - 1) for k in (0, 1))
        axis = max(abs(matrix[k, 2] - truth[k, 2]) / truth[k, k] for k in (0, 1))
        places, rays = (
            np.ascontiguousarray(part)
            for part in np.split(np.load(folder / "rays.npy"), [2], axis=1)
        )
        apart = np.linalg.norm(project(rays) - places, axis=1)
        low, high, most = np.percentile(apart, [50, 95, 100])
        corners = sum(len(pixels) for _, pixels in found)
        print(
            f"|{calibrate.__name__}|{len(found)}|{corners}|{rms:.3f}|{100 * focal:.3f} %|"
            f"{100 * axis:.3f} %|{low:.3f}, {high:.3f}, {most:.3f}|"
        )


if __name__ == "__main__":
    main()
