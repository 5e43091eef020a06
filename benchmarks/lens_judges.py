"""Calibrates from the pictures of `lens_views.py` with OpenCV and COLMAP, and tells how far off.

    python benchmarks/lens_judges.py FOLDER

Needs opencv-contrib-python 4.x, SciPy and pycolmap, and nothing of this project. A row for each
model and calibrator: views, corners, residual (root of the mean squared distance) [px], errors of
focal lengths and axis, and how far the two laws are apart over all pixels: median, 95 %, greatest
[px]. A turn of the camera shifts all directions alike, and the boards' poses take it up: the laws
are compared after the turn that brings them nearest.

Each calibrator begins with the corners as OpenCV finds them, and gets them again as `lens_corners`
locates them with what it has found itself, in three rounds, each until nothing is left that lies
far off. Views that it left out stay out.
"""

from __future__ import annotations

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import cv2
import numpy as np
from lens_corners import LEAST_CORNERS, Project, View, angles, detected, enough, located

ROUNDS = 3
FARTHER = 1.1
"""As far as the last corner that a law was found from, it is trusted."""
WRONG_POSE, FAR_OFF = 10.0, 6.0
"""As often the median residual, or more, has a view whose pose is the wrong one of two; and a
corner that was not well located."""
MOST_RUNS = 8
"""Of a calibrator, each without what the one before showed to be wrong."""
FISHEYE_DEG = 70.0, 86.0
"""From the axis to the last corners that `cv2.fisheye` gets: at first, and finally."""

Array: TypeAlias = Any


class Calibrated(NamedTuple):
    """Result of a calibrator; the poses are (3, 4) from the board, None where it used no view."""

    residual: float
    matrix: Array
    project: Project
    poses: list[Array | None]


ACCURATE = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 500, 1e-12)
CV: Any = cv2


def pose_of(turn: Array, shift: Array) -> Array:
    """Return the (3, 4) pose of a turn's vector and a shift."""
    return np.hstack([CV.Rodrigues(np.ravel(turn))[0], np.reshape(shift, (3, 1))])


def brown(views: Sequence[View], size: tuple[int, int], flags: int) -> Calibrated:
    """Calibrate by `cv2.calibrateCamera`."""
    objects = [view.points.astype(np.float32).reshape(-1, 1, 3) for view in views]
    images = [view.pixels.astype(np.float32).reshape(-1, 1, 2) for view in views]
    rms, matrix, law, turns, shifts = CV.calibrateCamera(
        objects, images, size, None, None, flags=flags, criteria=ACCURATE
    )
    still = np.zeros(3)

    def project(points: Array) -> Array:
        places = CV.projectPoints(points, still, still, matrix, law)[0].reshape(-1, 2)
        return np.where(points[:, 2:] > 0.0, places, np.nan)

    return Calibrated(rms, matrix, project, list(map(pose_of, turns, shifts)))


def fisheye(views: Sequence[View], size: tuple[int, int]) -> Calibrated:
    """Calibrate by `cv2.fisheye.calibrate`.

    It begins in the plane at depth 1, so it gets a first guess and no points near 90°.
    """
    guess, options = size[1] / math.radians(150.0), CV.fisheye
    matrix, law = np.diag([guess, guess, 1.0]), np.zeros((4, 1))
    matrix[:2, 2] = 0.5 * np.array(size)
    flags = options.CALIB_RECOMPUTE_EXTRINSIC | options.CALIB_FIX_SKEW
    for farthest in FISHEYE_DEG:
        angle = math.radians(farthest)
        edge = fisheye_law(matrix, law.ravel(), np.array([[math.sin(angle), 0.0, math.cos(angle)]]))
        near = [
            np.hypot(*(view.pixels - matrix[:2, 2]).T) < edge[0, 0] - matrix[0, 2] for view in views
        ]
        used = [n for n, inside in enumerate(near) if inside.sum() >= LEAST_CORNERS]
        rms, matrix, law, turns, shifts = options.calibrate(
            [views[n].points[near[n]].reshape(1, -1, 3) for n in used],
            [views[n].pixels[near[n]].reshape(1, -1, 2) for n in used],
            size,
            matrix,
            law,
            flags=flags | options.CALIB_USE_INTRINSIC_GUESS,
            criteria=ACCURATE,
        )
    poses: list[Array | None] = [None] * len(views)
    for n, turn, shift in zip(used, turns, shifts, strict=True):
        poses[n] = pose_of(turn, shift)
    return Calibrated(rms, matrix, partial(fisheye_law, matrix, law.ravel()), poses)


def fisheye_law(matrix: Array, law: Array, rays: Array) -> Array:
    """Return pixels of rays; `cv2.fisheye.projectPoints` divides by z, which is 0 at 90°."""
    x, y, z = rays.T
    across = np.hypot(x, y)
    angle = np.arctan2(across, z)
    bent = angle * (1 + sum(law[k] * angle ** (2 * k + 2) for k in range(4)))
    scale = np.where(across > 1e-12, bent / np.maximum(across, 1e-12), 1.0)
    places = np.stack([x * scale, y * scale], axis=1)
    return places * matrix[[0, 1], [0, 1]] + matrix[:2, 2]


def omnidir(views: Sequence[View], size: tuple[int, int]) -> Calibrated:
    """Calibrate by `cv2.omnidir.calibrate`."""
    rms, matrix, xi, law, turns, shifts, used = CV.omnidir.calibrate(
        [view.points.reshape(1, -1, 3) for view in views],
        [view.pixels.reshape(1, -1, 2) for view in views],
        size,
        None,
        None,
        None,
        CV.omnidir.CALIB_FIX_SKEW,
        ACCURATE,
    )
    poses: list[Array | None] = [None] * len(views)
    for n, turn, shift in zip(np.ravel(used), turns, shifts, strict=True):
        poses[n] = pose_of(turn, shift)
    mirror = float(np.ravel(xi)[0])
    return Calibrated(rms, matrix, partial(mirror_law, matrix, mirror, law.reshape(1, 4)), poses)


def mirror_law(matrix: Array, mirror: float, law: Array, rays: Array) -> Array:
    """Return pixels of rays."""
    still = np.zeros(3)
    places, _ = CV.omnidir.projectPoints(rays.reshape(1, -1, 3), still, still, matrix, mirror, law)
    return places.reshape(-1, 2)


def _off(view: View, project: Project, pose: Array) -> Array:
    """Return how far each corner of a view lies from where the law has it [px]."""
    places = project(np.ascontiguousarray(view.points @ pose[:, :3].T + pose[:, 3]))
    return np.linalg.norm(places - view.pixels, axis=1)


def colmap(name: str, views: Sequence[View], size: tuple[int, int]) -> Calibrated:
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
    times = Counter(point for view in views for point in map(tuple, view.points))
    found = []
    for view in views:
        kept = [times[point] > 1 for point in map(tuple, view.points)]
        found.append((view.points[kept], view.pixels[kept]))
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
    law: Project = lambda rays: camera.img_from_cam(rays) - 0.5  # noqa: E731
    if wide:
        law = partial(fisheye_law, matrix, camera.params[4:])
    squares, poses = [], []
    for number, (points, pixels) in enumerate(found, 1):
        pose = scene.images[number].cam_from_world()
        poses.append(pose.matrix())
        squares.append(((law(pose * points) - pixels) ** 2).sum(axis=1))
    return Calibrated(math.sqrt(np.concatenate(squares).mean()), matrix, law, poses)


def without_errors(
    calibrate: Callable[..., Calibrated], views: list[View], size: tuple[int, int]
) -> tuple[Calibrated, list[View]]:
    """Calibrate until all that is given is right; return what that gives, and from which corners.

    A flat board has two poses of nearly the same picture, and a calibrator's first guess can be the
    wrong one, which it never leaves: such views are left out of the next run, and told. So are
    corners that lie far off: one that was located 4 px beside, at the picture's rim, hides others
    that err less.
    """
    for left in reversed(range(MOST_RUNS)):
        found = calibrate(views, size)
        posed = [
            (view, pose) for view, pose in zip(views, found.poses, strict=True) if pose is not None
        ]
        off = [_off(view, found.project, pose) for view, pose in posed]
        median = np.nanmedian(np.concatenate(off))
        right = [np.median(each) < WRONG_POSE * median for each in off]
        near = [each < FAR_OFF * median for each in off]
        if all(each.all() for each in near) or not left:
            break
        if not all(right):
            print(f"{right.count(False)} views left out", file=sys.stderr)
        kept = [
            View(view.spline, view.points[close], view.pixels[close])
            for (view, _), close, fits in zip(posed, near, right, strict=True)
            if fits
        ]
        views = enough(kept)
    return found, views


def in_rounds(
    calibrate: Callable[..., Calibrated], views: list[View], size: tuple[int, int]
) -> tuple[Calibrated, list[View]]:
    """Return what a calibrator finds finally, and from which corners."""
    found, views = without_errors(calibrate, views, size)
    for _ in range(ROUNDS):
        posed = [
            (view, pose) for view, pose in zip(views, found.poses, strict=True) if pose is not None
        ]
        last = FARTHER * max(angles(view.points, pose).max() for view, pose in posed)
        views = enough([located(view, found.project, pose, last) for view, pose in posed])
        found, views = without_errors(calibrate, views, size)
    return found, views


def apart_after_turn(project: Project, rays: Array, places: Array) -> Array:
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
        first = detected(folder)
        truth = np.array(lens["K"])
        places, rays = (
            np.ascontiguousarray(part)
            for part in np.split(np.load(folder / "rays.npy"), [2], axis=1)
        )
        for name, calibrate in calibrators:
            size = lens["width"], lens["height"]
            (rms, matrix, project, _), views = in_rounds(calibrate, first, size)
            corners = sum(len(view.points) for view in views)
            focal = max(abs(matrix[k, k] / truth[k, k] - 1) for k in (0, 1))
            axis = max(abs(matrix[k, 2] / truth[k, 2] - 1) for k in (0, 1))
            apart = apart_after_turn(project, rays, places)
            low, high, most = np.percentile(apart, [50, 95, 100])
            print(
                f"|{model}|{name}|{len(views)}|{corners}|{rms:.3f}|{100 * focal:.3f} %|"
                f"{100 * axis:.3f} %|{low:.3f}, {high:.3f}, {most:.3f}|",
                flush=True,
            )


if __name__ == "__main__":
    main()
