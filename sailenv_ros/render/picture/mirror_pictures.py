"""Draws the reflections of flat mirrors into the picture.

The mirrors of `flat_mirrors` and a way to draw what each shows come in; the picture's radiance
goes out. Where the picture's edges are smooth, so are those of its mirrors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import tells_depth, unit_rays
from sailenv_ros.render.picture.half_pixels import pixel_shares
from sailenv_ros.render.scene.flat_mirrors import NEAR_PLANE_M, SeenMirror, Window
from sailenv_ros.types.camera import Camera, CameraIntrinsics

__all__ = ["Look", "Samples", "closer_window", "reflect"]

Samples: TypeAlias = Callable[[Window], NDArray[np.float32]]
"""``samples(window)`` returns (2 h + 1, 2 w + 1, 2): depth [m] and instance id of samples half a
pixel apart (see `half_pixels`) in a window of the picture."""

Look: TypeAlias = Callable[[Camera, NDArray[np.bool_], Window], NDArray[np.float16]]
"""``look(camera, only, window)`` returns (h, w, 4): exposed radiance of some instances, without
glass, in the window of the camera's picture."""

_AROUND = tuple(np.indices((3, 3)).reshape(2, 9) - 1)
"""Rows and columns of a pixel and its eight neighbours, from it."""


def reflect(
    mirrors: list[SeenMirror],
    camera: Camera,
    radiance: NDArray[np.float16],
    surface: NDArray[np.float32],
    look: Look,
    samples: Samples | None = None,
) -> None:
    """Put into a picture what its mirrors show.

    Parameters
    ----------
    mirrors : list of SeenMirror
        What `seen` returned for the camera.
    camera : Camera
        Of the picture's pixels.
    radiance : (H, W, 4) float16
        Exposed radiance and the share that came from around; written to.
    surface : (H, W, 2) float32
        Depth [m] and instance id.
    look : callable
        See `Look`.
    samples : callable or None
        See `Samples`; of a picture with smooth edges, whose mirrors have smooth edges, too.
    """
    for mirror in mirrors:
        whole, slant = _pixels(mirror, camera.intrinsics, camera, surface[mirror.window])
        if not whole.any():
            continue
        rows, columns = mirror.window
        partly = np.zeros_like(whole)
        if samples is not None:
            closer = closer_window(mirror.window)
            lens = camera.of_half_pixels().intrinsics
            mask, _ = _pixels(replace(mirror, window=closer), lens, camera, samples(mirror.window))
            covered = pixel_shares(mask)
            whole, partly = covered == 1.0, (covered > 0.0) & (covered < 1.0)
        width = camera.intrinsics.width
        flipped = rows, slice(width - columns.stop, width - columns.start)
        shown = look(mirror.camera, mirror.only, flipped)[:, ::-1, :3]
        # At grazing angles all light is mirrored (Schlick's approximation).
        grazing = (1.0 - slant[..., None]) ** 5
        shown = shown * (mirror.tint + (1.0 - mirror.tint) * grazing)
        target = radiance[mirror.window]
        if partly.any():
            at = np.nonzero(partly)
            share = covered[at][:, None]
            colour, around = target[..., :3], target[..., 3]
            colour[at] = _beside(colour, covered, at) + share * shown[at]
            around[at] *= 1.0 - covered[at]
        target[whole, :3] = shown[whole]
        target[whole, 3] = 0.0


def closer_window(window: Window) -> Window:
    """Return the samples half a pixel apart that lie in a window's pixels."""
    rows, columns = window
    return (
        slice(2 * rows.start, 2 * rows.stop + 1),
        slice(2 * columns.start, 2 * columns.stop + 1),
    )


def _beside(
    light: NDArray[np.float16], covered: NDArray[np.float32], at: tuple[NDArray[np.intp], ...]
) -> NDArray[np.float32]:
    """Return (N, 3) float32: the light of what pixels show beside the mirror.

    Parameters
    ----------
    light : (h, w, 3) float16
        With the mirror as it was drawn before.
    covered : (h, w) float32
        Share of each pixel that the mirror has.
    at : two (N,) int
        Row and column of pixels that it has in part.
    """
    own, share = light[at].astype(np.float32), covered[at][:, None]
    near = np.stack([a[:, None] + b for a, b in zip(at, _AROUND, strict=True)])
    rows, columns = np.clip(near, 0, np.array(covered.shape)[:, None, None] - 1)
    values, shares = light[rows, columns].astype(np.float32), covered[rows, columns][..., None]
    mirror, others = shares == 1.0, shares == 0.0
    # What the mirror had shown there is known from the pixels beside.
    sums = np.where(mirror, values, 0.0).sum(axis=1)
    before = sums / np.maximum(mirror.sum(axis=1), 1)
    rest = np.where(mirror.any(axis=1), own - share * before, (1.0 - share) * own)
    # Only about, though: the rest is as what is there without the mirror.
    alone = others.any(axis=1)
    least = np.where(alone, np.where(others, values, np.inf).min(axis=1), 0.0)
    most = np.where(alone, np.where(others, values, 0.0).max(axis=1), np.inf)
    beside: NDArray[np.float32] = np.clip(rest, (1.0 - share) * least, (1.0 - share) * most)
    return beside


def _pixels(
    mirror: SeenMirror, lens: CameraIntrinsics, camera: Camera, surface: NDArray[np.float32]
) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
    """Return which pixels of the window show the mirror, and the cosine of the viewing angle."""
    rows, columns = mirror.window
    rays = lens.rays(rows, columns) if tells_depth(lens) else unit_rays(lens)[rows, columns]
    normal = camera.camera_from_world[:3, :3] @ mirror.normal
    offset: Any = float(mirror.normal @ (mirror.point - camera.world_from_camera[:3, 3]))
    if lens.is_parallel:
        # Rays begin at x and y, and lead along the axis.
        offset = offset - rays[..., :2] @ normal[:2]
        rays[..., :2] = 0.0
    x, y, z = np.moveaxis(rays, -1, 0)
    along = normal[0] * x + normal[1] * y + normal[2] * z
    length = np.sqrt(z**2 + x**2 + y**2)
    mask = surface[..., 1] == mirror.instance_id
    depth = np.where(mask, surface[..., 0], 0.0)
    mask &= np.abs(along * depth - offset) < NEAR_PLANE_M
    return mask, np.clip(np.abs(along) / length, 0.0, 1.0).astype(np.float32)
