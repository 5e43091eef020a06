"""A street before the front: pavements, a road with kerbs, trees, a row of houses opposite."""

from __future__ import annotations

from sailenv_ros.assets.outside.houses import add_house, drawn_house
from sailenv_ros.assets.outside.painting import Painter, asphalt, lawn, paving, plain
from sailenv_ros.assets.outside.plants import hedge, tree
from sailenv_ros.assets.outside.plot import add_far_ground, add_house_itself, add_plot, new_greens
from sailenv_ros.assets.outside.scenery import GROUND_M, Scenery
from sailenv_ros.assets.outside.site import Site

__all__ = ["HOUSES_M", "build"]

_BED_M = 1.9
_PAVEMENT_M = 2.4
_ROAD_M = 6.0
_KERB_M = 0.12
_LONG_M = 36.0

HOUSES_M = _BED_M + _PAVEMENT_M + _ROAD_M + _PAVEMENT_M + 0.4
"""How far the houses opposite stand from the front [m]."""


def build(scenery: Scenery, site: Site) -> None:
    """Add a street to a scenery."""
    add_far_ground(scenery)
    add_house_itself(scenery, site)
    greens = new_greens(scenery)
    side, back = scenery.between(7.0, 9.0), scenery.between(9.0, 11.0)
    add_plot(scenery, site, greens, front_m=0.0, side_m=side, back_m=back)
    long = (-_LONG_M, _LONG_M)
    front = -site.half_y
    _add_bed(scenery, site, side, greens)
    near = front - _BED_M
    slabs = paving((0.33, 0.32, 0.30), (0.6, 0.4))
    _add_pavement(scenery, (near - _PAVEMENT_M, near), slabs, 24.0, far=False)
    road = near - _PAVEMENT_M
    scenery.level(long, (road - _ROAD_M, road), GROUND_M - _KERB_M, asphalt(_ROAD_M / 2.0), 13.0)
    _add_pavement(scenery, (front - HOUSES_M, road - _ROAD_M), slabs, 13.0, far=True)
    _add_houses(scenery, front - HOUSES_M)
    at = -_LONG_M + scenery.between(6.0, 12.0)
    while at < _LONG_M:
        tree(scenery, (at, road - _ROAD_M - 0.9), scenery.between(5.5, 7.5), greens[0])
        at += scenery.between(8.0, 11.5)
    _add_lamp_posts(scenery, road + 0.5)


def _add_bed(scenery: Scenery, site: Site, side_m: float, greens: list[int]) -> None:
    """Add the strip between house and pavement, with a low hedge along it."""
    x, front = site.half_x, -site.half_y
    ends = (-x - side_m, x + side_m)
    scenery.level(ends, (front - _BED_M, front - 0.45), GROUND_M, lawn(), 30.0)
    low, high = front - _BED_M, front - _BED_M + 0.45
    gate = scenery.between(-0.5, 0.5) * x
    for start, end in ((ends[0], gate - 0.6), (gate + 0.6, ends[1])):
        hedge(scenery, (start, end), (low, high), scenery.between(0.8, 0.95), greens[2])


def _add_pavement(
    scenery: Scenery, y: tuple[float, float], slabs: Painter, density: float, *, far: bool
) -> None:
    """Add a pavement with its kerb, which looks to the road."""
    long = (-_LONG_M, _LONG_M)
    stone = plain((0.40, 0.39, 0.37), 0.1)
    kerb = (y[1] - 0.15, y[1]) if far else (y[0], y[0] + 0.15)
    rest = (y[0], kerb[0]) if far else (kerb[1], y[1])
    scenery.level(long, rest, GROUND_M, slabs, density)
    scenery.level(long, kerb, GROUND_M, stone, density)
    wide = long[1] - long[0]
    if far:
        scenery.add(
            (long[1], y[1], GROUND_M - _KERB_M), (-wide, 0, 0), (0, 0, _KERB_M), stone, density
        )


def _add_houses(scenery: Scenery, front_y: float) -> None:
    """Add a row of houses, some of which adjoin."""
    at = -_LONG_M + scenery.between(0.0, 4.0)
    while at < _LONG_M - 4.0:
        wide = scenery.between(8.0, 11.0)
        storeys = 3 if scenery.dice.random() < 0.35 else 2
        near = abs(at + wide / 2.0) < 14.0
        add_house(
            scenery,
            drawn_house(scenery, (at, at + wide), front_y, looks=1.0, storeys=storeys),
            density=32.0 if near else 18.0,
        )
        at += wide + (0.0 if scenery.dice.random() < 0.5 else scenery.between(2.5, 4.5))


def _add_lamp_posts(scenery: Scenery, y: float) -> None:
    metal = plain((0.12, 0.13, 0.13), 0.1)
    at = -_LONG_M + scenery.between(2.0, 20.0)
    while at < _LONG_M:
        scenery.box(
            (at - 0.06, y - 0.06, GROUND_M), (at + 0.06, y + 0.06, GROUND_M + 5.2), metal, 8
        )
        scenery.box(
            (at - 0.12, y - 0.9, GROUND_M + 5.15), (at + 0.12, y + 0.06, GROUND_M + 5.3), metal, 8
        )
        at += 24.0
