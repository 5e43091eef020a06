"""A garden all around: terrace before the front, lawn, hedges and trees, neighbours behind."""

from __future__ import annotations

from sailenv_ros.assets.outside.painting import paving
from sailenv_ros.assets.outside.plants import hedge, shrub, tree
from sailenv_ros.assets.outside.plot import add_far_ground, add_house_itself, add_plot, new_greens
from sailenv_ros.assets.outside.scenery import GROUND_M, Scenery
from sailenv_ros.assets.outside.site import Site

__all__ = ["build"]

_TERRACE_M = 2.6
_FRONT_M = 11.0


def build(scenery: Scenery, site: Site) -> None:
    """Add a garden to a scenery."""
    add_far_ground(scenery)
    add_house_itself(scenery, site)
    greens = new_greens(scenery)
    side, back = scenery.between(7.0, 9.0), scenery.between(9.0, 11.0)
    add_plot(scenery, site, greens, front_m=_FRONT_M, side_m=side, back_m=back)
    x, y = site.half_x, site.half_y
    slabs = paving((0.42, 0.38, 0.32), (0.5, 0.5))
    terrace = GROUND_M + 0.04
    scenery.level((-x, x), (-y - _TERRACE_M, -y), terrace, slabs, 40.0)
    scenery.add((-x, -y - _TERRACE_M, GROUND_M), (2.0 * x, 0, 0), (0, 0, 0.04), slabs, 20.0)
    end = -y - _FRONT_M
    hedge(scenery, (-x - side, x + side), (end - 0.7, end), 1.7, greens[2])
    for number in range(3):
        at = (-x - 0.4 * side + number * (x + 0.4 * side), end + scenery.between(1.2, 2.5))
        shrub(scenery, at, scenery.between(0.6, 0.9), greens[1])
    tree(scenery, (scenery.between(1.0, 3.0), end + 3.2), scenery.between(4.5, 5.5), greens[0])
    for number in range(6):
        at = (-20.0 + 8.0 * number + scenery.between(-2.0, 2.0), end - scenery.between(3.0, 7.0))
        tree(scenery, at, scenery.between(7.0, 10.0), greens[number % 2])
