"""A view of numbers as colours: flow by direction and speed, depth by a ramp, ids by tables.

Each function takes one view as `sailenv_ros.types.views.VIEWS` describes it and gives a new array.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.bayer import colours_of_cells
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.labels import CategoryTable, colour_instances
from sailenv_ros.types.view_spec import ViewDisplay
from sailenv_ros.types.views import view_spec

__all__ = [
    "colour_categories",
    "colour_depth",
    "colour_directions",
    "colour_displacements",
    "colour_flow",
    "colour_mask",
    "colour_places",
    "developed_mosaic",
    "encoded_colour",
    "grey_depth",
    "view_picture",
]

Rgb = NDArray[np.uint8]

DEPTH_RANGE_M = 10.0


def colour_flow(flow: NDArray[np.float32], *, full_px_s: float | None = None) -> Rgb:
    """Show flow as hue by direction and value by speed, at full saturation.

    Parameters
    ----------
    flow : (H, W, 2) float32
        Velocity in the image [px/s], u right, v down; NaN where it does not exist.
    full_px_s : float or None
        Speed that is shown at full brightness [px/s]; None means the fastest of the picture.

    Returns
    -------
    rgb : (H, W, 3) uint8
        Red is to the right, then yellow-green down, cyan left, violet up; black stands still or
        has no flow.
    """
    u, v = np.nan_to_num(flow[..., 0]), np.nan_to_num(flow[..., 1])
    speed = np.hypot(u, v)
    full = float(speed.max(initial=0.0)) if full_px_s is None else full_px_s
    value = np.minimum(speed / full, 1.0) if full > 0.0 else np.zeros_like(speed)
    sixth = np.arctan2(v, u) * np.float32(3.0 / math.pi)
    # The textbook conversion from hue and value at saturation 1, without its six cases.
    distance = np.abs(np.mod(sixth[..., None] + np.array([0.0, 4.0, 2.0], np.float32), 6.0) - 3.0)
    full_hue = np.clip(distance - 1.0, 0.0, 1.0)
    return (255.0 * value[..., None] * full_hue + 0.5).astype(np.uint8)


def grey_depth(
    depth_m: NDArray[np.float32], *, near_m: float = 0.0, range_m: float = DEPTH_RANGE_M
) -> NDArray[np.uint8]:
    """Show depth as grey: 255 at the near plane, linearly down to 0 at the range and beyond.

    Parameters
    ----------
    depth_m : (H, W) float32
        Depth [m]; ``inf`` (nothing hit) becomes 0, ``nan`` (nearer than the near plane) 255.
    near_m, range_m : float
        Depths that are shown as 255 and as 0 [m].

    Returns
    -------
    grey : (H, W) uint8
    """
    scale = np.float32(255.0 / (range_m - near_m))
    grey = np.float32(range_m) - depth_m
    grey *= scale
    grey += np.float32(0.5)
    # fmin takes the number of a number and a NaN, which is just what is wanted of the too near.
    np.fmin(grey, np.float32(255.0), out=grey)
    np.maximum(grey, np.float32(0.0), out=grey)
    return grey.astype(np.uint8)


def colour_depth(
    depth_m: NDArray[np.float32], *, near_m: float = 0.0, range_m: float = DEPTH_RANGE_M
) -> Rgb:
    """Show depth by a ramp of colours whose brightness falls with depth; see `grey_depth`.

    Returns
    -------
    rgb : (H, W, 3) uint8
    """
    return np.take(_RAMP, grey_depth(depth_m, near_m=near_m, range_m=range_m), axis=0)


def colour_categories(category: NDArray[np.uint8], table: CategoryTable) -> Rgb:
    """Show each category in its own colour.

    Parameters
    ----------
    category : (H, W) uint8
    table : CategoryTable
        Grey where it has no such category.

    Returns
    -------
    rgb : (H, W, 3) uint8
    """
    return np.take(table.palette, category, axis=0)


def view_picture(
    view: str,
    values: NDArray[Any],
    *,
    table: CategoryTable,
    near_m: float = 0.0,
    depth_range_m: float = DEPTH_RANGE_M,
) -> Rgb:
    """Show any view as a picture.

    Parameters
    ----------
    view : str
        Its name in `sailenv_ros.types.views.VIEWS`.
    values : (H, W) or (H, W, C) array
        As described there.
    table : CategoryTable
        Colours of categories.
    near_m, depth_range_m : float
        Ends of the ramp for depth [m].

    Returns
    -------
    rgb : (H, W, 3) uint8

    Raises
    ------
    UnknownName
        If there is no such view.
    """
    spec = view_spec(view)
    if spec.display == "depth":
        return colour_depth(values, near_m=near_m, range_m=depth_range_m)
    if spec.display == "category":
        return colour_categories(values, table)
    return _DISPLAYS[spec.display](values)


def colour_directions(vectors: NDArray[np.float32]) -> Rgb:
    """Show unit vectors (H, W, 3) with x, y, z from -1 to 1 as red, green, blue from 0 to 255."""
    picture: Rgb = (127.5 * vectors + 128.0).astype(np.uint8)
    return picture


def colour_places(points: NDArray[np.float32]) -> Rgb:
    """Show places (H, W, 3) [m] with x, y, z as red, green, blue, to and fro every metre.

    Black where there is none (nan).
    """
    # A triangle wave has no jumps, and the same colours left and right of the origin do not touch.
    known = np.where(np.isfinite(points), points, np.float32(0.5))
    wave = np.abs(np.mod(known + np.float32(0.5), 2.0) - 1.0)
    return np.asarray(np.rint(255.0 * wave), np.uint8)


def colour_displacements(vectors: NDArray[np.float32]) -> Rgb:
    """Show displacements (H, W, 3) [m]: grey stands still, x, y, z change red, green, blue.

    The longest of the picture has full colour; black has none (nan).
    """
    known = np.isfinite(vectors).all(axis=-1, keepdims=True)
    values = np.where(known, vectors, np.float32(0.0))
    longest = float(np.abs(values).max(initial=0.0))
    shown = 127.5 * (values / longest if longest > 0.0 else values) + 127.5
    return np.where(known, np.rint(shown), 0.0).astype(np.uint8)


def colour_mask(mask: NDArray[np.bool_]) -> Rgb:
    """Show truth values (H, W): white where true, black where false."""
    return np.where(mask[..., None], _WHITE, _BLACK)


def encoded_colour(colour: NDArray[Any]) -> Rgb:
    """Show a colour (H, W, 3) by its sRGB codes.

    Parameters
    ----------
    colour : (H, W, 3) uint8 or float32
        Codes already, which are copied; or linear, where more than 1 is shown as 1 and NaN as 0.

    Returns
    -------
    rgb : (H, W, 3) uint8
        The nearest codes (IEC 61966-2-1).
    """
    if colour.dtype == np.uint8:
        return np.array(colour, np.uint8)
    codes = 255.0 * srgb_from_linear(np.nan_to_num(colour, posinf=1.0))
    return np.asarray(np.rint(codes), np.uint8)


def developed_mosaic(raw: NDArray[np.uint16]) -> Rgb:
    """Show RAW data (H, W) by the colours of its cells of two by two pixels, linear to sRGB."""
    return encoded_colour(np.maximum(colours_of_cells(raw), np.float32(0.0)))


def _cubehelix() -> Rgb:
    """Return (256, 3): black to white through colours, brightness rising evenly.

    D. A. Green, "A colour scheme for the display of astronomical intensity images", 2011.
    """
    start, turns, hue = 0.0, -0.6, 1.4
    brightness = np.linspace(0.0, 1.0, 256)
    angle = 2.0 * math.pi * (start / 3.0 + turns * brightness)
    amplitude = hue * brightness * (1.0 - brightness) / 2.0
    mix = np.array([[-0.14861, 1.78277], [-0.29227, -0.90649], [1.97294, 0.0]])
    turn = np.stack([np.cos(angle), np.sin(angle)])
    rgb = brightness[:, None] + amplitude[:, None] * (mix @ turn).T
    ramp: Rgb = (np.clip(rgb, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return ramp


_RAMP = _cubehelix()

_BLACK, _WHITE = np.zeros(3, np.uint8), np.full(3, 255, np.uint8)

_DISPLAYS: Mapping[ViewDisplay, Callable[[NDArray[Any]], Rgb]] = {
    "colour": encoded_colour,
    "mosaic": developed_mosaic,
    "instance": colour_instances,
    "flow": colour_flow,
    "direction": colour_directions,
    "mask": colour_mask,
    "place": colour_places,
    "displacement": colour_displacements,
}
"""Display functions of the views that need nothing but their values."""
