"""Cushions, towels and rugs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from sailenv_content.procedural.shapes import Vector3, box, part, rod
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.types.model import Texture

__all__ = ["cushion", "folded_towel", "hanging_towel", "rug"]

Colours = tuple[Vector3, ...]


def cushion(width: float, depth: float, height: float, colour: Vector3) -> list[RawPart]:
    """Return a cushion that lies flat: full in the middle, thin at its seam, corners pulled."""
    steps = 28
    t = np.linspace(-1.0, 1.0, steps + 1)
    u, v = np.meshgrid(t, t, indexing="ij")
    full = ((1.0 - u**2) * (1.0 - v**2)) ** 0.42
    # Between its corners the seam is drawn in.
    pull_u, pull_v = 1.0 - 0.07 * (1.0 - v**2), 1.0 - 0.07 * (1.0 - u**2)
    x, y = u * pull_u * depth / 2, v * pull_v * width / 2
    creases = 0.012 * np.sin(5.0 * u + 2.0 * v) * full
    sheets = []
    for side in (1.0, -1.0):
        z = height / 2 + side * (full * height / 2) + creases * height
        sheets.append(np.stack([x, y, np.maximum(z, 0.0)], axis=-1).reshape(-1, 3))
    index = np.arange((steps + 1) ** 2).reshape(steps + 1, steps + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    quads = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    mesh = RawMesh(
        positions=np.concatenate(sheets),
        uvs=np.zeros((2 * index.size, 2)),
        triangles=np.concatenate([quads, quads[:, ::-1] + index.size]),
    )
    return [part("cushion fabric", mesh, base_colour=(*colour, 1.0))]


def folded_towel(width: float, depth: float, layers: int, colours: Colours) -> list[RawPart]:
    """Return towels folded and laid upon one another, each rounded at its fold."""
    parts = []
    for layer in range(layers):
        thick = 0.032
        mesh = _rounded_slab(depth - 0.008 * layer, width - 0.006 * layer, thick, layer * thick)
        colour = colours[layer % len(colours)]
        parts.append(part(f"towel {layer}", mesh, base_colour=(*colour, 1.0)))
    return parts


def _rounded_slab(depth: float, width: float, height: float, base: float) -> RawMesh:
    """Return a slab along y whose long edges are round."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 9)
    radius = height / 2
    front = np.stack([depth / 2 - radius + radius * np.cos(angles), radius * np.sin(angles)], 1)
    ring = np.concatenate([front, front[::-1] * [-1.0, 1.0]]) + np.array([0.0, base + radius])
    count = len(ring)
    ends = [np.insert(ring, 1, y, axis=1) for y in (-width / 2, width / 2)]
    k = np.arange(count)
    following = (k + 1) % count
    walls = np.concatenate(
        [
            np.stack([k, k + count, following + count], 1),
            np.stack([k, following + count, following], 1),
        ]
    )
    fan = np.stack([np.zeros(count - 2, int), k[1:-1], k[2:]], 1)
    triangles = np.concatenate([walls, fan, fan[:, ::-1] + count])
    positions = np.concatenate(ends)
    volume = np.einsum(
        "ij,ij->",
        positions[triangles[:, 0]],
        np.cross(positions[triangles[:, 1]], positions[triangles[:, 2]]),
    )
    return RawMesh(
        positions=positions,
        uvs=np.zeros((2 * count, 2)),
        triangles=triangles if volume > 0 else triangles[:, ::-1],
    )


def hanging_towel(width: float, length: float, colour: Vector3) -> list[RawPart]:
    """Return a towel over a rail on the wall behind it; the origin is at its lower middle."""
    rail = rod(0.009, 1.0, (0.0, 0.0, 0.0))
    turned = rail.positions[:, [1, 0, 2]] * [1.0, width + 0.16, 1.0] + [0.06, 0.0, length]
    rail = RawMesh(positions=turned, uvs=rail.uvs, triangles=rail.triangles[:, ::-1])
    ends = [side * (width / 2 + 0.065) for side in (1, -1)]
    brackets = [
        *(box((0.06, 0.016, 0.016), (0.03, y, length)) for y in ends),
        *(box((0.006, 0.044, 0.044), (0.003, y, length)) for y in ends),
    ]
    rows, columns = 40, 24
    s = np.linspace(-1.0, 1.0, rows + 1)
    y = np.linspace(-width / 2, width / 2, columns + 1)
    drop = np.abs(s) * length * np.where(s < 0, 0.88, 1.0)
    over = np.clip(drop / 0.02, 0.0, 1.0)
    x_row = 0.06 + np.sign(s) * 0.012 * over
    z_row = length + 0.014 * (1.0 - over) - np.maximum(0.0, drop - 0.01)
    fold = 0.006 * np.sin(y * 38.0)[None] * np.clip(drop / length, 0.1, 1.0)[:, None]
    positions = np.stack(
        [
            x_row[:, None] + fold,
            np.broadcast_to(y, fold.shape),
            np.broadcast_to(z_row[:, None], fold.shape),
        ],
        axis=-1,
    ).reshape(-1, 3)
    positions[:, 2] -= positions[:, 2].min()
    index = np.arange(positions.shape[0]).reshape(rows + 1, columns + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    triangles = np.concatenate(
        [np.stack([a, c, b], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    )
    cloth = RawMesh(positions=positions, uvs=np.zeros((len(positions), 2)), triangles=triangles)
    chrome = {"base_colour": (0.56, 0.55, 0.53, 1.0), "roughness": 0.12, "metallic": 1.0}
    return [
        part("towel", cloth, base_colour=(*colour, 1.0), double_sided=True),
        part("chrome", rail, **chrome),
        *(part("chrome", bracket, **chrome) for bracket in brackets),
    ]


def rug(width: float, depth: float, pattern: str) -> list[RawPart]:
    """Return a rug with its short edge along x; ``oriental`` or ``striped``."""
    thick = 0.012
    picture = _oriental(width, depth) if pattern == "oriental" else _striped(width, depth)
    top = RawMesh(
        positions=np.array(
            [[x * depth / 2, y * width / 2, thick] for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        ),
        uvs=np.array([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]),
        triangles=np.array([[0, 1, 2], [0, 2, 3]]),
    )
    body = box((depth, width, thick - 0.001), (0.0, 0.0, (thick - 0.001) / 2))
    return [
        part("rug top", top, base_colour=(1, 1, 1, 1), base_colour_texture=picture),
        part("rug edge", body, base_colour=(0.20, 0.13, 0.09, 1.0)),
    ]


def _pile(picture: NDArray[np.float64], seed: int) -> Texture:
    """Add the unevenness of wool to a pattern."""
    generator = np.random.default_rng(seed)
    fine = ndimage.gaussian_filter(generator.standard_normal(picture.shape[:2]), 0.8)
    broad = ndimage.gaussian_filter(generator.standard_normal(picture.shape[:2]), (2.0, 30.0))
    shade = 1.0 + 0.10 * fine / fine.std() + 0.05 * broad / broad.std()
    pixels = np.full((*picture.shape[:2], 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * np.clip(picture * shade[..., None], 0.0, 1.0))
    pixels.flags.writeable = False
    return pixels


def _striped(width: float, depth: float) -> Texture:
    """Draw stripes of uneven width across the rug."""
    rows, columns = int(420 * depth), int(420 * width)
    palette = np.array(
        [[0.80, 0.76, 0.68], [0.24, 0.33, 0.38], [0.62, 0.36, 0.24], [0.86, 0.84, 0.8]]
    )
    edges = np.sort(np.random.default_rng(31).uniform(0.02, 0.98, 22))
    stripe = np.searchsorted(edges, np.linspace(0.0, 1.0, columns))
    return _pile(np.broadcast_to(palette[stripe % 4][None], (rows, columns, 3)).copy(), 32)


def _oriental(width: float, depth: float) -> Texture:
    """Draw a medallion on a red ground of small flowers, within three borders."""
    rows, columns = int(360 * depth), int(360 * width)
    v, u = np.mgrid[0:rows, 0:columns]
    x, y = (u + 0.5) / columns * width, (v + 0.5) / rows * depth
    edge = np.minimum(np.minimum(x, width - x), np.minimum(y, depth - y))
    red, blue = np.array([0.42, 0.09, 0.08]), np.array([0.09, 0.13, 0.26])
    cream, gold = np.array([0.78, 0.69, 0.52]), np.array([0.62, 0.44, 0.18])
    picture = np.broadcast_to(red, (rows, columns, 3)).copy()
    dx, dy = np.abs(x - width / 2), np.abs(y - depth / 2)
    cell_x, cell_y = np.mod(dx, 0.14) - 0.07, np.mod(dy + 0.07 * (dx // 0.14), 0.14) - 0.07
    angle, radius = np.arctan2(cell_y, cell_x), np.hypot(cell_x, cell_y)
    picture[radius < 0.026 * (1.0 + 0.45 * np.cos(6 * angle))] = cream
    picture[radius < 0.010] = blue
    medallion = np.hypot(dx / (0.30 * width), dy / (0.30 * depth))
    medallion *= 1.0 - 0.10 * np.cos(8.0 * np.arctan2(dy / depth, dx / width))
    for limit, colour in (
        (1.0, gold),
        (0.96, blue),
        (0.62, cream),
        (0.57, red),
        (0.26, gold),
        (0.2, blue),
    ):
        picture[medallion < limit] = colour
    ring = (medallion > 0.66) & (medallion < 0.92) & (radius < 0.030)
    picture[ring] = cream
    along = np.where(np.minimum(x, width - x) < np.minimum(y, depth - y), y, x)
    picture[edge < 0.24] = gold
    picture[edge < 0.225] = blue
    wave = np.abs(edge - 0.145 - 0.035 * np.sin(2 * np.pi * along / 0.18))
    border = (edge < 0.225) & (edge > 0.065)
    picture[border & (wave < 0.012)] = cream
    blossom = np.hypot(np.mod(along, 0.18) - 0.09, edge - 0.145)
    picture[border & (blossom < 0.022)] = red
    picture[border & (blossom < 0.008)] = gold
    picture[edge < 0.065] = gold
    picture[edge < 0.05] = red
    picture[(edge < 0.05) & (np.mod(along, 0.05) < 0.018) & (edge > 0.018)] = cream
    return _pile(picture, 33)
