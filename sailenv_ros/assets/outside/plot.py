"""A plot of land around a house: lawn, a strip of gravel, hedges or a fence, trees, neighbours."""

from __future__ import annotations

from sailenv_ros.assets.outside.houses import add_house, drawn_house
from sailenv_ros.assets.outside.painting import boards, lawn, paving, plain
from sailenv_ros.assets.outside.plants import GREENS, hedge, shrub, tree
from sailenv_ros.assets.outside.scenery import GROUND_M, Scenery
from sailenv_ros.assets.outside.site import Site

__all__ = ["add_far_ground", "add_house_itself", "add_plot", "new_greens"]

_FAR_M = 70.0
_BELOW_M = 0.25
_GRAVEL_M = 0.45


def new_greens(scenery: Scenery) -> list[int]:
    """Return the numbers of three colours of leaves, of which the last one is the hedges'."""
    dice = scenery.dice
    return [scenery.new_foliage(dice.choice(GREENS)) for _ in range(2)] + [
        scenery.new_foliage((0.06, 0.105, 0.03))
    ]


def add_far_ground(scenery: Scenery) -> None:
    """Add what lies below all, as far as one sees."""
    ground = plain((0.15, 0.15, 0.11), 0.2)
    far, z = (-_FAR_M, _FAR_M), GROUND_M - _BELOW_M
    scenery.level(far, far, z, ground, 1.5)


def add_house_itself(scenery: Scenery, site: Site) -> None:
    """Let the house that the room lies in keep light from its own garden."""
    x, y = site.half_x, site.half_y
    scenery.occluders.add_box((-x, -y, GROUND_M), (x, y, site.height_m + 0.6))


def add_plot(
    scenery: Scenery, site: Site, greens: list[int], *, front_m: float, side_m: float, back_m: float
) -> None:
    """Add the land around a house as far as its neighbours.

    Parameters
    ----------
    scenery : Scenery
    site : Site
    greens : list of int
        See `new_greens`.
    front_m, side_m, back_m : float
        How far it reaches beyond the house's walls [m].
    """
    west, east = -site.half_x - side_m, site.half_x + side_m
    south, north = -site.half_y - front_m, site.half_y + back_m
    grass, gravel = lawn(), paving((0.36, 0.34, 0.30), (0.5, 0.5))
    x, y = site.half_x, site.half_y
    edge = _GRAVEL_M
    # Pieces of their own on each side: near ones are finer.
    scenery.level((west, east), (y + edge, north), GROUND_M, grass, 18.0)
    if front_m > 0.0:
        scenery.level((west, east), (south, -y - edge), GROUND_M, grass, 22.0)
    for left, right in ((west, -x - edge), (x + edge, east)):
        scenery.level((left, right), (-y - edge, y + edge), GROUND_M, grass, 22.0)
    for rows in ((-y - edge, -y), (y, y + edge)):
        scenery.level((-x - edge, x + edge), rows, GROUND_M, gravel, 40.0)
    for columns in ((-x - edge, -x), (x, x + edge)):
        scenery.level(columns, (-y, y), GROUND_M, gravel, 40.0)
    _add_boundary(scenery, site, greens, (west, east), (south, north))
    for at in ((west + 1.6, y + 2.5), (east - 1.8, y + 4.0), (east - 1.5, -y + 0.5)):
        shrub(scenery, at, scenery.between(0.5, 0.8), greens[1])
    for side in (-1.0, 1.0):
        at = (side * (x + 0.72 * side_m), y + 0.6 * back_m + scenery.between(-1.0, 1.0))
        tree(scenery, at, scenery.between(4.6, 6.0), greens[scenery.dice.randrange(2)])


def _add_boundary(
    scenery: Scenery,
    site: Site,
    greens: list[int],
    x: tuple[float, float],
    y: tuple[float, float],
) -> None:
    """Add a hedge or fence at both sides and the back, and who lives behind them."""
    start = y[0] if y[0] < -site.half_y else -site.half_y
    for side in (-1.0, 1.0):
        at = x[0] if side < 0.0 else x[1]
        edges = sorted((at, at + side * 0.6))
        if scenery.dice.random() < 0.6:
            hedge(scenery, (edges[0], edges[1]), (start, y[1]), 1.7, greens[2])
        else:
            _fence(scenery, at, (start, y[1]), 1.6)
        near = at + side * scenery.between(3.0, 4.5)
        far = near + side * scenery.between(8.5, 10.5)
        low, high = sorted((near, far))
        house = drawn_house(
            scenery, (low, high), -site.half_y + scenery.between(-0.5, 1.5), looks=-1.0, storeys=2
        )
        add_house(scenery, house)
        tree(scenery, (at + side * 2.2, y[1] - 2.0), scenery.between(6.0, 8.0), greens[0])
    hedge(scenery, x, (y[1], y[1] + 0.7), 1.8, greens[2])
    behind = y[1] + scenery.between(9.0, 11.0)
    at = -22.0 + scenery.between(0.0, 3.0)
    while at < 20.0:
        wide = scenery.between(8.5, 11.0)
        add_house(
            scenery,
            drawn_house(scenery, (at, at + wide), behind, looks=-1.0, storeys=2),
            density=18.0,
        )
        at += wide + scenery.between(4.0, 7.0)
    for number in range(4):
        at = -15.0 + 9.5 * number + scenery.between(-2.0, 2.0)
        height = scenery.between(6.0, 9.0)
        tree(scenery, (at, y[1] + scenery.between(2.5, 5.0)), height, greens[number % 2])


def _fence(scenery: Scenery, x: float, y: tuple[float, float], height_m: float) -> None:
    wood = boards((0.30, 0.22, 0.15))
    low = (x - 0.02, y[0], GROUND_M + 0.06)
    scenery.box(low, (x + 0.02, y[1], GROUND_M + height_m), wood, 24.0, sides="ew", casts=True)
    post = plain((0.24, 0.18, 0.12), 0.15)
    count = max(2, round((y[1] - y[0]) / 2.4))
    for number in range(count + 1):
        at = y[0] + number * (y[1] - y[0]) / count
        foot, top = (
            (x - 0.06, at - 0.05, GROUND_M),
            (x + 0.06, at + 0.05, GROUND_M + height_m + 0.1),
        )
        scenery.box(foot, top, post, 8.0)
