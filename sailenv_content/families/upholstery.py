"""Upholstery that sofas and armchairs share: pads, seats between arms, loose cushions."""

from __future__ import annotations

from sailenv_content.families.builder import PieceBuilder
from sailenv_content.families.materials import FABRICS, PieceMaterial
from sailenv_content.families.parameters import Values
from sailenv_content.families.shaping import cushion

__all__ = ["loose_cushions", "pad", "seat", "width_of"]


def pad(
    b: PieceBuilder,
    material: PieceMaterial,
    size: tuple[float, float, float],
    at: tuple[float, float, float],
    *,
    puff: float = 0.02,
    radius: float = 0.045,
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0),
    pinch: float = 0.0,
    collides: bool = True,
) -> None:
    """Add a cushion that collides as its box."""
    mesh = cushion(size, radius=radius, puff=puff, tile_m=material.tile_m, steps=8, pinch=pinch)
    b.form(material, mesh, at, turn=turn, collides="none")
    if collides:
        b.collide(size, at, turn)


def width_of(v: Values) -> float:
    """Return the width of seats and arms [m]."""
    return float(v.seats * v.seat + 2.0 * v.arm)


def seat(b: PieceBuilder, v: Values, width: float, depth: float, base: float) -> None:
    """Add base, back, seat and back cushions between arms."""
    inner = width - 2.0 * v.arm
    top = v.height
    pad(b, v.cover, (depth - 0.02, inner, 0.16), (0.0, 0.0, base + 0.08), puff=0.0, radius=0.02)
    back = 0.17
    x = -depth / 2 + back / 2
    pad(
        b,
        v.cover,
        (back, inner, v.back - base - 0.1),
        (x, 0.0, (v.back + base + 0.1) / 2),
        puff=0.0,
    )
    each = inner / v.seats
    deep = depth - back
    with b.part("seat cushions", "pillow"):
        for number in range(v.seats):
            y = -inner / 2 + (number + 0.5) * each
            at = (back / 2 + 0.015, y, base + 0.16 + (top - base - 0.16) / 2)
            pad(b, v.cover, (deep + 0.02, each - 0.006, top - base - 0.16), at, puff=0.022)
    tall = v.back - top + 0.07
    with b.part("back cushions", "pillow"):
        for number in range(v.seats):
            y = -inner / 2 + (number + 0.5) * each
            at = (x + back / 2 + 0.075, y, top + tall / 2 - 0.01)
            pad(
                b,
                v.cover,
                (0.15, each - 0.012, tall),
                at,
                puff=0.035,
                turn=(0.0, -11.0, 0.0),
                pinch=v.soft,
            )


def loose_cushions(b: PieceBuilder, v: Values, width: float, depth: float) -> None:
    """Throw one or two small cushions into the corners."""
    for sign in (-1.0, 1.0):
        if b.chance(v.loose):
            with b.part("cushion", "pillow"):
                y = sign * (width / 2 - v.arm - 0.23)
                at = (-depth / 2 + 0.41, y, v.height + 0.2)
                pad(
                    b,
                    b.pick(*FABRICS),
                    (0.07, 0.42, 0.42),
                    at,
                    puff=0.055,
                    radius=0.03,
                    pinch=1.0,
                    turn=(0.0, -22.0, sign * -14.0),
                    collides=False,
                )
