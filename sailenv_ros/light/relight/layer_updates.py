"""Updated layers of baked light. From what changes at patches, texels and probes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.relight_kernels import spread_change
from sailenv_ros.native.relight_types import MappedTexels, PatchMap
from sailenv_ros.types.baked_light import LightLayer, SunEdges
from sailenv_ros.types.colour import HALF_MOST

__all__ = ["DirectDelta", "LayerUpdates"]

Floats = NDArray[np.float32]

DirectDelta = tuple[NDArray[np.uint8], Floats, Floats]
"""State, light and share of it that arrives, of texels or of patches; see `direct_light_delta`."""


class LayerUpdates:
    """Layers as they were baked, and how to write changes into copies of them.

    Parameters
    ----------
    layers : sequence of LightLayer
    area : list of int
        Which of them are of area lights.
    texels : MappedTexels
    patches : PatchMap
    threads : int
    """

    def __init__(
        self,
        layers: Sequence[LightLayer],
        area: list[int],
        texels: MappedTexels,
        patches: PatchMap,
        threads: int,
    ) -> None:
        self._layers, self._area = layers, area
        self._texels, self._patches, self._threads = texels, patches, threads

    def spread(
        self,
        found: NDArray[np.uint8],
        change: Floats,
        area: Floats,
        deltas: dict[int, DirectDelta],
    ) -> list[LightLayer]:
        """Bring texels up to date by what was found at patches.

        Parameters
        ----------
        deltas : dict of int to tuple
            What lamps and sun give to patches, by layer.
        """
        bounced = [layer.bounced.copy() for layer in self._layers]
        direct = {number: self._layers[number].direct.copy() for number in self._area}
        columns = [change, area]
        shares: dict[int, NDArray[np.float16]] = {}
        for number, (state, value, share) in deltas.items():
            if not state.any():
                continue
            # What is worked out anew is so for all lights alike.
            found = np.maximum(found, state)
            layer = self._layers[number]
            direct[number] = layer.direct.copy()
            columns.append(np.where(state > 0, value, np.float32(0.0))[:, None])
            if layer.visibility is not None:
                shares[number] = layer.visibility.astype(np.float16)
                columns.append(
                    np.where(state > 0, np.float32(255.0) * share, np.float32(0.0))[:, None]
                )
        maps = [*bounced]
        for number, texels in direct.items():
            maps.append(texels)
            if number in shares:
                maps.append(shares[number])
        # In one go: they share their neighbours.
        change = np.concatenate(columns, axis=1)
        spread_change(self._texels, self._patches, found, change, maps, threads=self._threads)
        result = []
        for number, (layer, texels) in enumerate(zip(self._layers, bounced, strict=True)):
            lit = replace(layer, bounced=texels)
            if number in shares:
                bytes_ = np.rint(np.minimum(shares[number], np.float16(255.0))).astype(np.uint8)
                lit = _shown(lit, direct[number], bytes_)
            elif number in direct:
                lit = replace(lit, direct=direct[number])
            result.append(lit)
        return result

    def with_direct(self, layer: LightLayer, delta: DirectDelta | None) -> LightLayer:
        """Return a layer with the direct light of a lamp or the sun, found at texels."""
        if delta is None:
            return layer
        state, value, share = delta
        direct = layer.direct.copy()
        _put(direct, self._texels.arrays["places"], state, value, HALF_MOST)
        if layer.visibility is None:
            return replace(layer, direct=direct)
        visibility = layer.visibility.copy()
        _put(visibility, self._texels.arrays["places"], state, 255.0 * share, 255.0)
        return _shown(layer, direct, visibility)

    def with_probes(self, layers: list[LightLayer], far: Floats, near: Floats) -> list[LightLayer]:
        """Return layers with what changes at probes; see `gather_probe_change`."""
        result = []
        for number, layer in enumerate(layers):
            own = slice(3 * number, 3 * number + 3)
            probes = layer.probe_bounced + far[..., own] + near[..., own]
            probes[..., 0, :] = np.maximum(probes[..., 0, :], 0.0)
            result.append(replace(layer, probe_bounced=probes.astype(np.float16)))
        return result


def _put(
    layer: NDArray[np.generic],
    places: NDArray[np.int32],
    state: NDArray[np.uint8],
    value: Floats,
    most: float,
) -> None:
    flat = layer.reshape(-1)
    chosen = np.flatnonzero(state)
    at = places[chosen]
    kept = np.where(state[chosen] == 1, flat[at].astype(np.float32), 0.0)
    new = np.clip(kept + value[chosen], 0.0, most)
    flat[at] = np.rint(new) if layer.dtype == np.uint8 else new


def _shown(
    layer: LightLayer, direct: NDArray[np.float16], visibility: NDArray[np.uint8]
) -> LightLayer:
    """Return a layer of a light whose share that arrives is known, with other shares."""
    edges = _elsewhere(layer.edges, visibility != layer.visibility)
    return replace(layer, direct=direct, visibility=visibility, edges=edges)


def _elsewhere(edges: SunEdges | None, changed: NDArray[np.bool_]) -> SunEdges | None:
    """Return edges of shadows without those at texels whose light has changed."""
    if edges is None:
        return None
    index = np.where(changed, np.int32(-1), edges.index)
    return replace(edges, index=np.ascontiguousarray(index, np.int32))
