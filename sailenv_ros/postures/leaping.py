"""Leaps of four legs: up, an animal crouches, rears, flies in an arc, and gives way as it lands.

Down from a height it does the same backwards, with its forelegs for its hind legs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sailenv_ros.postures.animal_bearing import TailHabit, animal_tail
from sailenv_ros.postures.animal_figure import AnimalFigure
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.four_legs import PawOffset, four_legged_posture
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.reclining import Recline
from sailenv_ros.postures.skeleton import Posture, turn_about
from sailenv_ros.postures.walking import own_print
from sailenv_ros.types.rig import Rig

__all__ = ["Leap", "LeapInstant", "leap_over_edge", "leaping_posture"]

_CROUCH_S, _REAR_S, _SETTLE_S = 0.42, 0.16, 0.32
_CROUCH, _GIVE = 0.5, 0.35
"""How far one has lain down who crouches, and who has landed."""

_STEEP = 0.75
"""Share of the slope of a leap by which one rears."""

_MOST_REAR_DEG = 46.0
_TUCK, _TRAIL, _REACH = 0.36, 0.3, 0.22
"""How far paws are drawn up, and are behind and ahead of their places, over the leg's height."""

_BEFORE = 0.4
"""How long before the flight the paws in front are raised, over its time."""

_CLEAR_M = 0.03
_LEAST_ARC_M = 0.06
_GRAVITY = 9.81


class LeapInstant(NamedTuple):
    """An animal at a time of a leap.

    Attributes
    ----------
    ahead_m, above_m : float
        From where the leap begins to where the body is; above the lower one of both ends [m].
    pitch_deg : float
        Nose upwards; about the paws behind, or downwards about those in front.
    crouch : float
        How far it has lain down.
    offsets : (2,) tuple of PawOffset
        Of the paws in front, and behind.
    """

    ahead_m: float
    above_m: float
    pitch_deg: float
    crouch: float
    offsets: tuple[PawOffset, PawOffset]


@dataclass(frozen=True, slots=True, kw_only=True)
class Leap:
    """A leap; one down is one up backwards.

    Attributes
    ----------
    ahead_m, up_m : float
        From the lower end to the higher one [m].
    arc_m : float
        How much higher than half way the flight is in its middle [m].
    down : bool
    """

    ahead_m: float
    up_m: float
    arc_m: float
    down: bool = False

    @property
    def flight_s(self) -> float:
        """Time in the air [s]: that of a thrown body."""
        return math.sqrt(8.0 * self.arc_m / _GRAVITY)

    @property
    def duration_s(self) -> float:
        """Time of all of it [s]."""
        return _CROUCH_S + _REAR_S + self.flight_s + _SETTLE_S

    def at(self, time_s: float) -> LeapInstant:
        """Return the animal at a time since the beginning [s]."""
        if not self.down:
            return self._up_at(time_s)
        up = self._up_at(self.duration_s - time_s)
        ahead_m = self.ahead_m - up.ahead_m
        fore, hind = (PawOffset(up=paw.up, ahead=-paw.ahead) for paw in reversed(up.offsets))
        return LeapInstant(ahead_m, up.above_m, -up.pitch_deg, up.crouch, (fore, hind))

    def _up_at(self, time_s: float) -> LeapInstant:
        crouched = min(max(time_s / _CROUCH_S, 0.0), 1.0)
        reared = min(max((time_s - _CROUCH_S) / _REAR_S, 0.0), 1.0)
        flown = min(max((time_s - _CROUCH_S - _REAR_S) / self.flight_s, 0.0), 1.0)
        settled = min(max((time_s - self.duration_s + _SETTLE_S) / _SETTLE_S, 0.0), 1.0)
        crouch = _CROUCH * smooth_step(crouched) * (1.0 - smooth_step(reared))
        crouch += _GIVE * math.sin(math.pi * settled) ** 2
        pitch, offsets = self._in_flight(flown, reared)
        above_m = self.up_m * flown + 4.0 * self.arc_m * flown * (1.0 - flown)
        return LeapInstant(self.ahead_m * flown, above_m, pitch, crouch, offsets)

    def _in_flight(
        self, flown: float, reared: float = 1.0
    ) -> tuple[float, tuple[PawOffset, PawOffset]]:
        """Return the pitch, and how paws are raised."""
        slope = math.degrees(math.atan2(self.up_m, self.ahead_m))
        most = min(_STEEP * slope, _MOST_REAR_DEG)
        pitch = most * smooth_step(reared) * (1.0 - smooth_step(flown))
        bump = math.sin(math.pi * (flown + _BEFORE * reared) / (1.0 + _BEFORE)) ** 2
        fore = PawOffset(up=_TUCK * bump, ahead=_REACH * bump)
        bump = math.sin(math.pi * flown)
        hind = PawOffset(up=_TUCK * bump**2, ahead=-_TRAIL * math.sin(2.0 * math.pi * flown) * bump)
        return pitch, (fore, hind)


def leap_over_edge(
    figure: AnimalFigure, ahead_m: float, up_m: float, edge_m: float, *, down: bool = False
) -> Leap:
    """Return the lowest leap whose paws clear an edge.

    Parameters
    ----------
    figure : AnimalFigure
    ahead_m, up_m : float
        From the lower end to the higher one, before the scale [m].
    edge_m : float
        From the lower end to the edge [m].
    down : bool
    """
    arc_m = _LEAST_ARC_M
    leap = Leap(ahead_m=ahead_m, up_m=up_m, arc_m=arc_m, down=down)
    fore, hind = ((figure.paws[n], float(figure.legs_m[n])) for n in (0, 2))
    # Up, about the paws behind; down, backwards, about those in front.
    pairs = (hind, fore) if down else (fore, hind)
    places = [place * [-1.0 if down else 1.0, 0.0, 1.0] for place, _ in pairs]
    for flown in np.linspace(0.05, 0.95, 19).tolist():
        pitch, offsets = leap._in_flight(flown)
        turn = turn_about("y", -pitch)
        for paw, place, (_, tall) in zip(offsets, places, pairs, strict=True):
            own = place - places[1] + [tall * paw.ahead, 0.0, tall * paw.up]
            x, _, z = (turn @ own + places[1] * [1.0, 0.0, 0.0]).tolist()
            if x + flown * ahead_m > edge_m - _CLEAR_M:
                needed = (up_m + _CLEAR_M) * (1.0 - flown) - z
                arc_m = max(arc_m, needed / (4.0 * flown * (1.0 - flown)))
    return replace(leap, arc_m=arc_m)


def leaping_posture(
    rig: Rig,
    moment: Moment,
    time_s: float,
    instant: LeapInstant,
    recline: Recline,
    *,
    seed: int,
    look: Look,
    tail: TailHabit,
) -> Posture:
    """Return the posture of an animal that leaps, in the frame of its body there.

    Parameters
    ----------
    rig : Rig
    moment : Moment
        Of feet that stand.
    time_s : float
        Of its breath and its tail [s].
    instant : LeapInstant
    recline : Recline
        How it lies.
    seed, look, tail
        As `four_legged_posture`.
    """
    level = four_legged_posture(
        *(rig, moment, time_s),
        seed=seed,
        look=look,
        tail=tail,
        lies=(instant.crouch, recline),
        offsets=instant.offsets,
    )
    # It stays up where the body goes down.
    upright = animal_tail(
        *(rig, level.turns["root"], 0.0, time_s),
        seed=seed,
        habit=tail,
        gladness=look.gladness,
        rests=0.0,
        room=moment.swing_room,
    )
    stands = moment.feet[2:] if instant.pitch_deg > 0.0 else moment.feet[:2]
    prints = [own_print(moment, place) for place in stands]
    pivot = np.array([0.5 * (prints[0].x + prints[1].x), 0.0, 0.0])
    turn = turn_about("y", -instant.pitch_deg)
    return Posture(
        root_m=pivot + turn @ (level.root_m - pivot),
        turns={name: turn @ own for name, own in {**level.turns, **upright}.items()},
    )
