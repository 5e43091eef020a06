"""Sample counts of relighting. Knows no scene."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["AT_VERTICES", "FINE", "QUICK", "Quality"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Quality:
    """Sample counts of relighting; by themselves, those of `FINE`.

    Attributes
    ----------
    first_rays, rays : int
        From each patch: to find what was hidden, and to find its light; the first pass is left out
        if there are none.
    area_rays, light_rays : int
        From each patch to each area light, from each texel to each other light; only 16 of them
        where these are all stopped, or none.
    probe_rays : int
        From each probe.
    object_points, object_rays : int
        Points of each object that can move, and rays from each of them.
    at_vertices : bool
        Whether the light on objects of `vertex_points` is found at their vertices, too.
    texel_rays, edge_rays : int
        From each texel near such an object, and where a shadow of it ends.
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

    first_rays: int = 16
    rays: int = 64
    area_rays: int = 64
    light_rays: int = 16
    probe_rays: int = 128
    object_points: int = 128
    object_rays: int = 64
    at_vertices: bool = False
    texel_rays: int = 256
    edge_rays: int = 32
    smoothing: int = 2
    least: float = 0.002
    bounces: int = 8
    with_far: bool = True
    by_texels: bool = True
    least_far: float = 0.004


QUICK = Quality(
    first_rays=0,
    rays=16,
    area_rays=2,
    light_rays=4,
    probe_rays=16,
    object_points=24,
    object_rays=24,
    texel_rays=64,
    smoothing=3,
    least=0.02,
    bounces=4,
    with_far=False,
    by_texels=False,
    least_far=0.012,
)
"""Quality of a frame in which something moves."""

FINE = Quality()
"""Quality of the frames after a motion."""

AT_VERTICES = Quality(at_vertices=True)
"""Quality of the light at vertices in these."""
