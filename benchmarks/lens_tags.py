"""Finds AprilTags in the pictures of `lens_views.py`, and tells how far off their poses are.

    python benchmarks/lens_tags.py FOLDER

Needs opencv-contrib-python 4.x, SciPy and pupil-apriltags, and nothing of this project. The
detector knows pin-holes alone: OpenCV rectifies the pictures by K and D of the lens, into a camera
that looks at the board. Black shines a little, more here than there: it is taken away. To refine
edges the detector reads nearest pixels, no farther away than `quad_decimate` and one: it gets
pictures of twice their size, and a larger `quad_decimate`. Tags are judged whose sides have 100 px
or more in the picture itself, and which are 10 px or more from its border. A row for each model:
tags, errors of the direction of their axes [deg] and of their places [% of the distance]: median,
95 %, greatest.
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
SIZE_PX, FOCAL_PX = 1600, 900.0
LEAST_SIDE_PX, MARGIN_PX = 100.0, 10.0
"""Smaller tags are left out, and those that come nearer to the picture's border."""
TAG_CORNERS = (
    0.5 * TAG_MODULES * MODULE_M * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
)
LARGER, DECIMATE = 2, 4.0
"""Larger than the picture is the detector's; of that it first looks at every fourth pixel."""
BLACK_PX, ALIKE = 161, 1.3
"""Black is averaged in squares of such sides; its light differs by less than this factor."""

Array: TypeAlias = Any
CV: Any = cv2


def turned_to(pose: Array) -> Array:
    """Return the (3, 3) rotation into a camera that looks at the board's middle."""
    ahead = pose[:3, 3] / np.linalg.norm(pose[:3, 3])
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


def usable(corners: Array, size: tuple[int, int], maps: Array | None) -> bool:
    """Return whether a tag is large enough and whole, also in the detector's picture.

    Its true (4, 2) pixels there tell: of a tag that is cut, corners are found along the cut.
    """
    if maps is not None:
        if np.minimum(corners, SIZE_PX - 1 - corners).min() < MARGIN_PX:
            return False
        columns, rows = np.rint(corners).astype(int).T
        corners = np.stack([each[rows, columns] for each in maps], axis=1)
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    beside = np.minimum(corners, np.array(size) - 1 - corners).min()
    return bool(sides.min() >= LEAST_SIDE_PX and beside >= MARGIN_PX)


def tag_in_board(number: int) -> Array:
    """Return where a tag's middle lies on the board [m]; x right, y down, from the middle."""
    row, column = divmod(number, TAGS)
    places = [MODULE_M * (2 + (TAG_MODULES + 2) * k + 0.5 * TAG_MODULES) for k in (column, row)]
    return np.array([*places, 0.0]) - (0.5 * SIDE_M, 0.5 * SIDE_M, 0.0)


def main() -> None:
    """Judge all models that have pictures."""
    detector = Detector("tag36h11", quad_decimate=DECIMATE, refine_edges=1, decode_sharpening=0.0)
    middle = 0.5 * (SIZE_PX - 1)
    inner = np.array([[FOCAL_PX, 0, middle], [0, FOCAL_PX, middle], [0, 0, 1.0]])
    print("|model|tags|axes [deg]|places [%]|\n" + 4 * "|---" + "|")
    for folder in sorted((Path(sys.argv[1]) / "tags").iterdir()):
        truth = json.loads((folder / "truth.json").read_text())
        lens, poses = truth["lens"], np.array(truth["poses"])
        angles, places = [], []
        for path, pose in zip(sorted(folder.glob("*.png")), poses, strict=True):
            root = root_light(CV.imread(str(path), CV.IMREAD_GRAYSCALE))
            size, maps, turn, used = root.shape[::-1], None, np.eye(3), np.array(lens["K"])
            if lens["model"] != "pinhole":
                turn, used = turned_to(pose), inner
                maps = rectification(lens, turn, inner)
                root = CV.remap(root, *maps, CV.INTER_LANCZOS4)
            # The detector counts from the picture's corner, half a pixel from OpenCV.
            camera = np.array([used[0, 0], used[1, 1], used[0, 2] + 0.5, used[1, 2] + 0.5])
            for tag in detected(detector, root, camera):
                if tag.tag_id >= TAGS * TAGS:
                    continue
                true = turn @ pose[:3, :3]
                place = turn @ (pose[:3, :3] @ tag_in_board(tag.tag_id) + pose[:3, 3])
                there = (place + TAG_CORNERS @ true.T) @ used.T
                if not usable(there[:, :2] / there[:, 2:], size, maps):
                    continue
                # Its axes may be turned by quarters within the tag: only the normal is compared,
                # and the turn within the plane to the nearest quarter.
                off = true.T @ tag.pose_R
                quarter = round(math.atan2(off[1, 0], off[0, 0]) / (0.5 * math.pi))
                c, s = (
                    round(math.cos(quarter * math.pi / 2)),
                    round(math.sin(quarter * math.pi / 2)),
                )
                off = off @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
                angle = math.degrees(math.acos(min(1.0, 0.5 * (np.trace(off) - 1.0))))
                angles.append(angle)
                distance = np.linalg.norm(place)
                places.append(100.0 * np.linalg.norm(tag.pose_t.ravel() - place) / distance)
        shown = [
            ", ".join(f"{n:.3f}" for n in np.percentile(each, [50, 95, 100]))
            for each in (angles, places)
        ]
        print(f"|{folder.name}|{len(angles)}|{shown[0]}|{shown[1]}|", flush=True)


if __name__ == "__main__":
    main()
