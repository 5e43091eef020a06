"""``sailenv/PointNav-v0``: walk to a place that is given as distance and direction.

The agent is a cylinder in free space. Where it would touch something it stops, which is counted.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from gymnasium import spaces
from typing_extensions import Unpack

from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import random_cell, way_length_m
from sailenv_ros.gym.navigation import Navigation
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds

__all__ = ["PointNavEnv"]

EYE_M = 1.2
STRIDE = Bounds(above=0.0, most=2.0, unit="m")
TURN = Bounds(above=0.0, most=180.0, unit="deg")
NEAR = Bounds(least=0.05, most=10.0, unit="m")
FARTHEST_M = 100.0

_MOVES = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
"""Stop, ahead, left, right."""


class PointNavEnv(RoomEnv):
    """Walk to a point.

    Discrete actions: 0 stop, 1 ahead, 2 left, 3 right. Continuous ones: (ahead, left, stop), −1 to
    1; stop above 0.5 ends the episode. Observed besides views: ``goal``, distance [m] and direction
    [rad, to the left] from the agent. Reward: how much shorter the path to the goal became [m],
    less 0.01 a step; 10 more for stopping near the goal. ``info``: ``success``, ``spl``,
    ``distance_to_goal_m``, ``path_length_m``, ``shortest_path_m``, ``bumps``.

    Parameters
    ----------
    stride_m, turn_deg : float
        Of one step.
    near_m : float
        Path to the goal within which stopping is success [m].
    least_path_m : float
        Length of the shortest path to begin with, where the room has one so long [m].
    **settings
        See `RoomEnv`.
    """

    def __init__(
        self,
        *,
        stride_m: float = 0.25,
        turn_deg: float = 15.0,
        near_m: float = 0.3,
        least_path_m: float = 1.5,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._stride_m = STRIDE.number("stride_m", stride_m)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        self._near_m = NEAR.number("near_m", near_m)
        self._least_path_m = NEAR.number("least_path_m", least_path_m)
        super().__init__(**settings)
        self._walker = Walker(0.0, 0.0, 0.0, EYE_M)
        self._goal = (0.0, 0.0, 0.0)
        self._stopped = False
        self._navigation: Navigation

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(4) if self.discrete else spaces.Box(-1.0, 1.0, (3,), np.float32)

    def _other_spaces(self) -> dict[str, spaces.Space[Any]]:
        low, high = np.array([0.0, -math.pi]), np.array([FARTHEST_M, math.pi])
        return {"goal": spaces.Box(low.astype(np.float32), high.astype(np.float32))}

    def _begin(self) -> bool:
        space, random = self.room.space, self.np_random
        self._goal = random_cell(space, random)
        distances_m = space.distances_m(self._goal)
        far = np.isfinite(distances_m) & (distances_m >= self._least_path_m)
        if not far.any():
            far = distances_m == distances_m[np.isfinite(distances_m)].max()
        start = random_cell(space, random, far)
        self._walker = Walker(start[0], start[1], float(random.uniform(-180.0, 180.0)), EYE_M)
        cell = space.cell_of(start)
        assert cell is not None
        shortest_m = way_length_m(space, start, self._goal)
        self._navigation = Navigation(space, distances_m, shortest_m, float(distances_m[cell]))
        self._stopped = False
        return True

    def _act(self, action: Any) -> None:
        if self.discrete:
            ahead, left = _MOVES[int(action)]
            self._stopped = int(action) == 0
        else:
            ahead, left, stop = (float(share) for share in action)
            self._stopped = stop > 0.5
        if not self._stopped:
            self._walker.turn(left * self._turn_deg)
            self._walker.walk(self.room.space, ahead * self._stride_m, self._is_taken)

    def _is_taken(self, x_m: float, y_m: float) -> bool:
        """Return whether somebody else stands at a place."""
        return False

    def _judge(self, look: Look) -> tuple[float, bool]:
        if not self._steps:
            return 0.0, False
        navigation = self._navigation
        arrived = navigation.distance_m <= self._near_m
        reward = navigation.judge(self._walker, ended=self._stopped, arrived=arrived)
        return reward, self._stopped

    def _info(self) -> Info:
        return self._navigation.info(self._walker)

    def _eye_pose(self) -> Pose:
        return self._walker.eye_pose(self.room.space.body.floor_m)

    def _other_observations(self, look: Look) -> dict[str, Any]:
        walker = self._walker
        along, across = self._goal[0] - walker.x_m, self._goal[1] - walker.y_m
        direction = math.atan2(across, along) - math.radians(walker.yaw_deg)
        return {"goal": (math.hypot(along, across), math.remainder(direction, math.tau))}
