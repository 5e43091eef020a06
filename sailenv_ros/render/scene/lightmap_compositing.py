"""From baked layers to the light of one moment: each light's layers times what it shines now.

Baked light, lights and surroundings come in; a light map, probes and the lights that the bake
knows nothing of go out. Plain arithmetic on arrays; nothing here knows OpenGL.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.baked_light import BakedLight, LightLayer, ProbeGrid, SunEdges
from sailenv_ros.types.lights import Environment, Light

__all__ = [
    "CompositedLight",
    "LayerPower",
    "LayerSum",
    "Term",
    "composite_lightmap",
    "instance_light",
    "light_alone",
    "main_light",
    "strength",
    "sum_texels",
]


Term: TypeAlias = tuple[NDArray[np.float16], NDArray[np.float32]]
"""A layer, (H, W, 3) or (H, W), and what each colour of it is multiplied by, (3,)."""


@dataclass(frozen=True, eq=False, slots=True)
class LayerSum:
    """Terms of the sum that makes a light map; see `sum_texels`, which adds them up."""

    terms: Sequence[Term]
    more: NDArray[np.float32]
    shown: NDArray[np.uint8]


class LayerPower(NamedTuple):
    """Factors of a layer.

    Attributes
    ----------
    number : int
        Of the layer in the bake.
    bounced, direct : (3,) float32
        By colour.
    """

    number: int
    bounced: NDArray[np.float32]
    direct: NDArray[np.float32]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class CompositedLight:
    """The light of what stands still, and of the air around it.

    Attributes
    ----------
    layers : LayerSum
        Of the light map: irradiance / pi of everything but the main light's direct part; the share
        of the main light that is not in shadow.
    probes : (Z, Y, X, 4, 3) float32
        As in `LightLayer`, without the main light's direct part.
    powers : tuple of LayerPower
        By which the same is to be summed of other light of these layers.
    more : (3,) float32
        Which is to be added to it.
    live : tuple of Light
        Lights that must be drawn as if there were no bake: they were added or moved.
    main_baked : bool
        True if the light map's fourth channel belongs to the present main light.
    main_transmittance : float
        Share of the main light that glass lets through to what has no texels; 1 if not known.
    main_edges : SunEdges or None
        Where the main light's shadows end, if that is known.
    """

    layers: LayerSum
    probes: NDArray[np.float32]
    powers: tuple[LayerPower, ...]
    more: NDArray[np.float32]
    live: tuple[Light, ...]
    main_baked: bool
    main_transmittance: float
    main_edges: SunEdges | None = None

    def texels(self) -> NDArray[np.float16]:
        """Return (H, W, 4) float16: the light map, added up at each call."""
        return sum_texels(self.layers.terms, self.layers.more, self.layers.shown)


def strength(light: Light) -> float:
    """Return a number by which lights are ordered: the stronger the larger."""
    return light.intensity * max(light.colour)


def main_light(lights: Sequence[Light]) -> Light | None:
    """Return the light that casts the shadow map: the strongest directional one."""
    suns = [light for light in lights if light.type == "directional" and light.intensity > 0.0]
    return max(suns, key=strength, default=None)


def sum_texels(
    terms: Sequence[Term], more: NDArray[np.float32], shown: NDArray[np.uint8]
) -> NDArray[np.float16]:
    """Return the sum of layers.

    Parameters
    ----------
    terms : sequence of Term
        Of the first one, `more` is added next; then the others follow in their order.
    more : (3,) float32
    shown : (H, W) uint8
        Share of the main light that arrives, 255 = all of it.

    Returns
    -------
    texels : (H, W, 4) float16
        The sum, 0 or more, and the share.
    """
    (first, factor), *others = terms
    texels = first.astype(np.float32) * factor + more
    for layer, factor in others:
        texels += (layer if layer.ndim == 3 else layer[..., None]) * factor
    four = np.empty((*shown.shape, 4), np.float16)
    four[..., :3] = np.maximum(texels, 0.0)
    four[..., 3] = shown * np.float32(1.0 / 255.0)
    return four


def composite_lightmap(
    baked: BakedLight, lights: Sequence[Light], environment: Environment
) -> CompositedLight:
    """Find what the layers count now.

    Ambient light stands in for bounced light where there is no bake. With one, it counts only in
    so far as it has changed since, so that setting it still has the effect one expects.
    """
    surroundings = baked.layers[0]
    before = baked.environment or environment
    sky = _ratio(_mean_sky(environment), _mean_sky(before)).astype(np.float32)
    more = np.subtract(environment.ambient, before.ambient).astype(np.float32)
    terms: list[Term] = [(surroundings.bounced, sky)]
    probes = surroundings.probe_bounced.astype(np.float32) * sky
    probes[..., 0, :] += more
    powers = [LayerPower(0, sky, np.zeros(3, np.float32))]
    shown = np.full(surroundings.direct.shape, 255, np.uint8)
    main = main_light(lights)
    main_baked, main_transmittance = False, 1.0
    main_edges: SunEdges | None = None
    present = {light.name: light for light in lights}
    known = set()
    for number, layer in enumerate(baked.layers[1:], start=1):
        assert layer.light is not None
        light = present.get(layer.light.name)
        if light is None or not _stands_alike(light, layer.light):
            continue
        known.add(light.name)
        is_main = light is main and layer.visibility is not None
        if any(light.power):
            powers.append(_power(number, light, direct=not is_main))
            _add(terms, probes, layer, powers[-1])
        if is_main and layer.visibility is not None:
            shown, main_baked, main_transmittance = layer.visibility, True, layer.clear
            main_edges = layer.edges
    live = tuple(light for light in lights if light.name not in known and light is not main)
    return CompositedLight(
        layers=LayerSum(terms, more, shown),
        probes=probes,
        powers=tuple(powers),
        more=more,
        live=live,
        main_baked=main_baked,
        main_transmittance=main_transmittance,
        main_edges=main_edges,
    )


def light_alone(baked: BakedLight, light: Light, *, is_main: bool) -> CompositedLight:
    """Return what one light adds: the same as `composite_lightmap`, without all others.

    Parameters
    ----------
    is_main : bool
        Whether it casts the shadow map.
    """
    probes = np.zeros(baked.layers[0].probe_bounced.shape, np.float32)
    for layer in baked.layers[1:]:
        assert layer.light is not None
        if layer.light.name != light.name or not _stands_alike(light, layer.light):
            continue
        shown, main_baked = np.full(layer.direct.shape, 255, np.uint8), False
        if is_main and layer.visibility is not None:
            shown, main_baked = layer.visibility, True
        terms: list[Term] = []
        _add(terms, probes, layer, _power(0, light, direct=not main_baked))
        return CompositedLight(
            layers=LayerSum(terms, np.zeros(3, np.float32), shown),
            probes=probes,
            powers=(),
            more=np.zeros(3, np.float32),
            live=(),
            main_baked=main_baked,
            main_transmittance=layer.clear if main_baked else 1.0,
        )
    dark: Term = np.zeros((2, 2, 3), np.float16), np.zeros(3, np.float32)
    return CompositedLight(
        layers=LayerSum([dark], np.zeros(3, np.float32), np.zeros((2, 2), np.uint8)),
        probes=probes,
        powers=(),
        more=np.zeros(3, np.float32),
        live=() if is_main else (light,),
        main_baked=False,
        main_transmittance=1.0,
    )


def instance_light(
    probes: NDArray[np.float32], grid: ProbeGrid, points: NDArray[np.float64]
) -> NDArray[np.float32]:
    """Interpolate probes at points; beyond the grid its border continues.

    Parameters
    ----------
    probes : (Z, Y, X, 4, 3) float32
    grid : ProbeGrid
    points : (N, 3) float64
        World frame [m].

    Returns
    -------
    light : (N, 4, 3) float32
    """
    last = np.array(grid.shape[::-1]) - 1
    at = (points - np.asarray(grid.origin_m)) / np.asarray(grid.spacing_m)
    at = np.clip(at, 0.0, last)
    low = np.minimum(at.astype(np.intp), np.maximum(last - 1, 0))
    share = (at - low).astype(np.float32)
    # Of the eight probes around each point.
    corners = np.array(list(np.ndindex(2, 2, 2)))[:, None, :]
    weight = np.prod(np.where(corners, share, 1.0 - share), axis=2)
    x, y, z = np.moveaxis(np.minimum(low + corners, last), 2, 0)
    result: NDArray[np.float32] = (weight[:, :, None, None] * probes[z, y, x]).sum(axis=0)
    return result


def _power(number: int, light: Light, *, direct: bool) -> LayerPower:
    power = np.array(light.power, np.float32)
    bounced = power * np.float32(light.indirect_multiplier)
    return LayerPower(number, bounced, power if direct else np.zeros(3, np.float32))


def _add(
    terms: list[Term], probes: NDArray[np.float32], layer: LightLayer, power: LayerPower
) -> None:
    terms.append((layer.bounced, power.bounced))
    probes += layer.probe_bounced * power.bounced
    if power.direct.any():
        terms.append((layer.direct, power.direct))
        probes += layer.probe_direct * power.direct


def _stands_alike(light: Light, baked: Light) -> bool:
    """Return whether two lights differ in nothing but what layers are multiplied by."""
    power = (baked.colour, baked.intensity, baked.indirect_multiplier)
    colour, intensity, indirect = power
    alike: bool = (
        replace(light, colour=colour, intensity=intensity, indirect_multiplier=indirect) == baked
    )
    return alike


def _ratio(now: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Divide; under a black sky nothing can have come from it, so nothing is scaled."""
    ratio: NDArray[np.float64] = np.divide(now, before, out=np.ones(3), where=before > 1e-6)
    return ratio


def _mean_sky(environment: Environment) -> NDArray[np.float64]:
    zenith, horizon = np.asarray(environment.sky_zenith), np.asarray(environment.sky_horizon)
    mean: NDArray[np.float64] = 0.5 * (zenith + horizon)
    return mean
