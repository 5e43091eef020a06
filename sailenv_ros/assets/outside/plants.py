"""Trees, shrubs and hedges outside: trunks, and cards that show sprays of leaves."""

from __future__ import annotations

import math

from sailenv_ros.assets.outside.painting import foliage, plain
from sailenv_ros.assets.outside.scenery import GROUND_M, Card, Scenery

__all__ = ["GREENS", "hedge", "shrub", "tree"]

Vector3 = tuple[float, float, float]

GREENS = ((0.075, 0.125, 0.03), (0.105, 0.14, 0.035), (0.06, 0.11, 0.04), (0.15, 0.15, 0.04))
"""Linear colours of leaves."""

_SIDES = 6


def tree(scenery: Scenery, at: tuple[float, float], height_m: float, leaves: int) -> None:
    """Add a tree of that height whose crown has half of it in width.

    Parameters
    ----------
    scenery : Scenery
    at : (2,) tuple of float
        Foot [m].
    height_m : float
    leaves : int
        Number of the colour of its leaves.
    """
    x, y = at
    foot = GROUND_M
    bare = height_m * scenery.between(0.24, 0.34)
    thick = 0.022 * height_m
    _trunk(scenery, (x, y, foot), bare + 0.3 * height_m, thick)
    middle = foot + bare + (height_m - bare) / 2.0
    half = ((0.24 + 0.06 * scenery.dice.random()) * height_m, (height_m - bare) / 2.0)
    scenery.occluders.add_crown((x, y, middle), 0.8 * half[1])
    # A crown is a few lumps, each of which has its own sprays.
    for number in range(7):
        turn = 2.4 * number + scenery.between(-0.4, 0.4)
        rise = -0.6 + 1.25 * (number / 6.0)
        reach = 0.55 * math.sqrt(max(0.05, 1.0 - rise * rise)) * half[0]
        lump = (
            x + reach * math.cos(turn),
            y + reach * math.sin(turn),
            middle + rise * 0.75 * half[1],
        )
        radius = 0.55 * half[0] * scenery.between(0.85, 1.2)
        scenery.occluders.add_ball(lump, 0.9 * radius)
        _sprays(scenery, lump, radius, (x, y, middle), leaves, 13)


def shrub(scenery: Scenery, at: tuple[float, float], radius_m: float, leaves: int) -> None:
    """Add a bush that stands on the ground."""
    x, y = at
    centre = (x, y, GROUND_M + 0.75 * radius_m)
    scenery.occluders.add_ball(centre, 0.8 * radius_m)
    scenery.occluders.add_crown(centre, 0.8 * radius_m)
    _sprays(scenery, centre, radius_m, (x, y, GROUND_M), leaves, 16)


def hedge(
    scenery: Scenery, x: tuple[float, float], y: tuple[float, float], height_m: float, leaves: int
) -> None:
    """Add a clipped hedge over a rectangle of ground, twigs on its top."""
    red, green, blue = scenery.leaf_colours[leaves]
    paint = foliage((0.8 * red, 0.8 * green, 0.8 * blue))
    top = GROUND_M + height_m
    scenery.box((x[0], y[0], GROUND_M), (x[1], y[1], top), paint, 30.0, casts=True)
    along_x = x[1] - x[0] >= y[1] - y[0]
    length = max(x[1] - x[0], y[1] - y[0])
    half = 0.3
    for number in range(max(1, round(length / (1.3 * half)))):
        along = (number + scenery.between(0.2, 0.8)) * 1.3 * half
        if along > length:
            break
        centre = (
            x[0] + along if along_x else (x[0] + x[1]) / 2.0,
            (y[0] + y[1]) / 2.0 if along_x else y[0] + along,
            top + scenery.between(-0.12, 0.0),
        )
        right = (half, 0.0, 0.0) if along_x else (0.0, half, 0.0)
        scenery.cards.append(Card(centre, right, (0.0, 0.0, half), (0.0, 0.0, 1.0), leaves))


def _trunk(scenery: Scenery, foot: Vector3, height_m: float, radius_m: float) -> None:
    x, y, z = foot
    bark = plain((0.11, 0.085, 0.065), 0.25)
    lean = scenery.between(-0.03, 0.03) * height_m, scenery.between(-0.03, 0.03) * height_m
    wide = 2.0 * radius_m * math.tan(math.pi / _SIDES)
    inset = 0.28
    for side in range(_SIDES):
        turn = 2.0 * math.pi * side / _SIDES
        ox, oy = math.cos(turn), math.sin(turn)
        # Narrower above: corners of a trapezium in shares of its sides.
        top = ((1.0 - inset, 1.0), (inset, 1.0))
        origin = (
            x + radius_m * ox + 0.5 * wide * oy,
            y + radius_m * oy - 0.5 * wide * ox,
            z,
        )
        drawn_in = inset * radius_m * 2.0
        scenery.add(
            origin,
            (-wide * oy, wide * ox, 0.0),
            (lean[0] - drawn_in * ox, lean[1] - drawn_in * oy, height_m),
            bark,
            12.0,
            outline=((0.0, 0.0), (1.0, 0.0), *top),
        )


def _sprays(
    scenery: Scenery,
    centre: Vector3,
    radius_m: float,
    heart: Vector3,
    leaves: int,
    count: int,
) -> None:
    """Add cards around a lump of leaves, shaded as if they lay on a crown around its heart."""
    for number in range(count):
        # Directions that are spread evenly, a little off.
        rise = 1.0 - 2.0 * (number + 0.5) / count
        turn = number * math.pi * (3.0 - math.sqrt(5.0)) + scenery.between(-0.3, 0.3)
        flat = math.sqrt(1.0 - rise * rise)
        out = (flat * math.cos(turn), flat * math.sin(turn), rise)
        x, y, z = (c + 0.55 * radius_m * o for c, o in zip(centre, out, strict=True))
        # One looks at it from the middle of all: what lies behind the lump is not seen.
        if out[0] * centre[0] + out[1] * centre[1] > 0.25 * math.hypot(*centre[:2]):
            continue
        away = (x - heart[0], y - heart[1], z - heart[2])
        length = math.hypot(*away) or 1.0
        shading = (away[0] / length, away[1] / length, away[2] / length)
        half = 0.62 * radius_m * scenery.between(0.8, 1.15)
        yaw, tip = scenery.between(0.0, math.pi), scenery.between(-0.5, 0.5)
        right = (half * math.cos(yaw), half * math.sin(yaw), 0.0)
        up = (
            -half * math.sin(tip) * math.sin(yaw),
            half * math.sin(tip) * math.cos(yaw),
            half * math.cos(tip),
        )
        scenery.cards.append(Card((x, y, z), right, up, shading, leaves))
