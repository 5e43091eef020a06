"""Lights in our units as an emitter of Mitsuba: sun, point, spot and area lights without a body.

Lives in the tracer's environment. Its numbers come from `export.lamp`. Bodiless lights are met by
sampling alone, so an area light casts soft shadows and hides nothing behind it from the camera.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi

__all__ = ["register"]

FAR_M = 1000.0

_NUMBERS: dict[str, Any] = {
    "position": mi.ScalarPoint3f,
    "direction": mi.ScalarVector3f,
    "half_width": mi.ScalarVector3f,
    "half_height": mi.ScalarVector3f,
    "area": float,
    "radius": float,
    "range": float,
    "cos_inner": float,
    "cos_outer": float,
    "cos_radius": float,
}
"""Parameters of a light, with their types, by its kind; see `export.lamp`."""


class Lamp(mi.Emitter):  # type: ignore[misc,name-defined]
    """One light; see `sailenv_ros.types.lights.Light` for its units. Lamps are small balls."""

    def __init__(self, props: Any) -> None:
        mi.Emitter.__init__(self, props)
        self.kind = str(props["kind"])
        self.power = mi.Color3f(props["power"])
        for name, make in _NUMBERS.items():
            if props.has_property(name):
                setattr(self, name, make(props[name]))
        flags = mi.EmitterFlags
        self.m_flags = flags.DeltaDirection if self.kind == "directional" else flags.DeltaPosition

    def sample_direction(self, it: Any, sample: Any, active: Any = True) -> Any:
        """Choose a point of the light; return it and the irradiance at normal incidence."""
        if self.kind == "directional":
            frame = mi.Frame3f(mi.Vector3f(-self.direction))
            away = frame.to_world(mi.warp.square_to_uniform_cone(sample, self.cos_radius))
            point = it.p + FAR_M * away
            distance = mi.Float(FAR_M)
            light = self.power
        else:
            point = mi.Point3f(self.position)
            if self.kind == "area":
                point += (2.0 * sample.x - 1.0) * mi.Vector3f(self.half_width)
                point += (2.0 * sample.y - 1.0) * mi.Vector3f(self.half_height)
            # Of a small ball as much arrives as of its middle, and shadows have soft edges.
            away, _, distance2 = _way(point - it.p)
            light = self.power * self._pattern(away, distance2) / distance2
            if self.kind != "area":
                point += self.radius * mi.warp.square_to_uniform_sphere(sample)
            away, distance, _ = _way(point - it.p)
        ds = mi.DirectionSample3f()
        ds.p, ds.n, ds.uv, ds.time = point, mi.Normal3f(0.0), mi.Point2f(0.0), it.time
        ds.pdf, ds.delta = mi.Float(1.0), mi.Bool(True)
        ds.emitter, ds.d, ds.dist = mi.EmitterPtr(self), away, distance
        return ds, dr.select(active, light, 0.0)

    def _pattern(self, away: Any, distance2: Any) -> Any:
        """Return the share of the light that goes this way and this far."""
        if self.kind == "area":
            along = -dr.dot(away, mi.Vector3f(self.direction))
            return dr.maximum(along, 0.0) * self.area
        reach = distance2 / self.range**2
        window = dr.clip(1.0 - reach * reach, 0.0, 1.0)
        window *= window
        if self.kind == "point":
            return window
        along = -dr.dot(away, mi.Vector3f(self.direction))
        width = max(self.cos_inner - self.cos_outer, 1e-6)
        t = dr.clip((along - self.cos_outer) / width, 0.0, 1.0)
        return window * t * t * (3.0 - 2.0 * t)

    def pdf_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
        """Return 0: nothing meets such a light by chance."""
        return mi.Float(0.0)

    def eval_direction(self, it: Any, ds: Any, active: Any = True) -> Any:
        """Return 0, likewise."""
        return mi.Color3f(0.0)

    def eval(self, si: Any, active: Any = True) -> Any:
        """Return 0: it has no body that could be seen."""
        return mi.Color3f(0.0)

    def bbox(self) -> Any:
        """Return no extent."""
        return mi.ScalarBoundingBox3f()

    def to_string(self) -> str:
        """Name it."""
        return f"Lamp[{self.kind}]"


def _way(offset: Any) -> tuple[Any, Any, Any]:
    """Return the direction of an offset, its length [m] and the length squared."""
    distance2 = dr.maximum(dr.squared_norm(offset), 1e-8)
    distance = dr.sqrt(distance2)
    return offset / distance, distance, distance2


def register() -> None:
    """Make ``sailenv_lamp`` known to the chosen variant of Mitsuba."""
    mi.register_emitter("sailenv_lamp", Lamp)
