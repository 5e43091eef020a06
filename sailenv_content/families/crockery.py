"""Glazes and handles that cups, bowls, plates, pots and vases share."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.lathe import sleeve
from sailenv_content.families.materials import PieceMaterial, paint
from sailenv_content.families.shaping import Floats, swept, with_uvs
from sailenv_content.procedural.forms import curve
from sailenv_ros.types.model import Mesh

__all__ = ["CLEAR", "GLAZES", "band", "grained", "loop", "radius_at"]

GLAZES = tuple(
    paint(c, 0.16, 2300.0)
    for c in (
        "#f0ece2",
        "#dfe5e6",
        "#c9d3c6",
        "#39424e",
        "#2f5a6c",
        "#b5694a",
        "#d2a65a",
        "#7d8f78",
        "#8a3b32",
        "#26282b",
        "#d9b9ab",
    )
)
CLEAR = (("#dfe8e6", 0.08), ("#9fc3b6", 0.35), ("#b98a3e", 0.45), ("#7fa0bd", 0.35))
"""Colours and opacities of glass."""


def radius_at(rows: Floats, z: float) -> float:
    """Return the radius of a profile at a height [m]."""
    return float(np.interp(z, rows[:, 1], rows[:, 0]))


def grained(mesh: Mesh, material: PieceMaterial) -> Mesh:
    """Return a wide turned form as if cut from one board, if it has a grain."""
    if material.surface.base_colour_texture is None:
        return mesh
    return with_uvs(mesh, (1, 0), (0.0, 0.0), (material.tile_m, material.tile_m))


def band(
    b: PieceBuilder,
    material: PieceMaterial,
    rows: Floats,
    low: float,
    high: float,
    *,
    segments: int = 32,
) -> None:
    """Paint a band around a profile, from one height to another [m]."""
    heights = np.linspace(low, high, 6)
    around = np.array([(radius_at(rows, float(z)) + 0.0004, z) for z in heights])
    b.form(material, sleeve(around, wall=0.0003, segments=segments), collides="none", volume=1e-7)


def loop(
    b: PieceBuilder,
    material: PieceMaterial,
    x: float,
    low: float,
    high: float,
    *,
    out: float = 0.03,
    thick: float = 0.005,
    yaw_deg: float = 0.0,
    foot_x: float | None = None,
) -> None:
    """Add a bowed handle to a side at x, from one height to another [m]; at an angle about z."""
    with b.frame(yaw_deg=yaw_deg), b.part("handle", "handle"):
        start = x if foot_x is None else foot_x
        mid = (low + high) / 2
        path = curve(
            [
                (start - 0.003, 0, low),
                (max(start, x) + 0.75 * out, 0, low + 0.12 * (high - low)),
                (max(start, x) + out, 0, mid),
                (x + 0.8 * out, 0, high - 0.1 * (high - low)),
                (x - 0.003, 0, high),
            ],
            14,
        )
        b.form(material, swept(path, thick, sides=10))
