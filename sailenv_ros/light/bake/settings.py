"""Resolution and sample counts of baking: nothing in, `BakeSettings` out. Knows no scene."""

from __future__ import annotations

from dataclasses import dataclass, replace

__all__ = ["BAKE_VERSION", "INSIDE_SHARE", "BakeSettings", "drafted"]

BAKE_VERSION = 20
"""Grows whenever the same scene and settings would give another result."""


INSIDE_SHARE = 0.25
"""A point that sees more backs of surfaces than this share lies inside of something."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BakeSettings:
    """Resolution and sample counts of baking.

    Attributes
    ----------
    texel_m : float
        Side of a light map's texel on models of few triangles: walls, floors, boards [m].
    fine_texel_m : float
        Side of a texel on models of many triangles [m].
    max_map : int
        Largest side of the light map [texels]; texels grow until everything fits.
    rays : int
        Rays from each texel into its half space; texels of a tile of 4 by 4 share 16 times as many
        directions. A multiple of `pass_rays`.
    pass_rays : int
        Rays that are cast at a time; the first serve the bounces, too. A square of a power of two:
        4, 16, 64.
    window_rays : int
        Rays from each texel to each window in each of these passes; a square of a power of two.
    light_rays : int
        Rays from each texel to each light, where its shadows have edges; a quarter of them finds
        the edges. A square of a power of two, at least 4.
    bounces : int
        How many times light is handed on before the last gathering.
    probe_spacing_m : float
        Distance of neighbouring probes, if there are not too many of them [m].
    max_probes : int
    probe_rays : int
        Rays from each probe.
    """

    texel_m: float = 0.02
    fine_texel_m: float = 0.03
    max_map: int = 2048
    rays: int = 64
    pass_rays: int = 64
    window_rays: int = 16
    light_rays: int = 16
    bounces: int = 12
    probe_spacing_m: float = 0.4
    max_probes: int = 8000
    probe_rays: int = 1024


def drafted(settings: BakeSettings) -> BakeSettings:
    """Return how a draft is made: a quarter of the rays, fewer bounces, nothing refined."""
    return replace(
        settings,
        rays=min(16, settings.pass_rays),
        pass_rays=min(16, settings.pass_rays),
        window_rays=min(4, settings.window_rays),
        light_rays=min(4, settings.light_rays),
        bounces=min(5, settings.bounces),
    )
