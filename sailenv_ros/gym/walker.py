"""A body that walks on a map of free space and looks around; it stops where it would touch."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from sailenv_ros.space.free_space import FreeSpace
from sailenv_ros.types.geometry import Pose

__all__ = ["Walker"]

STEEPEST_DEG = 60.0
"""How far a walker looks up and down [deg]."""


@dataclass(slots=True)
class Walker:
    """A cylinder upon the floor with an eye.

    Attributes
    ----------
    x_m, y_m : float
        Its axis, in the world [m].
    yaw_deg, pitch_deg : float
        Where it looks: counter-clockwise from the x axis, and downwards [deg].
    eye_m : float
        Height of the eye above the floor [m].
    walked_m : float
        Length of its way so far [m].
    bumps : int
        How often it was stopped.
    """

    x_m: float
    y_m: float
    yaw_deg: float
    eye_m: float
    pitch_deg: float = 0.0
    walked_m: float = 0.0
    bumps: int = 0

    def turn(self, left_deg: float, down_deg: float = 0.0) -> None:
        """Turn to the left and downwards [deg]; the eye turns no further than `STEEPEST_DEG`."""
        self.yaw_deg = math.remainder(self.yaw_deg + left_deg, 360.0)
        self.pitch_deg = min(STEEPEST_DEG, max(-STEEPEST_DEG, self.pitch_deg + down_deg))

    def walk(
        self,
        space: FreeSpace,
        metres: float,
        is_taken: Callable[[float, float], bool] = lambda x_m, y_m: False,
    ) -> bool:
        """Go ahead on a straight line as far as all cells are free; say if it was stopped.

        Tried every half cell. It stays in its region: no way leads between cells that touch at a
        corner.

        Parameters
        ----------
        space : FreeSpace
        metres : float
            Backwards if negative.
        is_taken : callable
            Whether somebody else stands at a place [m].
        """
        if metres == 0.0:
            return False
        ahead = math.radians(self.yaw_deg)
        along, across = math.cos(ahead) * metres, math.sin(ahead) * metres
        count = math.ceil(2.0 * abs(metres) / space.resolution_m)
        (left, low), side = space.origin_m, space.resolution_m
        height, width = space.cells.shape
        here = space.cell_of((self.x_m, self.y_m))
        region = 0 if here is None else int(space.regions[here])
        reached = 0
        for number in range(1, count + 1):
            x_m = self.x_m + along * (number / count)
            y_m = self.y_m + across * (number / count)
            row, column = math.floor((y_m - low) / side), math.floor((x_m - left) / side)
            if not (0 <= row < height and 0 <= column < width):
                break
            if not region or space.regions[row, column] != region or is_taken(x_m, y_m):
                break
            reached = number
        share = reached / count
        self.x_m += along * share
        self.y_m += across * share
        self.walked_m += abs(metres) * share
        self.bumps += reached < count
        return reached < count

    def eye_pose(self, floor_m: float) -> Pose:
        """Return where its eye is and looks."""
        place = (self.x_m, self.y_m, floor_m + self.eye_m)
        return Pose.from_rpy_deg(place, (0.0, self.pitch_deg, self.yaw_deg))
