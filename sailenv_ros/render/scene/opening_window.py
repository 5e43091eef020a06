"""The part of a picture in which what lies outside a room can be seen: that of the openings.

An eye in a closed room sees through windows and doors alone. What lies outside is neither culled
nor drawn beyond the rectangle around them, which changes no pixel.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.camera import Camera
from sailenv_ros.types.outside import Outside
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["OpeningWindows"]

MARGIN_PX = 2
NEAREST_M = 1e-3

Rectangle = tuple[int, int, int, int]


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
        if outside is None or self._shell_rows is None or not camera.intrinsics.is_pinhole:
            return None
        eye = camera.world_from_camera[:3, 3]
        if not ((eye > outside.low_m) & (eye < outside.high_m)).all():
            return None
        if not np.array_equal(snapshot.world_from_body[self._shell_rows], self._shell_poses):
            return None
        return self._row, _around(self._corners, camera)

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


def _around(corners: NDArray[np.float64], camera: Camera) -> Rectangle:
    """Return the rectangle around all openings (N, 8, 3), in pixels; empty if none is seen."""
    lens = camera.intrinsics
    turn, shift = camera.camera_from_world[:3, :3], camera.camera_from_world[:3, 3]
    focal, centre = np.array([lens.fx, lens.fy]), np.array([lens.cx, lens.cy])
    most = np.array([lens.width - 1, lens.height - 1])
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for seen in corners @ turn.T + shift:
        points = _before_eye(seen)
        if not len(points):
            continue
        places = points[:, :2] / points[:, 2:] * focal + centre
        first, last = places.min(axis=0), places.max(axis=0)
        if (last >= -MARGIN_PX).all() and (first <= most + MARGIN_PX).all():
            low, high = np.minimum(low, first), np.maximum(high, last)
    if not np.isfinite(low).all():
        return 1, 1, 0, 0
    left, top = np.clip(np.floor(low) - MARGIN_PX, 0, most).tolist()
    right, bottom = np.clip(np.ceil(high) + MARGIN_PX, 0, most).tolist()
    return int(left), int(top), int(right), int(bottom)


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
