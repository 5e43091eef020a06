"""Walking tasks that end at a place: distances to it, the way so far, success and SPL.

SPL, success weighted by path length, is S·l / max(p, l) with the length l of the shortest path and
that of the agent's, p (Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.gym.ground import distance_at
from sailenv_ros.gym.walker import Walker
from sailenv_ros.space.free_space import FreeSpace

__all__ = ["STEP_COST", "SUCCESS_REWARD", "Navigation"]

STEP_COST = 0.01
"""Taken off the reward of each step."""

SUCCESS_REWARD = 10.0


@dataclass(slots=True)
class Navigation:
    """A way to walk.

    Attributes
    ----------
    space : FreeSpace
    distances_m : (H, W) float64
        How far each cell is from where the way shall end [m].
    shortest_m : float
        Length of the shortest path from the start [m].
    distance_m : float
        How far the walker still is [m].
    ended : bool
        True once it said that it has arrived.
    success : bool
        Whether it had then.
    """

    space: FreeSpace
    distances_m: NDArray[np.float64]
    shortest_m: float
    distance_m: float
    ended: bool = False
    success: bool = False

    def judge(self, walker: Walker, *, ended: bool, arrived: bool) -> float:
        """Return the reward of a step: how much nearer it came [m], less a cost, and the end's."""
        before = self.distance_m
        self.distance_m = distance_at(self.space, self.distances_m, walker.x_m, walker.y_m)
        self.ended, self.success = ended, ended and arrived
        return before - self.distance_m - STEP_COST + SUCCESS_REWARD * self.success

    def info(self, walker: Walker) -> dict[str, float]:
        """Return the figures of a table of navigation."""
        longest = max(walker.walked_m, self.shortest_m)
        spl = float(self.success) if longest == 0.0 else self.success * self.shortest_m / longest
        return {
            "success": self.success,
            "spl": spl,
            "distance_to_goal_m": self.distance_m,
            "path_length_m": walker.walked_m,
            "shortest_path_m": self.shortest_m,
            "bumps": walker.bumps,
        }
