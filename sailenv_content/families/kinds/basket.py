"""Baskets: woven round and oval, square, of wire, for laundry with a lid."""

from __future__ import annotations

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.family import Family, Style
from sailenv_content.families.hollow import Box
from sailenv_content.families.lathe import scaled, vessel
from sailenv_content.families.materials import PieceMaterial, fabric, metal, paint
from sailenv_content.families.parameters import Choice, Span, Values
from sailenv_content.families.shaping import cushion, extruded, swept
from sailenv_content.procedural.forms import circle, curve, rectangle, tube
from sailenv_ros.assets.meshes import smooth_mesh

__all__ = ["FAMILY"]


def _strand(b: PieceBuilder, material: PieceMaterial, path: np.ndarray, thick: float) -> None:
    """Add a closed strand along a path (N, 3)."""
    mesh = smooth_mesh(tube(path, thick, sides=6, closed=True))
    length = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())
    b.form(material, mesh, collides="none", volume=length * np.pi * thick**2)


def _outline(v: Values, count: int) -> np.ndarray:
    """Return (count, 2) points of the basket's outline at its rim, evenly apart."""
    if v.square:
        flat = rectangle(v.width, v.depth, 0.05, 8)
        closed = np.concatenate([flat, flat[:1]])
        along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
        at = np.linspace(0, along[-1], count, endpoint=False)
        return np.stack([np.interp(at, along, closed[:, k]) for k in range(2)], -1)
    return np.asarray(circle(count) * (v.depth / 2, v.width / 2))


def _woven(b: PieceBuilder, v: Values) -> None:
    """Weave strands around upright stakes, over and under them in turn."""
    stakes, h, thick = 2 * v.stakes, v.height, v.thick
    rim = _outline(v, stakes)
    rows = int(h / (1.75 * thick))
    for row in range(rows):
        z = thick + (h - 2 * thick) * row / (rows - 1)
        swell = v.base + (1 - v.base) * (z / h) ** v.curve
        push = thick * 0.75 * np.where((np.arange(stakes) + row) % 2, 1.0, -1.0)
        flat = rim * swell
        flat = flat * (1.0 + push / np.linalg.norm(flat, axis=1))[:, None]
        strand = v.second if v.striped and (row * 5 // rows) % 2 else v.material
        _strand(b, strand, np.c_[flat, np.full(stakes, z)], thick)
    for point in rim[::1]:
        heights = np.linspace(thick, h, 6)
        path = np.stack(
            [np.append(point * (v.base + (1 - v.base) * (z / h) ** v.curve), z) for z in heights]
        )
        b.form(v.material, swept(path, 0.7 * thick, sides=5), collides="none")
    for lift in (0.0, 1.6 * thick):
        _strand(b, v.material, np.c_[rim, np.full(stakes, h + lift)], 1.3 * thick)
    floor = extruded(rim * v.base * 0.99, 1.5 * thick, bevel=0.001, tile_m=v.material.tile_m)
    b.form(v.material, floor, collides="box")
    _walls(b, v)
    if v.handles:
        reach = v.width / 2
        for sy in (-1.0, 1.0):
            bow = curve(
                [
                    (-0.06, sy * reach, h),
                    (-0.045, sy * reach * 1.02, h + 0.05),
                    (0.0, sy * reach * 1.02, h + 0.07),
                    (0.045, sy * reach * 1.02, h + 0.05),
                    (0.06, sy * reach, h),
                ],
                14,
            )
            with b.part("handle", "handle"):
                b.form(v.material, swept(bow, 1.5 * thick, sides=8))
    if v.filled:
        _cloth(b, v)
    if v.lid:
        at = (-v.depth / 2 - 0.006, 0.0, h + 4 * thick)
        with b.hinge(
            "lid", "lid", at=at, axis=(0, -1, 0), opens_deg=100.0, friction=0.2, damping=0.2
        ):
            top = extruded(rim * 1.03, 0.016, bevel=0.005, tile_m=v.material.tile_m)
            b.form(v.material, top, (0, 0, h + 4 * thick))
            for share in (0.3, 0.55, 0.8, 1.02):
                _strand(
                    b, v.material, np.c_[rim * share, np.full(stakes, h + 4 * thick + 0.016)], thick
                )


def _walls(b: PieceBuilder, v: Values) -> None:
    """Let the walls collide, so that it stays hollow."""
    d, w, h = v.depth * (1 + v.base) / 2, v.width * (1 + v.base) / 2, v.height
    share = 1.0 if v.square else 0.72
    for sign in (-1.0, 1.0):
        b.collide((0.012, w * share, h), (sign * (d / 2 - 0.006), 0.0, h / 2))
        b.collide((d * share, 0.012, h), (0.0, sign * (w / 2 - 0.006), h / 2))


def _cloth(b: PieceBuilder, v: Values) -> None:
    """Lay folded blankets into it."""
    with b.part("blankets", "blanket"):
        z = 0.02
        while z < v.height + 0.02:
            thick = b.between(0.05, 0.08)
            size = (0.66 * v.depth * v.base, 0.66 * v.width * v.base, thick)
            cloth = fabric(b.pick("#c9d2d6", "#b9a892", "#566273", "#a8715c", "#7f8f7a"))
            mesh = cushion(size, radius=0.024, puff=0.008, tile_m=cloth.tile_m, steps=6)
            turn = (0.0, 0.0, b.between(-8.0, 8.0))
            b.form(cloth, mesh, (0.0, 0.0, z + thick / 2), turn=turn, collides="none")
            z += 0.92 * thick


def _wire(b: PieceBuilder, v: Values) -> None:
    """Weld a basket of wires."""
    count, h, thick = 28, v.height, 0.0022
    rim = _outline(v, count)
    for row in range(5):
        z = thick + (h - 2 * thick) * row / 4
        swell = v.base + (1 - v.base) * z / h
        _strand(
            b, v.metal, np.c_[rim * swell, np.full(count, z)], thick * (1.7 if row == 4 else 1.0)
        )
    for point in rim:
        path = np.array(
            [(0.12 * point[0], 0.12 * point[1], thick), (*(point * v.base), thick), (*point, h)]
        )
        b.form(v.metal, swept(path, thick, sides=5), collides="none")
    _strand(b, v.metal, np.c_[rim * 0.5 * v.base, np.full(count, thick)], thick)
    low = Box(
        (-v.depth / 2 * v.base, -v.width / 2 * v.base, 0),
        (v.depth / 2 * v.base, v.width / 2 * v.base, 0.006),
    )
    b.collide(low.size, low.middle)
    _walls(b, v)
    if v.filled:
        _cloth(b, v)


def _felt(b: PieceBuilder, v: Values) -> None:
    """Sew a soft round basket of felt or rope, with two loops."""
    r, h = v.depth / 2, v.height
    rows = [(0.94 * r, 0.0), (r, 0.03), (1.02 * r, 0.5 * h), (0.97 * r, h)]
    mesh = vessel(rows, wall=0.008, floor=0.01, segments=40, tile_m=0.06)
    b.form(v.cloth, scaled(mesh, (1.0, v.width / v.depth, 1.0)), collides="none", volume=0.003)
    b.collide((1.4 * r, 1.4 * r, 0.012), (0, 0, 0.006))
    _walls(b, Values({**v.all, "base": 1.0}))
    for sy in (-1.0, 1.0):
        y = sy * v.width / 2 * 0.97
        bow = curve(
            [
                (-0.05, y, h - 0.03),
                (-0.04, y, h + 0.02),
                (0, y, h + 0.045),
                (0.04, y, h + 0.02),
                (0.05, y, h - 0.03),
            ],
            12,
        )
        with b.part("handle", "handle"):
            b.form(v.leather, swept(bow, 0.006, sides=8), collides="none")
    if v.filled:
        _cloth(b, Values({**v.all, "base": 0.9}))


_RUSHES = tuple(
    paint(c, 0.8, 400.0) for c in ("#b98f5a", "#8c6a42", "#d2b98a", "#6b5038", "#e2d8c4", "#4a4a48")
)
_SHARED = {
    "depth": Span(0.28, 0.4),
    "width": Span(0.3, 0.45),
    "height": Span(0.2, 0.32),
    "base": Span(0.78, 0.95),
    "curve": Span(0.5, 1.2),
    "stakes": Choice(14, 18),
    "thick": Span(0.005, 0.0065),
    "material": Choice(*_RUSHES),
    "second": Choice(*_RUSHES),
    "striped": Choice(True, False),
    "square": False,
    "handles": Choice(True, False),
    "filled": Choice(True, False),
    "lid": False,
}

FAMILY = Family(
    name="basket",
    category="basket",
    least_m=(0.2, 0.2, 0.12),
    most_m=(0.7, 0.8, 0.85),
    styles={
        "woven": Style(_woven, _SHARED),
        "square": Style(_woven, {**_SHARED, "square": True, "base": Span(0.9, 0.97)}),
        "laundry": Style(
            _woven,
            {
                **_SHARED,
                "height": Span(0.5, 0.6),
                "thick": 0.0075,
                "lid": True,
                "handles": False,
                "filled": False,
                "square": Choice(True, False),
                "curve": 1.0,
            },
        ),
        "wire": Style(
            _wire,
            {
                **_SHARED,
                "square": Choice(True, False),
                "metal": Choice(metal("#232326"), metal("brass"), metal("copper")),
            },
        ),
        "soft": Style(
            _felt,
            {
                **_SHARED,
                "cloth": Choice(*(fabric(c) for c in ("#6f7a83", "#c9bda8", "#4a4a52", "#b98a3e"))),
                "leather": Choice(paint("#6b3f24", 0.6), paint("#2a2624", 0.6)),
            },
        ),
    },
)
