"""``sailenv/Rearrange-v0``: look around, then say what has moved since.

Small things are moved on what they lie on; the agent points at them with the middle of its picture.
(The question of Batra et al., "Rearrangement: A Challenge for Embodied AI", 2020, without hands.)
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from typing_extensions import Unpack

from sailenv_ros.gym.eye import Eye, Look
from sailenv_ros.gym.ground import random_cell
from sailenv_ros.gym.moved_things import move_things
from sailenv_ros.gym.point_nav import EYE_M, TURN
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.validation import Bounds

__all__ = ["RearrangeEnv"]

COUNT = Bounds(least=1, most=20, whole=True)
STEPS = Bounds(least=1, most=10_000, whole=True)

WRONG_COST = 0.5
"""Taken off the reward for pointing at what has not moved."""

LEAST_PX = 12
"""Pixels of a thing in a picture of 128×128 towards it, from which it counts as visible."""

TRIES = 20
"""Places to stand that are tried in a room."""

_TURNS = ((1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.0, 0.0))
"""Left, right, up, down, point."""


class RearrangeEnv(RoomEnv):
    """Point at what has moved.

    Discrete actions: 0 left, 1 right, 2 up, 3 down, 4 point. Continuous ones: (left, down, point),
    −1 to 1; point above 0.5 points. Observed besides views: ``phase``, 0 while nothing has moved, 1
    afterwards. Reward: 1 for pointing at a thing that has moved, −0.5 at something else, in phase 1
    alone. ``info``: ``phase``, ``moved``, ``found`` and ``wrong`` (numbers), ``success`` (all were
    found, which ends the episode).

    Parameters
    ----------
    things : int
        That are moved.
    look_steps : int
        Steps before they are.
    turn_deg : float
        Of one step.
    **settings
        See `RoomEnv`.
    """

    needs = frozenset({"instance"})

    def __init__(
        self,
        *,
        things: int = 1,
        look_steps: int = 40,
        turn_deg: float = 15.0,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._things = COUNT.integer("things", things)
        self._look_steps = STEPS.integer("look_steps", look_steps)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        super().__init__(**settings)
        lens = CameraIntrinsics(width=128, height=128, vertical_fov_deg=60.0)
        self._searching_eye = Eye("instance", lens, PictureSettings(), 10.0)
        self._eye = Walker(0.0, 0.0, 0.0, EYE_M)
        self._moved: Mapping[int, NDArray[np.float64]] = {}
        self._goals: dict[int, frozenset[int]] = {}
        self._found: set[int] = set()
        self._wrong = 0
        self._points = False

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(5) if self.discrete else spaces.Box(-1.0, 1.0, (3,), np.float32)

    def _other_spaces(self) -> dict[str, spaces.Space[Any]]:
        return {"phase": spaces.Discrete(2)}

    @property
    def _phase(self) -> int:
        return int(self._steps >= self._look_steps)

    def _begin(self) -> bool:
        room, random = self.room, self.np_random
        for _ in range(TRIES):
            x_m, y_m, _ = random_cell(room.space, random)
            self._eye = Walker(x_m, y_m, float(random.uniform(-180.0, 180.0)), EYE_M, 15.0)
            moved = move_things(room, self._things, random, self._sees)
            if len(moved) == self._things:
                self._moved = {row: pose for one in moved.values() for row, pose in one.items()}
                self._goals = {
                    first: frozenset(room.ids[list(rows)].tolist()) for first, rows in moved.items()
                }
                self._found, self._wrong, self._points = set(), 0, False
                return True
        return False

    def _sees(self, row: int, moved: Mapping[int, NDArray[np.float64]]) -> bool:
        """Return whether the eye could see a thing, some others moved."""
        room = self.room
        scene = room.scene_at(0, moved)
        middle = np.append(0.5 * room.own_boxes[row].sum(axis=0), 1.0)
        eye = self._eye.eye_pose(room.space.body.floor_m)
        pose = look_at(eye.position_m, (scene.world_from_body[row] @ middle)[:3])
        seen = self._searching_eye.look(room, scene, pose, None).views["instance"]
        return int(np.count_nonzero(seen == room.ids[row])) >= LEAST_PX

    def _act(self, action: Any) -> None:
        if self.discrete:
            left, down = _TURNS[int(action)]
            self._points = int(action) == 4
        else:
            left, down, point = (float(share) for share in action)
            self._points = point > 0.5
        if not self._points:
            self._eye.turn(left * self._turn_deg, down * self._turn_deg)

    def _judge(self, look: Look) -> tuple[float, bool]:
        if not (self._points and self._phase):
            return 0.0, False
        row, column = self.eye.intrinsics.height // 2, self.eye.intrinsics.width // 2
        pointed = int(look.views["instance"][row, column])
        new = {first for first, ids in self._goals.items() if pointed in ids} - self._found
        self._found |= new
        self._wrong += not new
        return (1.0 if new else -WRONG_COST), len(self._found) == len(self._goals)

    def _info(self) -> Info:
        return {
            "phase": self._phase,
            "moved": len(self._goals),
            "found": len(self._found),
            "wrong": self._wrong,
            "success": len(self._found) == len(self._goals),
        }

    def _eye_pose(self) -> Pose:
        return self._eye.eye_pose(self.room.space.body.floor_m)

    def _places(self) -> Mapping[int, NDArray[np.float64]]:
        return self._moved if self._phase else {}

    def _other_observations(self, look: Look) -> dict[str, Any]:
        return {"phase": self._phase}

    def _lacking(self) -> str:
        return f"rooms in which {self._things} small things can be moved in view of the agent"
