"""Light maps and reflection maps, updated by src/kernels/light_maps.cpp."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.render_types import LAYER_SUM, address, record

__all__ = ["LayeredMap", "blur_directions", "sum_texels"]

RUN_TEXELS = 8
"""`LAYER_RUN` of src/kernels/layer_sum.h."""

_SUM = Kernel("sum_texels", "ia")
_BLUR = Kernel("blur_directions", "iiaaiaa")


class LayeredMap:
    """A light map that is the sum of layers, each texel added up when it is looked at first.

    What `render.lightmap_compositing.sum_texels` does, bit for bit. A picture needs a small part of
    a room's light map.

    Parameters
    ----------
    terms : sequence of array and factors
        (H, W, 3) or (H, W) float16, and (3,) float32; the first one has three channels.
    more : (3,) float32
    shown : (H, W) uint8
    before : LayeredMap or None
        One that is not used any more, whose memory may be used again.

    Attributes
    ----------
    height, width : int
    record : (1,) LAYER_SUM
        Good while this object lives.
    """

    def __init__(
        self,
        terms: Sequence[tuple[NDArray[np.float16], NDArray[np.float32]]],
        more: NDArray[np.float32],
        shown: NDArray[np.uint8],
        before: LayeredMap | None = None,
    ) -> None:
        self.height, self.width = shown.shape
        size = self.height * self.width
        # Kernels take eight texels at a time; the last ones are made longer.
        spare = -size % 8
        self._layers = []
        for layer, _ in terms:
            shape = shown.shape if layer.ndim == 2 else (*shown.shape, 3)
            dense = checked("layer", np.ascontiguousarray(layer), np.float16, shape)
            if spare:
                flat = dense.reshape(size, -1)
                dense = np.concatenate([flat, np.zeros((spare, flat.shape[1]), np.float16)])
            self._layers.append(dense)
        self._channels = np.array([1 if layer.ndim == 2 else 3 for layer, _ in terms], np.int32)
        # Over and over, as eight texels of three channels lie.
        self._factors = np.array([np.tile(factor, 8) for _, factor in terms], np.float32)
        self._addresses = np.array([address(layer) for layer in self._layers], np.uint64)
        self._more = np.tile(np.asarray(more, np.float32), 8)
        self._shown = np.ascontiguousarray(shown).reshape(-1)
        if spare:
            self._shown = np.concatenate([self._shown, np.zeros(spare, np.uint8)])
        if before is not None and len(before._texels) == size + spare:
            self._texels: NDArray[np.float16] = before._texels
        else:
            self._texels = np.empty((size + spare, 4), np.float16)
        self._states = np.zeros(-(-len(self._texels) // RUN_TEXELS), np.uint8)
        self.record = record(
            LAYER_SUM,
            count=len(self._texels),
            terms=len(terms),
            layers_at=address(self._addresses),
            channels_at=address(self._channels),
            factors_at=address(self._factors),
            more_at=address(self._more),
            shown_at=address(self._shown),
            texels_at=address(self._texels),
            states_at=address(self._states),
        )

    def texels(self, *, threads: int) -> NDArray[np.float16]:
        """Return (H, W, 4) float16: the whole map."""
        _SUM(threads, self.record)
        size = self.height * self.width
        whole: NDArray[np.float16] = self._texels[:size].reshape(self.height, self.width, 4)
        return whole


def sum_texels(
    terms: Sequence[tuple[NDArray[np.float16], NDArray[np.float32]]],
    more: NDArray[np.float32],
    shown: NDArray[np.uint8],
    *,
    threads: int,
) -> NDArray[np.float16]:
    """Return the sum of layers, (H, W, 4) float16; see `LayeredMap`."""
    return LayeredMap(terms, more, shown).texels(threads=threads)


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
