"""What several families are made of: legs, carcasses, shelves.

A `Workbench` and measures in [m] in; forms are added where the bench works. The front is at +x.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from sailenv_content.families.contents import folded
from sailenv_content.families.hollow import Box
from sailenv_content.families.shaping import swept, turned
from sailenv_content.families.stuff import Stuff, glass, metal
from sailenv_content.families.workbench import Workbench

__all__ = ["carcass", "four_legs", "leg", "shelf"]


BOARD_M = 0.018
BACK_M = 0.006

LegKind = Literal["square", "tapered", "round", "turned", "splayed", "hairpin", "metal", "block"]


def leg(
    b: Workbench,
    stuff: Stuff,
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
        b.box(stuff, (width, width, height), middle, bevel=0.003)
    elif kind in ("square", "tapered"):
        taper = 1.0 if kind == "square" else 1.75
        foot_m = width / taper
        b.box(
            stuff,
            (foot_m, foot_m, height),
            middle,
            bevel=0.003,
            top=(taper, taper),
            lean=(-out[0], -out[1]),
        )
    elif kind == "hairpin":
        for side in (-1.0, 1.0):
            start = top + np.array([0.0, side * 0.055, 0.0])
            b.form(stuff, swept([start, foot], 0.006, sides=8))
    elif kind == "metal":
        b.form(stuff, swept([foot, top], width / 2.0, sides=14))
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
        b.form(stuff, turned(profile, segments=18, tile_m=stuff.tile_m), (x, y, 0.0))
    else:
        thin = 0.55 if kind == "splayed" else 0.8
        radii = np.array([thin, 1.0]) * width / 2.0
        b.form(stuff, swept([foot, top], radii, sides=16, tile_m=stuff.tile_m))


def four_legs(
    b: Workbench,
    stuff: Stuff,
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
            leg(b, stuff, kind, x, y, height, thick, z=z, splay=splay)


def carcass(
    b: Workbench,
    stuff: Stuff,
    inside: Box,
    *,
    board: float = BOARD_M,
    back: Stuff | None = None,
    top: Stuff | None = None,
    overhang: float = 0.0,
    has_back: bool = True,
) -> None:
    """Add sides, bottom, top and back around a hollow that is open at its front."""
    size, middle = inside.size, inside.middle
    depth = size[0] + BACK_M
    x = middle[0] - BACK_M / 2.0
    for sign in (-1.0, 1.0):
        at = (x, middle[1] + sign * (size[1] + board) / 2.0, middle[2])
        b.box(stuff, (depth, board, size[2]), at)
    whole = size[1] + 2.0 * board
    b.box(stuff, (depth, whole, board), (x, middle[1], inside.low[2] - board / 2.0))
    lid = (depth + overhang, whole + 2.0 * overhang, board)
    b.box(top or stuff, lid, (x + overhang / 2.0, middle[1], inside.high[2] + board / 2.0))
    if has_back:
        b.box(
            back or stuff,
            (BACK_M, size[1], size[2]),
            (inside.low[0] - BACK_M / 2.0, middle[1], middle[2]),
            bevel=0.0005,
        )


def shelf(
    b: Workbench,
    stuff: Stuff,
    inside: Box,
    z: float,
    *,
    thick: float = 0.018,
    setback: float = 0.02,
) -> None:
    """Add a shelf whose upper side is at a height, in a hollow."""
    size, middle = inside.size, inside.middle
    at = (middle[0] - setback / 2.0, middle[1], z - thick / 2.0)
    b.box(stuff, (size[0] - setback, size[1] - 0.001, thick), at)


def handle(
    b: Workbench,
    stuff: Stuff,
    kind: str,
    x: float,
    y: float,
    z: float,
    *,
    length: float = 0.13,
    upright: bool = False,
) -> None:
    """Add a handle to a front whose face is at x: bar, knob, cup, edge or none."""
    if kind == "none":
        return
    turn = (90.0, 0.0, 0.0) if upright else (0.0, 0.0, 0.0)
    with b.part("handle", "handle"):
        if kind == "bar":
            out, half = 0.032, length / 2.0
            ends = np.array([[x, -half, 0], [x + out, -half, 0], [x + out, half, 0], [x, half, 0]])
            if upright:
                ends = ends[:, [0, 2, 1]]
            path = ends + np.array([0.0, y, z])
            for first, last in ((0, 1), (2, 3)):
                b.form(stuff, swept(path[[first, last]], 0.005, sides=10), collides="none")
            reach = path[[1, 2]] + (path[2] - path[1]) / length * np.array([[-0.012], [0.012]])
            b.form(stuff, swept(reach, 0.006, sides=12))
        elif kind == "knob":
            profile = [
                (0.0, 0.0),
                (0.007, 0.0),
                (0.006, 0.014),
                (0.014, 0.02),
                (0.016, 0.026),
                (0.012, 0.032),
                (0.0, 0.034),
            ]
            b.form(stuff, turned(profile, segments=18), (x, y, z), turn=(0.0, 90.0, 0.0))
        elif kind == "cup":
            turns = np.linspace(0.0, np.pi / 2.0, 6)
            rows = [(0.026 * np.cos(t), 0.026 * np.sin(t)) for t in turns]
            mesh = turned([(0.0, 0.0), *rows], segments=18)
            b.form(stuff, mesh, (x, y, z), turn=(0.0, 90.0, 0.0))
        else:  # a strip along the upper edge
            b.box(stuff, (0.016, length, 0.004), (x + 0.008, y, z), turn=turn, bevel=0.001)


def front_panel(
    b: Workbench, stuff: Stuff, kind: FrontKind, panel: Box, *, pane: Stuff | None = None
) -> None:
    """Add the leaf of a door or the front of a drawer, as thick as the box is deep."""
    size, middle = panel.size, panel.middle
    if kind == "flat" or min(size[1:]) < 0.16:
        b.box(stuff, size, middle)
        return
    if kind == "grooved":
        count = max(2, round(size[1] / 0.085))
        for column in panel.columns([1.0] * count, 0.003):
            b.box(stuff, column.size, column.middle, bevel=0.003, collides=False)
        b.box(
            stuff,
            (size[0] * 0.6, size[1] - 0.002, size[2] - 0.002),
            (middle[0] - 0.2 * size[0], middle[1], middle[2]),
            collides=False,
        )
        b.collide(size, middle)
        return
    rim = min(0.07, 0.28 * min(size[1:]))
    for sign in (-1.0, 1.0):
        at = (middle[0], middle[1] + sign * (size[1] - rim) / 2.0, middle[2])
        b.box(stuff, (size[0], rim, size[2]), at, collides=False)
        at = (middle[0], middle[1], middle[2] + sign * (size[2] - rim) / 2.0)
        b.box(stuff, (size[0], size[1] - 2.0 * rim, rim), at, collides=False)
    field = panel.inset(rim)
    if kind == "louvre":
        for row in field.rows([1.0] * max(3, round(field.size[2] / 0.045)), 0.004):
            b.box(
                stuff,
                (0.008, field.size[1], row.size[2]),
                row.middle,
                turn=(0.0, -28.0, 0.0),
                bevel=0.001,
                collides=False,
            )
    else:
        thin = 0.004 if kind == "glass" else 0.009
        inner = (pane or glass()) if kind == "glass" else stuff
        b.box(
            inner, (thin, field.size[1], field.size[2]), field.middle, bevel=0.0005, collides=False
        )
    b.collide(size, middle)


def door(
    b: Workbench,
    name: str,
    stuff: Stuff,
    kind: FrontKind,
    panel: Box,
    *,
    hinge: str,
    handle_kind: str = "bar",
    metal_: Stuff | None = None,
    opens_deg: float = 110.0,
    handle_z: float | None = None,
) -> None:
    """Add a hinged door: a front panel, its hinge at its left or right (as it looks), a handle."""
    left = hinge == "left"
    y = panel.high[1] if left else panel.low[1]
    at = (panel.high[0], y, panel.middle[2])
    with b.hinge(
        name, "door", at=at, axis=(0.0, 0.0, -1.0 if not left else 1.0), opens_deg=opens_deg
    ):
        front_panel(b, stuff, kind, panel)
        inset = min(0.045, 0.2 * panel.size[1])
        grip = panel.low[1] + inset if left else panel.high[1] - inset
        z = panel.middle[2] if handle_z is None else handle_z
        length = min(0.14, 0.5 * panel.size[2])
        handle(
            b,
            metal_ or metal("steel"),
            handle_kind,
            panel.high[0],
            grip,
            z,
            upright=True,
            length=length,
        )


def drawer(
    b: Workbench,
    name: str,
    stuff: Stuff,
    kind: FrontKind,
    panel: Box,
    depth: float,
    *,
    inner: Stuff,
    handle_kind: str = "bar",
    metal_: Stuff | None = None,
    side_gap: float = 0.014,
    fill: bool = True,
) -> None:
    """Add a drawer: a front, a box behind it, a handle, and what lies in it.

    Parameters
    ----------
    panel : Box
        The front.
    depth : float
        Of the box behind it [m].
    """
    size, middle = panel.size, panel.middle
    with b.slide(name, "drawer", by=0.75 * depth):
        front_panel(b, stuff, kind, panel)
        width, height = size[1] - 2.0 * side_gap, max(0.03, size[2] - 0.045)
        low = panel.low[2] + 0.018
        back, thick = panel.low[0] - depth, 0.010
        x = (panel.low[0] + back) / 2.0
        b.box(inner, (depth, width, 0.006), (x, middle[1], low + 0.003), bevel=0.0005)
        for sign in (-1.0, 1.0):
            at = (x, middle[1] + sign * (width - thick) / 2.0, low + height / 2.0)
            b.box(inner, (depth, thick, height), at, bevel=0.001)
        at = (back + thick / 2.0, middle[1], low + height / 2.0)
        b.box(inner, (thick, width - 2.0 * thick, height), at, bevel=0.001)
        if handle_kind == "edge":
            length, z = 0.5 * size[1], panel.high[2] - 0.001
        else:
            length, z = min(0.16, 0.5 * size[1]), middle[2]
        grips = (-0.28, 0.28) if size[1] > 0.75 and handle_kind != "edge" else (0.0,)
        for place in grips:
            handle(
                b,
                metal_ or metal("steel"),
                handle_kind,
                panel.high[0],
                middle[1] + place * size[1],
                z,
                length=length,
            )
        if fill:
            folded(
                b,
                Box(
                    (back + thick, middle[1] - width / 2.0 + thick, low + 0.007),
                    (panel.low[0], middle[1] + width / 2.0 - thick, low + height),
                ),
            )
