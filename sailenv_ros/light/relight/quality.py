"""Sample counts of relighting. Knows no scene."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FINE", "QUICK", "Quality"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Quality:
    """Sample counts of relighting.

    Attributes
    ----------
    first_rays, rays : int
        From each patch: to find what was hidden, and to find its light; the first pass is left out
        if there are none.
    area_rays, light_rays : int
        From each patch to each area light, from each texel to each other light.
    probe_rays : int
        From each probe.
    smoothing : int
        How many patches to each side are averaged over at most.
    least : float
        Objects that may take less of a patch's view than this share change nothing there.
    bounces : int
        How often light is sent on between surfaces whose colour has changed.
    with_far : bool
        False leaves out what comes from surfaces that became brighter or darker, as long as none
        has another material.
    by_texels : bool
        True traces shadows of lamps and sun from each texel, False from each patch.
    least_far : float
        Changes of less than this share of what most patches get are not seen where they come from
        surfaces that became brighter or darker.
    """

    first_rays: int
    rays: int
    area_rays: int
    light_rays: int
    probe_rays: int
    smoothing: int
    least: float
    bounces: int
    with_far: bool
    by_texels: bool
    least_far: float


QUICK = Quality(
    first_rays=0,
    rays=4,
    area_rays=2,
    light_rays=4,
    probe_rays=16,
    smoothing=3,
    least=0.02,
    bounces=4,
    with_far=False,
    by_texels=False,
    least_far=0.012,
)
"""Quality of a frame in which something moves."""

FINE = Quality(
    first_rays=16,
    rays=64,
    area_rays=16,
    light_rays=16,
    probe_rays=128,
    smoothing=2,
    least=0.002,
    bounces=8,
    with_far=True,
    by_texels=True,
    least_far=0.004,
)
"""Quality of the frames after a motion."""
