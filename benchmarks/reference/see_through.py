"""See-through surfaces as the renderer understands them, as a BSDF of Mitsuba.

A share of it, its opacity, is covered by what reflects diffusely; the rest is clear glass of an
index of 1.5, and takes the more of the material's hue the more is covered (glass.cpp). It is met
as one face of a body that light enters and leaves, or as a sheet with both of its faces. Lives in
the tracer's environment.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
from lit_surface import OwnSurface, textured

__all__ = ["register"]


class SeeThrough(OwnSurface):
    """Its parameters are textures or colours; ``faces`` is 0 of cloth, which mirrors nothing."""

    def __init__(self, props: Any) -> None:
        mi.BSDF.__init__(self, props)
        self.base, self.tint, self.opacity, self.faces = (
            textured(props[name]) for name in ("base_color", "tint", "opacity", "faces")
        )
        flags = mi.BSDFFlags
        sides = flags.FrontSide | flags.BackSide
        self.m_components = [
            flags.DeltaReflection | sides,
            flags.Null | sides,
            flags.DiffuseReflection | sides | flags.SpatiallyVarying,
        ]
        self.m_flags = self.m_components[0] | self.m_components[1] | self.m_components[2]

    def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
        """Mirror, let through or scatter; return it with the share of light that it carries."""
        mirrored, clear, covered = self._shares(si, active)
        mirrors, passes = sample1 < mirrored, sample1 < mirrored + clear
        scatters = ~passes
        side = dr.select(si.wi.z < 0.0, mi.Float(-1.0), mi.Float(1.0))
        around = mi.warp.square_to_cosine_hemisphere(sample2)
        density = mi.warp.square_to_cosine_hemisphere_pdf(around)
        bs = mi.BSDFSample3f()
        bs.wo = dr.select(
            mirrors,
            mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z),
            dr.select(passes, -si.wi, mi.Vector3f(around.x, around.y, around.z * side)),
        )
        bs.eta = 1.0
        number = dr.select(mirrors, mi.UInt32(0), dr.select(passes, mi.UInt32(1), mi.UInt32(2)))
        kinds = [mi.UInt32(int(kind)) for kind in self.m_components]
        bs.sampled_component = number
        bs.sampled_type = dr.select(mirrors, kinds[0], dr.select(passes, kinds[1], kinds[2]))
        bs.pdf = dr.select(mirrors, mirrored, dr.select(passes, clear, covered * density))
        value = dr.select(scatters, self.base.eval(si, active), mi.Color3f(1.0))
        value = dr.select(passes & ~mirrors, self.tint.eval(si, active), value)
        return bs, dr.select(active & (bs.pdf > 0.0), value, 0.0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return what scatters, times the cosine, and the density of its direction."""
        _, _, covered = self._shares(si, active)
        cosine = dr.select(si.wi.z * wo.z > 0.0, dr.abs(wo.z), 0.0)
        pdf = dr.select(active, covered * cosine / dr.pi, 0.0)
        return self.base.eval(si, active) * pdf, pdf

    def eval_null_transmission(self, si: Any, active: Any = True) -> Any:
        """Return the share of light that goes straight through."""
        _, clear, _ = self._shares(si, active)
        return dr.select(active, clear * self.tint.eval(si, active), 0.0)

    def _shares(self, si: Any, active: Any) -> tuple[Any, Any, Any]:
        """Return which shares are mirrored, let through and scattered; 1 in all."""
        once = mi.fresnel(dr.abs(si.wi.z), 1.5)[0]
        faces = self.faces.eval_1(si, active)
        mirrored = dr.select(
            faces > 1.5, 2.0 * once / (1.0 + once), dr.select(faces > 0.5, once, 0.0)
        )
        covered = (1.0 - mirrored) * self.opacity.eval_1(si, active)
        return mirrored, 1.0 - mirrored - covered, covered

    def to_string(self) -> str:
        """Name it."""
        return "SeeThrough[]"


def register() -> None:
    """Make ``sailenv_see_through`` known to the chosen variant of Mitsuba."""
    mi.register_bsdf("sailenv_see_through", SeeThrough)
