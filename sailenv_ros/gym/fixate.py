"""``sailenv/Fixate-v0``: look from object to object with a foveated eye, by saccades.

The label at the fixation is told, and that alone: the retina has to say where to look next.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from typing_extensions import Unpack

from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import random_cell
from sailenv_ros.gym.point_nav import EYE_M, TURN
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds

__all__ = ["FixateEnv"]

COUNT = Bounds(least=1, most=1000, whole=True)

FIXATION_COST = 0.01
"""Taken off the reward of each step."""

RETINA = (20, 32)
"""Rings and wedges unless told otherwise."""

_TURNS = tuple((left, down) for down in (-1.0, 0.0, 1.0) for left in (1.0, 0.0, -1.0))
"""Nine saccades, from up left to down right; 4 stays."""


class FixateEnv(RoomEnv):
    """Fixate one object after the other.

    Discrete actions: 0 to 8, the eight directions by half the largest saccade, row by row from up
    left, and 4 to stay. Continuous ones: (left, down), −1 to 1 of the largest saccade. Observed
    besides views, which are seen by a `Retina`: ``label``, the category id at the fixation. Reward:
    1 for an object that was not fixated before, less 0.01 a step. ``info``: ``fixated`` and
    ``objects`` (numbers), ``instance`` and ``category`` at the fixation, ``success`` (enough were
    fixated, which ends the episode).

    Parameters
    ----------
    saccade_deg : float
        Largest turn to the side and downwards [deg].
    goal_objects : int
        To fixate, or as many as the room has.
    **settings
        See `RoomEnv`.
    """

    needs = frozenset({"instance", "category"})

    def __init__(
        self,
        *,
        saccade_deg: float = 30.0,
        goal_objects: int = 8,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._saccade_deg = TURN.number("saccade_deg", saccade_deg)
        self._goal = COUNT.integer("goal_objects", goal_objects)
        settings.setdefault("retina", RETINA)
        super().__init__(**settings)
        self._eye = Walker(0.0, 0.0, 0.0, EYE_M)
        self._fixated: set[int] = set()
        self._ids = frozenset[int]()
        self._instance = self._category = 0

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(9) if self.discrete else spaces.Box(-1.0, 1.0, (2,), np.float32)

    def _other_spaces(self) -> dict[str, spaces.Space[Any]]:
        return {"label": spaces.Discrete(256)}

    def _begin(self) -> bool:
        rows = [row for rows in self.room.objects.values() for row in rows]
        if not rows:
            return False
        random = self.np_random
        x_m, y_m, _ = random_cell(self.room.space, random)
        self._eye = Walker(x_m, y_m, float(random.uniform(-180.0, 180.0)), EYE_M, 10.0)
        self._ids, self._fixated = frozenset(self.room.ids[rows].tolist()), set()
        return True

    def _act(self, action: Any) -> None:
        if self.discrete:
            left, down = (0.5 * turn for turn in _TURNS[int(action)])
        else:
            left, down = (float(turn) for turn in action)
        self._eye.turn(left * self._saccade_deg, down * self._saccade_deg)

    def _judge(self, look: Look) -> tuple[float, bool]:
        row, column = self.eye.intrinsics.height // 2, self.eye.intrinsics.width // 2
        self._instance = int(look.views["instance"][row, column])
        self._category = int(look.views["category"][row, column])
        is_new = self._instance in self._ids and self._instance not in self._fixated
        if is_new:
            self._fixated.add(self._instance)
        return float(is_new) - FIXATION_COST, self._is_done

    @property
    def _is_done(self) -> bool:
        return len(self._fixated) >= min(self._goal, len(self._ids))

    def _info(self) -> Info:
        categories = self.room.snapshot.contents.categories
        return {
            "fixated": len(self._fixated),
            "objects": len(self._ids),
            "instance": self._instance,
            "category": categories[self._category].name if self._category in categories else "",
            "success": self._is_done,
        }

    def _eye_pose(self) -> Pose:
        return self._eye.eye_pose(self.room.space.body.floor_m)

    def _other_observations(self, look: Look) -> dict[str, Any]:
        return {"label": self._category}

    def _lacking(self) -> str:
        return "rooms with objects"
