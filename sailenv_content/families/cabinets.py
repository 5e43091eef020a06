"""Cabinets on legs that several families share: a carcass, its hollow, and fronts before it.

Values in; their depth, width, height, legs, leg, frame, scheme (sides, fronts, top), inner,
handle and metal are read.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.contents import plates, stores
from sailenv_content.families.fronts import CLEARANCE_M, FrontKind, door, drawer
from sailenv_content.families.hollow import Box
from sailenv_content.families.joinery import carcass, four_legs, shelf
from sailenv_content.families.materials import WOODS, PieceMaterial, metal, paint, wood
from sailenv_content.families.parameters import Choice, Values
from sailenv_ros.types.joints import SoftClose

__all__ = [
    "BOARD_M",
    "CABINET_MATERIALS",
    "SCHEMES",
    "cabinet_body",
    "cabinet_door",
    "cabinet_drawer",
    "divided",
    "outer_doors",
    "stocked",
    "unit",
]

BOARD_M = 0.018

_WHITE, _DARK, _SAGE, _BLUE = (paint(c) for c in ("#e9e6df", "#33373b", "#8c9a86", "#54616b"))
SCHEMES = (
    *((one, one, one) for one in WOODS),
    (_WHITE, _WHITE, _WHITE),
    (_WHITE, _WHITE, wood("oak")),
    (_BLUE, _BLUE, wood("oak")),
    (_SAGE, _SAGE, wood("ash")),
    (_DARK, _DARK, wood("walnut")),
    (wood("walnut"), _WHITE, wood("walnut")),
    (wood("oak"), _SAGE, wood("oak")),
    (wood("black oak"), wood("walnut"), wood("black oak")),
)
"""Materials of sides, fronts and top that go together."""

CABINET_MATERIALS = {
    "scheme": Choice(*SCHEMES),
    "inner": wood("birch"),
    "frame": Choice(*WOODS, metal("#232326")),
    "leg": Choice("tapered", "round", "square"),
    "handle": Choice("bar", "knob", "cup", "edge"),
    "metal": Choice(metal("steel"), metal("brass"), metal("#26272a")),
}


def unit(
    b: PieceBuilder,
    material: PieceMaterial,
    outer: Box,
    *,
    top: PieceMaterial | None = None,
    has_top: bool = True,
    has_back: bool = True,
) -> tuple[Box, Box]:
    """Add a carcass as large as a box; return its hollow and the room of its fronts.

    Without a top its fronts reach up to the box's upper side.
    """
    front = outer.high[0] - 0.022
    lid = BOARD_M if has_top else 0.0
    inside = outer.within((0.006, BOARD_M, BOARD_M), (0.022, BOARD_M, lid))
    carcass(b, material, inside, top=top, has_top=has_top, has_back=has_back)
    x = front + 0.001
    low, high = (x, *outer.low[1:]), (x + 0.019, outer.high[1], outer.high[2] - lid)
    return inside, Box(low, high).inset(CLEARANCE_M)


def cabinet_body(b: PieceBuilder, v: Values) -> tuple[Box, Box]:
    """Add what it stands on and a carcass; return its hollow and the room of its fronts.

    `v.leg` is a kind of leg, ``plinth``, or ``none``.
    """
    half, side = v.depth / 2, v.width / 2
    outer = Box((-half, -side, v.legs), (half, side, v.height))
    inside, fronts = unit(b, v.scheme[0], outer, top=v.scheme[2])
    if v.leg == "plinth":
        size = (v.depth - 0.08, v.width - 0.02, v.legs)
        b.box(v.scheme[0], size, (-0.03, 0.0, v.legs / 2))
    elif v.leg != "none":
        four_legs(b, v.frame, v.leg, v.depth - 0.06, v.width - 0.06, v.legs, 0.04)
    return inside, fronts


def cabinet_drawer(
    b: PieceBuilder,
    v: Values,
    name: str,
    panel: Box,
    inside: Box,
    *,
    front: FrontKind | None = None,
    fill: bool = True,
    soft_close: SoftClose | None = None,
) -> None:
    """Add a drawer of the cabinet's materials; its front is the cabinet's unless told otherwise."""
    drawer(
        b,
        name,
        v.scheme[1],
        front or v.front,
        panel,
        inside.size[0] - 0.03,
        inner=v.inner,
        handle_kind=v.handle,
        metal_=v.metal,
        side_gap=0.03,
        fill=fill,
        soft_close=soft_close,
    )


def cabinet_door(b: PieceBuilder, v: Values, name: str, panel: Box, hinge: str) -> None:
    """Add a door of the cabinet's materials, with its hinge at one side."""
    door(b, name, v.scheme[1], v.front, panel, hinge=hinge, handle_kind=v.handle, metal_=v.metal)


def outer_doors(b: PieceBuilder, v: Values, right: Box, left: Box, *, prefix: str = "") -> None:
    """Add two doors with their hinges at the outer sides."""
    for side, panel in (("right", right), ("left", left)):
        cabinet_door(b, v, f"{prefix}{side} door", panel, side)


def divided(
    b: PieceBuilder,
    material: PieceMaterial,
    inside: Box,
    shares: Iterable[float],
    *,
    setback: float = 0.02,
) -> list[Box]:
    """Divide a hollow by upright boards into columns from the right, by share; return them."""
    rooms = inside.columns(shares, BOARD_M)
    for room, other in pairwise(rooms):
        y = float(room.high[1] + other.low[1]) / 2
        b.box(
            material,
            (inside.size[0] - setback, BOARD_M, inside.size[2]),
            (inside.middle[0] - setback / 2, y, inside.middle[2]),
        )
    return rooms


def stocked(b: PieceBuilder, material: PieceMaterial, room: Box, *, setback: float) -> None:
    """Put a shelf into a room, plates on it and stores below it."""
    z = float(room.middle[2])
    shelf(b, material, room, z, setback=setback)
    plates(b, Box((room.low[0], room.low[1], z), room.high))
    stores(b, Box(room.low, (room.high[0], room.high[1], z - 0.02)))
