"""Fronts that open: doors on hinges, drawers on slides, their handles.

A `PieceBuilder` and measures in [m] in; forms are added to the part that it is at. The front is
at +x.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import folded
from sailenv_content.families.hardware import MAGNET
from sailenv_content.families.hollow import Box
from sailenv_content.families.materials import PieceMaterial, glass, metal
from sailenv_content.families.shaping import swept, turned
from sailenv_ros.types.joints import Detents, SoftClose

__all__ = [
    "CLEARANCE_M",
    "FrontKind",
    "door",
    "drawer",
    "flap",
    "front_panel",
    "handle",
    "sliding_doors",
]

CLEARANCE_M = 0.003
"""Gap around what opens [m]."""


FrontKind = Literal["flat", "shaker", "grooved", "glass", "louvre"]


def handle(
    b: PieceBuilder,
    material: PieceMaterial,
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
                b.form(material, swept(path[[first, last]], 0.005, sides=10), collides="none")
            reach = path[[1, 2]] + (path[2] - path[1]) / length * np.array([[-0.012], [0.012]])
            b.form(material, swept(reach, 0.006, sides=12))
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
            b.form(material, turned(profile, segments=18), (x, y, z), turn=(0.0, 90.0, 0.0))
        elif kind == "cup":
            turns = np.linspace(0.0, np.pi / 2.0, 6)
            rows = [(0.026 * np.cos(t), 0.026 * np.sin(t)) for t in turns]
            mesh = turned([(0.0, 0.0), *rows], segments=18)
            b.form(material, mesh, (x, y, z), turn=(0.0, 90.0, 0.0))
        else:  # a strip along the upper edge
            b.box(material, (0.016, length, 0.004), (x + 0.008, y, z), turn=turn, bevel=0.001)


def front_panel(
    b: PieceBuilder,
    material: PieceMaterial,
    kind: FrontKind,
    panel: Box,
    *,
    pane: PieceMaterial | None = None,
) -> None:
    """Add the leaf of a door or the front of a drawer, as thick as the box is deep."""
    size, middle = panel.size, panel.middle
    if kind == "flat" or min(size[1:]) < 0.16:
        b.box(material, size, middle)
        return
    if kind == "grooved":
        count = max(2, round(size[1] / 0.085))
        for column in panel.columns([1.0] * count, 0.003):
            b.box(material, column.size, column.middle, bevel=0.003, collides=False)
        b.box(
            material,
            (size[0] * 0.6, size[1] - 0.002, size[2] - 0.002),
            # Its back lies behind those of the boards, not in their plane.
            (middle[0] - 0.2 * size[0] - 0.0005, middle[1], middle[2]),
            collides=False,
        )
        b.collide(size, middle)
        return
    rim = min(0.07, 0.28 * min(size[1:]))
    for sign in (-1.0, 1.0):
        at = (middle[0], middle[1] + sign * (size[1] - rim) / 2.0, middle[2])
        b.box(material, (size[0], rim, size[2]), at, collides=False)
        at = (middle[0], middle[1], middle[2] + sign * (size[2] - rim) / 2.0)
        b.box(material, (size[0], size[1] - 2.0 * rim, rim), at, collides=False)
    field = panel.inset(rim)
    if kind == "louvre":
        for row in field.rows([1.0] * max(3, round(field.size[2] / 0.045)), 0.004):
            b.box(
                material,
                (0.008, field.size[1], row.size[2]),
                row.middle,
                turn=(0.0, -28.0, 0.0),
                bevel=0.001,
                collides=False,
            )
    else:
        thin = 0.004 if kind == "glass" else 0.009
        inner = (pane or glass()) if kind == "glass" else material
        b.box(
            inner, (thin, field.size[1], field.size[2]), field.middle, bevel=0.0005, collides=False
        )
    b.collide(size, middle)


def door(
    b: PieceBuilder,
    name: str,
    material: PieceMaterial,
    kind: FrontKind,
    panel: Box,
    *,
    hinge: str,
    handle_kind: str = "bar",
    metal_: PieceMaterial | None = None,
    opens_deg: float = 110.0,
    handle_z: float | None = None,
    pane: PieceMaterial | None = None,
    soft_close: SoftClose | None = None,
) -> None:
    """Add a hinged door: a front panel, its hinge at its left or right (as it looks), a handle.

    A magnet keeps it shut, unless it has a soft close.
    """
    left = hinge == "left"
    y = panel.high[1] if left else panel.low[1]
    at = (panel.high[0], y, panel.middle[2])
    with b.hinge(
        name,
        "door",
        at=at,
        axis=(0.0, 0.0, -1.0 if not left else 1.0),
        opens_deg=opens_deg,
        soft_close=soft_close,
        detents=MAGNET if soft_close is None else None,
    ):
        front_panel(b, material, kind, panel, pane=pane)
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


def flap(
    b: PieceBuilder,
    name: str,
    material: PieceMaterial,
    kind: FrontKind,
    panel: Box,
    *,
    category: str = "door",
    hinge: Literal["bottom", "top"] = "bottom",
    handle_kind: str = "bar",
    metal_: PieceMaterial | None = None,
    opens_deg: float = 88.0,
    length: float = 0.0,
    pane: PieceMaterial | None = None,
    extra: tuple[PieceMaterial, Box] | None = None,
    shut: Detents = MAGNET,
) -> None:
    """Add a front that folds down or up, with a handle near its free edge, `length` [m] long.

    `extra` is a board that goes with it, `shut` what keeps it shut.
    """
    down = hinge == "bottom"
    at = (panel.high[0], panel.middle[1], panel.low[2] if down else panel.high[2])
    axis = (0.0, 1.0 if down else -1.0, 0.0)
    with b.hinge(name, category, at=at, axis=axis, opens_deg=opens_deg, detents=shut):
        front_panel(b, material, kind, panel, pane=pane)
        if extra is not None:
            b.box(extra[0], extra[1].size, extra[1].middle)
        edge = min(0.05, 0.2 * panel.size[2])
        z = panel.high[2] - edge if down else panel.low[2] + edge
        handle(
            b,
            metal_ or metal("steel"),
            handle_kind,
            panel.high[0],
            panel.middle[1],
            z,
            length=length or min(0.16, 0.5 * panel.size[1]),
        )


def sliding_doors(
    b: PieceBuilder,
    opening: Box,
    material: PieceMaterial,
    kind: FrontKind,
    metal_: PieceMaterial,
    *,
    grip_z: float,
    grip_m: float = 0.22,
    pane: PieceMaterial | None = None,
) -> None:
    """Add two doors that slide past each other before an opening, the right one in front."""
    middle = float(opening.middle[1])
    for sign, name, x in ((1.0, "left door", 0.0), (-1.0, "right door", 0.026)):
        low = (opening.low[0] + x, middle if sign > 0 else opening.low[1], opening.low[2])
        high = (low[0] + 0.022, opening.high[1] if sign > 0 else middle + 0.02, opening.high[2])
        panel = Box(low, high)
        by = float(opening.size[1]) / 2.0 - 0.05
        with b.slide(name, "door", by=by, axis=(0.0, -sign, 0.0), friction=6.0):
            front_panel(b, material, kind, panel, pane=pane)
            edge = panel.low[1] + 0.03 if sign < 0 else panel.high[1] - 0.03
            grip = (0.002, 0.02, grip_m)
            b.box(metal_, grip, (panel.high[0], edge, grip_z), collides=False)


def drawer(
    b: PieceBuilder,
    name: str,
    material: PieceMaterial,
    kind: FrontKind,
    panel: Box,
    depth: float,
    *,
    inner: PieceMaterial,
    handle_kind: str = "bar",
    metal_: PieceMaterial | None = None,
    side_gap: float = 0.014,
    fill: bool = True,
    soft_close: SoftClose | None = None,
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
    with b.slide(name, "drawer", by=0.75 * depth, soft_close=soft_close):
        front_panel(b, material, kind, panel)
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
