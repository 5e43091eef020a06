"""The part of a picture in which what lies outside a room can be seen: that of the openings.

An eye in a closed room sees through windows and doors alone. What lies outside is neither culled
nor drawn beyond the rectangle around them, which changes no pixel.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import unit_rays
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.outside import Outside
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["OpeningWindows"]

MARGIN_PX = 2
NEAREST_M = 1e-3

LENS_MARGIN_PX = 6
"""The same through a lens that bends the outlines of openings, which are followed in `STEPS`."""

STEPS = 128
LEAST_AHEAD = 0.37
"""Least cosine from the axis of what a lens sees that sees ahead alone: up to 68 degrees."""

FARTHEST = 4.0
"""Coordinates at depth 1 m up to which outlines are followed: further than such a lens sees."""

BEYOND_PX = 1e6

Rectangle = tuple[int, int, int, int]

NOTHING: Rectangle = 1, 1, 0, 0

_ALONG = np.linspace(0.0, 1.0, STEPS)[:, None, None]


class OpeningWindows:
    """Finds the rectangle for each picture; keeps where the parts of the contents are."""

    def __init__(self) -> None:
        self._contents: SceneContents | None = None
        self._outside: Outside | None = None
        self._row = -1
        self._shell_rows: list[int] | None = None
        self._shell_poses = np.zeros((0, 4, 4))
        self._corners = np.zeros((0, 8, 3))

    def of(self, snapshot: WorldSnapshot, camera: Camera) -> tuple[int, Rectangle] | None:
        """Return the row of what lies outside, and where it can be seen.

        Returns
        -------
        found : (int, (4,) tuple of int) or None
            First column and row, last column and row; the first is greater than the last where
            nothing can be seen. None where all of the picture may show it.
        """
        self._know(snapshot.contents)
        outside = self._outside
        if outside is None or self._shell_rows is None:
            return None
        if camera.intrinsics.is_parallel:
            return None  # some rays may begin outside
        eye = camera.world_from_camera[:3, 3]
        if not ((eye > outside.low_m) & (eye < outside.high_m)).all():
            return None
        if not np.array_equal(snapshot.world_from_body[self._shell_rows], self._shell_poses):
            return None
        around = _around(self._corners, camera)
        return None if around is None else (self._row, around)

    def _know(self, contents: SceneContents) -> None:
        if self._contents is contents:
            return
        self._contents, self._outside, self._shell_rows = contents, None, None
        rows = [row for row, drawn in enumerate(contents.instances) if drawn.outside is not None]
        if not rows:
            return
        self._row, self._outside = rows[0], contents.instances[rows[0]].outside
        assert self._outside is not None
        named = {
            drawn.instance.name: row
            for row, drawn in enumerate(contents.instances)
            if all(part.material.alpha == "opaque" for part in drawn.model.parts)
        }
        shell = self._outside.shell
        if shell and named.keys() >= shell.keys():
            self._shell_rows = [named[name] for name in shell]
            self._shell_poses = np.tile(np.eye(4), (len(shell), 1, 1))
            self._shell_poses[:, :3, 3] = list(shell.values())
            openings = [
                list(product(*zip(*ends, strict=True))) for ends in self._outside.openings_m
            ]
            self._corners = np.array(openings, np.float64).reshape(-1, 8, 3)


def _around(corners: NDArray[np.float64], camera: Camera) -> Rectangle | None:
    """Return the rectangle around all openings (N, 8, 3), in pixels; empty if none is seen.

    None where a lens may show them anywhere.
    """
    lens = camera.intrinsics
    turn, shift = camera.camera_from_world[:3, :3], camera.camera_from_world[:3, 3]
    if not lens.is_pinhole:
        return _around_through_lens(corners @ turn.T + shift, lens)
    focal, centre = np.array([lens.fx, lens.fy]), np.array([lens.cx, lens.cy])
    found = []
    for seen in corners @ turn.T + shift:
        points = _before_eye(seen)
        if len(points):
            found.append(points[:, :2] / points[:, 2:] * focal + centre)
    if not found:
        return NOTHING
    return _rectangle(np.concatenate(found), [len(each) for each in found], lens, MARGIN_PX)


def _rectangle(
    places: NDArray[np.float64], counts: list[int], lens: CameraIntrinsics, margin: int
) -> Rectangle:
    """Return the rectangle around those of some outlines that reach into the picture.

    Their places (N, 2) lie one outline after another, so many of each.
    """
    starts = np.cumsum([0, *counts[:-1]])
    low, high = np.minimum.reduceat(places, starts), np.maximum.reduceat(places, starts)
    # Numbers of Python: there are a few openings, and an array's operation takes longer than all.
    right, bottom = lens.width - 1, lens.height - 1
    seen = [
        (*first, *last)
        for first, last in zip(low.tolist(), high.tolist(), strict=True)
        if min(last) >= -margin and first[0] <= right + margin and first[1] <= bottom + margin
    ]
    if not seen:
        return NOTHING
    lefts, tops, rights, bottoms = zip(*seen, strict=True)
    return (
        min(max(math.floor(min(lefts)) - margin, 0), right),
        min(max(math.floor(min(tops)) - margin, 0), bottom),
        min(max(math.ceil(max(rights)) + margin, 0), right),
        min(max(math.ceil(max(bottoms)) + margin, 0), bottom),
    )


@lru_cache(maxsize=8)
def _sees_ahead_alone(lens: CameraIntrinsics) -> bool:
    return bool(np.nanmin(unit_rays(lens)[..., 2]) >= LEAST_AHEAD)


def _around_through_lens(corners: NDArray[np.float64], lens: CameraIntrinsics) -> Rectangle | None:
    """Return the rectangle around all openings (N, 8, 3) of the optical frame.

    At depth 1 an opening has a convex outline, whose image ends where the outline's does. What the
    lens does not see lies far away in its direction from the axis. None for a lens that sees to the
    side.
    """
    if not _sees_ahead_alone(lens):
        return None
    outlines = []
    for seen in corners:
        points = _before_eye(seen)
        if not len(points):
            continue
        ahead = (points[:, :2] / points[:, 2:]).astype(np.float32)
        outline = _within_square(cv2.convexHull(ahead)[:, 0].astype(np.float64), FARTHEST)
        if len(outline):
            after = np.concatenate([outline[1:], outline[:1]])
            outlines.append((outline + _ALONG * (after - outline)).reshape(-1, 2))
    if not outlines:
        return NOTHING
    sides = np.concatenate(outlines)
    places = lens.project(np.column_stack([sides, np.ones(len(sides))]))
    lost = np.isnan(places[:, 0])
    if lost.any():
        away = sides[lost]
        places[lost] = BEYOND_PX * away / np.maximum(np.linalg.norm(away, axis=1)[:, None], 1e-9)
    return _rectangle(places, [len(each) for each in outlines], lens, LENS_MARGIN_PX)


def _within_square(outline: NDArray[np.float64], half: float) -> NDArray[np.float64]:
    """Return the part of a convex outline (N, 2) in which no coordinate is beyond `half`."""
    if np.abs(outline).max() <= half:
        return outline
    for axis, sign in product((0, 1), (-1.0, 1.0)):
        inside = half - sign * outline[:, axis]
        kept = []
        for number, point in enumerate(outline):
            before = inside[number - 1]
            if (before < 0.0) != (inside[number] < 0.0):
                share = before / (before - inside[number])
                kept.append(outline[number - 1] + share * (point - outline[number - 1]))
            if inside[number] >= 0.0:
                kept.append(point)
        outline = np.array(kept).reshape(-1, 2)
        if not len(outline):
            break
    return outline


def _before_eye(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return corners of a box (8, 3) that lie before the eye, and where its edges come there."""
    depth = corners[:, 2]
    before = depth >= NEAREST_M
    if before.all():
        return corners
    # Between any two corners; those that are no edges lie within the box.
    a, b = np.nonzero(before[:, None] & ~before[None])
    share = (depth[a] - NEAREST_M) / (depth[a] - depth[b])
    cut = corners[a] + share[:, None] * (corners[b] - corners[a])
    return np.concatenate([corners[before], cut])
