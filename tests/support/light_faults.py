"""Faults of light that are seen in pictures of rooms: single pixels, dashes at edges, spots."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import find_objects, label, maximum_filter, minimum_filter

from sailenv_ros.types.colour import LINEAR_OF_SRGB8

__all__ = ["bright_spots", "dark_blots", "dashes", "luma_of", "outliers", "surfaces_of"]

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]

STANDS_OUT = 40
"""Luma, of 255, by which a pixel is darker than all eight around it."""

EDGE_PX = 3
"""Greatest distance from an edge between surfaces at which dashes are looked for [px]."""

DARKER = 8
"""Luma by which a dash is darker than the same surface on both its sides."""

ALIKE = 4
"""Difference of the surface's own colour, of 255, up to which light alone makes pixels differ."""

STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (1, -2), (2, 1), (2, -1))
REACHES_PX = (3, 5, 8)
BORDER_PX = 9

BLOCK_PX = 8
RING = 5
"""Spots are looked for among squares of `BLOCK_PX`, in rings so far around each."""

BLOT_PX = 31
"""Blots that are narrower are looked for [px]."""

BLOT_SHARE = 0.5
"""Share of the light around it below which a pixel belongs to a blot."""

BLOT_LEAST_PX = 3
"""Least width and height of a blot [px]."""

TURN = 0.97
"""Cosine between the normals of neighbours below which a surface ends."""

BRIGHTER = 4.0
"""Luma by which a spot is brighter than all of its ring."""


def luma_of(rgb: NDArray[np.uint8]) -> Ints:
    """Return (H, W) int64, 0 to 255."""
    found: Ints = rgb.astype(np.int64) @ np.array([77, 150, 29]) // 256
    return found


def _colour_of(albedo: NDArray[np.float32]) -> Ints:
    """Return (H, W) int64, 0 to 255, in steps about as even as luma's."""
    found: Ints = (np.sqrt(albedo.mean(axis=2)) * 255.0).astype(np.int64)
    return found


def surfaces_of(instance: NDArray[np.integer], normals: NDArray[np.floating], plain: Bools) -> Ints:
    """Return (H, W): a number for each flat side of each instance, -1 where it is not `plain`."""
    axis = np.argmax(np.abs(normals), axis=2)
    along = np.take_along_axis(normals, axis[..., None], axis=2)[..., 0]
    return np.where(plain, instance.astype(np.int64) * 6 + axis * 2 + (along > 0), -1)


def outliers(rgb: NDArray[np.uint8], plain: Bools) -> NDArray[np.intp]:
    """Return (N, 2): rows and columns of single dark pixels among pixels that are all `plain`."""
    luma = luma_of(rgb)
    rows, columns = luma.shape

    def beside(array: NDArray[np.generic]) -> NDArray[np.generic]:
        steps = [step for step in np.ndindex(3, 3) if step != (1, 1)]
        return np.array([array[v : v + rows - 2, u : u + columns - 2] for v, u in steps])

    own, around = luma[1:-1, 1:-1], beside(luma)
    found = own < around.min(axis=0) - STANDS_OUT
    return np.argwhere(found & plain[1:-1, 1:-1] & beside(plain).all(axis=0)) + 1


def dashes(rgb: NDArray[np.uint8], albedo: NDArray[np.float32], surfaces: Ints) -> NDArray[np.intp]:
    """Return (N, 2): pixels by an edge of two surfaces that are darker than the edge on both sides.

    A shade that runs along the edge is none: it is as dark on both sides. So is what the surface's
    own colour makes dark, such as joints of tiles.

    Parameters
    ----------
    rgb : (H, W, 3) uint8
    albedo : (H, W, 3) float32
        Linear, 0 to 1.
    surfaces : (H, W) int
        As `surfaces_of` returns them.
    """
    luma, colour = luma_of(rgb), _colour_of(albedo)
    lowest = minimum_filter(surfaces, 2 * EDGE_PX + 1)
    highest = maximum_filter(surfaces, 2 * EDGE_PX + 1)
    near = (lowest >= 0) & (lowest != highest)
    near[:BORDER_PX] = near[-BORDER_PX:] = near[:, :BORDER_PX] = near[:, -BORDER_PX:] = False
    found = np.zeros_like(near)
    for reach in REACHES_PX:
        for dv, du in STEPS:
            far = max(round(reach / max(abs(dv), abs(du))), 1)
            here = near.copy()
            for v, u in ((far * dv, far * du), (-far * dv, -far * du)):
                here &= np.roll(surfaces, (v, u), (0, 1)) == surfaces
                here &= np.roll(luma, (v, u), (0, 1)) > luma + DARKER
                here &= np.abs(np.roll(colour, (v, u), (0, 1)) - colour) <= ALIKE
            found |= here
    return np.argwhere(found)


def bright_spots(
    rgb: NDArray[np.uint8], albedo: NDArray[np.float32], surfaces: Ints
) -> NDArray[np.intp]:
    """Return (N, 2): rows and columns of squares of 8 by 8 pixels brighter than all around them.

    On one surface of one colour alone; patches of sun are told by their sharp edges.
    """
    rows, columns = (side // BLOCK_PX for side in surfaces.shape)

    def blocks(array: Ints) -> Ints:
        cut = array[: rows * BLOCK_PX, : columns * BLOCK_PX]
        return cut.reshape(rows, BLOCK_PX, columns, BLOCK_PX).swapaxes(1, 2)

    light, colour, own = blocks(luma_of(rgb)), blocks(_colour_of(albedo)), blocks(surfaces)
    even = (own.min(axis=(2, 3)) == own.max(axis=(2, 3))) & (own[..., 0, 0] >= 0)
    even &= np.ptp(colour, axis=(2, 3)) <= ALIKE
    level, surface = light.mean(axis=(2, 3)), own[..., 0, 0]
    found = []
    for v, u in np.argwhere(even[RING:-RING, RING:-RING]) + RING:
        ring = [(v + a, u + b) for a in (-RING, 0, RING) for b in (-RING, 0, RING) if a or b]
        at = tuple(np.array(ring).T)
        around = even[at] & (surface[at] == surface[v, u])
        if around.all() and level[v, u] > level[at].max() + BRIGHTER:
            found.append((v, u))
    return np.array(found, np.intp).reshape(-1, 2)


def dark_blots(
    rgb: NDArray[np.uint8],
    albedo: NDArray[np.float32],
    normals: NDArray[np.float32],
    instance: NDArray[np.integer],
) -> Bools:
    """Return (H, W) bool: blots with less than half of the light around them, in smooth surfaces.

    Shades that touch an edge, as where two things meet, are none.
    """
    linear = LINEAR_OF_SRGB8[rgb].mean(axis=2)
    light = (linear / np.maximum(albedo.mean(axis=2), 0.02)).astype(np.float32)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (BLOT_PX, BLOT_PX))
    around = cv2.morphologyEx(light, cv2.MORPH_CLOSE, disc)
    dark = (light < BLOT_SHARE * around) & (instance > 0)
    edge = np.zeros_like(dark)
    for axis in (0, 1):
        ahead = np.roll(normals, -1, axis)
        ends = (np.einsum("vuc,vuc->vu", normals, ahead) < TURN) | (
            np.roll(instance, -1, axis) != instance
        )
        edge |= ends | np.roll(ends, 1, axis)
    edge = cv2.dilate(edge.astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    found: Bools = np.zeros(dark.shape, bool)
    parts, _ = label(dark)
    for number, box in enumerate(find_objects(parts), start=1):
        own = parts[box] == number
        if min(own.shape) >= BLOT_LEAST_PX and not (own & edge[box]).any():
            found[box] |= own
    return found
