"""Calibrates from the pictures of `lens_views.py` with OpenCV and COLMAP, and tells how far off.

    python benchmarks/lens_judges.py FOLDER

Needs opencv-contrib-python 4.x and pycolmap, and nothing of this project. A row for each model and
calibrator: views, corners, residual (root of the mean squared distance) [px], errors of focal
lengths and axis, and how far the two laws are apart over all pixels: median, 95 %, greatest [px].
A turn of the camera shifts all directions alike, and the boards' poses take it up: the laws are
compared after the turn that brings them nearest.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np

SIDE_M, SQUARES, WIDE_SQUARES = 1.04, 12, 8
WIDE = "equidistant", "mei"
LEAST_CORNERS = 8
WRONG_POSE = 10.0
"""As often the median residual, or more, has a view whose pose is the wrong one of two."""

Array: TypeAlias = Any
Found: TypeAlias = list[tuple[Array, Array]]
"""Points of the board and their pixels, for each picture."""

Calibrated: TypeAlias = tuple[float, Array, Callable[[Array], Array]]
"""Residual, matrix, and the law: rays to pixels."""

ACCURATE = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 500, 1e-12)
CV: Any = cv2


def linear_light(picture: Array) -> Array:
    """Return a picture's light from its sRGB bytes: an edge lies where half of it is left."""
    share = picture.astype(np.float32) / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return (255.0 * light).astype(np.float32)


def detect(folder: Path, squares: int) -> Found:
    """Return what was found in each picture in which enough corners were."""
    dictionary = CV.aruco.getPredefinedDictionary(CV.aruco.DICT_5X5_250)
    square = SIDE_M / squares
    board = CV.aruco.CharucoBoard((squares, squares), square, 0.5 * square, dictionary)
    parameters = CV.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMax = 63
    detector = CV.aruco.CharucoDetector(board)
    detector.setDetectorParameters(parameters)
    found = []
    for path in sorted(folder.glob("*.png")):
        picture = CV.imread(str(path), CV.IMREAD_GRAYSCALE)
        corners, ids, _, _ = detector.detectBoard(picture)
        if ids is None or len(ids) < LEAST_CORNERS:
            continue
        points = board.getChessboardCorners()[ids.ravel()].astype(np.float64)
        found.append((points, refined(linear_light(picture), corners.reshape(-1, 2))))
    return [(points[kept], pixels[kept]) for points, (pixels, kept) in found if kept.any()]


def refined(light: Array, corners: Array) -> tuple[Array, Array]:
    """Return corners to a part of a pixel, and which of them are.

    Each is looked for in a window that holds no other corner, and nothing of a marker.
    """
    stop = (CV.TERM_CRITERIA_EPS | CV.TERM_CRITERIA_COUNT, 100, 1e-4)
    height, width = light.shape
    apart = np.linalg.norm(corners[:, None] - corners[None], axis=-1)
    nearest = np.min(apart + np.diag(np.full(len(corners), np.inf)), axis=1)
    places, kept = np.empty(corners.shape), np.zeros(len(corners), np.bool_)
    for number, (corner, near) in enumerate(zip(corners, nearest, strict=True)):
        half = int(min(max(0.17 * near, 2.0), 8.0))
        start = corner.astype(np.float32).reshape(1, 1, 2)
        for _ in range(2):
            start = CV.cornerSubPix(light, start, (half, half), (-1, -1), stop)
        x, y = places[number] = start.reshape(2)
        inside = half + 1 <= x < width - half - 2 and half + 1 <= y < height - half - 2
        kept[number] = inside and near > 14.0 and math.dist((x, y), corner) < 2.0
    return places, kept


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


def fisheye(found: Found, size: tuple[int, int]) -> Calibrated:
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
    return rms, matrix, partial(fisheye_law, matrix, law.ravel())


def fisheye_law(matrix: Array, law: Array, rays: Array) -> Array:
    """Return pixels of rays; `cv2.fisheye.projectPoints` divides by z, which is 0 at 90°."""
    x, y, z = rays.T
    across = np.hypot(x, y)
    angle = np.arctan2(across, z)
    bent = angle * (1 + sum(law[k] * angle ** (2 * k + 2) for k in range(4)))
    scale = np.where(across > 1e-12, bent / np.maximum(across, 1e-12), 1.0)
    places = np.stack([x * scale, y * scale], axis=1)
    return places * matrix[[0, 1], [0, 1]] + matrix[:2, 2]


def omnidir(found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate by `cv2.omnidir.calibrate`, twice.

    A flat board has two poses of nearly the same picture, and this calibrator's first guess can be
    the wrong one, which it never leaves. Such views are left out of the second run, and told.
    """
    objects = [points.reshape(1, -1, 3) for points, _ in found]
    images = [pixels.reshape(1, -1, 2) for _, pixels in found]
    for last in (False, True):
        rms, matrix, xi, law, turns, shifts, used = CV.omnidir.calibrate(
            objects, images, size, None, None, None, CV.omnidir.CALIB_FIX_SKEW, ACCURATE
        )
        mirror, still = float(np.ravel(xi)[0]), np.zeros(3)
        if last:
            break
        views = np.ravel(used)
        residuals = [
            _residual(objects[view], images[view], turn, shift, (matrix, mirror, law))
            for view, turn, shift in zip(views, turns, shifts, strict=True)
        ]
        kept = views[residuals < WRONG_POSE * np.median(residuals)]
        if len(kept) < len(found):
            print(f"cv2.omnidir: {len(found) - len(kept)} views left out", file=sys.stderr)
        objects, images = [objects[view] for view in kept], [images[view] for view in kept]

    def project(rays: Array) -> Array:
        places, _ = CV.omnidir.projectPoints(
            rays.reshape(1, -1, 3), still, still, matrix, mirror, law.reshape(1, 4)
        )
        return places.reshape(-1, 2)

    return rms, matrix, project


def _residual(
    points: Array, pixels: Array, turn: Array, shift: Array, lens: tuple[Array, float, Array]
) -> float:
    """Return the root of the mean squared distance of a view's corners [px]."""
    matrix, mirror, law = lens
    places, _ = CV.omnidir.projectPoints(points, turn, shift, matrix, mirror, law)
    return float(np.sqrt(((places.reshape(-1, 2) - pixels.reshape(-1, 2)) ** 2).sum(1).mean()))


def colmap(name: str, found: Found, size: tuple[int, int]) -> Calibrated:
    """Calibrate by COLMAP's bundle adjustment over the board's points, which stay.

    It begins as `cv2.calibrateCamera` or `cv2.fisheye.calibrate` do: from a rough focal length.
    COLMAP counts from the picture's corner, half a pixel from ours.
    """
    import pycolmap

    wide = "FISHEYE" in name
    guess = size[1] / math.radians(150.0) if wide else 0.7 * size[0]
    scene = pycolmap.Reconstruction()
    camera = pycolmap.Camera.create_from_model_id(
        1, getattr(pycolmap.CameraModelId, name), guess, *size
    )
    scene.add_camera_with_trivial_rig(camera)
    camera = scene.cameras[1]
    # It wants each point to be seen twice.
    times = Counter(point for points, _ in found for point in map(tuple, points))
    kept = [[times[point] > 1 for point in map(tuple, points)] for points, _ in found]
    found = [(points[k], pixels[k]) for (points, pixels), k in zip(found, kept, strict=True)]
    numbers: dict[tuple[float, ...], int] = {}
    for points, _ in found:
        for point in map(tuple, points):
            if point not in numbers:
                numbers[point] = scene.add_point3D(np.array(point), pycolmap.Track())
    config = pycolmap.BundleAdjustmentConfig()
    for number, (points, pixels) in enumerate(found, 1):
        first = pycolmap.AbsolutePoseEstimationOptions()
        first.ransac.max_error = 40.0
        pose = pycolmap.estimate_and_refine_absolute_pose(pixels + 0.5, points, camera, first)
        image = pycolmap.Image(
            name=str(number), keypoints=pixels + 0.5, camera_id=1, image_id=number
        )
        scene.add_image_with_trivial_frame(image, pose["cam_from_world"])
        for k, point in enumerate(map(tuple, points)):
            scene.add_observation(numbers[point], pycolmap.TrackElement(number, k))
        config.add_image(number)
    for number in numbers.values():
        config.add_constant_point(number)
    options = pycolmap.BundleAdjustmentOptions()
    options.refine_principal_point = True
    options.print_summary = False
    options.ceres.solver_options.max_num_iterations = 1000
    options.ceres.solver_options.gradient_tolerance = 1e-12
    pycolmap.create_default_bundle_adjuster(options, config, scene).solve()
    camera = scene.cameras[1]
    fx, fy, cx, cy = camera.params[:4]
    matrix = np.array([[fx, 0.0, cx - 0.5], [0.0, fy, cy - 0.5], [0.0, 0.0, 1.0]])
    squares = []
    for number, (points, pixels) in enumerate(found, 1):
        seen = scene.images[number].cam_from_world() * points
        squares.append(((camera.img_from_cam(seen) - 0.5 - pixels) ** 2).sum(axis=1))
    law: Callable[[Array], Array] = lambda rays: camera.img_from_cam(rays) - 0.5  # noqa: E731
    if wide:
        law = partial(fisheye_law, matrix, camera.params[4:])
    return math.sqrt(np.concatenate(squares).mean()), matrix, law


def apart_after_turn(project: Callable[[Array], Array], rays: Array, places: Array) -> Array:
    """Return distances [px] of the law's pixels from the true places, after the best turn."""
    turn = np.zeros(3)

    def off(angles: Array) -> Array:
        return project(np.ascontiguousarray(rays @ CV.Rodrigues(angles)[0].T)) - places

    for _ in range(4):
        here, step = off(turn), 1e-5
        slopes = np.stack([(off(turn + step * e) - here).ravel() / step for e in np.eye(3)], axis=1)
        turn = turn - np.linalg.lstsq(slopes, here.ravel(), rcond=None)[0]
    return np.linalg.norm(off(turn), axis=1)


FIXED = CV.CALIB_FIX_K1 | CV.CALIB_FIX_K2 | CV.CALIB_FIX_K3 | CV.CALIB_ZERO_TANGENT_DIST
CALIBRATORS: Mapping[str, Sequence[tuple[str, Callable[..., Calibrated]]]] = {
    "pinhole": [("cv2.calibrateCamera", partial(brown, flags=FIXED))],
    "plumb_bob": [
        ("cv2.calibrateCamera", partial(brown, flags=0)),
        ("pycolmap, OPENCV", partial(colmap, "OPENCV")),
    ],
    "rational_polynomial": [
        ("cv2.calibrateCamera, rational", partial(brown, flags=CV.CALIB_RATIONAL_MODEL)),
        ("pycolmap, FULL_OPENCV", partial(colmap, "FULL_OPENCV")),
    ],
    "thin_prism": [
        (
            "cv2.calibrateCamera, rational and thin prism",
            partial(brown, flags=CV.CALIB_RATIONAL_MODEL | CV.CALIB_THIN_PRISM_MODEL),
        )
    ],
    "equidistant": [
        ("cv2.fisheye.calibrate", fisheye),
        ("pycolmap, OPENCV_FISHEYE", partial(colmap, "OPENCV_FISHEYE")),
    ],
    "mei": [("cv2.omnidir.calibrate", omnidir)],
}


def main() -> None:
    """Judge all models that have pictures."""
    print("|model|calibrator|views|corners|residual|fx, fy|cx, cy|laws apart|\n" + 8 * "|---" + "|")
    for model, calibrators in CALIBRATORS.items():
        folder = Path(sys.argv[1]) / "charuco" / model
        if not (folder / "truth.json").exists():
            continue
        lens = json.loads((folder / "truth.json").read_text())["lens"]
        found = detect(folder, WIDE_SQUARES if model in WIDE else SQUARES)
        truth = np.array(lens["K"])
        places, rays = (
            np.ascontiguousarray(part)
            for part in np.split(np.load(folder / "rays.npy"), [2], axis=1)
        )
        corners = sum(len(pixels) for _, pixels in found)
        for name, calibrate in calibrators:
            rms, matrix, project = calibrate(found, (lens["width"], lens["height"]))
            focal = max(abs(matrix[k, k] / truth[k, k] - 1) for k in (0, 1))
            axis = max(abs(matrix[k, 2] / truth[k, 2] - 1) for k in (0, 1))
            apart = apart_after_turn(project, rays, places)
            low, high, most = np.percentile(apart, [50, 95, 100])
            print(
                f"|{model}|{name}|{len(found)}|{corners}|{rms:.3f}|{100 * focal:.3f} %|"
                f"{100 * axis:.3f} %|{low:.3f}, {high:.3f}, {most:.3f}|"
            )


if __name__ == "__main__":
    main()
