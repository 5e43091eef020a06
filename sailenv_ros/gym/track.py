"""``sailenv/Track-v0``: keep a moving object in the middle of the picture by turning the eye.

Reward is exact: 1 − the angle between the optical axis and the object's centre over half the
field of view, at least −1. The object moves on straight lines between random places that a body
can reach, at its own speed and height; the eye stands still and turns.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from typing_extensions import Unpack

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.gym.eye import Look
from sailenv_ros.gym.ground import away_from, random_cell
from sailenv_ros.gym.room import OwnObject
from sailenv_ros.gym.room_env import Info, RoomEnv
from sailenv_ros.gym.room_settings import STEP_NS, RoomSettings
from sailenv_ros.gym.walker import Walker
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import Bounds

__all__ = ["TrackEnv"]

SPEED = Bounds(above=0.0, most=10.0, unit="m/s")
TURN = Bounds(above=0.0, most=90.0, unit="deg")

ASSETS = ("sphere", "cube", "cylinder", "cone")
COLOURS = ("#d1352b", "#2a9d3f", "#2b59c3", "#f2b705", "#8a3ffc")
SIZE_M = 0.3
EYE_M = 1.2
CENTRED_DEG = 5.0
"""Angle up to which the object counts as centred [deg]."""

CLEAR_M = 0.9
"""The object keeps this far from the eye [m]."""

_TURNS = ((0, 0), (1, 0), (-1, 0), (0, -1), (0, 1))
"""Stay, left, right, up, down: to the left and downwards."""


class TrackEnv(RoomEnv):
    """Keep a moving object centred.

    Discrete actions: 0 stay, 1 left, 2 right, 3 up, 4 down. Continuous ones: (left, down), each a
    share −1 to 1 of the largest turn. ``info`` has ``angle_error_deg``, ``centred`` (up to 5°),
    ``centred_share`` of the steps so far, ``target_pixels`` and ``success`` (the share is at least
    a half).

    Parameters
    ----------
    speed_m_s : float
        Of the object, up to 10 [m/s].
    turn_deg : float
        Largest turn of a step [deg].
    assets : sequence of str
        What moves: one for each room, in turn.
    **settings
        See `RoomEnv`.
    """

    needs = frozenset({"instance"})

    def __init__(
        self,
        *,
        speed_m_s: float = 0.8,
        turn_deg: float = 4.0,
        assets: Sequence[str] = ASSETS,
        **settings: Unpack[RoomSettings],
    ) -> None:
        self._speed_m_s = SPEED.number("speed_m_s", speed_m_s)
        self._turn_deg = TURN.number("turn_deg", turn_deg)
        if isinstance(assets, str) or not assets:
            raise InvalidRequest("assets", assets, "a list of at least one asset")
        self._assets = tuple(assets)
        super().__init__(**settings)
        self._half_fov_deg = self.eye.intrinsics.vertical_fov_deg / 2.0
        self._eye = Walker(0.0, 0.0, 0.0, EYE_M)
        self._route = _Route(np.zeros((2, 3)))
        self._target = np.eye(4)
        self._error_deg = 180.0
        self._centred = self._pixels = 0

    def _actions(self) -> spaces.Space[Any]:
        return spaces.Discrete(5) if self.discrete else spaces.Box(-1.0, 1.0, (2,), np.float32)

    def _own_objects(self, name: str) -> tuple[OwnObject, ...]:
        number = self.room_names.index(name)
        asset = self._assets[number % len(self._assets)]
        size = (SIZE_M, SIZE_M, SIZE_M)
        return (OwnObject("target", asset, size, COLOURS[number % len(COLOURS)]),)

    def _begin(self) -> bool:
        space = self.room.space
        x_m, y_m, _ = random_cell(space, self.np_random)
        free = away_from(space, (x_m, y_m), CLEAR_M)
        if not (free.regions == 1).any():
            return False
        self._height_m = float(self.np_random.uniform(0.4, 1.5))
        self._free = free
        self._route = _Route(np.array([random_cell(free, self.np_random)]))
        self._advance(0.0)
        ahead = self._target[:3, 3] - (x_m, y_m, space.body.floor_m + EYE_M)
        off_deg = self.np_random.uniform(-0.8, 0.8, 2) * self._half_fov_deg
        self._eye = Walker(x_m, y_m, 0.0, EYE_M)
        self._eye.turn(
            math.degrees(math.atan2(ahead[1], ahead[0])) + off_deg[0],
            math.degrees(-math.atan2(ahead[2], math.hypot(ahead[0], ahead[1]))) + off_deg[1],
        )
        self._centred = 0
        return True

    def _act(self, action: Any) -> None:
        left, down = _TURNS[int(action)] if self.discrete else (float(a) for a in action)
        self._eye.turn(left * self._turn_deg, down * self._turn_deg)
        self._advance(self._speed_m_s * STEP_NS * 1e-9)

    def _judge(self, look: Look) -> tuple[float, bool]:
        camera = look.past.camera
        offset = camera.camera_from_world @ np.append(self._target[:3, 3], 1.0)
        self._error_deg = math.degrees(math.atan2(math.hypot(offset[0], offset[1]), offset[2]))
        row = self.room.rows["target"]
        self._pixels = int(np.count_nonzero(look.views["instance"] == self.room.ids[row]))
        self._centred += self._steps > 0 and self._error_deg <= CENTRED_DEG
        return max(-1.0, 1.0 - self._error_deg / self._half_fov_deg), False

    def _info(self) -> Info:
        share = self._centred / max(1, self._steps)
        return {
            "angle_error_deg": self._error_deg,
            "centred": self._error_deg <= CENTRED_DEG,
            "centred_share": share,
            "target_pixels": self._pixels,
            "success": share >= 0.5,
        }

    def _eye_pose(self) -> Pose:
        return self._eye.eye_pose(self.room.space.body.floor_m)

    def _places(self) -> Mapping[int, NDArray[np.float64]]:
        return {self.room.rows["target"]: self._target}

    def _advance(self, metres: float) -> None:
        """Move the object on along its route, to further places at its end."""
        while not self._route.holds(metres):
            start = self._route.end
            goal = random_cell(self._free, self.np_random)
            self._route.extend(self._free.path(start, goal))
        place = self._route.advance(metres)
        self._target = np.eye(4)
        self._target[:3, 3] = place[0], place[1], self.room.space.body.floor_m + self._height_m


class _Route:
    """Straight lines between places (N, 3), and how far along them something is [m]."""

    def __init__(self, places: NDArray[np.float64]) -> None:
        self._gone_m = 0.0
        self._places = places[:1]
        self._at_m = np.zeros(1)
        self.extend(places)

    @property
    def end(self) -> tuple[float, float, float]:
        """The last place."""
        x, y, z = self._places[-1].tolist()
        return x, y, z

    def extend(self, places: NDArray[np.float64]) -> None:
        """Add places after the last one, which is the first of these; forget what is done."""
        kept = max(0, int(np.searchsorted(self._at_m, self._gone_m, side="right")) - 1)
        self._places = np.concatenate([self._places[kept:], places[1:]])
        lengths_m = np.linalg.norm(np.diff(self._places, axis=0), axis=1)
        gone_m = self._gone_m - self._at_m[kept]
        self._at_m, self._gone_m = np.concatenate([[0.0], np.cumsum(lengths_m)]), float(gone_m)

    def holds(self, metres: float) -> bool:
        """Return whether it leads so much further."""
        return bool(self._gone_m + metres <= self._at_m[-1])

    def advance(self, metres: float) -> NDArray[np.float64]:
        """Advance, and return the place (3,) then."""
        self._gone_m += metres
        return np.array([np.interp(self._gone_m, self._at_m, row) for row in self._places.T])
