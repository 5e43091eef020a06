"""Attention of a person or an animal: at what or whom it looks, and how its look gets there.

People look where they are told to. Animals that are told nothing look now and then at others who
are near, and are glad.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.postures.look import AHEAD, Look
from sailenv_ros.world.crowd import Crowd

__all__ = ["Attention"]

Doubles = NDArray[np.float64]

_STEPS = 12
"""Steps of physics after which it sees where the other is now."""

_NEAR_M, _SIDE_DEG = 2.6, 115.0
"""How near, and how far from straight ahead, one is whom an animal looks at."""

_SPELL_S, _OFTEN = 5.0, 0.75
"""Time for which an animal looks at somebody or elsewhere [s], and share of these times."""

_IN_PASSING = 0.5
"""Gladness of one who walks by, and looks ahead."""


class Attention:
    """Attention of one person or animal.

    Parameters
    ----------
    name : str
        Of it.
    seed : int
        Sets animals apart.
    eyes_m : float
        Height of its eyes over its feet.
    by_itself : bool
        True if it looks at others without being told to.

    Attributes
    ----------
    target : str
        Name of what it was told to look at; empty for nothing.
    look : Look
        Where it looks now.
    """

    def __init__(self, name: str, seed: int, eyes_m: float, *, by_itself: bool) -> None:
        self._name, self._seed, self._eyes_m = name, seed, eyes_m
        self._by_itself = by_itself
        self.forget()

    def forget(self) -> None:
        """Look ahead at once."""
        self.target = ""
        self.look = self._wanted = AHEAD
        self._steps = 0

    def advance(
        self, crowd: Crowd | None, world_from_body: Doubles, time_s: float, *, walks: bool
    ) -> None:
        """Look a step of physics later.

        Parameters
        ----------
        crowd : Crowd or None
        world_from_body : (4, 4) float64
        time_s : float
            Simulated time [s].
        walks : bool
            True of one who looks where it goes, unless it was told to look elsewhere.
        """
        if crowd is not None and self._steps % _STEPS == 0:
            self._wanted = self._sought(crowd, world_from_body, time_s, walks)
        self._steps += 1
        self.look = self.look.towards(self._wanted, STEP_S)

    def _sought(self, crowd: Crowd, matrix: Doubles, time_s: float, walks: bool) -> Look:
        if self.target:
            face = crowd.face(self.target)
            if face is None:
                return AHEAD
            glad = self._by_itself and self.target in crowd.people
            return self._at(face, matrix)._replace(heed=1.0, gladness=float(glad))
        if not self._by_itself or not self._is_curious(time_s):
            return AHEAD
        place = float(matrix[0, 3]), float(matrix[1, 3])
        face = crowd.nearest_face(self._name, place, _NEAR_M)
        if face is None:
            return AHEAD
        look = self._at(face, matrix)
        if abs(look.left_deg) > _SIDE_DEG:
            return AHEAD
        return Look(gladness=_IN_PASSING) if walks else look._replace(heed=1.0, gladness=1.0)

    def _at(self, face: Doubles, matrix: Doubles) -> Look:
        """Return the direction of a place in the world."""
        x, y, z = (matrix[:3, :3].T @ (face - matrix[:3, 3])).tolist()
        away = max(math.hypot(x, y), 0.2)
        down = math.degrees(math.atan2(self._eyes_m - z, away))
        return Look(math.degrees(math.atan2(y, x)), down)

    def _is_curious(self, time_s: float) -> bool:
        """Return whether it looks at others now: by turns, as if at random."""
        spell = math.floor(time_s / _SPELL_S + 0.37 * self._seed)
        return math.sin(12.9898 * spell + 4.1 * self._seed) * 43758.5453 % 1.0 < _OFTEN
