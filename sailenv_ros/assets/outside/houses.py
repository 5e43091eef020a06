"""Houses outside: painted fronts with windows, sills, gables, a roof."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailenv_ros.assets.outside.painting import (
    Board,
    Floats,
    Painter,
    noise,
    plain,
    resized,
    tiles,
    uneven,
)
from sailenv_ros.assets.outside.scenery import GROUND_M, Scenery

__all__ = ["House", "add_house", "drawn_house"]

Rgb = tuple[float, float, float]

_STOREY_M = 2.9
_PLINTH_M = 0.7
_WINDOW_M = (1.1, 1.45)
_DOOR_M = (1.05, 2.2)
_EAVES_M = 0.45

_LAMPLIT: Rgb = (9.0, 6.0, 3.0)
"""Colour of a lit pane at night, over the light that falls on it."""

_WALLS: tuple[Rgb, ...] = (
    (0.62, 0.57, 0.47),
    (0.66, 0.64, 0.60),
    (0.55, 0.42, 0.30),
    (0.52, 0.55, 0.55),
    (0.60, 0.48, 0.33),
    (0.36, 0.16, 0.11),
)
_ROOFS: tuple[Rgb, ...] = ((0.27, 0.10, 0.065), (0.20, 0.085, 0.06), (0.09, 0.09, 0.10))
_DOORS: tuple[Rgb, ...] = ((0.10, 0.16, 0.12), (0.28, 0.06, 0.05), (0.12, 0.09, 0.07))


@dataclass(frozen=True, slots=True)
class House:
    """A house whose front looks along -y or +y.

    Attributes
    ----------
    x : (2,) tuple of float
        From where to where along the street [m].
    front_y, depth_m : float
        Where its front stands, and how deep it is, away from its front [m].
    storeys : int
    wall, roof, door : (3,) tuple of float
        Linear colours.
    roof_m : float
        Height of the ridge above the eaves [m].
    looks : float
        1 if its front looks to +y, -1 to -y.
    """

    x: tuple[float, float]
    front_y: float
    depth_m: float
    storeys: int
    wall: Rgb
    roof: Rgb
    door: Rgb
    roof_m: float
    looks: float

    @property
    def height_m(self) -> float:
        """Of the eaves above the ground [m]."""
        return _PLINTH_M + _STOREY_M * self.storeys + 0.35


def drawn_house(
    scenery: Scenery, x: tuple[float, float], front_y: float, *, looks: float, storeys: int
) -> House:
    """Draw the looks of a house at a place."""
    dice = scenery.dice
    return House(
        x=x,
        front_y=front_y,
        depth_m=scenery.between(8.0, 10.0),
        storeys=storeys,
        wall=dice.choice(_WALLS),
        roof=dice.choice(_ROOFS),
        door=dice.choice(_DOORS),
        roof_m=scenery.between(2.6, 3.6),
        looks=looks,
    )


def add_house(scenery: Scenery, house: House, *, density: float = 26.0) -> None:
    """Add a house; its front has windows, a door and sills, and its gables a window each."""
    (x0, x1), looks = house.x, house.looks
    y0, y1 = sorted((house.front_y, house.front_y - looks * house.depth_m))
    top = GROUND_M + house.height_m
    scenery.occluders.add_box((x0, y0, GROUND_M), (x1, y1, top + 0.5 * house.roof_m))
    wide = x1 - x0
    columns = max(2, round(wide / 2.5))
    door = scenery.dice.randrange(columns)
    night = scenery.daylight.is_night
    front = _front(house, columns, door, lit=0.3 if night else 0.0)
    left = x0 if looks < 0.0 else x1
    right = (-looks * wide, 0.0, 0.0)
    scenery.add((left, house.front_y, GROUND_M), right, (0, 0, house.height_m), front, density)
    for column in range(columns):
        for storey in range(house.storeys):
            if storey == 0 and column == door:
                continue
            along = (column + 0.5) * wide / columns
            x = left - looks * along
            up = GROUND_M + _PLINTH_M + storey * _STOREY_M + 0.9
            half = _WINDOW_M[0] / 2.0 + 0.08
            ys = sorted((house.front_y, house.front_y + looks * 0.12))
            scenery.box(
                (x - half, ys[0], up - 0.07), (x + half, ys[1], up), plain((0.55, 0.54, 0.5)), 6.0,
                sides="n" if looks > 0.0 else "s",
            )  # fmt: skip
    side, gable = _front(house, 2, -1, lit=0.0), plain(house.wall)
    for x, way in ((x0, -1.0), (x1, 1.0)):
        start = (x, y0 if way > 0.0 else y1, GROUND_M)
        deep = (0.0, way * house.depth_m, 0.0)
        scenery.add(start, deep, (0, 0, house.height_m), side, 0.8 * density)
        scenery.add(
            (*start[:2], top), deep, (0, 0, house.roof_m), gable, 0.5 * density,
            outline=((0.0, 0.0), (1.0, 0.0), (0.5, 1.0)),
        )  # fmt: skip
    _add_roof(scenery, house, (y0, y1), top, density)
    at, middle = x0 + 0.3 * wide, (y0 + y1) / 2.0
    scenery.box(
        (at - 0.3, middle - 0.3, top + 0.6 * house.roof_m),
        (at + 0.3, middle + 0.3, top + house.roof_m + 0.7),
        plain((0.25, 0.12, 0.09), 0.15),
        10.0,
    )


def _add_roof(
    scenery: Scenery, house: House, y: tuple[float, float], top: float, density: float
) -> None:
    x0, x1 = house.x[0] - 0.2, house.x[1] + 0.2
    middle, rise = (y[0] + y[1]) / 2.0, house.roof_m
    # The eaves run on down the slope, before the front.
    drop = _EAVES_M * rise / (0.5 * house.depth_m)
    paint = tiles(house.roof)
    low, high = y[0] - _EAVES_M, y[1] + _EAVES_M
    run, climb = middle - low, rise + drop
    scenery.add((x0, low, top - drop), (x1 - x0, 0, 0), (0, run, climb), paint, 0.6 * density)
    scenery.add((x1, high, top - drop), (x0 - x1, 0, 0), (0, -run, climb), paint, 0.6 * density)
    gutter = plain((0.30, 0.30, 0.30), 0.1)
    for edge, out in ((low, -1.0), (high, 1.0)):
        ys = sorted((edge, edge + out * 0.12))
        under = top - drop - 0.12
        scenery.box(
            (x0, ys[0], under),
            (x1, ys[1], under + 0.12),
            gutter,
            3.0,
            sides="s" if out < 0 else "n",
        )
        inner = sorted((edge, edge - out * _EAVES_M))
        # The underside of the eaves, seen from below.
        scenery.add(
            (x0, inner[1], top - drop), (x1 - x0, 0, 0), (0, inner[0] - inner[1], 0),
            plain((0.5, 0.48, 0.44)), 3.0,
        )  # fmt: skip


def _front(house: House, columns: int, door: int, *, lit: float) -> Painter:
    """Return the painter of a front: plinth, windows with frames, panes and curtains, a door."""

    def paint(board: Board) -> Floats:
        wall = np.asarray(house.wall, np.float32)
        tone = (
            1.0 + 0.05 * noise(board, 2.0) + 0.05 * noise(board, 0.25) + 0.05 * noise(board, 0.04)
        )
        # Rain has washed down from the eaves, mud has splashed up.
        tone = tone * np.clip(0.9 + 0.1 * board.up_m / 1.5, 0.0, 1.0)
        picture = wall * tone[..., None]
        if house.wall[0] > 3.0 * house.wall[2]:
            picture = picture * _bricks(board)[..., None]
        plinth = np.broadcast_to(board.up_m < _PLINTH_M - 0.15, tone.shape)
        picture[plinth] = (0.24 * tone[plinth])[:, None]
        step = board.width_m / columns
        for column in range(columns):
            middle = (column + 0.5) * step
            for storey in range(house.storeys):
                foot = _PLINTH_M + storey * _STOREY_M
                if storey == 0 and column == door:
                    _paint_door(board, picture, middle, foot - 0.55, house.door)
                else:
                    glows = float(board.rng.uniform()) < lit
                    _paint_window(board, picture, middle, foot + 0.9, glows)
        return np.asarray(picture, np.float32)

    return paint


def _bricks(board: Board) -> Floats:
    row = np.floor(board.up_m / 0.075)
    place = board.across_m / 0.24 + 0.5 * (row % 2)
    tone: Floats = (1.0 + 0.35 * uneven(np.floor(place), row)).astype(np.float32)
    return tone


def _fill(
    board: Board, picture: Floats, x: tuple[float, float], y: tuple[float, float], colour: object
) -> None:
    """Paint a rectangle, its edges as far as they cover their pixels.

    Two colours are that of its foot and that of its top.
    """
    per_x, per_y = board.columns / board.width_m, board.rows / board.height_m
    across = np.clip(
        np.minimum((board.across_m - x[0]) * per_x, (x[1] - board.across_m) * per_x) + 0.5, 0.0, 1.0
    )
    up = np.clip(
        np.minimum((board.up_m - y[0]) * per_y, (y[1] - board.up_m) * per_y) + 0.5, 0.0, 1.0
    )
    rows, columns = np.flatnonzero(up[:, 0]), np.flatnonzero(across[0])
    if not len(rows) or not len(columns):
        return
    box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    share = (up[box[0]] * across[:, box[1]])[..., None]
    wanted = np.asarray(colour, np.float32)
    if wanted.ndim == 2:
        wanted = resized(wanted[::-1], rows[-1] + 1 - rows[0], 3)[:, None]
    picture[box] += (wanted - picture[box]) * share


def _paint_window(board: Board, picture: Floats, middle: float, foot: float, glows: bool) -> None:
    half, tall = _WINDOW_M[0] / 2.0, _WINDOW_M[1]
    x, y = (middle - half, middle + half), (foot, foot + tall)
    # Surround, the shade of the reveal, frame.
    _fill(board, picture, (x[0] - 0.1, x[1] + 0.1), (y[0], y[1] + 0.1), (0.62, 0.61, 0.58))
    _fill(board, picture, x, y, (0.12, 0.115, 0.11))
    _fill(board, picture, (x[0] + 0.03, x[1] - 0.02), (y[0], y[1] - 0.07), (0.70, 0.70, 0.68))
    drawn = float(board.rng.uniform(0.05, 0.4))
    for left, right in ((x[0] + 0.09, middle - 0.035), (middle + 0.035, x[1] - 0.08)):
        low, high = y[0] + 0.07, y[1] - 0.14
        # Panes mirror the sky above and the street below.
        pane = np.array([(0.05, 0.06, 0.07), (0.16, 0.20, 0.24)])
        _fill(
            board, picture, (left, right), (low, high), np.full((2, 3), _LAMPLIT) if glows else pane
        )
        wide = drawn * (right - left)
        side = (left, left + wide) if left < middle - 0.2 else (right - wide, right)
        _fill(
            board, picture, side, (low, high), np.array([0.34, 0.34, 0.33]) * (8.0 if glows else 1)
        )


def _paint_door(board: Board, picture: Floats, middle: float, foot: float, colour: Rgb) -> None:
    half, tall = _DOOR_M[0] / 2.0, _DOOR_M[1]
    _fill(board, picture, (middle - half - 0.1, middle + half + 0.1), (foot, foot + tall + 0.1),
          (0.6, 0.59, 0.56))  # fmt: skip
    _fill(board, picture, (middle - half, middle + half), (foot, foot + tall), (0.05, 0.05, 0.05))
    leaf = np.asarray(colour)
    _fill(board, picture, (middle - half + 0.03, middle + half - 0.02), (foot, foot + tall - 0.06),
          leaf)  # fmt: skip
    for low, high in ((0.2, 0.95), (1.15, 1.9)):
        _fill(board, picture, (middle - 0.33, middle + 0.33), (foot + low, foot + high), 0.7 * leaf)
    _fill(board, picture, (middle - 0.7, middle + 0.7), (foot - 0.16, foot), (0.4, 0.4, 0.38))
