"""Throws: folded, rolled, spread with fringes, dropped in a heap."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.draping import fringe
from sailenv_content.families.family import Family, Style
from sailenv_content.families.materials import FABRICS, PieceMaterial, fabric
from sailenv_content.families.parameters import Choice, Span, Values, Whole
from sailenv_content.families.shaping import cushion, placed, swept
from sailenv_content.procedural.forms import loft
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.types.model import Mesh

__all__ = ["FAMILY"]

TILE_M = 0.06


def _folded(b: PieceBuilder, v: Values) -> None:
    """Fold a throw into a pile of layers, with a stripe and a fringe at its open end."""
    d, w, thick = v.depth, v.width, v.thick
    z = 0.0
    for number in range(v.layers):
        cloth = v.second if v.striped and number == v.layers - 1 else v.cloth
        size = (d * b.between(0.97, 1.0), w * b.between(0.97, 1.0), thick)
        mesh = cushion(size, radius=0.48 * thick, puff=0.003, tile_m=TILE_M, steps=8)
        at = (b.between(-0.004, 0.004), b.between(-0.004, 0.004), z + thick / 2)
        b.form(cloth, mesh, at, turn=(0.0, 0.0, b.between(-1.5, 1.5)), collides="none")
        z += 0.93 * thick
    b.collide((d, w, z), (0.0, 0.0, z / 2))
    low = 0.4 * thick
    for sign in (-1.0, 1.0):
        ys = np.linspace(-0.46 * w, 0.46 * w, int(w / 0.02))
        ends = np.stack([np.full(len(ys), sign * d / 2), ys, np.full(len(ys), low)], -1)
        if v.fringe and sign > 0:
            fringe(b, v.cloth, ends, (sign * v.fringe, 0.0))


def _rolled(b: PieceBuilder, v: Values) -> None:
    """Roll a throw, tied with two bands."""
    w, turns, thick = v.width, v.turns, 0.013
    turn = np.linspace(0.0, 2.0 * np.pi * turns, 20 * turns)
    radius = 0.012 + thick * turn / (2.0 * np.pi)
    inner, outer = radius, radius + 0.8 * thick
    line = [np.stack([r * np.cos(turn), r * np.sin(turn)], -1) for r in (outer, inner)]
    outline = np.concatenate([line[0], line[1][::-1]])
    rings = np.empty((2, len(outline), 3))
    for row, y in enumerate((-w / 2, w / 2)):
        rings[row, :, 0], rings[row, :, 1], rings[row, :, 2] = outline[:, 0], y, -outline[:, 1]
    # The ends are strips along the winding: a fan would fill the gaps.
    raw = loft(rings, caps=False)
    columns, strip = len(outline) + 1, _strip(len(turn))
    triangles = np.concatenate([raw.triangles, strip[:, ::-1], strip + columns])
    uvs = raw.uvs * (float(radius.max()) * 2 * turns / TILE_M, w / TILE_M)
    mesh = smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=triangles), 60.0)
    r = float(outer[-20:].mean())
    b.form(v.cloth, mesh, (0.0, 0.0, r), volume=np.pi * r * r * w)
    for sign in (-1.0, 1.0):
        turn = np.linspace(0, 2 * np.pi, 33)
        reach = np.interp(turn, np.linspace(0, 2 * np.pi, 20), outer[-20:]) + 0.0015
        path = np.stack(
            [reach * np.cos(turn), np.full(33, sign * 0.24 * w), r - reach * np.sin(turn)], -1
        )
        for aside in (-0.008, 0.0, 0.008):
            band = swept(path + np.array([0.0, aside, 0.0]), 0.004, sides=6)
            b.form(v.second, band, collides="none", volume=1e-6)


def _strip(n: int) -> NDArray[np.int64]:
    """Return (2 N - 2, 3) triangles between a row of points and the row that leads back."""
    first = np.arange(n - 1)
    back = 2 * n - 1 - first
    return np.concatenate(
        [np.stack([first, first + 1, back - 1], -1), np.stack([first, back - 1, back], -1)]
    )


def _sheet(b: PieceBuilder, v: Values, d: float, w: float, lift: float) -> Mesh:
    """Return a sheet that lies with folds of a height."""
    nx, ny = 41, 33
    x, y = np.linspace(-d / 2, d / 2, nx), np.linspace(-w / 2, w / 2, ny)
    height = np.zeros((nx, ny))
    for _ in range(6):
        along, across = b.rng.uniform(-11.0, 11.0, 2)
        height += np.abs(np.sin(along * x[:, None] + across * y + b.between(0.0, 6.3)))
    edge = np.minimum(1 - np.abs(x[:, None]) / (d / 2), 1 - np.abs(y) / (w / 2))
    height = lift * (height / 6.0) ** 1.5 * np.clip(0.35 + 2.4 * edge, 0.0, 1.0)
    rings = np.empty((nx, 2 * ny, 3))
    rings[..., 0] = x[:, None]
    rings[:, :ny, 1], rings[:, ny:, 1] = y, y[::-1]
    rings[:, :ny, 2] = height * 0.9
    rings[:, ny:, 2] = (height + v.thick)[:, ::-1]
    raw = loft(rings, caps=False)
    strip = _strip(ny)
    triangles = np.concatenate([raw.triangles, strip[:, ::-1], strip + (nx - 1) * (2 * ny + 1)])
    uvs = raw.positions[:, :2] / TILE_M
    return smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=triangles), 70.0)


def _spread(b: PieceBuilder, v: Values) -> None:
    """Spread a throw, with stripes across and fringes at its ends."""
    d, w = v.depth * 1.6, v.width * 1.5
    mesh = _sheet(b, v, d, w, v.lift)
    b.form(v.cloth, mesh, collides="none", volume=d * w * v.thick)
    b.collide((d, w, 0.6 * v.lift), (0.0, 0.0, 0.3 * v.lift))
    points = mesh.positions.astype(np.float64)
    for sign in (-1.0, 1.0):
        rim = points[np.abs(points[:, 0] - sign * d / 2) < 1e-6]
        ends = []
        for y in np.linspace(-0.49 * w, 0.49 * w, int(w / 0.025)):
            near = rim[np.argmin(np.abs(rim[:, 1] - y))]
            ends.append([near[0], y, near[2] + 0.5 * v.thick])
        fringe(b, v.cloth, np.array(ends), (sign * v.fringe, 0.0))


def _heap(b: PieceBuilder, v: Values) -> None:
    """Drop a throw: a mound of folds that wind round one another."""
    r, h = 0.5 * v.depth, v.tall
    turns = np.linspace(0.0, 2 * np.pi, 49)[:-1]
    rings = []
    waves = [(k, b.between(0, 6.3), b.between(0.3, 1.0)) for k in (3, 5, 8, 13)]
    for share in np.linspace(0.0, 1.0, 17):
        out = np.sqrt(max(0.0, 1.0 - share**1.6)) * r + 0.006
        fold = sum(a * np.sin(k * turns + p + 2.4 * share * (1 + k / 8)) for k, p, a in waves)
        reach = out * (1.0 + 0.1 * fold * (1.0 - 0.5 * share))
        up = h * share * (1.0 + 0.12 * np.sin(2 * turns + waves[0][1]))
        sink = 0.5 * h * max(0.0, share - 0.82) / 0.18
        rings.append(
            np.stack([reach * np.cos(turns), v.stretch * reach * np.sin(turns), up - sink], -1)
        )
    raw = loft(np.array(rings))
    uvs = np.stack([raw.uvs[:, 0] * 2 * np.pi * r, raw.uvs[:, 1] * (r + h)], -1) / TILE_M
    mesh = smooth_mesh(RawMesh(positions=raw.positions, uvs=uvs, triangles=raw.triangles), 75.0)
    b.form(v.cloth, mesh, volume=0.35 * r * r * h)
    tail = _sheet(b, v, 0.9 * v.depth, 0.5 * v.width, 0.4 * v.lift)
    b.form(
        v.cloth,
        placed(tail, (0.5 * r, 0.35 * r, 0.0), (0, 0, v.turn)),
        collides="none",
        volume=5e-4,
    )


_WOOLS: tuple[PieceMaterial, ...] = (
    *FABRICS,
    *(fabric(c) for c in ("#e4ded0", "#cbbfa9", "#8fa0a8", "#d9b9a6", "#566273")),
)
_SHARED = {
    "depth": Span(0.3, 0.42),
    "width": Span(0.36, 0.5),
    "thick": Span(0.02, 0.03),
    "cloth": Choice(*_WOOLS),
    "second": Choice(*_WOOLS),
    "striped": Choice(True, False),
    "fringe": Span(0.03, 0.055),
}

FAMILY = Family(
    name="throw",
    category="blanket",
    least_m=(0.08, 0.25, 0.03),
    most_m=(0.95, 0.95, 0.35),
    styles={
        "folded": Style(_folded, {**_SHARED, "layers": Whole(3, 6)}),
        "rolled": Style(_rolled, {**_SHARED, "turns": Whole(4, 6)}),
        "spread": Style(_spread, {**_SHARED, "thick": 0.006, "lift": Span(0.1, 0.16)}),
        "heap": Style(
            _heap,
            {
                **_SHARED,
                "thick": 0.007,
                "tall": Span(0.12, 0.2),
                "lift": Span(0.05, 0.08),
                "stretch": Span(0.9, 1.3),
                "turn": Span(0.0, 180.0),
            },
        ),
    },
)
