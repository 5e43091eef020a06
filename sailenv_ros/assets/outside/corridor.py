"""A corridor behind a door that is open or may be opened: floor, walls, ceiling, a lamp."""

from __future__ import annotations

import math

import numpy as np

from sailenv_ros.assets.outside.painting import Board, Floats, Painter, paving, plain
from sailenv_ros.assets.outside.scenery import Scenery
from sailenv_ros.assets.rooms.pieces import WallFrame
from sailenv_ros.scene.spec_room import DoorSpec

__all__ = ["add_corridor"]

_DEEP_M = 1.5
_SKIRTING_M = 0.09
_BEHIND_M = 0.002
"""It begins so far behind the wall's outer face, which it must not touch [m]."""


def add_corridor(scenery: Scenery, frame: WallFrame, door: DoorSpec, brightness: float) -> None:
    """Add a corridor along the outside of a wall, as long as the wall is.

    Parameters
    ----------
    scenery : Scenery
        In the axes of the world.
    frame : WallFrame
    door : DoorSpec
        One of the wall's.
    brightness : float
        Radiance of a white surface below the lamp [W/(m² sr)].
    """
    near = frame.thickness_m + _BEHIND_M
    far, half = near + _DEEP_M, frame.length_m / 2.0
    high = max(2.4, min(frame.height_m, 2.7))
    walls, floor = (0.74, 0.72, 0.68), (0.30, 0.21, 0.13)
    white = plain((0.82, 0.82, 0.80), 0.02)
    along, out = np.asarray(frame.along), np.asarray(frame.outward)
    foot = np.asarray(frame.middle_m)
    # Seen from inside the room the right is to one side or the other of `along`.
    way = 1.0 if np.cross(along, (0.0, 0.0, 1.0)) @ -out > 0.0 else -1.0
    run = way * along

    def corner(a: float, o: float, z: float) -> tuple[float, float, float]:
        x, y, _ = (foot + a * run + o * out).tolist()
        return x, y, z

    def side(a: float, o: float, z: float = 0.0) -> tuple[float, float, float]:
        x, y, _ = (a * run + o * out).tolist()
        return x, y, z

    def lit(paint: Painter, centre: tuple[float, float]) -> Painter:
        return _in_lamplight(paint, centre, high, brightness)

    at = way * door.at
    long = 2.0 * half
    plaster = _with_skirting(plain(walls, 0.03))
    scenery.add(
        corner(-half, far, 0.0), side(long, 0.0), (0, 0, high),
        lit(_with_door(plaster, at + half + 0.35), (at + half, high - 0.3)), 60.0,
        has_own_light=True,
    )  # fmt: skip
    scenery.add(
        corner(half, near, 0.0), side(-long, 0.0), (0, 0, high),
        lit(plaster, (half - at, high - 0.3)), 20.0, has_own_light=True,
    )  # fmt: skip
    for end, way_out in ((-half, 1.0), (half, -1.0)):
        start = near if way_out > 0.0 else far
        scenery.add(
            corner(end, start, 0.0), side(0.0, way_out * _DEEP_M), (0, 0, high),
            lit(plaster, (_DEEP_M / 2.0, high - 0.3)), 40.0, has_own_light=True,
        )  # fmt: skip
    boards = paving(floor, (1.2, 0.14), 0.004)
    scenery.add(
        corner(-half, near, 0.0), side(long, 0.0), side(0.0, _DEEP_M),
        lit(boards, (at + half, _DEEP_M / 2.0)), 60.0, has_own_light=True,
    )  # fmt: skip
    scenery.add(
        corner(-half, far, high), side(long, 0.0), side(0.0, -_DEEP_M),
        lit(white, (at + half, _DEEP_M / 2.0)), 20.0, has_own_light=True,
    )  # fmt: skip


def _in_lamplight(
    paint: Painter, centre: tuple[float, float], high_m: float, brightness: float
) -> Painter:
    """Return a painter that adds the light of a lamp over a place of the picture, and of walls."""

    def lit(board: Board) -> Floats:
        away = (board.across_m - centre[0]) ** 2 + (board.up_m - centre[1]) ** 2
        direct = 1.0 / (1.0 + away / (0.8 * high_m))
        # Darker where walls, floor and ceiling meet.
        edge = np.minimum(board.up_m, board.height_m - board.up_m)
        corner = 1.0 - 0.35 * np.exp(-edge / 0.12)
        tone = brightness * (0.35 + 0.65 * direct) * corner
        return np.asarray(paint(board) * tone[..., None], np.float32)

    return lit


def _with_skirting(paint: Painter) -> Painter:
    def painted(board: Board) -> Floats:
        picture = paint(board)
        low = np.broadcast_to(board.up_m < _SKIRTING_M, picture.shape[:2])
        picture[low] = (0.72, 0.72, 0.70)
        return picture

    return painted


def _with_door(paint: Painter, middle_m: float) -> Painter:
    """Return a painter of a wall with a door and a picture beside it."""

    def painted(board: Board) -> Floats:
        picture = paint(board)
        x, up = board.across_m - middle_m, board.up_m

        def fill(left: float, right: float, low: float, high: float, colour: Floats) -> None:
            picture[(x > left) & (x < right) & (up > low) & (up < high)] = colour

        paint_ = np.asarray((0.70, 0.69, 0.66), np.float32)
        fill(-0.53, 0.53, 0.0, 2.1, 0.8 * paint_)
        fill(-0.45, 0.45, 0.0, 2.03, paint_)
        for low, high in ((0.22, 0.95), (1.15, 1.88)):
            fill(-0.31, 0.31, low, high, 0.86 * paint_)
            fill(-0.28, 0.28, low + 0.03, high - 0.03, 0.96 * paint_)
        fill(0.33, 0.36, 0.95, 1.12, np.asarray((0.35, 0.34, 0.32), np.float32))
        for side in (-1.0, 1.0):
            at = side * math.sqrt(2.3)
            fill(at - 0.27, at + 0.27, 1.3, 1.95, np.asarray((0.12, 0.09, 0.06), np.float32))
            fill(at - 0.24, at + 0.24, 1.33, 1.92, np.asarray((0.60, 0.56, 0.48), np.float32))
            fill(at - 0.16, at + 0.1, 1.42, 1.75, np.asarray((0.20, 0.30, 0.34), np.float32))
        return picture

    return painted
