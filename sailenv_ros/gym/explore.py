"""``sailenv/Explore-v0``: see as much of the floor as possible by walking around.

A cell of the floor is seen once the centre of a pixel shows it. What counts are the cells on which
the agent could stand.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from typing_extensions import Unpack

from sailenv_ros.frame.lens_rays import reach_view
from sailenv_ros.frame.motion.rigid_motion import camera_points
from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import random_cell
from sailenv_ros.gym.point_nav import EYE_M, STRIDE, TURN
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds

__all__ = ["ExploreEnv"]

SHARE = Bounds(above=0.0, most=1.0)

SEEN_PX = 10
"""Pixels from which an object counts as seen."""

_MOVES = ((1.0, 0.0), (0.0, 1.0), (0.0, -1.0))
"""Ahead, left, right."""


class ExploreEnv(RoomEnv):
    """See the floor of a room.

    Discrete actions: 0 ahead, 1 left, 2 right. Continuous ones: (ahead, left), −1 to 1. Reward: the
    area of the floor that was seen for the first time [m²]. ``info``: ``coverage`` (share of the
    floor), ``seen_m2``, ``objects_seen`` and ``objects``, ``path_length_m``, ``bumps``, ``success``
    (the coverage is reached, which ends the episode).

    Parameters
    ----------
    stride_m, turn_deg : float
        Of one step.
    goal_coverage : float
        Share of the floor to see.
    **settings
        See `RoomEnv`.
    """

    def __init__(
        self,
        *,
        stride_m: float = 0.25,
        turn_deg: float = 30.0,
        goal_coverage: float = 0.95,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._stride_m = STRIDE.number("stride_m", stride_m)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        self._goal = SHARE.number("goal_coverage", goal_coverage)
        super().__init__(**settings)
        lens = self.eye.intrinsics
        self._reach = reach_view(lens)
        self.needs = frozenset({self._reach, "instance"})
        self._walker = Walker(0.0, 0.0, 0.0, EYE_M)
        self._seen = np.zeros((0, 0), bool)
        self._ids = self._seen_ids = frozenset[int]()
        self._cells = 1

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(3) if self.discrete else spaces.Box(-1.0, 1.0, (2,), np.float32)

    def _begin(self) -> bool:
        space, random = self.room.space, self.np_random
        x_m, y_m, _ = random_cell(space, random)
        self._walker = Walker(x_m, y_m, float(random.uniform(-180.0, 180.0)), EYE_M, 20.0)
        self._seen = np.zeros(space.cells.shape, bool)
        self._cells = int((space.regions == 1).sum())
        rows = [row for rows in self.room.objects.values() for row in rows]
        self._ids, self._seen_ids = frozenset(self.room.ids[rows].tolist()), frozenset()
        return True

    def _act(self, action: Any) -> None:
        ahead, left = _MOVES[int(action)] if self.discrete else (float(a) for a in action)
        self._walker.turn(left * self._turn_deg)
        self._walker.walk(self.room.space, ahead * self._stride_m)

    def _judge(self, look: Look) -> tuple[float, bool]:
        space = self.room.space
        before = int(self._seen.sum())
        self._mark(look)
        ids, counts = np.unique(look.views["instance"], return_counts=True)
        self._seen_ids |= self._ids.intersection(ids[counts >= SEEN_PX].tolist())
        gained = int(self._seen.sum()) - before
        return gained * space.resolution_m**2, self.coverage >= self._goal

    @property
    def coverage(self) -> float:
        """Share of the floor that was seen, 0 to 1."""
        return int(self._seen.sum()) / self._cells

    def _mark(self, look: Look) -> None:
        """Mark the cells whose floor is in a picture."""
        space = self.room.space
        reach = look.views[self._reach]
        points = camera_points(reach, self.eye.intrinsics)[np.isfinite(reach)]
        pose = look.past.camera.world_from_camera
        points = points @ pose[:3, :3].T + pose[:3, 3]
        low = np.abs(points[:, 2] - space.body.floor_m) <= space.body.step_m
        cells = np.floor((points[low, :2] - space.origin_m) / space.resolution_m).astype(np.intp)
        height, width = space.cells.shape
        inside = (cells >= 0).all(axis=1) & (cells < (width, height)).all(axis=1)
        column, row = cells[inside].T
        self._seen[row, column] = True
        self._seen &= space.regions == 1

    def _info(self) -> Info:
        return {
            "coverage": self.coverage,
            "seen_m2": int(self._seen.sum()) * self.room.space.resolution_m**2,
            "objects_seen": len(self._seen_ids),
            "objects": len(self._ids),
            "path_length_m": self._walker.walked_m,
            "bumps": self._walker.bumps,
            "success": self.coverage >= self._goal,
        }

    def _eye_pose(self) -> Pose:
        return self._walker.eye_pose(self.room.space.body.floor_m)
