"""The ChArUco board of `lens_views.py`, and its corners in pictures, for `lens_judges.py`.

Markers tell which corners are seen. Where a corner lies is found as Datta et al. do ("Accurate
camera calibration using iterative refinement of control points", ICCV Workshops 2009): with a first
calibration each corner's surroundings are drawn as seen from straight ahead, where edges are
straight, and `cv2.cornerSubPix` looks there. In the picture itself a lens bends the edges, and
the corner found lies off. All corners of the board are looked for, also those beside which no whole
marker is seen: so they reach to the picture's border.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import cv2
import numpy as np
from scipy.ndimage import map_coordinates, spline_filter

SIDE_M, SQUARES = 1.04, 16
"""Of every board, and along each side of this one."""
LEAST_CORNERS = 8
HALF, MARGIN = 12, 3
"""Samples from a corner to the end of its window, and from there to the end of what is drawn."""
WINDOWS = 0.2, 0.13, 0.08
"""From a corner to the end of its window, as shares of a square; markers begin at 0.25. The largest
is taken that lies in the picture."""
SOFTER = 2.0
"""Standard deviation by which what is drawn is blurred [samples]; corners scatter less then."""
LEAST_WINDOW_PX = 5.0
"""Corners with smaller windows are left out: these hold too few pixels."""
FARTHEST_OFF = 0.25
"""Share of the window by which a corner may lie off where it was expected."""
ALIKE = 0.2
"""Of the contrast: by so much two fields of one colour may differ."""

Array: TypeAlias = Any
CV: Any = cv2
Project: TypeAlias = Callable[[Array], Array]
"""From points in the optical frame to pixels; nan for those that have none."""


class View(NamedTuple):
    """Corners found in a picture: points of the board [m] and their pixels."""

    spline: Array
    """Coefficients of the picture's cubic spline."""
    points: Array
    pixels: Array


def root_light(picture: Array) -> Array:
    """Return the root of a picture's light from its sRGB bytes, 0 to 255.

    The board's edges are as soft on either side in this measure, in which textures are filtered.
    """
    share = picture.astype(np.float32) / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return (255.0 * np.sqrt(light)).astype(np.float32)


def charuco() -> Any:
    """Return the board."""
    dictionary = CV.aruco.getPredefinedDictionary(CV.aruco.DICT_5X5_250)
    square = SIDE_M / SQUARES
    return CV.aruco.CharucoBoard((SQUARES, SQUARES), square, 0.5 * square, dictionary)


def detected(folder: Path) -> list[View]:
    """Return the pictures in which enough corners were found, as OpenCV finds them."""
    board = charuco()
    parameters = CV.aruco.DetectorParameters()
    parameters.adaptiveThreshWinSizeMax = 63
    beside = CV.aruco.CharucoParameters()
    beside.minMarkers = 1
    detector = CV.aruco.CharucoDetector(board, beside)
    detector.setDetectorParameters(parameters)
    found = []
    for path in sorted(folder.glob("*.png")):
        picture = root_light(CV.imread(str(path), CV.IMREAD_GRAYSCALE))
        corners, ids, _, _ = detector.detectBoard(picture.astype(np.uint8))
        if ids is not None and len(ids) >= LEAST_CORNERS:
            points = board.getChessboardCorners()[ids.ravel()].astype(np.float64)
            spline = spline_filter(picture, mode="mirror", output=np.float32)
            found.append(View(spline, points, corners.reshape(-1, 2).astype(np.float64)))
    return found


def angles(points: Array, pose: Array) -> Array:
    """Return how far from the axis points of a board are seen [rad]."""
    there = points @ pose[:, :3].T + pose[:, 3]
    return np.arctan2(np.hypot(there[:, 0], there[:, 1]), there[:, 2])


def located(view: View, project: Project, pose: Array, farthest: float) -> View:
    """Return all corners of the board in a picture, by a first law and the board's (3, 4) pose.

    None are looked for farther than this from the axis [rad].
    """
    points = np.asarray(charuco().getChessboardCorners(), np.float64)
    points = points[angles(points, pose) < farthest]
    height, width = view.spline.shape

    def seen(places: Array) -> Array:
        return project(np.ascontiguousarray(places @ pose[:, :3].T + pose[:, 3]))

    with np.errstate(invalid="ignore"):
        middle = seen(points) if len(points) else np.empty((0, 2))
        points = points[((middle >= 0) & (middle <= (width - 1, height - 1))).all(axis=1)]
    found = []
    for window in WINDOWS:
        fits, *corners = _in_windows(view.spline, points, window * SIDE_M / SQUARES, seen)
        found.append(corners)
        points = points[~fits]
    points, places = (np.concatenate(part) for part in zip(*found, strict=True))
    return View(view.spline, points, seen(places) if len(points) else points[:, :2])


def _in_windows(
    spline: Array, points: Array, window_m: float, seen: Project
) -> tuple[Array, Array, Array]:
    """Return whose windows lie in the picture; corners found in theirs, and where they seem to lie.

    All are points of the board [m].
    """
    if not len(points):
        return np.zeros(0, np.bool_), points, points
    height, width = spline.shape
    step, reach = window_m / HALF, HALF + MARGIN
    edge = 2 * reach + 1
    offsets = np.arange(-reach, reach + 1) * step
    across, down = np.meshgrid(offsets, offsets)
    samples = points[:, None, None] + np.stack([across, down, np.zeros_like(across)], axis=-1)
    with np.errstate(invalid="ignore"):
        places = seen(samples.reshape(-1, 3)).reshape(-1, edge, edge, 2)
        fits = ((places >= 1) & (places <= (width - 2, height - 2))).all(axis=(1, 2, 3))
    points, places = points[fits], places[fits]
    ends = places[:, [MARGIN, -MARGIN - 1, reach, reach], [reach, reach, MARGIN, -MARGIN - 1]]
    down_px, across_px = ends[:, 1] - ends[:, 0], ends[:, 3] - ends[:, 2]
    large = np.minimum(np.hypot(*down_px.T), np.hypot(*across_px.T)) > 2.0 * LEAST_WINDOW_PX
    # Where a law folds, the board seems to be seen from behind.
    large &= across_px[:, 0] * down_px[:, 1] > across_px[:, 1] * down_px[:, 0]
    points, places = points[large], places[large]
    if not len(points):
        return fits, points, points
    # `cv2.remap` rounds places to 1/32 px.
    rows_columns = np.moveaxis(places.reshape(-1, edge, 2)[..., ::-1], -1, 0)
    sharp = map_coordinates(spline, rows_columns, mode="mirror", prefilter=False)
    fronts = np.stack(
        [
            CV.GaussianBlur(each, (0, 0), SOFTER, borderType=CV.BORDER_REPLICATE)
            for each in sharp.reshape(-1, edge, edge)
        ]
    )
    starts = np.array([(reach, reach + edge * k) for k in range(len(points))], np.float32)
    stop = (CV.TERM_CRITERIA_EPS | CV.TERM_CRITERIA_COUNT, 100, 1e-5)
    ends = CV.cornerSubPix(
        fronts.reshape(-1, edge), starts[:, None].copy(), (HALF, HALF), (-1, -1), stop
    )[:, 0]
    moved = ends.astype(np.float64) - starts
    kept = np.abs(moved).max(axis=1) < FARTHEST_OFF * HALF
    kept &= chequered(fronts)
    there = points + np.pad(moved * step, ((0, 0), (0, 1)))
    return fits, points[kept], there[kept]


def chequered(fronts: Array) -> Array:
    """Return of which (n, edge, edge) pictures the fields about the middle are those of a board."""
    low, high = MARGIN, HALF + MARGIN - 4
    parts = slice(low, high), slice(-high, -low)
    means = np.stack([fronts[:, r, c].mean(axis=(1, 2)) for r in parts for c in parts], axis=1)
    lower, upper = np.sort(means, axis=1)[:, :2], np.sort(means, axis=1)[:, 2:]
    contrast = upper.mean(axis=1) - lower.mean(axis=1)
    apart = np.maximum(np.ptp(lower, axis=1), np.ptp(upper, axis=1))
    diagonal = (means[:, 0] > means[:, 1]) == (means[:, 3] > means[:, 2])
    return (contrast > 40.0) & (apart < ALIKE * contrast) & diagonal


def enough(views: Sequence[View]) -> list[View]:
    """Return the views with enough corners."""
    return [view for view in views if len(view.points) >= LEAST_CORNERS]
