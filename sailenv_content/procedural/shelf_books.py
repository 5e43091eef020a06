"""Books that stand, lean and lie on the shelves of a bookcase of the catalogues."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sailenv_content.procedural.forms import merged, moved
from sailenv_content.procedural.prints import Sheet
from sailenv_content.procedural.shapes import Vector3, box, printed_part
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.types.model import Texture

__all__ = ["shelf_books"]

GAP_M = 0.001
"""Between neighbours."""

BOARD_M = 0.0022
PAGES_ROW = 24
"""Row of the sheet that has the colour of paper; those above have a spine each."""

CLOTHS: Sequence[Vector3] = (
    *((0.45, 0.12, 0.11), (0.12, 0.20, 0.34), (0.16, 0.29, 0.22), (0.78, 0.72, 0.60)),
    *((0.70, 0.49, 0.20), (0.22, 0.20, 0.21), (0.36, 0.45, 0.52), (0.83, 0.80, 0.76)),
    *((0.52, 0.27, 0.16), (0.30, 0.16, 0.26), (0.60, 0.20, 0.15), (0.20, 0.38, 0.42)),
)
TITLES = (
    *("THE QUIET HARBOUR", "A SHORT HISTORY", "GARDENS", "LETTERS HOME", "NORTH LIGHT", "OPTICS"),
    *("THE LONG HARVEST", "ATLAS", "RIVERS", "FIVE VOICES", "THE GLASS HILL", "MECHANICS"),
    *("COLLECTED POEMS", "WINTER", "ON WALKING", "THE MAPMAKER", "BIRDS", "ALGEBRA"),
    *("A HOUSE BY THE SEA", "COOKERY", "NIGHT TRAINS", "THE ORCHARD", "BRIDGES", "SALT"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Bay:
    """Space on a shelf [m]: from `right` to `left` along y, `floor` to `ceiling`, filled so far."""

    right: float
    left: float
    floor: float
    ceiling: float
    filled: float


BAYS = (
    _Bay(right=-0.785, left=-0.32, floor=1.483, ceiling=1.80, filled=0.92),
    _Bay(right=-0.27, left=0.775, floor=1.483, ceiling=1.80, filled=0.42),
    _Bay(right=-0.785, left=0.228, floor=1.118, ceiling=1.43, filled=0.75),
    _Bay(right=0.28, left=0.775, floor=1.118, ceiling=1.43, filled=0.25),
    _Bay(right=-0.785, left=-0.32, floor=0.761, ceiling=1.07, filled=0.30),
    _Bay(right=-0.27, left=0.775, floor=0.761, ceiling=1.07, filled=0.86),
)
"""Shelves of ``BlendSwap-CC-BY/bookcase``, as wide, deep and high as the catalogue has it."""

FRONT_M = 0.120
"""Place of the spines along x [m]; the shelves reach from -0.13 to 0.165."""


def shelf_books() -> list[RawPart]:
    """Return the books of that bookcase, in its own axes, its front towards x."""
    random = np.random.default_rng(4)
    print_ = _spines()
    return [
        printed_part("book print", mesh, print_, roughness=0.6)
        for bay in BAYS
        for mesh in _books(bay, random)
    ]


def _books(bay: _Bay, random: np.random.Generator) -> Iterator[RawMesh]:
    """Yield the books of a bay: a row from its right, one that leans on it, a pile farther on."""
    tallest = bay.ceiling - bay.floor - 0.03
    y, end = bay.right, bay.right + bay.filled * (bay.left - bay.right)
    last = 0.0
    while True:
        size = _size(random, tallest)
        if y + size[1] > end:
            break
        yield _placed(_book(size, random), y, bay.floor, random)
        y, last = y + size[1] + GAP_M, size[2]
    depth, thick, height = _size(random, tallest)
    angle = np.radians(random.uniform(9.0, 16.0))
    height = min(height, 0.95 * last)
    reach = height * np.sin(angle) + thick * np.cos(angle)
    if last and y + reach < bay.left - GAP_M:
        leaning = moved(
            _book((depth, thick, height), random), turn_deg=(float(np.degrees(angle)), 0.0, 0.0)
        )
        yield _placed(leaning, y, bay.floor, random)
        y += reach + GAP_M
    if bay.left - y > 0.42:
        yield from _pile(float(random.uniform(y + 0.20, bay.left - 0.16)), bay.floor, random)


def _pile(y: float, floor: float, random: np.random.Generator) -> Iterator[RawMesh]:
    """Yield books that lie upon one another, their spines to the front."""
    for _ in range(int(random.integers(2, 5))):
        depth, thick, height = _size(random, 0.25)
        lying = moved(_book((depth, thick, height), random), turn_deg=(90.0, 0.0, 0.0))
        lying = moved(lying, turn_deg=(0.0, 0.0, float(random.normal(0.0, 3.0))))
        low, high = lying.positions.min(axis=0), lying.positions.max(axis=0)
        middle = (low + high) / 2.0
        yield moved(lying, (FRONT_M - 0.02 - high[0], y - middle[1], floor - low[2]))
        floor += thick + GAP_M


def _size(random: np.random.Generator, tallest: float) -> Vector3:
    """Return depth, thickness and height of a book [m]."""
    height = float(np.clip(random.normal(0.215, 0.028), 0.165, tallest))
    depth = float(np.clip(height * random.uniform(0.64, 0.76), 0.11, 0.20))
    return depth, float(np.clip(random.gamma(6.0, 0.0047), 0.012, 0.055)), height


def _placed(mesh: RawMesh, y: float, z: float, random: np.random.Generator) -> RawMesh:
    """Return a book whose lower right corner is somewhere, its spine nearly in the row."""
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    front = FRONT_M + float(random.uniform(-0.012, 0.006))
    return moved(mesh, (front - high[0], y - low[1], z - low[2]))


def _book(size: Vector3, random: np.random.Generator) -> RawMesh:
    """Return an upright book, its spine to the front, with places in the sheet of spines."""
    depth, thick, height = size
    row = int(random.integers(0, PAGES_ROW))
    boards = [
        box((depth, BOARD_M, height), (-depth / 2.0, side * (thick - BOARD_M) / 2.0, height / 2.0))
        for side in (1.0, -1.0)
    ]
    inner = thick - 2.0 * BOARD_M
    spine = box((BOARD_M, inner, height), (-BOARD_M / 2.0, 0.0, height / 2.0))
    pages = box(
        (depth - BOARD_M - 0.003, inner, height - 0.006),
        (-(depth + BOARD_M - 0.003) / 2.0, 0.0, height / 2.0),
    )
    return merged(
        [
            *(_coloured(board, row, thick, height) for board in boards),
            _coloured(spine, row, thick, height),
            _coloured(pages, PAGES_ROW, thick, height),
        ]
    )


def _coloured(mesh: RawMesh, row: int, thick: float, height: float) -> RawMesh:
    """Return a mesh with a row of the sheet on what faces x, and its plain end elsewhere."""
    up = mesh.positions[:, 2] / height
    across = mesh.positions[:, 1] / thick + 0.5
    front = np.zeros(len(up), bool) if mesh.normals is None else mesh.normals[:, 0] > 0.9
    u = np.where(front & (row < PAGES_ROW), 0.99 - 0.95 * up, 0.015)
    v = np.where(front, 0.06 + 0.88 * across, 0.5)
    uvs = np.stack([u, 1.0 - (row + 1.0 - v) / (PAGES_ROW + 1.0)], axis=-1)
    return dataclasses.replace(mesh, uvs=uvs)


def _spines() -> Texture:
    """Return the sheet: a row for each spine, its head to the right, and one for paper."""
    random = np.random.default_rng(9)
    rows = PAGES_ROW + 1
    sheet = Sheet(512, 24 * rows, (0.90, 0.86, 0.77))
    for row, title in enumerate(TITLES):
        cloth = CLOTHS[(5 * row + row // len(CLOTHS)) % len(CLOTHS)]
        top, step = row / rows, 1.0 / rows
        sheet.box(0.0, top, 1.0, top + step, cloth)
        pale = sum(cloth) > 1.5
        ink: Vector3 = (0.20, 0.16, 0.14) if pale else (0.90, 0.82, 0.58)
        if random.random() < 0.6:
            for x in (0.09, 0.91):
                sheet.box(x - 0.006, top, x + 0.006, top + step, ink)
        middle = top + step / 2.0
        sheet.text(title, 0.58, middle, 0.34 * step, ink)
        sheet.text("* * *" if row % 3 else "A. M.", 0.2, middle, 0.22 * step, ink)
    return sheet.texture()
