"""Frames of lenses that bend straight lines → what a pin-hole at their place would see."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.lens_rays import ray_lengths
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["undistorted"]

_OF_SURFACES: Final = (
    *("category", "instance", "normals", "albedo", "uv"),
    *("metallic_roughness", "object_coords", "measured_depth"),
)
"""Views that tell of a surface point, wherever in the picture it is."""

_FARTHEST_PX = 30_000.0


def undistorted(frame: Frame) -> Frame:
    """Return a frame as a pin-hole of the same focal length sees it, its axis in the middle.

    Colours are interpolated, and depths within a surface; other views are those of the nearest
    pixel. What the lens did not see is black, of no instance and infinitely far. Flow, RAW data and
    amodal masks are left out.

    Raises
    ------
    InvalidRequest
        If its rays are parallel.
    """
    lens = frame.camera.intrinsics
    if lens.is_parallel:
        raise InvalidRequest("lens", "parallel rays", "one whose rays meet, to be undistorted")
    straight, places = _law(lens)
    if straight == lens:
        return frame
    height, width = lens.height, lens.width
    columns, rows = np.rint(places).astype(np.int64)
    seen = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    nearest = rows.clip(0, height - 1), columns.clip(0, width - 1)
    views: dict[str, NDArray[Any]] = {}
    for name, values in frame.views.items():
        if name in _OF_SURFACES:
            found = values[nearest]
            found[~seen] = 0
            views[name] = found
    if "rgb" in frame.views:
        u, v = places.astype(np.float32)
        views["rgb"] = np.asarray(cv2.remap(frame["rgb"], u, v, cv2.INTER_LINEAR), np.uint8)
        views["rgb"][~seen] = 0
    if "depth" in frame.views:
        depth = np.where(seen, frame["depth"][nearest], np.inf)
        if "instance" in frame.views:
            within = _within_surfaces(frame["depth"], frame["instance"], places)
            depth = np.where(seen & np.isfinite(within), within, depth)
        views["depth"] = depth.astype(np.float32)
        if "range" in frame.views:
            views["range"] = (depth * ray_lengths(straight)).astype(np.float32)
    camera = replace(frame.camera, intrinsics=straight)
    return replace(frame, camera=camera, views=views, draw_amodal=None)


@lru_cache(maxsize=4)
def _law(lens: CameraIntrinsics) -> tuple[CameraIntrinsics, NDArray[np.float64]]:
    """Return the pin-hole, and (2, H, W) columns and rows where the lens has its pixels."""
    straight = replace(
        lens,
        distortion_model="pinhole",
        distortion=(),
        max_angle_deg=0.0,
        cx_offset_px=0.0,
        cy_offset_px=0.0,
        fx_px=lens.fx,
        fy_px=lens.fy,
    )
    places = np.moveaxis(lens.project(straight.rays()), -1, 0)
    places = np.nan_to_num(places, nan=-_FARTHEST_PX).clip(-_FARTHEST_PX, _FARTHEST_PX)
    places.flags.writeable = False
    return straight, places


def _within_surfaces(
    depth: NDArray[np.float32], instance: NDArray[np.uint16], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return depths between the four pixels around places; nan where these are of several things.

    Their inverse grows evenly along a plane.
    """
    height, width = depth.shape
    low = np.floor(places)
    x, y = places - low
    columns, rows = low.astype(np.int64)
    inside = (columns >= 0) & (columns < width - 1) & (rows >= 0) & (rows < height - 1)
    columns, rows = columns.clip(0, width - 2), rows.clip(0, height - 2)
    inverse = np.zeros(places.shape[1:])
    own = instance[rows, columns]
    for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        there = rows + down, columns + right
        with np.errstate(divide="ignore"):
            share = (x if right else 1.0 - x) * (y if down else 1.0 - y)
            inverse += share / depth[there].astype(np.float64)
        inside &= (instance[there] == own) & np.isfinite(depth[there])
    with np.errstate(divide="ignore"):
        return np.where(inside, 1.0 / inverse, np.nan)
