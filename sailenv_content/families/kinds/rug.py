"""Rugs: knotted with borders, flat woven, of light wool, coiled round, modern; mats for baths."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.draping import fringe
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import FABRICS, fabric, paint, printed
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.rug_patterns import Loom, woven
from sailenv_content.families.shaping import board, placed, turned, with_uvs
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.model import Texture

__all__ = ["FAMILY"]

DENSITY = 250.0
"""Of wool on its ground, air counted in [kg/m³]."""


def _picture(b: PieceBuilder, v: Values, size: tuple[float, float]) -> Texture:
    linear = [m.surface.base_colour[:3] for m in (v.cloth, v.second, v.light, v.dark)]
    loom = Loom(b.rng, size, srgb_from_linear(np.array(linear)))
    return woven(loom, v.pattern, v.rough)


def _sheet(b: PieceBuilder, v: Values) -> None:
    """Lay a rectangle, with fringes at its ends for some."""
    d, w, t = v.depth, v.width, v.thick
    wool = printed("rug", _picture(b, v, (d, w)), roughness=0.95, density=DENSITY)
    mesh = placed(board((d, w, t), bevel=0.3 * t), (0.0, 0.0, t / 2))
    # Its rows, from the top, run along x; its columns along y.
    b.form(
        wool, with_uvs(mesh, (1, 0), (-w / 2, -d / 2), (w, d)), collides="none", volume=d * w * t
    )
    b.collide((d, w, t), (0.0, 0.0, t / 2))
    if v.fringe:
        xs = np.linspace(-0.495 * d, 0.495 * d, int(d / 0.016))
        for sign in (-1.0, 1.0):
            ends = np.stack([xs, np.full(len(xs), sign * w / 2), np.full(len(xs), 0.4 * t)], -1)
            fringe(b, v.light, ends, (0.0, sign * v.fringe))


def _disc(b: PieceBuilder, v: Values) -> None:
    """Lay a round rug."""
    r, t = 0.5 * v.across, v.thick
    wool = printed("rug", _picture(b, v, (2 * r, 2 * r)), roughness=0.95, density=DENSITY)
    profile = [(0.0, 0.0), (r - 0.2 * t, 0.0), (r, 0.5 * t), (r - 0.3 * t, t), (0.0, t)]
    mesh = with_uvs(turned(profile, segments=72), (1, 0), (-r, -r), (2 * r, 2 * r))
    b.form(wool, mesh, volume=np.pi * r * r * t)


_LIGHTS = tuple(paint(c, 0.95) for c in ("#e6dfd0", "#d8ccb4", "#cfcac0", "#e9e2d6", "#c8b48e"))
_DARKS = tuple(paint(c, 0.95) for c in ("#2a2826", "#1f2a3d", "#40261e", "#3a3f42", "#4d3a22"))
_DYES = (*FABRICS, *(fabric(c) for c in ("#7a1f22", "#1f3357", "#31583f", "#c98a5e", "#8f7a9c")))

_SHARED = {
    "cloth": Choice(*_DYES),
    "second": Choice(*_DYES),
    "light": Choice(*_LIGHTS),
    "dark": Choice(*_DARKS),
    "depth": Span(1.45, 2.0),
    "width": Span(2.1, 2.9),
    "thick": Span(0.008, 0.014),
    "rough": 0.09,
    "fringe": 0.0,
}
_SMALL = {**_SHARED, "depth": Span(0.6, 0.8), "width": Span(1.1, 1.5)}

FAMILY = Family(
    name="rug",
    category="rug",
    least_m=(0.4, 0.6, 0.006),
    most_m=(2.2, 3.1, 0.03),
    styles={
        "oriental": Style(
            _sheet,
            {**_SHARED, "pattern": "oriental", "fringe": Choice(0.0, 0.05, 0.08), "rough": 0.07},
        ),
        "kilim": Style(
            _sheet,
            {
                **_SHARED,
                "pattern": Choice("kilim", "kilim", "striped"),
                "thick": Span(0.006, 0.009),
                "fringe": Choice(0.0, 0.04, 0.07),
            },
        ),
        "berber": Style(
            _sheet, {**_SHARED, "pattern": "berber", "fringe": Choice(0.0, 0.06), "rough": 0.06}
        ),
        "modern": Style(_sheet, {**_SHARED, "pattern": Choice("shapes", "checks", "bordered")}),
        "round": Style(
            _disc,
            {
                **_SHARED,
                "pattern": Choice("rings", "rings", "shapes"),
                "across": Span(1.5, 2.1),
                "rough": 0.12,
            },
        ),
        "bedside": Style(
            _sheet,
            {
                **_SMALL,
                "pattern": Choice("oriental", "kilim", "striped", "berber", "bordered", "shapes"),
                "fringe": Choice(0.0, 0.0, 0.04),
            },
        ),
        "mat": Style(
            _sheet,
            {
                **_SMALL,
                "depth": Span(0.45, 0.6),
                "width": Span(0.7, 0.95),
                "thick": Span(0.012, 0.014),
                "pattern": Choice("ribbed", "ribbed", "bordered", "striped"),
                "rough": 0.08,
            },
        ),
        "disc": Style(
            _disc,
            {
                **_SHARED,
                "pattern": Choice("rings", "shapes"),
                "across": Span(0.8, 1.2),
                "rough": 0.12,
            },
        ),
    },
)
