"""An activity on the spot: where the feet stand for it, how it continues, its postures."""

from __future__ import annotations

import math
import zlib
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.figure import Figure, figure_of
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.grasping import Grip, Side
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.types.model import Asset
from sailenv_ros.types.rig import Rig
from sailenv_ros.world.ways import Place

__all__ = ["Actor", "Held", "Instant", "Place", "SpotActivity", "matrix_of"]

Doubles = NDArray[np.float64]

_AHEAD = 0.4
"""How far beside the body something is still straight ahead, over half the width of the hips."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Actor:
    """A person who does something.

    Attributes
    ----------
    name : str
    asset : Asset
        With a rig.
    scale : float
    floor_m : float
        Height of the floor that it stands on [m].
    """

    name: str
    asset: Asset
    scale: float
    floor_m: float

    @property
    def rig(self) -> Rig:
        """The skeleton."""
        assert self.asset.rig is not None
        return self.asset.rig

    @property
    def figure(self) -> Figure:
        """Its measures, before the scale."""
        return figure_of(self.rig)

    def hands(self, goal: Doubles) -> tuple[Side, Side]:
        """Return the hand that is nearer to a place of the body frame, and the other.

        Straight ahead it is the right one, of one in ten people the left.
        """
        beside = float(goal[1])
        if abs(beside) < _AHEAD * self.figure.half_width_m:
            left = zlib.crc32(self.name.encode()) % 10 == 0
        else:
            left = beside > 0.0
        return ("L", "R") if left else ("R", "L")


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """State that all postures depend on.

    Attributes
    ----------
    moment : Moment
        Of the feet, before the scale [m].
    time_s : float
        Simulated time [s].
    seed : int
        Sets people's breaths apart.
    look : Look
        Where one looks.
    """

    moment: Moment
    time_s: float
    seed: int
    look: Look


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Held:
    """A thing in the hand of a person.

    Attributes
    ----------
    name : str
    grip : Grip
    middle : (3,) float64
        Of the thing, in its own frame, scale included [m].
    turn : (3, 3) float64
        Of the thing from the axes of the person.
    """

    name: str
    grip: Grip
    middle: Doubles
    turn: Doubles


class SpotActivity(ABC):
    """Something that a person does where it stands.

    Attributes
    ----------
    feet : (2,) tuple of float
        Where the person stands for it [m].
    yaw : float or None
        Which way it looks there [rad]; None for any.
    piece : str
        Name of the object that limbs pass through meanwhile; empty for none.
    takes : tuple of (2,) tuples of float
        Places that nobody else is to use meanwhile [m].
    travels : bool
        True if the body ends elsewhere than it began.
    """

    feet: Place
    yaw: float | None = None
    piece: str = ""
    takes: tuple[Place, ...] = ()
    travels: bool = False

    @property
    @abstractmethod
    def word(self) -> Activity:
        """Word for it now."""

    @abstractmethod
    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once it is over.

        Parameters
        ----------
        world_from_body : (4, 4) float64
            Where the body is.
        moment : Moment
            Of its feet, before the scale.
        """

    @abstractmethod
    def end(self) -> None:
        """Begin to end it."""

    def moved(self, begin: Doubles) -> Doubles:
        """Return the pose of the body now, by the one in which it began."""
        return begin

    def standing(self, now: Doubles) -> Doubles:
        """Return the pose in which the body would stand on its floor, by the one now."""
        return now

    def held(self, before: Held | None) -> Held | None:
        """Return what is in the hand now, by what was in it when it began."""
        return before

    @abstractmethod
    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body where its feet stand."""


def matrix_of(moment: Moment, floor_m: float) -> Doubles:
    """Return (4, 4): world from a body whose feet are on a floor of some height [m]."""
    c, s = math.cos(moment.yaw), math.sin(moment.yaw)
    return np.array([
        [c, -s, 0.0, moment.x],
        [s, c, 0.0, moment.y],
        [0.0, 0.0, 1.0, floor_m],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip
