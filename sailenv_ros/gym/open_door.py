"""``sailenv/Open-v0``: walk to a door and open it.

The leaf turns on its hinge in equal steps while the agent is near and looks at it. It is an
obstacle, open or shut, and does not turn against the agent.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from typing_extensions import Unpack

from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import random_cell
from sailenv_ros.gym.navigation import STEP_COST, SUCCESS_REWARD
from sailenv_ros.gym.point_nav import EYE_M, NEAR, STRIDE, TURN
from sailenv_ros.gym.room import DOOR_STEPS, Door
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose, invert

__all__ = ["OpenEnv"]

_MOVES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
"""Ahead, left, right, open, shut."""


class OpenEnv(RoomEnv):
    """Open a door.

    Discrete actions: 0 ahead, 1 left, 2 right, 3 open, 4 shut. Continuous ones: (ahead, left,
    open), −1 to 1; beyond ±0.5 the door is moved. Either turns it by an eighth of its range, if it
    is within reach and in the middle of the picture. Reward: the share of the range that the door
    opened, less 0.01 a step; 10 more once it is open, which ends the episode. ``info``:
    ``open_share``, ``reached`` (it can be moved now), ``stuck`` (how often the agent was in its
    way), ``path_length_m``, ``bumps``, ``success``.

    Parameters
    ----------
    stride_m, turn_deg : float
        Of one step.
    reach_m : float
        Horizontal distance of the leaf up to which it can be moved [m].
    **settings
        See `RoomEnv`.
    """

    opens = True
    needs = frozenset({"instance"})

    def __init__(
        self,
        *,
        stride_m: float = 0.25,
        turn_deg: float = 15.0,
        reach_m: float = 1.0,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._stride_m = STRIDE.number("stride_m", stride_m)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        self._reach_m = NEAR.number("reach_m", reach_m)
        super().__init__(**settings)
        self._walker = Walker(0.0, 0.0, 0.0, EYE_M)
        self._door: Door
        self._at = self._judged = self._stuck = 0
        self._reached = False

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(5) if self.discrete else spaces.Box(-1.0, 1.0, (3,), np.float32)

    def _begin(self) -> bool:
        doors, random = self.room.doors, self.np_random
        if not doors:
            return False
        self._door = doors[int(random.integers(len(doors)))]
        x_m, y_m, _ = random_cell(self.room.space, random)
        self._walker = Walker(x_m, y_m, float(random.uniform(-180.0, 180.0)), EYE_M)
        self._at = self._judged = self._stuck = 0
        self._reached = False
        return True

    def _act(self, action: Any) -> None:
        ahead, left, move = (
            _MOVES[int(action)] if self.discrete else (float(share) for share in action)
        )
        self._walker.turn(left * self._turn_deg)
        self._walker.walk(self.room.space, ahead * self._stride_m, self._is_taken)
        if abs(move) > 0.5 and self._reached:
            to = min(DOOR_STEPS, max(0, self._at + (1 if move > 0.0 else -1)))
            here = self._walker.x_m, self._walker.y_m
            if self._leaf_distance_m(to, *here) < self.body.radius_m:
                self._stuck += 1
            else:
                self._at = to

    def _judge(self, look: Look) -> tuple[float, bool]:
        row, column = self.eye.intrinsics.height // 2, self.eye.intrinsics.width // 2
        pointed = int(look.views["instance"][row, column])
        walker = self._walker
        near = self._leaf_distance_m(self._at, walker.x_m, walker.y_m) <= self._reach_m
        self._reached = near and pointed in self.room.ids[list(self._door.places[0])]
        gained, self._judged = self._at - self._judged, self._at
        is_open = self._at == DOOR_STEPS
        return gained / DOOR_STEPS - STEP_COST + SUCCESS_REWARD * is_open, is_open

    def _info(self) -> Info:
        return {
            "open_share": self._at / DOOR_STEPS,
            "reached": self._reached,
            "stuck": self._stuck,
            "path_length_m": self._walker.walked_m,
            "bumps": self._walker.bumps,
            "success": self._at == DOOR_STEPS,
        }

    def _eye_pose(self) -> Pose:
        return self._walker.eye_pose(self.room.space.body.floor_m)

    def _places(self) -> Mapping[int, NDArray[np.float64]]:
        return self._door.places[self._at] if self._at else {}

    def _leaf_distance_m(self, at: int, x_m: float, y_m: float) -> float:
        """Return the horizontal distance of a place from the leaf's box at a step [m]."""
        leaf = self._door.leaf
        low, high = self.room.own_boxes[leaf]
        pose = self._door.places[at].get(leaf, self.room.snapshot.world_from_body[leaf])
        x, y, _, _ = invert(pose) @ (x_m, y_m, float(pose[2, 3]), 1.0)
        aside = max(low[0] - x, x - high[0], 0.0)
        return math.hypot(aside, max(low[1] - y, y - high[1], 0.0))

    def _is_taken(self, x_m: float, y_m: float) -> bool:
        """Return whether the leaf is in the way, once it is not shut any more."""
        here_m = self._leaf_distance_m(self._at, self._walker.x_m, self._walker.y_m)
        there_m = self._leaf_distance_m(self._at, x_m, y_m)
        return self._at > 0 and there_m < min(self.body.radius_m, here_m)

    def _lacking(self) -> str:
        return "rooms with a door that opens"
