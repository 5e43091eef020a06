"""Folding screens: of paper, slats, cane, cloth, and painted; their outer leaves turn."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.framing import pictured
from sailenv_content.families.fronts import front_panel
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import FABRICS, WOODS, PieceMaterial, metal, paint, printed
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import board, cushion, placed, swept
from sailenv_content.procedural.paintings import ARTS
from sailenv_ros.assets.solids import joined
from sailenv_ros.types.model import Mesh

__all__ = ["FAMILY"]

PAPER = paint("#efe8d6", 0.9, 500.0)


def _leaf(b: PieceBuilder, v: Values) -> None:
    """Add a leaf along y, around the origin, that stands on the floor."""
    w, h, deep, bar = v.leaf, v.height, v.deep, v.bar
    if v.kind == "slats":
        panel = Box((-deep / 2, -w / 2, 0.03), (deep / 2, w / 2, h))
        low, high = panel.rows([v.lower, 1.0 - v.lower], 0.002)
        front_panel(b, v.material, "shaker", low)
        front_panel(b, v.material, "louvre", high)
        for sign in (-1.0, 1.0):
            foot = (deep, 0.04, 0.03)
            b.box(v.material, foot, (0.0, sign * (w / 2 - 0.02), 0.015), bevel=0.003)
        return
    if v.kind == "cloth":
        tall = h - 0.02
        mesh = cushion((0.045, w, tall), radius=0.014, puff=0.006, tile_m=v.cloth.tile_m, steps=8)
        b.form(v.cloth, mesh, (0.0, 0.0, 0.02 + tall / 2), collides="none")
        b.collide((0.04, w, tall), (0.0, 0.0, 0.02 + tall / 2))
        for sign in (-1.0, 1.0):
            peg = swept([(0, sign * (w / 2 - 0.05), 0), (0, sign * (w / 2 - 0.05), 0.025)], 0.013)
            b.form(v.material, peg)
        if v.studs:
            for side in (-1.0, 1.0):
                for z in np.arange(0.06, h - 0.03, 0.06):
                    at = (side * 0.0245, side * (w / 2 - 0.02), float(z))
                    b.box(v.metal, (0.004, 0.008, 0.008), at, bevel=0.0018, collides=False)
        return
    feet = 0.06
    for sign in (-1.0, 1.0):
        b.box(v.material, (deep, bar, h), (0.0, sign * (w - bar) / 2, h / 2), bevel=0.003)
    rails = (feet + bar / 2, h - bar / 2)
    for z in rails:
        b.box(v.material, (deep, w - 2 * bar, bar), (0.0, 0.0, z), bevel=0.002)
    field = Box((-0.002, -w / 2 + bar, feet + bar), (0.002, w / 2 - bar, h - bar))
    size, mid = field.size, field.middle
    b.collide((0.01, size[1], size[2]), mid)
    if v.kind == "paper":
        b.box(PAPER, size, mid, bevel=0.0005, collides=False)
        for share in np.linspace(0, 1, v.rows + 1)[1:-1]:
            z = field.low[2] + share * size[2]
            bar_size = (0.014, size[1] - 0.002, 0.009)
            b.box(v.material, bar_size, (0, 0, z), bevel=0.001, collides=False)
        for share in np.linspace(0, 1, v.columns + 1)[1:-1]:
            y = field.low[1] + share * size[1]
            bar_size = (0.012, 0.009, size[2] - 0.002)
            b.box(v.material, bar_size, (0, y, mid[2]), bevel=0.001, collides=False)
    elif v.kind == "cane":
        b.form(
            v.reed,
            _woven(float(size[1]), float(field.low[2]), float(field.high[2])),
            collides="none",
            volume=3e-4,
        )
    else:
        for side in (-1.0, 1.0):
            art = _art(b, v, size[1] / size[2])
            turn = (0.0, 0.0, 0.0 if side > 0 else 180.0)
            mesh = pictured(size[1], size[2], float(mid[2]), 0.004, thick=0.004)
            b.form(art, placed(mesh, turn_deg=turn), collides="none")


@lru_cache(maxsize=8)
def _woven(width: float, low: float, high: float) -> Mesh:
    """Return strips that cross one another, over a field as wide along y."""
    strips = []
    for sign in (-1.0, 1.0):
        for z in np.arange(low - width / 2, high + width / 2, 0.036):
            ends = np.array([[z - sign * width / 2, -width / 2], [z + sign * width / 2, width / 2]])
            kept = _clipped(ends, low, high)
            if kept is not None:
                (z0, y0), (z1, y1) = kept
                length = float(np.hypot(z1 - z0, y1 - y0))
                strip = board((0.0016, length, 0.005), bevel=0.0005)
                at = (0.0012 * sign, (y0 + y1) / 2, (z0 + z1) / 2)
                strips.append(placed(strip, at, (45.0 * sign, 0.0, 0.0)))
    for y in np.arange(-width / 2 + 0.018, width / 2, 0.036):
        strip = board((0.0016, 0.004, high - low), bevel=0.0005)
        strips.append(placed(strip, (0.003, float(y), (low + high) / 2)))
    return joined(strips)


def _clipped(ends: np.ndarray, low: float, high: float) -> np.ndarray | None:
    """Return a line of heights and places clipped to heights; None if nothing is left."""
    (z0, y0), (z1, y1) = ends if ends[0, 0] < ends[1, 0] else ends[::-1]
    if z1 <= low + 0.01 or z0 >= high - 0.01:
        return None
    first, last = max(0.0, (low - z0) / (z1 - z0)), min(1.0, (high - z0) / (z1 - z0))
    return np.array([[z0 + s * (z1 - z0), y0 + s * (y1 - y0)] for s in (first, last)])


def _art(b: PieceBuilder, v: Values, aspect: float) -> PieceMaterial:
    seed = int(b.rng.integers(1, 100000))
    return printed(f"panel {seed}", ARTS[v.art](seed, aspect))


def _screen(b: PieceBuilder, v: Values) -> None:
    """Stand the inner leaves at an angle; the outer ones turn about their edges."""
    w, fold = v.leaf, v.fold
    # So wide that edges stay clear of one another at every angle.
    thick = 0.046 if v.kind == "cloth" else v.deep + 0.003
    gap = thick * np.tan(np.radians(max(fold, 31.0) / 2)) + 0.002
    count = int(v.leaves)
    inner = 1 if count == 3 else 2
    yaws = [0.0] if inner == 1 else [fold / 2, -fold / 2]
    spots: list[tuple[float, float, float]] = []
    edges = []
    x, y = 0.0, -inner * w / 2 * np.cos(np.radians(fold / 2 if inner == 2 else 0.0))
    edges.append((x, y))
    for yaw in yaws:
        c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        spots.append((x - s * w / 2, y + c * w / 2, yaw))
        x, y = x - s * (w + gap), y + c * (w + gap)
    edges.append((x + np.sin(np.radians(yaws[-1])) * gap, y - np.cos(np.radians(yaws[-1])) * gap))
    for px, py, yaw in spots:
        with b.frame((px, py, 0.0), yaw):
            _leaf(b, v)
    names = ("right leaf", "left leaf")
    for name, sign in zip(names, (-1.0, 1.0), strict=True):
        near = yaws[0 if sign < 0 else -1]
        yaw = near + sign * fold
        c, s = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        ex, ey = edges[0 if sign < 0 else 1]
        nc, ns = np.cos(np.radians(near)), np.sin(np.radians(near))
        # Hinges are at the faces towards which leaves fold.
        hx = ex - sign * ns * gap / 2
        hy = ey + sign * nc * gap / 2
        at = (hx - sign * s * (w / 2 + gap / 2), hy + sign * c * (w / 2 + gap / 2), 0.0)
        axis = (0.0, 0.0, -sign)
        with (
            b.hinge(
                name,
                "room divider",
                at=(hx, hy, 0.0),
                axis=axis,
                opens_deg=fold + 30.0,
                friction=1.2,
            ),
            b.frame(at, yaw),
        ):
            _leaf(b, v)
        for z in (0.2 * v.height, 0.8 * v.height):
            pin = swept([(hx, hy, z - 0.03), (hx, hy, z + 0.03)], 0.004, sides=8)
            b.form(v.metal, pin, collides="none")


_SHARED = {
    "leaf": Span(0.4, 0.5),
    "height": Span(1.6, 1.85),
    "deep": Span(0.02, 0.026),
    "bar": Span(0.024, 0.036),
    "leaves": Choice(3, 4),
    "fold": Span(28.0, 50.0),
    "material": Choice(*WOODS, paint("#e9e6df"), paint("#2b2623")),
    "metal": Choice(metal("brass"), metal("#26272a"), metal("steel")),
    "rows": Whole(4, 7),
    "columns": Whole(2, 3),
    "lower": Span(0.25, 0.5),
    "cloth": Choice(*FABRICS),
    "studs": Choice(True, False),
    "reed": Choice(paint("#c9a466", 0.6), paint("#a88452", 0.6), paint("#3a3026", 0.6)),
    "art": Whole(0, len(ARTS) - 1),
}

FAMILY = Family(
    name="folding_screen",
    category="room divider",
    least_m=(0.1, 0.8, 1.5),
    most_m=(0.9, 2.2, 2.0),
    styles={
        kind: Style(_screen, {**_SHARED, "kind": kind})
        for kind in ("paper", "slats", "cane", "cloth", "painted")
    },
)
