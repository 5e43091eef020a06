"""Light that was computed beforehand for what stands still, as the renderer takes it.

Made by `bake/` from a scene's first snapshot, travels in `SceneContents` to `render/`. Each light
has a layer of its own, computed for white light of intensity 1: a light whose colour or
intensity changes changes the picture without baking again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.lights import Environment, Light

__all__ = [
    "LIGHT_TERMS",
    "EDGE_POINTS",
    "BakedLight",
    "LightChart",
    "LightLayer",
    "ObjectLight",
    "ProbeGrid",
    "SunEdges",
    "Unwrapping",
]

EDGE_POINTS = 4
"""Points of a texel along each side at which `SunEdges` knows the share of light."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Unwrapping:
    """A model's surface, unwrapped; entries in the order of the model's parts.

    Attributes
    ----------
    vertices : tuple of (V,) uint32
        Which vertex of the part's mesh each vertex copies: at seams one becomes several.
    triangles : tuple of (M, 3) uint32
        The mesh's triangles in their order, with indices into `vertices`.
    uvs : tuple of (V, 2) float32
        Place in the model's chart, each 0 to 1.
    """

    vertices: tuple[NDArray[np.uint32], ...]
    triangles: tuple[NDArray[np.uint32], ...]
    uvs: tuple[NDArray[np.float32], ...]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LightChart:
    """Chart of one instance in the light map.

    Attributes
    ----------
    unwrapping : Unwrapping
        Of the instance's model; shared by instances of one model.
    offset, scale : (2,) tuple of float
        The point of the light map (0 to 1; v grows with rows) is ``offset + scale * uv``.
    world_from_body : (4, 4) float64
        Pose for which it was baked: an instance that stands elsewhere has no baked light.
    """

    unwrapping: Unwrapping
    offset: tuple[float, float]
    scale: tuple[float, float]
    world_from_body: NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ProbeGrid:
    """Points in a box at which light from everywhere is known.

    Attributes
    ----------
    origin_m : (3,) tuple of float
        World position of the probe of index 0, 0, 0 [m].
    spacing_m : (3,) tuple of float
        Distance of neighbours along x, y, z [m].
    shape : (3,) tuple of int
        Probes along z, y, x.
    """

    origin_m: tuple[float, float, float]
    spacing_m: tuple[float, float, float]
    shape: tuple[int, int, int]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SunEdges:
    """Shadow edges of a directional light, at a finer resolution than the light map.

    Attributes
    ----------
    index : (H, W) int32
        Number of each texel's block, -1 where it has none: there the light map's share counts.
    blocks : (K, 6, 6) uint8
        Share of the light that arrives, 255 = all of it, at 4 by 4 points of each texel and at the
        points around them; point (i, j) lies at ((j - 0.5) / 4, (i - 0.5) / 4) of the texel.
        Between them it is bilinear.
    """

    index: NDArray[np.int32]
    blocks: NDArray[np.uint8]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class LightLayer:
    """Contribution of one light to the scene, for white light of intensity 1.

    Texels hold irradiance / pi on the texel's surface, so that a matt surface's radiance is albedo
    times it. Probes hold four numbers per colour, ``c0, cx, cy, cz``, from which irradiance / pi on
    a surface of unit normal n is ``max(c0 + cx nx + cy ny + cz nz, 0)`` (world frame; spherical
    harmonics of band 0 and 1 convolved with the cosine, Ramamoorthi and Hanrahan 2001).

    Attributes
    ----------
    light : Light or None
        The light as it was baked; None for the surroundings: the sky and what glows of itself, as
        bright as they are.
    direct : (H, W) float16
        What arrives straight from the light, with soft shadows. All 0 for the surroundings.
    bounced : (H, W, 3) float16
        What arrives after one or more bounces; for the surroundings also what arrives straight.
    probe_direct, probe_bounced : (Z, Y, X, 4, 3) float16
        The same at the probes; the last axis is red, green, blue. `probe_direct` is 0 for
        directional lights (moving things are lit by them in real time) and the surroundings.
    visibility : (H, W) uint8 or None
        Share of a directional light that is not in shadow, 255 = all of it; None for other lights.
        Kept beside `direct` because it does not depend on the fine structure of the surface.
        Of texels that have a block in `edges` it is neither 0 nor 255.
    edges : SunEdges or None
        Of a directional light, where its shadows end; None if that is not known.
    clear : float
        Share of a directional light that glass lets through where it comes into the air that the
        probes know, 0 to 1: what moves has no texels that would know it. 1 for other lights.
    """

    light: Light | None
    direct: NDArray[np.float16]
    bounced: NDArray[np.float16]
    probe_direct: NDArray[np.float16]
    probe_bounced: NDArray[np.float16]
    visibility: NDArray[np.uint8] | None = None
    clear: float = 1.0
    edges: SunEdges | None = None


LIGHT_TERMS = 28
"""Terms of `ObjectLight`."""


def _of_no_vertices() -> NDArray[np.float16]:
    return np.zeros((0, 0, 2), np.float16)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ObjectLight:
    """Contribution of each layer to the light on one object that can move, where it stands.

    Terms give irradiance / pi on a surface by its normal and place in the world, as
    `irradiance_of_terms` of light_law.h has them: 1, three of the normal, and for each side of the
    body one, and three of the place.

    Attributes
    ----------
    bounced : (L, LIGHT_TERMS, 3) float32
        By layer, term and colour: what comes from surfaces, the sky and what glows.
    direct : (L, LIGHT_TERMS) float32
        What arrives straight from the layer's light, with soft shadows; 0 for directional lights,
        which light moving things in real time, and the surroundings.
    axes : (3, 3) float32
        Of the body, in the world frame, one a row.
    found, fitted : (L, V, 2) float16
        Luminance of the irradiance / pi at each vertex of the model's parts, one part after
        another, bounced and direct: as rays found it, and as the terms have it over the share that
        the model does not hide of itself. What is drawn is right at vertices if it is multiplied
        by their quotient. Empty where the terms are to be taken as they are.
    """

    bounced: NDArray[np.float32]
    direct: NDArray[np.float32]
    axes: NDArray[np.float32]
    found: NDArray[np.float16] = field(default_factory=_of_no_vertices)
    fitted: NDArray[np.float16] = field(default_factory=_of_no_vertices)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class BakedLight:
    """Light maps and probes of one scene; compared by identity.

    Attributes
    ----------
    fingerprint : str
        Hash of everything it depends on.
    charts : mapping of int to LightChart
        By instance id; instances that can move have none.
    layers : tuple of LightLayer
        The surroundings first, then the lights in the scene's order.
    probes : ProbeGrid
    seen : (K, L, 3) float16
        Radiance of points that eyes in the room see, in all directions but steeply up and down,
        by the light of each layer; not what lies behind glass. For exposure meters.
    environment : Environment or None
        The surroundings as the scene has them of itself; None until a world takes the bake.
    rough : bool
        True of light that is refined soon: what is mirrored may wait for that.
    casters : frozenset of int
        Instance ids of what can move and whose shadow is in the light map.
    unshadowed : BakedLight or None
        The same without these shadows; None if there are none.
    checksum : str
        Of the file that it was read from; empty for light that was never in one, or was changed.
    """

    fingerprint: str
    charts: Mapping[int, LightChart]
    layers: tuple[LightLayer, ...]
    probes: ProbeGrid
    seen: NDArray[np.float16] = field(default_factory=lambda: np.zeros((0, 0, 3), np.float16))
    environment: Environment | None = None
    rough: bool = False
    casters: frozenset[int] = frozenset()
    unshadowed: BakedLight | None = None
    checksum: str = ""

    @property
    def of_still(self) -> BakedLight:
        """The light without anything of what can move."""
        return self if self.unshadowed is None else self.unshadowed
