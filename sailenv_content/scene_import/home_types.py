"""Parts of a home as its file has them: walls, rooms, pieces, cameras."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.plan_walls import Opening, PlanWall

__all__ = [
    "ARC_STEP",
    "Doubles",
    "FRONT_YAW_DEG",
    "Home",
    "HomeCamera",
    "HomePiece",
    "HomeRoom",
    "HomeWall",
    "Paint",
    "Vector3",
]


Doubles = NDArray[np.float64]

Vector3 = tuple[float, float, float]

ARC_STEP = math.radians(12.0)
"""A round wall becomes straight ones of at most this turn."""

FRONT_YAW_DEG = -90.0
"""Yaw of a piece that is not turned in the plan: it faces south, towards the reader of the plan."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Paint:
    """Paint of a surface: a colour or a picture, and its shininess.

    Attributes
    ----------
    colour : (3,) tuple of float or None
        Linear; None for the surface's own.
    image : str
        Name of a picture in the archive; empty for none.
    tile_m : (2,) tuple of float
        Size of the picture on the surface [m].
    shininess : float
        0 to 1.
    """

    colour: Vector3 | None = None
    image: str = ""
    tile_m: tuple[float, float] = (1.0, 1.0)
    shininess: float = 0.0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class HomeWall:
    """A wall with the paint of its left and its right side, and of its top."""

    line: PlanWall
    left: Paint
    right: Paint
    top: Paint


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class HomeRoom:
    """A room: its outline (N, 2) [m], its floor's height, and paint; None for what is hidden."""

    name: str
    outline: Doubles
    elevation_m: float
    level_rise_m: float
    floor: Paint | None
    ceiling: Paint | None


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class HomePiece:
    """A piece of furniture, a door, a window or a light.

    Attributes
    ----------
    kind : {'piece', 'opening', 'light'}
    catalogue : str
        Its id in a catalogue; may be empty.
    name, creator, licence, model : str
        `model` is the name of its file in the archive.
    position : (3,) tuple of float
        Middle of its base [m].
    yaw_deg : float
        Where its front looks.
    size_m : (3,) tuple of float
        Depth, width, height: along its own x, y, z [m].
    turn : (3, 3) float64
        Of the model in its file's axes.
    mirrored : bool
    paint : Paint
        Of all of it.
    materials : dict of str to Paint
        Of some of its materials.
    sources : tuple
        Position [m] and linear colour of each light source, brightness included.
    cut : (4,) tuple of float
        Left, top, width, height of what it cuts out of walls, as shares of its front.
    """

    kind: str
    catalogue: str
    name: str
    creator: str
    licence: str
    model: str
    position: Vector3
    yaw_deg: float
    tilt_deg: tuple[float, float]
    size_m: Vector3
    turn: Doubles
    mirrored: bool
    paint: Paint
    materials: dict[str, Paint]
    sources: tuple[tuple[Vector3, Vector3], ...]
    cut: tuple[float, float, float, float]

    def opening_in(self, wall: PlanWall) -> Opening | None:
        """Return what it cuts out of a wall; None if it is not in it."""
        left_share, top_share, width_share, height_share = self.cut
        facing = math.radians(self.yaw_deg)
        front = np.array([math.cos(facing), math.sin(facing)])
        beside = np.array([-front[1], front[0]])  # its own left, its y
        if abs(float(beside @ wall.left)) > math.sin(math.radians(20.0)):
            return None
        depth, width, height = self.size_m
        middle = np.array(self.position[:2])
        away = abs(float((middle - wall.start) @ wall.left))
        # In the wall: its box reaches the wall's middle third at least.
        if away > 0.5 * depth + wall.thickness_m / 6.0:
            return None
        # Shares count from the left of who stands before it: its own y is to that one's right.
        centre = middle + beside * width * (left_share + 0.5 * width_share - 0.5)
        at = float((centre - wall.start) @ wall.along)
        half = 0.5 * width * width_share
        if at + half < 0.0 or at - half > wall.length_m:
            return None
        top = self.position[2] + height * (1.0 - top_share) - wall.low_m
        low = top - height * height_share
        return Opening(along_m=(at - half, at + half), height_m=(low, top))


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeCamera:
    """A camera: position [m], pitch (down is positive) and yaw [deg], horizontal angle [deg]."""

    name: str
    position: Vector3
    pitch_deg: float
    yaw_deg: float
    fov_deg: float
    is_observer: bool


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Home:
    """All that is imported of a file."""

    name: str
    walls: tuple[HomeWall, ...]
    rooms: tuple[HomeRoom, ...]
    pieces: tuple[HomePiece, ...]
    cameras: tuple[HomeCamera, ...]
