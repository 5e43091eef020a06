"""Parts of lamps: shades and bulbs that glow by the light of their lamp, cords, bases."""

from __future__ import annotations

from typing import Literal

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.lathe import sleeve, smooth_profile
from sailenv_content.families.materials import PieceMaterial, glow, metal, paint
from sailenv_content.families.shaping import swept, turned

__all__ = ["PAPERS", "BULB", "ShadeKind", "bulb", "foot", "globe", "shade"]

ShadeKind = Literal["drum", "cone", "empire", "dome", "bell"]

PAPERS = tuple(
    glow(colour, strength)
    for colour, strength in (
        ("#f1e7d3", 5.0),
        ("#e8dcc4", 4.5),
        ("#f4f1ea", 5.5),
        ("#c9b48f", 4.0),
        ("#b5694a", 3.5),
        ("#8fa39a", 3.5),
    )
)
BULB = glow("#fff3dc", 11.0)
GLOBE = glow("#f6f2e8", 6.0)
_INSIDE = glow("#f3ead6", 3.0)

_SHADES: dict[str, tuple[tuple[float, float], ...]] = {
    "drum": ((1.0, 0.0), (0.96, 1.0)),
    "cone": ((1.0, 0.0), (0.45, 1.0)),
    "empire": ((1.0, 0.0), (0.66, 1.0)),
    "dome": ((1.0, 0.0), (0.98, 0.2), (0.86, 0.52), (0.6, 0.82), (0.16, 1.0)),
    "bell": ((1.0, 0.0), (0.78, 0.18), (0.6, 0.5), (0.46, 0.85), (0.3, 1.0)),
}


def shade(
    b: PieceBuilder,
    kind: ShadeKind,
    material: PieceMaterial,
    radius: float,
    height: float,
    at: tuple[float, float, float],
    *,
    tilt_deg: float = 0.0,
    ribs: int = 0,
) -> None:
    """Add a shade whose lower edge is at a height; one that does not glow glows inside.

    Parameters
    ----------
    ribs : int
        Of pleats: its number of sides; 0 for a round one.
    """
    rows = np.array(_SHADES[kind]) * (radius, height)
    if len(rows) > 2:
        rows = smooth_profile(rows, 14)
    segments, turn = ribs or 40, (0.0, tilt_deg, 0.0)
    crease = 5.0 if ribs else 40.0
    mesh = sleeve(rows, wall=0.002, segments=segments, crease_deg=crease)
    b.form(material, mesh, at, turn=turn, collides="none", volume=_area(rows) * 0.001)
    if not any(material.surface.glow):
        inner = sleeve(rows - (0.0025, 0.0), wall=0.0008, segments=segments)
        b.form(_INSIDE, inner, at, turn=turn, collides="none", volume=1e-6)
    low, high = rows[0], rows[-1]
    hull = [(0, low[1]), low, high, (0, high[1])]
    outline = turned(hull, segments=14)
    b.hull(outline, at, turn=turn)


def _area(rows: np.ndarray) -> float:
    """Return the area of a shade [m²]."""
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=1)
    return float((steps * np.pi * (rows[1:, 0] + rows[:-1, 0])).sum())


def bulb(
    b: PieceBuilder,
    at: tuple[float, float, float],
    *,
    hanging: bool = False,
    size: float = 0.03,
    material: PieceMaterial = BULB,
) -> None:
    """Add a bulb in its socket, upright on a height or hanging from it."""
    turn = (180.0, 0.0, 0.0) if hanging else (0.0, 0.0, 0.0)
    socket = [(0, 0), (0.019, 0), (0.019, 0.035), (0.014, 0.045), (0, 0.045)]
    b.form(metal("#232326"), turned(socket, segments=16), at, turn=turn, collides="none")
    rows = smooth_profile(
        [
            (0.013, 0.044),
            (0.014, 0.06),
            (size, 0.06 + 1.2 * size),
            (0.7 * size, 0.06 + 1.95 * size),
            (0.0, 0.06 + 2.2 * size),
        ],
        12,
    )
    glass = turned([(0, 0.044), *rows], segments=18)
    b.form(material, glass, at, turn=turn, collides="none", volume=2e-5)


def globe(
    b: PieceBuilder, radius: float, at: tuple[float, float, float], material: PieceMaterial = GLOBE
) -> None:
    """Add a ball of opal glass around a place."""
    turn = np.linspace(-np.pi / 2, np.pi / 2, 17)
    rows = np.stack([radius * np.cos(turn), radius * np.sin(turn)], -1)
    rows[[0, -1], 0] = 0.0
    mesh = turned(rows, segments=28)
    b.form(material, mesh, at, volume=4.0 * np.pi * radius**2 * 0.002)


def foot(b: PieceBuilder, material: PieceMaterial, radius: float, *, height: float = 0.02) -> None:
    """Add a round foot on the floor, and a cord that leaves it to the back."""
    rows = [(0, 0), (radius, 0), (radius, 0.6 * height), (0.94 * radius, height), (0, height)]
    b.form(material, turned(rows, segments=36), volume=radius**2 * height)
    path = np.array([(-0.6, 0.0, 0.006), (-1.06, 0.02, 0.003), (-1.12, 0.1, 0.003)]) * (
        radius,
        radius,
        1,
    )
    b.form(paint("#1d1e20", 0.6), swept(path, 0.0025, sides=6), collides="none")
