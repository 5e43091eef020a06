"""Constructions of several families: legs, carcasses, shelves.

A `PieceBuilder` and measures in [m] in; forms are added to the part that it is at. The front is
at +x.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial
from sailenv_content.families.shaping import swept, turned

__all__ = ["carcass", "four_legs", "leg", "open_box", "shelf"]


BOARD_M = 0.018
BACK_M = 0.006

LegKind = Literal["square", "tapered", "round", "turned", "splayed", "hairpin", "metal", "block"]


def leg(
    b: PieceBuilder,
    material: PieceMaterial,
    kind: LegKind,
    x: float,
    y: float,
    height: float,
    width: float,
    *,
    z: float = 0.0,
    splay: float = 0.0,
) -> None:
    """Add a leg whose top is at (x, y); `splay` is how far its foot stands outwards [m]."""
    out = np.sign([x, y]) * splay
    foot, top = np.array([x + out[0], y + out[1], z]), np.array([x, y, z + height])
    middle = (foot + top) / 2.0
    if kind == "block":
        b.box(material, (width, width, height), middle, bevel=0.003)
    elif kind in ("square", "tapered"):
        taper = 1.0 if kind == "square" else 1.75
        foot_m = width / taper
        b.box(
            material,
            (foot_m, foot_m, height),
            middle,
            bevel=0.003,
            top=(taper, taper),
            lean=(-out[0], -out[1]),
        )
    elif kind == "hairpin":
        for side in (-1.0, 1.0):
            start = top + np.array([0.0, side * 0.055, 0.0])
            b.form(material, swept([start, foot], 0.006, sides=8))
    elif kind == "metal":
        b.form(material, swept([foot, top], width / 2.0, sides=14))
    elif kind == "turned":
        r = width / 2.0
        rows = [
            (0.0, 0.0),
            (0.62, 0.0),
            (0.7, 0.03),
            (0.55, 0.06),
            (0.62, 0.3),
            (0.9, 0.62),
            (0.6, 0.66),
            (0.95, 0.69),
            (0.6, 0.72),
            (1.0, 0.78),
            (1.0, 1.0),
            (0.0, 1.0),
        ]
        profile = [(r * a, z + height * t) for a, t in rows]
        b.form(material, turned(profile, segments=18, tile_m=material.tile_m), (x, y, 0.0))
    else:
        thin = 0.55 if kind == "splayed" else 0.8
        radii = np.array([thin, 1.0]) * width / 2.0
        b.form(material, swept([foot, top], radii, sides=16, tile_m=material.tile_m))


def four_legs(
    b: PieceBuilder,
    material: PieceMaterial,
    kind: LegKind,
    depth: float,
    width: float,
    height: float,
    thick: float,
    *,
    splay: float = 0.0,
    z: float = 0.0,
) -> None:
    """Add legs below the corners of a rectangle, whose outer sides are flush with it."""
    inset = thick / 2.0 + (0.055 if kind == "hairpin" else 0.0)
    for sx in (-1.0, 1.0):
        for sy in (-1.0, 1.0):
            x, y = sx * (depth / 2.0 - inset), sy * (width / 2.0 - inset)
            leg(b, material, kind, x, y, height, thick, z=z, splay=splay)


def carcass(
    b: PieceBuilder,
    material: PieceMaterial,
    inside: Box,
    *,
    board: float = BOARD_M,
    back: PieceMaterial | None = None,
    top: PieceMaterial | None = None,
    overhang: float = 0.0,
    has_back: bool = True,
    has_top: bool = True,
) -> None:
    """Add sides, bottom, top and back around a hollow that is open at its front."""
    size, middle = inside.size, inside.middle
    depth = size[0] + BACK_M
    x = middle[0] - BACK_M / 2.0
    for sign in (-1.0, 1.0):
        at = (x, middle[1] + sign * (size[1] + board) / 2.0, middle[2])
        b.box(material, (depth, board, size[2]), at)
    whole = size[1] + 2.0 * board
    b.box(material, (depth, whole, board), (x, middle[1], inside.low[2] - board / 2.0))
    if has_top:
        lid = (depth + overhang, whole + 2.0 * overhang, board)
        b.box(top or material, lid, (x + overhang / 2.0, middle[1], inside.high[2] + board / 2.0))
    if has_back:
        b.box(
            back or material,
            (BACK_M, size[1], size[2]),
            (inside.low[0] - BACK_M / 2.0, middle[1], middle[2]),
            bevel=0.0005,
        )


def shelf(
    b: PieceBuilder,
    material: PieceMaterial,
    inside: Box,
    z: float,
    *,
    thick: float = 0.018,
    setback: float = 0.02,
) -> None:
    """Add a shelf whose upper side is at a height, in a hollow."""
    size, middle = inside.size, inside.middle
    at = (middle[0] - setback / 2.0, middle[1], z - thick / 2.0)
    b.box(material, (size[0] - setback, size[1] - 0.001, thick), at)


def open_box(
    b: PieceBuilder,
    material: PieceMaterial,
    outer: Box,
    wall: float,
    *,
    liner: PieceMaterial | None = None,
) -> Box:
    """Add a floor and four sides around a hollow that is open at its top; return it."""
    size, middle = outer.size, outer.middle
    bevel = min(0.003, 0.3 * wall)
    b.box(
        material,
        (size[0], size[1], wall),
        (middle[0], middle[1], outer.low[2] + wall / 2),
        bevel=bevel,
    )
    tall, z = size[2] - wall, middle[2] + wall / 2
    for sign in (-1.0, 1.0):
        b.box(
            material,
            (wall, size[1], tall),
            (middle[0] + sign * (size[0] - wall) / 2, middle[1], z),
            bevel=bevel,
        )
        b.box(
            material,
            (size[0] - 2 * wall, wall, tall),
            (middle[0], middle[1] + sign * (size[1] - wall) / 2, z),
            bevel=bevel,
        )
    room = outer.within((wall, wall, wall), (wall, wall, 0.0))
    if liner is not None:
        b.box(
            liner,
            (room.size[0], room.size[1], 0.003),
            (middle[0], middle[1], room.low[2] + 0.0015),
            collides=False,
        )
    return room
