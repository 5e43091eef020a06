"""The structures of src/kernels/lens_table.h as NumPy types: lenses that bend straight lines.

Fields that end in `_at` hold addresses of arrays. The process that fills them in keeps these alive.
"""

from __future__ import annotations

from math import prod

from sailenv_ros.native.render_types import ADDRESS, structure

__all__ = [
    "BLOCK_CELLS",
    "CUBE_FACE",
    "CUBE_FACES",
    "FACE_CELLS",
    "FACE_NODE",
    "LENS_GROUP_SHAPE",
    "LENS_TABLE",
    "LENS_TILES",
    "LENS_TILE_SHAPE",
    "UNKNOWN_BEND",
]

CUBE_FACES = 6
FACE_CELLS, BLOCK_CELLS = 128, 8
LENS_TILE_SHAPE = 8, 8
"""Rows and columns of a tile."""

LENS_GROUP_SHAPE = 4, 2
"""Rows and columns of the tiles that are looked at together."""

UNKNOWN_BEND = 1e30

FACE_NODE = structure(("u v bend wide_bend", "<f4"))

CUBE_FACE = structure(
    ("turn", "<f8", 9),
    ("low high", "<f8", 2),
    ("origin per", "<f4", 2),
    ("nodes_at cells_at blocks_at", ADDRESS),
    ("all", "<i2", 4),
)

LENS_TILES = structure(
    ("low_x low_y high_x high_y", "<f4", prod(LENS_GROUP_SHAPE)),
    ("faces", "<i4", prod(LENS_GROUP_SHAPE)),
)

LENS_TABLE = structure(
    ("x_at y_at face_at steps_at tiles_at faces_at", ADDRESS),
    ("stride tile_groups rows columns step_stride step_rows several fine", "<i8"),
)
