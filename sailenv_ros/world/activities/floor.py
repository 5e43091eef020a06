"""Resting on the floor, as animals do: paws step into place, and the body goes down."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.animal_bearing import tail_habit
from sailenv_ros.postures.animal_figure import animal_figure_of
from sailenv_ros.postures.easing import smoother_step
from sailenv_ros.postures.footsteps import FootPrint, Moment, Way
from sailenv_ros.postures.four_legs import four_legged_posture
from sailenv_ros.postures.reclining import Recline, recline_of
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.types.rig import Rig
from sailenv_ros.world.activities.base import Actor, Instant, Place, SpotActivity
from sailenv_ros.world.skin import contact_skin

__all__ = ["FLOOR", "LyingOnFloor", "RestingOnFloor", "SittingOnFloor"]

Doubles = NDArray[np.float64]

FLOOR = "floor"
"""Name of the seat and the bed that animals have everywhere."""

_STEP_UP = 0.53
"""How far the paws behind come forward of one who sits, over the distance between the paws."""

_BELLY = ("spine02", "spine03", "belly")


class RestingOnFloor(SpotActivity):
    """An animal that rests where it stands.

    Parameters
    ----------
    actor : Actor
    place : (2,) tuple of float
        Where it stands [m].
    """

    _DOWN_S: float
    _WORDS: tuple[Activity, Activity]
    """Of one who goes down, and of one who rests."""

    def __init__(self, actor: Actor, place: Place) -> None:
        self._actor, self._rig = actor, actor.rig
        self.feet = place
        self._done_s = 0.0
        self._rises = False
        self._posture = partial(
            four_legged_posture, self._rig, tail=tail_habit(actor.asset.category)
        )

    @property
    def word(self) -> Activity:
        """Word for it now."""
        if self._rises:
            return "getting up"
        return self._WORDS[self._done_s >= self._DOWN_S]

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the animal stands again."""
        self._done_s = min(self._done_s + (-STEP_S if self._rises else STEP_S), self._DOWN_S)
        return self._done_s > 0.0

    def end(self) -> None:
        """Begin to get up."""
        self._rises = True

    @property
    def _share(self) -> float:
        return smoother_step(max(self._done_s, 0.0) / self._DOWN_S)

    def steps(self, feet: tuple[FootPrint, ...]) -> Way:
        """Return the steps of the paws to where they are to be for it [m]."""
        stride = animal_figure_of(self._rig).stride.scaled(self._actor.scale)
        prints = tuple((number, self._print(feet, number)) for number in self._order)
        return Way(start=feet, prints=prints, step_s=stride.step_s, lead_m=stride.lead_m)

    _order: tuple[int, ...]

    def _print(self, feet: tuple[FootPrint, ...], number: int) -> FootPrint:
        """Return where a paw is to be, by where all stand."""
        raise NotImplementedError


class SittingOnFloor(RestingOnFloor):
    """An animal on its haunches; parameters as `RestingOnFloor`."""

    _DOWN_S, _WORDS, _order = 1.1, ("sitting down", "seated"), (2, 3)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        return self._posture(now.moment, now.time_s, seed=now.seed, look=now.look, sits=self._share)

    def _print(self, feet: tuple[FootPrint, ...], number: int) -> FootPrint:
        ahead, behind = feet[number - 2], feet[number]
        x, y = (
            behind_part + _STEP_UP * (ahead_part - behind_part)
            for ahead_part, behind_part in ((ahead.x, behind.x), (ahead.y, behind.y))
        )
        return FootPrint(x, y, behind.yaw)


class LyingOnFloor(RestingOnFloor):
    """An animal upon its belly; parameters as `RestingOnFloor`.

    Attributes
    ----------
    recline : Recline
        How it lies.
    """

    _DOWN_S, _WORDS, _order = 1.5, ("lying down", "lying"), (2, 0, 3, 1)

    def __init__(self, actor: Actor, place: Place) -> None:
        super().__init__(actor, place)
        self.recline = _recline_of(actor, self._rig)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        lies = self._share, self.recline
        return self._posture(now.moment, now.time_s, seed=now.seed, look=now.look, lies=lies)

    def _print(self, feet: tuple[FootPrint, ...], number: int) -> FootPrint:
        place = feet[number]
        ahead = self._actor.scale * self.recline.ahead_m[number // 2]
        c, s = float(np.cos(place.yaw)), float(np.sin(place.yaw))
        return FootPrint(place.x + ahead * c, place.y + ahead * s, place.yaw)


def _recline_of(actor: Actor, rig: Rig) -> Recline:
    skin = contact_skin(actor.asset)
    own = np.isin(skin.joints, [rig.joint_of[name] for name in _BELLY])
    at_rest = skin.places(Posture(root_m=rig.heads[0]))
    return recline_of(rig, float(at_rest[own, 2].min()))
