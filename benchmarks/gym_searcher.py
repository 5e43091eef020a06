"""Memory of who searches in `benchmarks.gym_learning`.

All comes from what the environment observes, from the agent's actions, and from the length of its
way so far, as wheels tell it. Places are relative to where and how the episode began.
"""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

__all__ = ["ORDER", "REACH_M", "SIDE", "SIGNS", "Searcher"]

SIDE, REACH_M = 20, 5.0
FIELD_DEG, EYE_M, TURN_DEG, STRIDE_M, NEAR_M = 75.0, 1.2, 30.0, 0.25, 1.0
LEAST_PX = 2
"""Settings of `SearchEnv`, which asks for 0.5 % of the pixels."""

FOUND, AHEAD, LEFT, RIGHT, UP, DOWN = range(6)
SECTORS, CELL_M, CELLS = 24, 0.2, 100
RECENT = 12
"""Steps that it compares its place with."""

EXAMINED_M = 1.5
"""Farther away something small may be overlooked."""

MOST_POINTS = 2000

Reals = NDArray[np.float64]


def _mirror() -> tuple[NDArray[np.int64], Reals]:
    around = [SECTORS * row + -np.arange(SECTORS) % SECTORS for row in range(4)]
    goal, done, moved = np.split(np.arange(8 + 6 + 5) + 4 * SECTORS, (8, 14))
    order = np.concatenate([*around, goal, done[[FOUND, AHEAD, RIGHT, LEFT, UP, DOWN]], moved])
    signs = np.ones(len(order))
    signs[[goal[1], moved[-1]]] = -1.0  # what goes to the left
    return order, signs


ORDER, SIGNS = _mirror()
"""Mirror what is observed: the number for each place, and its factor."""


def _rays() -> Reals:
    """Return (SIDE², 2): how far to the left and down the ray of a pixel goes by 1 m of depth."""
    middles = np.linspace(-1.0, 1.0, 2 * SIDE + 1)[1::2] * math.tan(math.radians(FIELD_DEG / 2))
    down, right = np.meshgrid(middles, middles, indexing="ij")
    return np.stack([-right.ravel(), down.ravel()], axis=1)


RAYS = _rays()


class Searcher(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Observes what it remembers, as a vector.

    In each of 24 directions, to the left from ahead, the distances of the nearest thing in the way,
    of the farthest floor, of the nearest place not seen from nearby, and of what is wanted. Then
    where the nearest of that is, its last action, and how it moved.

    Parameters
    ----------
    env : gymnasium.Env
        ``sailenv/Search-v0`` with the views depth and category.
    curiosity : float
        More reward for what is seen from nearby, as long as nothing wanted was seen [1/m²].
    """

    def __init__(self, env: gymnasium.Env[Any, Any], curiosity: float = 0.0) -> None:
        super().__init__(env)
        self._curiosity = curiosity
        self.observation_space = gymnasium.spaces.Box(-1.0, 1.0, SIGNS.shape, np.float32)
        self._forget()

    def _forget(self) -> None:
        self.place, self.turns, self.tilts, self.steps = np.zeros(2), 0, 0, 0
        self.action, self.stopped, self._walked_m = -1, False, 0.0
        self._stuck, self._way = 0.0, [self.place]
        self._solid = np.zeros((CELLS, CELLS), bool)
        self._least_m = np.full((CELLS, CELLS), np.inf)
        self._goals = np.zeros((0, 3))

    def reset(self, **settings: Any) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode, in which nothing is known."""
        self._forget()
        seen, info = self.env.reset(**settings)
        self._remember(seen)
        return self.observed(), info

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Act, and remember what is seen then."""
        reward, terminated, truncated, info = self.act(action)
        return self.observed(), reward, terminated, truncated, info

    def act(self, action: Any) -> tuple[float, bool, bool, dict[str, Any]]:
        """Do as `step` does, for those who decide nothing from what is observed now."""
        seen, reward, terminated, truncated, info = self.env.step(action)
        self._move(int(action), info["path_length_m"])
        before = np.count_nonzero(self._least_m <= EXAMINED_M)
        self._remember(seen)
        if not len(self._goals):
            examined = int(np.count_nonzero(self._least_m <= EXAMINED_M)) - before
            reward = float(reward) + self._curiosity * examined * CELL_M**2
        return float(reward), terminated, truncated, info

    def observed(self) -> NDArray[np.float32]:
        """Return what it remembers."""
        return np.concatenate([self._around(), self._goal, self._own()]).astype(np.float32)

    def _move(self, action: int, walked_m: float) -> None:
        stride_m = walked_m - self._walked_m
        yaw = math.radians(self.turns * TURN_DEG)
        ahead = np.array([math.cos(yaw), math.sin(yaw)])
        self.place = self.place + stride_m * ahead
        self._way = [*self._way[1 - RECENT :], self.place]
        self.stopped = action == AHEAD and stride_m < 0.99 * STRIDE_M
        self._stuck = 0.8 * self._stuck + 0.2 * self.stopped
        if self.stopped:  # something is there, seen or not
            row, column = _cells((self.place + 0.3 * ahead)[None])[0]
            self._solid[row, column], self._least_m[row, column] = True, 0.0
        self.turns += (action == LEFT) - (action == RIGHT)
        self.tilts = min(2, max(-2, self.tilts + (action == DOWN) - (action == UP)))
        self.action, self._walked_m = action, walked_m
        self.steps += 1

    def _remember(self, seen: Any) -> None:
        mask = (seen["category"] == seen["goal"]).ravel()
        depth_m = np.asarray(seen["depth"], np.float64).ravel()
        points, aside_m = self._points(depth_m)
        hit = (depth_m > 0.0) & (depth_m < REACH_M)
        rows, columns = _cells(points[hit]).T
        in_way = (points[hit, 2] > 0.1) & (points[hit, 2] < 1.3)
        self._solid[rows[in_way], columns[in_way]] = True
        np.minimum.at(self._least_m, (rows, columns), aside_m[hit])
        self._goals = np.concatenate([self._goals, points[hit & mask]])[-MOST_POINTS:]
        self.goal_px = int(np.count_nonzero(mask))
        self._goal = self._nearest_goal()

    def _points(self, depth_m: Reals) -> tuple[Reals, Reals]:
        """Return where pixels are (N, 3), and their horizontal distances."""
        down = math.radians(self.tilts * TURN_DEG)
        ahead_m = depth_m * (math.cos(down) - RAYS[:, 1] * math.sin(down))
        height_m = EYE_M - depth_m * (math.sin(down) + RAYS[:, 1] * math.cos(down))
        left_m = depth_m * RAYS[:, 0]
        yaw = math.radians(self.turns * TURN_DEG)
        x = self.place[0] + ahead_m * math.cos(yaw) - left_m * math.sin(yaw)
        y = self.place[1] + ahead_m * math.sin(yaw) + left_m * math.cos(yaw)
        return np.stack([x, y, height_m], axis=1), np.hypot(ahead_m, left_m)

    def _polar(self, places: Reals) -> tuple[Reals, Reals, NDArray[np.int64]]:
        """Return distances of places, their directions [rad], and the numbers of these."""
        x, y = (places - self.place).T
        angle = np.arctan2(y, x) - math.radians(self.turns * TURN_DEG)
        sector = np.round(angle * (SECTORS / math.tau)).astype(np.int64) % SECTORS
        return np.hypot(x, y), angle, sector

    def _around(self) -> Reals:
        cells = np.argwhere(np.isfinite(self._least_m))
        distance_m, _, sector = self._polar(CELL_M * (cells.astype(np.float64) + 0.5 - CELLS / 2))
        solid = self._solid[cells[:, 0], cells[:, 1]]
        unknown = self._least_m[cells[:, 0], cells[:, 1]] > EXAMINED_M
        around_m = np.full((4, SECTORS), REACH_M)
        around_m[1] = 0.0
        np.minimum.at(around_m[0], sector[solid], distance_m[solid])
        np.maximum.at(around_m[1], sector[~solid], distance_m[~solid])
        np.minimum.at(around_m[2], sector[unknown], distance_m[unknown])
        distance_m, _, sector = self._polar(self._goals[:, :2])
        np.minimum.at(around_m[3], sector, distance_m)
        self.free_m = np.minimum(around_m[0], around_m[1])
        # Near places are told apart more finely.
        return np.sqrt(np.minimum(around_m / REACH_M, 1.0)).ravel()

    def _nearest_goal(self) -> Reals:
        """Return of the nearest of it: known, direction, distance twice, height, pixels, near."""
        self.goal_m, self.goal_angle, self.goal_down = math.inf, 0.0, 0.0
        if not len(self._goals):
            return np.zeros(8)
        distance_m, angle, _ = self._polar(self._goals[:, :2])
        nearest = int(np.argmin(distance_m))
        self.goal_m = float(distance_m[nearest])
        self.goal_angle = math.remainder(float(angle[nearest]), math.tau)
        self.goal_down = math.atan2(EYE_M - self._goals[nearest, 2], self.goal_m)
        return np.array(
            [
                1.0,
                math.sin(self.goal_angle),
                math.cos(self.goal_angle),
                math.sqrt(min(1.0, self.goal_m / REACH_M)),
                min(1.0, max(-1.0, 4.0 * (self.goal_m - NEAR_M))),
                self.goal_down / (math.pi / 2),
                min(1.0, self.goal_px / (4 * LEAST_PX)),
                self.goal_m < 0.95 * NEAR_M and self.goal_px >= LEAST_PX,
            ]
        )

    def _own(self) -> Reals:
        """Return: last action, stopped, now and lately, tilt, where it was."""
        far_m, angle, _ = self._polar(self._way[0][None])
        far = min(1.0, float(far_m[0]) / (RECENT * STRIDE_M))
        back = far * math.cos(angle[0]), far * math.sin(angle[0])
        actions = np.arange(6) == self.action
        return np.array([*actions, self.stopped, self._stuck, self.tilts / 2, *back])


def _cells(places: Reals) -> NDArray[np.int64]:
    """Return (N, 2): cells of the map that places (N, 2 or 3) are in."""
    cells = np.floor(places[:, :2] / CELL_M + CELLS / 2).astype(np.int64)
    return np.clip(cells, 0, CELLS - 1)
