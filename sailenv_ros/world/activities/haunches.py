"""Sitting on the floor, as animals do: the paws behind step up, and the rump goes down."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.animal_figure import animal_figure_of
from sailenv_ros.postures.easing import smoother_step
from sailenv_ros.postures.footsteps import FootPrint, Moment, Way
from sailenv_ros.postures.four_legs import four_legged_posture
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.world.activities.base import Actor, Instant, Place, SpotActivity

__all__ = ["FLOOR", "Haunches", "steps_up"]

Doubles = NDArray[np.float64]

FLOOR = "floor"
"""Name of the seat that animals have everywhere."""

_DOWN_S = 1.1
_STEP_UP = 0.53
"""How far the paws behind come forward, over the distance between the paws."""


class Haunches(SpotActivity):
    """An animal that sits where it stands.

    Parameters
    ----------
    actor : Actor
    place : (2,) tuple of float
        Where it stands [m].
    """

    def __init__(self, actor: Actor, place: Place) -> None:
        self._rig = actor.rig
        self.feet = place
        self._done_s = 0.0
        self._rises = False

    @property
    def word(self) -> Activity:
        """Word for it now."""
        if self._rises:
            return "getting up"
        return "seated" if self._done_s >= _DOWN_S else "sitting down"

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the animal stands again."""
        self._done_s = min(self._done_s + (-STEP_S if self._rises else STEP_S), _DOWN_S)
        return self._done_s > 0.0

    def end(self) -> None:
        """Begin to get up."""
        self._rises = True

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        share = smoother_step(max(self._done_s, 0.0) / _DOWN_S)
        return four_legged_posture(
            *(self._rig, now.moment, now.time_s),
            seed=now.seed,
            look_deg=now.look_deg,
            sits=share,
        )


def steps_up(actor: Actor, feet: tuple[FootPrint, ...]) -> Way:
    """Return the steps of the paws behind to where they are to be for it [m]."""
    stride = animal_figure_of(actor.rig).stride.scaled(actor.scale)
    prints = []
    for number in (2, 3):
        ahead, behind = feet[number - 2], feet[number]
        x, y = (
            behind_part + _STEP_UP * (ahead_part - behind_part)
            for ahead_part, behind_part in ((ahead.x, behind.x), (ahead.y, behind.y))
        )
        prints.append((number, FootPrint(x, y, behind.yaw)))
    return Way(start=feet, prints=tuple(prints), step_s=stride.step_s)
