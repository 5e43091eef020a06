"""The renderer's own material model as a BSDF of Mitsuba, so that light alone is compared.

Metallic-roughness: a diffuse lobe below Schlick's Fresnel term, GGX with height-correlated Smith
visibility above it, the same formulae as in lighting.frag; seen from behind it is the same. Lives
in the tracer's environment. (Mitsuba's principled BSDF gives back 5 % more light than falls on a
rough white surface, which adds up in a white room.)
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

__all__ = ["OwnSurface", "register", "textured"]


class OwnSurface(mi.BSDF):  # type: ignore[misc,name-defined]
    """A BSDF of ours: it has a texture `base`, and tells value and density in `eval_pdf`."""

    def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return the BSDF times the cosine."""
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return the density with which `sample` chooses a direction."""
        return self.eval_pdf(ctx, si, wo, active)[1]

    def eval_diffuse_reflectance(self, si: Any, active: Any = True) -> Any:
        """Return the colour that guides the denoiser."""
        return self.base.eval(si, active)


class LitSurface(OwnSurface):
    """Its parameters are textures: ``base_color``, ``metallic``, ``roughness``."""

    def __init__(self, props: Any) -> None:
        mi.BSDF.__init__(self, props)
        self.base, self.metallic, self.roughness = (
            textured(props[name]) for name in ("base_color", "metallic", "roughness")
        )
        flags = mi.BSDFFlags
        sides = flags.FrontSide | flags.BackSide | flags.SpatiallyVarying
        self.m_components = [flags.DiffuseReflection | sides, flags.GlossyReflection | sides]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
        """Choose a lobe and a direction; return it with the share of light that it carries."""
        diffuse, f0, alpha = self._finish(si, active)
        wi, side = _turned(si.wi)
        glossy_share = self._glossy_share(diffuse, f0)
        glossy = active & (sample1 < glossy_share)
        halfway, _ = _facets(alpha).sample(wi, sample2)
        mirrored = 2.0 * dr.dot(wi, halfway) * mi.Vector3f(halfway) - wi
        wo = dr.select(glossy, mirrored, mi.warp.square_to_cosine_hemisphere(sample2))
        bs = mi.BSDFSample3f()
        bs.wo = mi.Vector3f(wo.x, wo.y, wo.z * side)
        bs.eta = 1.0
        bs.sampled_component = dr.select(glossy, mi.UInt32(1), mi.UInt32(0))
        kinds = [mi.UInt32(int(kind)) for kind in self.m_components]
        bs.sampled_type = dr.select(glossy, kinds[1], kinds[0])
        value, bs.pdf = self._lobes(wi, wo, diffuse, f0, alpha, glossy_share)
        active &= bs.pdf > 0.0
        return bs, dr.select(active, value / dr.maximum(bs.pdf, 1e-12), 0.0)

    def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
        """Return both."""
        diffuse, f0, alpha = self._finish(si, active)
        wi, side = _turned(si.wi)
        above = mi.Vector3f(wo.x, wo.y, wo.z * side)
        share = self._glossy_share(diffuse, f0)
        value, pdf = self._lobes(wi, above, diffuse, f0, alpha, share)
        return dr.select(active, value, 0.0), dr.select(active, pdf, 0.0)

    def _finish(self, si: Any, active: Any) -> tuple[Any, Any, Any]:
        base = self.base.eval(si, active)
        metallic = self.metallic.eval_1(si, active)
        roughness = self.roughness.eval_1(si, active)
        f0 = 0.04 * (1.0 - metallic) + base * metallic
        return base * (1.0 - metallic), f0, dr.square(roughness)

    def _glossy_share(self, diffuse: Any, f0: Any) -> Any:
        """Return how often the glossy lobe is chosen."""
        glossy, below = mi.luminance(f0), mi.luminance(diffuse)
        return dr.clip(glossy / dr.maximum(glossy + below, 1e-6), 0.15, 1.0)

    def _lobes(
        self, wi: Any, wo: Any, diffuse: Any, f0: Any, alpha: Any, glossy_share: Any
    ) -> tuple[Any, Any]:
        """Return value times cosine, and density; both directions are on the front."""
        nv, nl = wi.z, wo.z
        halfway = dr.normalize(wi + wo)
        vh = dr.dot(wi, halfway)
        a2 = dr.square(alpha)
        spread = dr.square(halfway.z) * (a2 - 1.0) + 1.0
        distribution = a2 / (dr.pi * dr.square(spread))
        smith = nl * dr.safe_sqrt(nv * nv * (1.0 - a2) + a2)
        smith += nv * dr.safe_sqrt(nl * nl * (1.0 - a2) + a2)
        visibility = 0.5 / dr.maximum(smith, 1e-7)
        fresnel = f0 + (1.0 - f0) * dr.power(dr.clip(1.0 - vh, 0.0, 1.0), 5.0)
        value = diffuse * (1.0 - fresnel) / dr.pi + fresnel * distribution * visibility
        facets = _facets(alpha).pdf(wi, halfway) / dr.maximum(4.0 * vh, 1e-7)
        pdf = glossy_share * facets + (1.0 - glossy_share) * nl / dr.pi
        front = (nv > 0.0) & (nl > 0.0)
        return dr.select(front, value * nl, 0.0), dr.select(front, pdf, 0.0)

    def to_string(self) -> str:
        """Name it."""
        return "LitSurface[]"


def register() -> None:
    """Make ``sailenv_surface`` known to the chosen variant of Mitsuba."""
    mi.register_bsdf("sailenv_surface", LitSurface)


class _Plain:
    """One colour everywhere."""

    def __init__(self, colour: Any) -> None:
        self.colour = mi.Color3f(colour)
        # As a variable in memory: surfaces that differ in it alone share their code.
        dr.make_opaque(self.colour)

    def eval(self, si: Any, active: Any) -> Any:
        return self.colour

    def eval_1(self, si: Any, active: Any) -> Any:
        return self.colour.x


def textured(given: Any) -> Any:
    """Return a texture as it is, a colour as one that is the same everywhere."""
    return given if hasattr(given, "eval_1") else _Plain(given)


def _facets(alpha: Any) -> Any:
    return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, alpha, True)


def _turned(wi: Any) -> tuple[Any, Any]:
    """Return the direction as if seen from the front, and the sign of the side."""
    side = dr.select(wi.z < 0.0, mi.Float(-1.0), mi.Float(1.0))
    return mi.Vector3f(wi.x, wi.y, wi.z * side), side
