"""``sailenv/Search-v0``: find an object of a named category in a furnished room.

ObjectNav's task: declare that it is found, near it and with it in view. (Batra et al., "ObjectNav
Revisited", 2020.)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from typing_extensions import Unpack

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import near_boxes, random_cell, way_length_m
from sailenv_ros.gym.navigation import Navigation
from sailenv_ros.gym.point_nav import EYE_M, NEAR, STRIDE, TURN
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import RoomSettings
from sailenv_ros.gym.room_store import shared_rooms
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds

__all__ = ["SearchEnv"]

SHARE = Bounds(above=0.0, most=1.0)

_MOVES = tuple(
    (float(ahead), float(left), float(down))
    for ahead, left, down in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1))
)
"""Found, ahead, left, right, up, down."""


class SearchEnv(RoomEnv):
    """Find an object of a category.

    Discrete actions: 0 found, 1 ahead, 2 left, 3 right, 4 up, 5 down. Continuous ones: (ahead,
    left, down, found), −1 to 1; found above 0.5 ends the episode. Observed besides views: ``goal``,
    the id of the category. Reward: how much shorter the path to the nearest such object became [m],
    less 0.01 a step; 10 more for success: declared within `near_m` of one, with enough of its
    pixels in view. ``info``: as `PointNavEnv`, ``category`` and ``goal_pixels``.

    Parameters
    ----------
    categories : sequence of str
        To search for; none means whatever a room has besides its walls.
    stride_m, turn_deg : float
        Of one step.
    near_m : float
        Horizontal distance from the object's box [m].
    seen_share : float
        Least share of the picture's pixels that are the object's.
    **settings
        See `RoomEnv`.

    Raises
    ------
    UnknownName
        If there is no such category.
    """

    needs = frozenset({"category"})

    def __init__(
        self,
        *,
        categories: Sequence[str] = (),
        stride_m: float = 0.25,
        turn_deg: float = 30.0,
        near_m: float = 1.0,
        seen_share: float = 0.005,
        **settings: Unpack[RoomSettings],
    ) -> None:
        if isinstance(categories, str):
            raise InvalidRequest("categories", categories, "a list of names of categories")
        known = shared_rooms().categories()
        self._wanted = {name: known.named(name).id for name in categories}
        self._stride_m = STRIDE.number("stride_m", stride_m)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        self._near_m = NEAR.number("near_m", near_m)
        self._seen_share = SHARE.number("seen_share", seen_share)
        super().__init__(**settings)
        self._walker = Walker(0.0, 0.0, 0.0, EYE_M)
        self._goal, self._goal_id, self._pixels = "", 0, 0
        self._declared = False
        self._navigation: Navigation

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(6) if self.discrete else spaces.Box(-1.0, 1.0, (4,), np.float32)

    def _other_spaces(self) -> dict[str, spaces.Space[Any]]:
        return {"goal": spaces.Discrete(256)}

    def _begin(self) -> bool:
        room, random = self.room, self.np_random
        there = [name for name in room.objects if not self._wanted or name in self._wanted]
        for place in random.permutation(len(there)).tolist():
            category = there[place]
            near = near_boxes(room.space, room.boxes[list(room.objects[category])], self._near_m)
            if near.any() and not near[room.space.regions == 1].all():
                self._set_out(category, near)
                return True
        return False

    def _set_out(self, category: str, near: Any) -> None:
        space, random = self.room.space, self.np_random
        distances_m = space.distances_to_m(near)
        start = random_cell(space, random, ~near)
        self._walker = Walker(start[0], start[1], float(random.uniform(-180.0, 180.0)), EYE_M)
        cell = space.cell_of(start)
        assert cell is not None
        reach = np.where(near, space.distances_m(start), np.inf)
        row, column = divmod(int(np.argmin(reach)), reach.shape[1])
        shortest_m = way_length_m(space, start, space.position_of(row, column))
        self._navigation = Navigation(space, distances_m, shortest_m, float(distances_m[cell]))
        self._goal = category
        first = self.room.objects[category][0]
        self._goal_id = self.room.snapshot.contents.instances[first].instance.category_id
        self._declared = False

    def _act(self, action: Any) -> None:
        if self.discrete:
            ahead, left, down = _MOVES[int(action)]
            self._declared = int(action) == 0
        else:
            ahead, left, down, found = (float(share) for share in action)
            self._declared = found > 0.5
        if not self._declared:
            self._walker.turn(left * self._turn_deg, down * self._turn_deg)
            self._walker.walk(self.room.space, ahead * self._stride_m)

    def _judge(self, look: Look) -> tuple[float, bool]:
        category = look.views["category"]
        self._pixels = int(np.count_nonzero(category == self._goal_id))
        if not self._steps:
            return 0.0, False
        seen = self._pixels >= self._seen_share * category.size
        arrived = seen and self._navigation.distance_m == 0.0
        reward = self._navigation.judge(self._walker, ended=self._declared, arrived=arrived)
        return reward, self._declared

    def _info(self) -> Info:
        return {
            **self._navigation.info(self._walker),
            "category": self._goal,
            "goal_pixels": self._pixels,
        }

    def _eye_pose(self) -> Pose:
        return self._walker.eye_pose(self.room.space.body.floor_m)

    def _other_observations(self, look: Look) -> dict[str, Any]:
        return {"goal": self._goal_id}

    def _lacking(self) -> str:
        names = ", ".join(self._wanted) or "an object"
        return f"rooms with a place near {names}; these have none"
