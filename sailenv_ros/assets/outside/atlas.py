"""From a `Scenery` to the parts of a model: pictures in their light, on as few textures as hold.

The materials only emit: colour times light, computed once, as a photograph has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.outside.painting import Board, leaves, resized
from sailenv_ros.assets.outside.scenery import Card, Piece, Scenery
from sailenv_ros.types.colour import LUMINANCE, srgb_from_linear
from sailenv_ros.types.model import Material, Mesh, ModelPart

__all__ = ["MEAN_SHARE", "model_parts"]

Floats: TypeAlias = NDArray[np.float64]
Pixels: TypeAlias = NDArray[np.float32]
_Board: TypeAlias = tuple[Piece, int, int]

PAGE_PX = 1024
BORDER_PX = 4
LEAF_PX = 128
LEVELS = 4
"""Steps of brightness of leaves: a card takes the nearest to its light."""

SUN_STEP_M, MOST_SUN_STEPS = 0.2, 100
SKY_STEP_M, MOST_SKY_STEPS = 0.7, 16
"""How far apart light is computed on a piece, at least [m], and at most so often along a side."""

MEAN_SHARE = 1.0 / 3.0
"""Share of the emission that the mean luminance of all surfaces has: whites are three times as
bright as the mean at most."""


@dataclass(frozen=True, eq=False, slots=True)
class _Placed:
    piece: Piece
    pixels: Pixels
    page: int
    row: int
    column: int


def model_parts(scenery: Scenery, seed: int, scale: float | None = None) -> tuple[ModelPart, ...]:
    """Return flat pieces, a part for each texture, and cards of leaves as the last part.

    Parameters
    ----------
    scenery : Scenery
        With at least one piece.
    seed : int
        Of the painters.
    scale : float or None
        Emission of what is as bright as can be shown; None finds one that suits the pieces.
    """
    boards = [(piece, *_pixels_of(piece)) for piece in scenery.pieces]
    lights = _lights(scenery, boards)
    order = sorted(range(len(boards)), key=lambda i: (-boards[i][1], -boards[i][2], i))
    placed: list[_Placed] = []
    page, row, column, tall = 0, 0, 0, 0
    for number in order:
        piece, rows, columns = boards[number]
        pixels = _painted(piece, rows, columns, seed, number)
        light = lights[number]
        if light is not None:
            sky, sun = (resized(part, rows, columns) for part in light)
            pixels = pixels * (sky + sun[..., None] * np.asarray(scenery.daylight.sun, np.float32))
        if column + columns + 2 * BORDER_PX > PAGE_PX:
            row, column, tall = row + tall, 0, 0
        if row + rows + 2 * BORDER_PX > PAGE_PX:
            page, row, column, tall = page + 1, 0, 0, 0
        placed.append(_Placed(piece, pixels, page, row + BORDER_PX, column + BORDER_PX))
        column, tall = column + columns + 2 * BORDER_PX, max(tall, rows + 2 * BORDER_PX)
    scale = _scale(placed) if scale is None else scale
    parts = [
        _page_part([one for one in placed if one.page == number], scale)
        for number in range(page + 1)
    ]
    if scenery.cards:
        parts.append(_cards_part(scenery, scale, seed))
    return tuple(parts)


def _pixels_of(piece: Piece) -> tuple[int, int]:
    """Return rows and columns of a piece's picture."""
    wide, tall = piece.size_m
    most = PAGE_PX - 2 * BORDER_PX
    return (
        min(most, max(2, round(tall * piece.density))),
        min(most, max(2, round(wide * piece.density))),
    )


def _painted(piece: Piece, rows: int, columns: int, seed: int, number: int) -> Pixels:
    rng = np.random.Generator(np.random.PCG64([seed, number]))
    wide, tall = piece.size_m
    return np.asarray(piece.paint(Board(wide, tall, columns, rows, rng)), np.float32)


def _lights(scenery: Scenery, boards: Sequence[_Board]) -> list[tuple[Pixels, Pixels] | None]:
    """Return, for each board in daylight, that of the sky and the share of the sun's, on grids."""
    lit = [number for number, (piece, _, _) in enumerate(boards) if not piece.has_own_light]
    results: list[tuple[Pixels, Pixels] | None] = [None] * len(boards)
    if not lit:
        return results
    found = []
    for step, most, light in (
        (SKY_STEP_M, MOST_SKY_STEPS, scenery.occluders.sky_light),
        (SUN_STEP_M, MOST_SUN_STEPS, scenery.occluders.sun_light),
    ):
        grids = [_grid(boards[number], step, most) for number in lit]
        points = np.concatenate([grid for grid, _ in grids])
        normals = np.concatenate(
            [
                np.broadcast_to(boards[number][0].normal, grid.shape)
                for number, (grid, _) in zip(lit, grids, strict=True)
            ]
        )
        values = light(scenery.daylight, points, normals).astype(np.float32)
        ends = np.cumsum([len(grid) for grid, _ in grids])[:-1]
        pieces = np.split(values, ends)
        found.append(
            [
                one.reshape(*shape, *one.shape[1:])
                for one, (_, shape) in zip(pieces, grids, strict=True)
            ]
        )
    for number, sky, sun in zip(lit, *found, strict=True):
        results[number] = sky, sun
    return results


def _grid(board: _Board, step_m: float, most: int) -> tuple[Floats, tuple[int, int]]:
    """Return points on a piece, row by row from the top, and how many rows and columns they are."""
    piece, rows, columns = board
    wide, tall = piece.size_m
    across = min(most, columns, max(2, round(wide / step_m) + 1))
    down = min(most, rows, max(2, round(tall / step_m) + 1))
    s = (np.arange(across) + 0.5) / across
    t = (np.arange(down)[::-1] + 0.5) / down
    shares = np.stack(np.meshgrid(s, t), axis=-1).reshape(-1, 2)
    return piece.places(shares), (down, across)


def _scale(placed: Sequence[_Placed]) -> float:
    """Return the emission of what is as bright as can be shown."""
    means = [float((one.pixels.mean(axis=(0, 1)) * LUMINANCE).sum()) for one in placed]
    areas = [one.piece.size_m[0] * one.piece.size_m[1] for one in placed]
    # Far ground and roads are large, and seldom seen.
    weights = np.minimum(np.asarray(areas), 60.0)
    mean = float((np.asarray(means) * weights).sum() / max(weights.sum(), 1e-9))
    return max(1e-4, mean / MEAN_SHARE)


def _page_part(placed: Sequence[_Placed], scale: float) -> ModelPart:
    texture = np.full((PAGE_PX, PAGE_PX, 4), 255, np.uint8)
    texture[..., :3] = 0
    border = ((BORDER_PX, BORDER_PX), (BORDER_PX, BORDER_PX), (0, 0))
    for one in placed:
        rows, columns = one.pixels.shape[:2]
        texture[
            one.row - BORDER_PX : one.row + rows + BORDER_PX,
            one.column - BORDER_PX : one.column + columns + BORDER_PX,
            :3,
        ] = np.pad(_encoded(one.pixels / np.float32(scale)), border, mode="edge")
    return ModelPart(mesh=_page_mesh(placed), material=_material("outside", texture, scale))


def _page_mesh(placed: Sequence[_Placed]) -> Mesh:
    positions, normals, uvs, triangles = [], [], [], []
    first = 0
    for one in placed:
        shares = np.asarray(one.piece.outline, np.float64)
        count = len(shares)
        rows, columns = one.pixels.shape[:2]
        positions.append(one.piece.places(shares))
        normals.append(np.broadcast_to(one.piece.normal, (count, 3)))
        # The picture's edges are the piece's; v runs up, rows run down.
        u = (one.column + shares[:, 0] * columns) / PAGE_PX
        v = 1.0 - (one.row + (1.0 - shares[:, 1]) * rows) / PAGE_PX
        uvs.append(np.stack([u, v], axis=1))
        triangles += [(first, first + i, first + i + 1) for i in range(1, count - 1)]
        first += count
    return Mesh(
        positions=np.concatenate(positions).astype(np.float32),
        normals=np.concatenate(normals).astype(np.float32),
        uvs=np.concatenate(uvs).astype(np.float32),
        triangles=np.asarray(triangles, np.uint32),
    )


def _cards_part(scenery: Scenery, scale: float, seed: int) -> ModelPart:
    """Return all cards; each shows the leaves whose brightness is nearest to its light."""
    light = np.array([_card_light(scenery, card) for card in scenery.cards])
    bright = light @ LUMINANCE
    low, high = float(np.quantile(bright, 0.03)), float(np.quantile(bright, 0.97))
    levels = np.linspace(low, max(high, low + 1e-6), LEVELS)
    level = np.abs(bright[:, None] - levels).argmin(axis=1)
    colours = len(scenery.leaf_colours)
    grid = int(np.ceil(np.sqrt(colours * LEVELS)))
    edge = 512 if grid <= 4 else 1024
    leaf_px = edge // grid
    texture = np.zeros((edge, edge, 4), np.uint8)
    for colour in range(colours):
        for step in range(LEVELS):
            rng = np.random.Generator(np.random.PCG64([seed, colour, step]))
            picture = leaves(
                leaf_px, scenery.leaf_colours[colour], float(levels[step]) / scale, 130, rng
            )
            row, column = divmod(colour * LEVELS + step, grid)
            tile = np.s_[
                row * leaf_px : (row + 1) * leaf_px, column * leaf_px : (column + 1) * leaf_px
            ]
            texture[tile][..., :3] = _encoded(picture[..., :3])
            texture[tile][..., 3] = np.round(255.0 * picture[..., 3]).astype(np.uint8)
    number = np.array([card.foliage for card in scenery.cards]) * LEVELS + level
    material = _material("leaves", texture, scale, masked=True)
    return ModelPart(mesh=_card_mesh(scenery.cards, number, grid), material=material)


def _card_light(scenery: Scenery, card: Card) -> Floats:
    daylight = scenery.daylight
    normal = np.asarray(card.normal)
    sky = daylight.sky(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.2]])).mean(axis=0)
    facing = float((normal * np.asarray(daylight.towards_sun)).sum())
    # Leaves let light through: those that look away from the sun are not dark.
    sun = np.asarray(daylight.sun) / np.pi * max(0.12, 0.25 + 0.75 * facing)
    result: Floats = sky * (0.55 + 0.35 * card.normal[2]) + sun
    return result


def _card_mesh(cards: Sequence[Card], number: NDArray[np.intp], grid: int) -> Mesh:
    centre = np.array([card.centre for card in cards])
    right = np.array([card.right for card in cards])
    up = np.array([card.up for card in cards])
    normal = np.cross(right, up)
    normal /= np.sqrt((normal * normal).sum(axis=1, keepdims=True))
    signs = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    corners = centre[:, None] + signs[:, :1] * right[:, None] + signs[:, 1:] * up[:, None]
    row, column = np.divmod(number, grid)
    u = (column[:, None] + 0.5 + 0.5 * signs[:, 0]) / grid
    v = 1.0 - (row[:, None] + 0.5 - 0.5 * signs[:, 1]) / grid
    first = 4 * np.arange(len(cards))[:, None, None]
    triangles = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return Mesh(
        positions=corners.reshape(-1, 3).astype(np.float32),
        normals=np.repeat(normal, 4, axis=0).astype(np.float32),
        uvs=np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
        triangles=triangles.astype(np.uint32),
    )


def _material(
    name: str, texture: NDArray[np.uint8], scale: float, *, masked: bool = False
) -> Material:
    texture.flags.writeable = False
    return Material(
        name=name,
        base_colour=(1.0, 1.0, 1.0, 1.0),
        roughness=1.0,
        emission=(scale, scale, scale),
        base_colour_texture=texture,
        alpha="mask" if masked else "opaque",
        double_sided=masked,
    )


def _encoded(linear: Pixels) -> NDArray[np.uint8]:
    return np.asarray(_CODES[(np.clip(linear, 0.0, 1.0) * np.float32(4095.0)).astype(np.uint16)])


_CODES = np.round(255.0 * srgb_from_linear((np.arange(4096) + 0.5) / 4096.0)).astype(np.uint8)
"""8-bit codes of linear light in steps of 1 / 4096."""
