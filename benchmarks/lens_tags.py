"""Finds AprilTags in the pictures of `lens_views.py`, and tells how far off their poses are.

    python benchmarks/lens_tags.py FOLDER

Needs opencv-contrib-python 4.x, SciPy and pupil-apriltags, and nothing of this project. The
detector knows pin-holes alone: OpenCV rectifies the pictures by K and D of the lens, into a camera
that looks at the tag. Black shines a little, more here than there: it is taken away. To refine
edges the detector reads nearest pixels, no farther away than `quad_decimate` and one, where all of
a soft edge must lie: it gets pictures of twice their size, and a larger `quad_decimate`. Along an
edge that nearly is a row or a column of pixels it errs by up to half a pixel, always to one side:
the camera is rolled about its axis into three positions, and of a tag's poses the one counts that
is nearest to their median. Tags are judged that are found in all three, whose sides have 100 px or
more in the picture itself, and which are 10 px or more from its border. A row for each model: tags,
errors of the direction of their axes [deg] and of their places [% of the distance]: median, 95 %,
greatest.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any, TypeAlias

import cv2
import numpy as np
from lens_corners import SIDE_M, root_light
from pupil_apriltags import Detector

MODULES, TAG_MODULES, TAGS = 32, 8, 3
MODULE_M = SIDE_M / MODULES
SIZE_PX, FOCAL_PX = 1000, 900.0
LEAST_SIDE_PX, MARGIN_PX = 100.0, 10.0
"""Smaller tags are left out, and those that come nearer to the picture's border."""
TAG_CORNERS = (
    0.5 * TAG_MODULES * MODULE_M * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
)
ROLLS_DEG = (15.0, 45.0, 75.0)
"""The camera is turned about its axis by so much."""
LARGER, DECIMATE = 2, 6.0
"""Larger than the picture is the detector's; of that it first looks at every sixth pixel."""
BLACK_PX, ALIKE = 161, 1.3
"""Black is averaged in squares of such sides; its light differs by less than this factor."""

Array: TypeAlias = Any
CV: Any = cv2


def turned_to(place: Array) -> Array:
    """Return the (3, 3) rotation into a camera that looks at a place."""
    ahead = place / np.linalg.norm(place)
    right = np.cross([0.0, 1.0, 0.0] if abs(ahead[1]) < 0.9 else [1.0, 0.0, 0.0], ahead)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def rectification(lens: dict[str, Any], turn: Array, inner: Array) -> Array:
    """Return two maps: where a pin-hole of matrix `inner`, that is turned, finds its pixels."""
    K, D, size = np.array(lens["K"]), np.array(lens["D"]), (SIZE_PX, SIZE_PX)
    if lens["model"] == "equidistant":
        return CV.fisheye.initUndistortRectifyMap(K, D, turn, inner, size, CV.CV_32FC1)
    if lens["model"] == "mei":
        return CV.omnidir.initUndistortRectifyMap(
            K, D[1:], D[:1], turn, inner, size, CV.CV_32FC1, CV.omnidir.RECTIFY_PERSPECTIVE
        )
    return CV.initUndistortRectifyMap(K, D, turn, inner, size, CV.CV_32FC1)


def from_black(root: Array, found: list[Any]) -> Array:
    """Return the root of light above that of the tags' black, which shines a little.

    Else soft edges seem to lie farther out. It shines unlike from place to place.
    """
    inside = np.zeros(root.shape, np.uint8)
    for tag in found:
        CV.fillConvexPoly(inside, np.rint(tag.corners).astype(np.int32), 1)
    if not inside.any():
        return root
    light = root**2
    darkest = np.percentile(light[inside > 0], 5)
    dark = ((inside > 0) & (light < ALIKE * darkest)).astype(np.float32)
    share, black = (CV.blur(each, (BLACK_PX, BLACK_PX)) for each in (dark, dark * light))
    black = np.where(share > 1e-4, black / np.maximum(share, 1e-4), darkest)
    return np.sqrt(np.maximum(light - black, 0.0))


def detected(detector: Any, root: Array, camera: Array) -> list[Any]:
    """Return the tags in the root of a picture's light; corners in its pixels, from its corner.

    `camera` is (fx, fy, cx, cy) [px]. A first look tells where black is.
    """
    found: list[Any] = []
    for _ in range(2):
        light = from_black(root, found)
        light = CV.resize(light, None, fx=LARGER, fy=LARGER, interpolation=CV.INTER_CUBIC)
        picture = np.clip(np.rint(light), 0, 255).astype(np.uint8)
        found = detector.detect(picture, True, LARGER * camera, TAG_MODULES * MODULE_M)
        for tag in found:
            tag.corners = tag.corners / LARGER
    return found


def usable(corners: Array, size: tuple[int, int], maps: Array) -> bool:
    """Return whether a tag is large enough and whole, also in the detector's picture.

    Its true (4, 2) pixels there tell: of a tag that is cut, corners are found along the cut.
    """
    if np.minimum(corners, SIZE_PX - 1 - corners).min() < MARGIN_PX:
        return False
    columns, rows = np.rint(corners).astype(int).T
    corners = np.stack([each[rows, columns] for each in maps], axis=1)
    if not np.isfinite(corners).all():
        return False
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    beside = np.minimum(corners, np.array(size) - 1 - corners).min()
    return bool(sides.min() >= LEAST_SIDE_PX and beside >= MARGIN_PX)


def tag_in_board(number: int) -> Array:
    """Return where a tag's middle lies on the board [m]; x right, y down, from the middle."""
    row, column = divmod(number, TAGS)
    places = [MODULE_M * (2 + (TAG_MODULES + 2) * k + 0.5 * TAG_MODULES) for k in (column, row)]
    return np.array([*places, 0.0]) - (0.5 * SIDE_M, 0.5 * SIDE_M, 0.0)


def rolled(degrees: float) -> Array:
    """Return the (3, 3) rotation into a camera that is rolled about its axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def looks(
    detector: Any, root: Array, lens: dict[str, Any], pose: Array, number: int
) -> list[tuple[Array, Array]]:
    """Return a tag's pose by each roll, a rotation and a place [m]; empty if it is not usable."""
    found = []
    middle = 0.5 * (SIZE_PX - 1)
    inner = np.array([[FOCAL_PX, 0, middle], [0, FOCAL_PX, middle], [0, 0, 1.0]])
    # The detector counts from the picture's corner, half a pixel from OpenCV.
    camera = np.array([FOCAL_PX, FOCAL_PX, middle + 0.5, middle + 0.5])
    place = pose[:3, :3] @ tag_in_board(number) + pose[:3, 3]
    for degrees in ROLLS_DEG:
        turn = rolled(degrees) @ turned_to(place)
        there = (place + TAG_CORNERS @ pose[:3, :3].T) @ turn.T @ inner.T
        maps = rectification(lens, turn, inner)
        if there[:, 2].min() <= 0 or not usable(
            there[:, :2] / there[:, 2:], root.shape[::-1], maps
        ):
            return []
        for tag in detected(detector, CV.remap(root, *maps, CV.INTER_LANCZOS4), camera):
            if tag.tag_id == number:
                # Where it tells of more than one minimum the third axis may point the other way.
                seen = tag.pose_R * [1.0, 1.0, np.linalg.det(tag.pose_R)]
                found.append((turn.T @ seen, turn.T @ tag.pose_t.ravel()))
    return found if len(found) == len(ROLLS_DEG) else []


def nearest_to_median(poses: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Return the pose whose corners are nearest to the median of all."""
    corners = np.array([place + TAG_CORNERS @ turn.T for turn, place in poses])
    off = np.linalg.norm(corners - np.median(corners, axis=0), axis=2).max(axis=1)
    return poses[int(np.argmin(off))]


def angle_deg(true: Array, seen: Array) -> float:
    """Return the angle between two rotations [deg].

    Axes may be turned by quarters within the tag: the turn within its plane counts to the nearest.
    """
    off = true.T @ seen
    off = off @ rolled(-90.0 * round(math.atan2(off[1, 0], off[0, 0]) / (0.5 * math.pi)))
    return math.degrees(math.acos(min(1.0, 0.5 * (np.trace(off) - 1.0))))


def main() -> None:
    """Judge all models that have pictures."""
    detector = Detector("tag36h11", quad_decimate=DECIMATE, refine_edges=1, decode_sharpening=0.0)
    print("|model|tags|axes [deg]|places [%]|\n" + 4 * "|---" + "|")
    for folder in sorted((Path(sys.argv[1]) / "tags").iterdir()):
        truth = json.loads((folder / "truth.json").read_text())
        angles, places = [], []
        for path, told in zip(sorted(folder.glob("*.png")), truth["poses"], strict=True):
            root, pose = root_light(CV.imread(str(path), CV.IMREAD_GRAYSCALE)), np.array(told)
            for number in range(TAGS * TAGS):
                poses = looks(detector, root, truth["lens"], pose, number)
                if not poses:
                    continue
                turn, place = nearest_to_median(poses)
                true = pose[:3, :3] @ tag_in_board(number) + pose[:3, 3]
                angles.append(angle_deg(pose[:3, :3], turn))
                places.append(100.0 * np.linalg.norm(place - true) / np.linalg.norm(true))
        shown = [
            ", ".join(f"{n:.3f}" for n in np.percentile(each, [50, 95, 100]))
            for each in (angles, places)
        ]
        print(f"|{folder.name}|{len(angles)}|{shown[0]}|{shown[1]}|", flush=True)


if __name__ == "__main__":
    main()
