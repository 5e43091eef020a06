"""Cushions: square, long, round with pleats, bolsters, with stripes, for the floor."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import FABRICS, LEATHERS, PieceMaterial, fabric, printed
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import cushion, swept, turned, with_uvs
from sailenv_content.procedural.forms import tube
from sailenv_ros.assets.meshes import smooth_mesh
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.model import Mesh

__all__ = ["FAMILY"]


def _soft(b: PieceBuilder, material: PieceMaterial, v: Values, d: float, w: float) -> Mesh:
    mesh = cushion(
        (d, w, 0.6 * v.thick),
        radius=0.2 * v.thick,
        puff=0.4 * v.thick,
        tile_m=material.tile_m,
        steps=14,
        pinch=v.pinch,
    )
    b.form(material, mesh, (0.0, 0.0, v.thick * 0.7), collides="none")
    b.collide((0.85 * d, 0.85 * w, v.thick), (0.0, 0.0, 0.7 * v.thick))
    return mesh


def _square(b: PieceBuilder, v: Values) -> None:
    """Lay a cushion flat, with a cord around its seam or tassels at its corners."""
    d, w = v.size, v.size * v.ratio
    mesh = _soft(b, v.cover, v, d, w)
    z = 0.7 * v.thick
    points = mesh.positions[np.abs(mesh.positions[:, 2]) < 0.12 * v.thick].astype(np.float64)
    angle = np.arctan2(points[:, 1] / w, points[:, 0] / d)
    bins = np.linspace(-np.pi, np.pi, 41)[:-1]
    far = [
        points[
            np.argmax(
                np.where(
                    np.abs((angle - t + np.pi) % (2 * np.pi) - np.pi) < 0.1,
                    np.hypot(points[:, 0], points[:, 1]),
                    0.0,
                )
            )
        ]
        for t in bins
    ]
    rim = np.array(far) * (1.005, 1.005, 0.0)
    if v.trim == "cord":
        cord = smooth_mesh(tube(rim, 0.005, sides=8, closed=True))
        b.form(v.second, cord, (0, 0, z), collides="none", volume=2e-5)
    elif v.trim == "tassels":
        tassel = turned(
            [(0, 0), (0.012, 0.002), (0.009, 0.035), (0.004, 0.04), (0.006, 0.046), (0, 0.052)],
            segments=10,
        )
        for sx in (-1.0, 1.0):
            for sy in (-1.0, 1.0):
                corner = mesh.positions[np.argmax(mesh.positions @ np.array([sx, sy, 0.0]))]
                at = (float(corner[0]), float(corner[1]), z - 0.003)
                out = float(np.degrees(np.arctan2(sy, sx)))
                b.form(v.second, tassel, at, turn=(0, 90, out), collides="none")


def _striped(b: PieceBuilder, v: Values) -> None:
    """Cover a cushion with a cloth that has stripes of two colours."""
    d, w = v.size, v.size * v.ratio
    pixels = np.full((8, 512, 4), 255, np.uint8)
    odd = (np.arange(512) * v.stripes // 512) % 2 == 1
    for mine, one in ((odd, v.second), (~odd, v.cover)):
        srgb = srgb_from_linear(np.array(one.surface.base_colour[:3]))
        pixels[:, mine, :3] = np.rint(255.0 * srgb)
    cloth = printed("striped cloth", pixels)
    mesh = cushion(
        (d, w, 0.6 * v.thick), radius=0.2 * v.thick, puff=0.4 * v.thick, steps=14, pinch=v.pinch
    )
    mesh = with_uvs(mesh, (1, 0), (-0.52 * w, -d / 2), (1.04 * w, d))
    b.form(cloth, mesh, (0, 0, 0.7 * v.thick), collides="none", volume=0.1 * d * w * v.thick)
    b.collide((0.85 * d, 0.85 * w, v.thick), (0.0, 0.0, 0.7 * v.thick))


def _round(b: PieceBuilder, v: Values) -> None:
    """Pleat a round cushion around a button."""
    r, h = v.size / 2, v.thick * 1.2
    rows = [
        (0, 0),
        (0.5 * r, 0.0),
        (0.9 * r, 0.12 * h),
        (r, 0.5 * h),
        (0.88 * r, 0.86 * h),
        (0.45 * r, h),
        (0.12 * r, 0.88 * h),
        (0, 0.86 * h),
    ]
    mesh = turned(rows, segments=4 * v.pleats, tile_m=v.cover.tile_m, crease_deg=60.0)
    angles = np.arctan2(mesh.positions[:, 1], mesh.positions[:, 0])
    ridge = 1.0 - 0.02 * (1.0 + np.cos(v.pleats * angles))
    positions = mesh.positions.copy()
    positions[:, :2] *= ridge[:, None]
    b.form(
        v.cover,
        Mesh(positions=positions, normals=mesh.normals, uvs=mesh.uvs, triangles=mesh.triangles),
    )
    button = [(0, 0), (0.02, 0.002), (0.018, 0.01), (0, 0.013)]
    b.form(v.second, turned(button, segments=18), (0, 0, 0.87 * h), collides="none")


def _bolster(b: PieceBuilder, v: Values) -> None:
    """Make a roll with flat ends, drawn together around buttons."""
    r, w = 0.5 * v.thick + 0.03, v.size * 1.15
    rows = [
        (0, 0.012),
        (0.3 * r, 0.012),
        (0.85 * r, 0.0),
        (0.97 * r, 0.012),
        (r, 0.05),
        (1.02 * r, 0.5 * w),
        (r, w - 0.05),
        (0.97 * r, w - 0.012),
        (0.85 * r, w),
        (0.3 * r, w - 0.012),
        (0, w - 0.012),
    ]
    mesh = turned(rows, segments=32, tile_m=v.cover.tile_m, crease_deg=60.0)
    b.form(v.cover, mesh, (0, w / 2, 1.02 * r), turn=(90, 0, 0))
    for y in (-w / 2 + 0.012, w / 2 - 0.012):
        ring = [
            (0.97 * r * np.cos(t), y, 1.02 * r + 0.97 * r * np.sin(t))
            for t in np.linspace(0, 2 * np.pi, 33)
        ]
        b.form(v.second, swept(ring, 0.004, sides=6), collides="none", volume=1e-5)


_SHARED = {
    "size": Span(0.4, 0.52),
    "ratio": 1.0,
    "thick": Span(0.11, 0.16),
    "pinch": Span(0.5, 1.0),
    "trim": Choice("none", "cord", "cord", "tassels"),
    "cover": Choice(*FABRICS, *LEATHERS[:2], fabric("#e9e5dc")),
    "second": Choice(*FABRICS, fabric("#e9e5dc"), fabric("#26282b")),
}

FAMILY = Family(
    name="cushion",
    category="pillow",
    least_m=(0.1, 0.25, 0.08),
    most_m=(0.9, 0.95, 0.35),
    styles={
        "square": Style(_square, _SHARED),
        "long": Style(_square, {**_SHARED, "size": Span(0.28, 0.36), "ratio": Span(1.5, 1.9)}),
        "striped": Style(
            _striped, {**_SHARED, "stripes": Choice(3, 6, 8, 12), "ratio": Choice(1.0, 1.4)}
        ),
        "round": Style(_round, {**_SHARED, "pleats": Whole(10, 16)}),
        "bolster": Style(_bolster, _SHARED),
    },
)
