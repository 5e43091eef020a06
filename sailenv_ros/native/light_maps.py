"""Light maps and reflection maps, brought up to date by src/kernels/light_maps.cpp."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.render_types import address

__all__ = ["blur_directions", "sum_texels"]

_SUM = Kernel(
    "sum_texels",
    "integer",
    "integer",
    "integer",
    "array",
    "array",
    "array",
    "array",
    "array",
    "array",
)
_BLUR = Kernel(
    "blur_directions", "integer", "integer", "array", "array", "integer", "array", "array"
)


def sum_texels(
    terms: Sequence[tuple[NDArray[np.float16], NDArray[np.float32]]],
    more: NDArray[np.float32],
    shown: NDArray[np.uint8],
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Return the sum of layers, as `render.lightmap_compositing.sum_texels` does, bit for bit.

    Parameters
    ----------
    terms : sequence of array and factors
        (H, W, 3) or (H, W) float16, and (3,) float32; the first one has three channels.
    more : (3,) float32
    shown : (H, W) uint8

    Returns
    -------
    texels : (H, W, 4) float16
    """
    height, width = shown.shape
    # Kernels take eight texels at a time; the last ones are made longer.
    spare = -(height * width) % 8
    layers = []
    for layer, _ in terms:
        shape = (height, width) if layer.ndim == 2 else (height, width, 3)
        dense = checked("layer", np.ascontiguousarray(layer), np.float16, shape)
        if spare:
            flat = dense.reshape(height * width, -1)
            dense = np.concatenate([flat, np.zeros((spare, flat.shape[1]), np.float16)])
        layers.append(dense)
    channels = np.array([1 if layer.ndim == 2 else 3 for layer, _ in terms], np.int32)
    factors = np.array([factor for _, factor in terms], np.float32)
    addresses = np.array([address(layer) for layer in layers], np.uint64)
    arriving = np.concatenate([shown.reshape(-1), np.zeros(spare, np.uint8)])
    out = np.empty((height * width + spare, 4), np.float16)
    _SUM(
        threads,
        len(out),
        len(terms),
        addresses,
        channels,
        factors,
        np.ascontiguousarray(more, np.float32),
        arriving,
        out,
    )
    return out[: height * width].reshape(height, width, 4)


def blur_directions(
    radiance: NDArray[np.float32],
    directions: NDArray[np.float32],
    lobe: NDArray[np.float32],
    result: NDArray[np.float32],
    *,
    threads: int,
) -> None:
    """Average a map of all directions over a lobe about each of them.

    Parameters
    ----------
    radiance : (N, N, 3) float32
        N is a multiple of 8.
    directions : (N, N, 3) float32
        Unit direction of each texel.
    lobe : (S, 4) float32
        Directions about the z axis, and how much each counts.
    result : (N, N, 3) float32
        Takes the means.
    """
    edge = len(radiance)
    checked("radiance", radiance, np.float32, (edge, edge, 3))
    checked("directions", directions, np.float32, (edge, edge, 3))
    checked("lobe", lobe, np.float32, (None, 4))
    checked("result", result, np.float32, (edge, edge, 3))
    four = np.zeros((edge, edge, 4), np.float32)
    four[..., :3] = radiance
    _BLUR(threads, edge, four, directions, len(lobe), lobe, result)
