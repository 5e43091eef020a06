"""Perching, as cats do: they jump on a couch or a bed, lie there, and jump down again."""

from __future__ import annotations

import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.animal_bearing import tail_habit
from sailenv_ros.postures.animal_figure import animal_figure_of
from sailenv_ros.postures.footsteps import (
    FootPrint,
    Moment,
    Way,
    moment_of,
    standing_feet,
    way_to_turn,
)
from sailenv_ros.postures.gaits import gait_of
from sailenv_ros.postures.leaping import Leap, leap_over_edge, leaping_posture
from sailenv_ros.postures.reclining import Recline
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.world.activities.base import Actor, Instant, SpotActivity, matrix_of
from sailenv_ros.world.activities.floor import LyingOnFloor
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.perches import Perch
from sailenv_ros.world.surfaces import is_empty

__all__ = ["Perching", "perches_for", "ways_to_perch"]

Doubles = NDArray[np.float64]

_CLIMBERS = frozenset({"cat"})
"""Categories of animals that jump on furniture."""

_BEFORE_M, _BEYOND_M = 0.05, 0.2
"""From the body to the edge before it jumps up; how much farther it is after it has jumped down,
where its longer end is towards the edge [m]."""


class Perching(SpotActivity):
    """An animal on a piece of furniture.

    Parameters
    ----------
    actor : Actor
    perch : Perch
    before_m : float
        From where it stands on the floor to the edge [m].

    Attributes
    ----------
    lands : (2,) tuple of float
        Where it comes down again [m].
    """

    travels = True

    def __init__(self, actor: Actor, perch: Perch, before_m: float) -> None:
        self._actor, self._perch = actor, perch
        x, y, height_m = perch.place
        self.feet, self.lands = (
            (x + away_m * perch.out[0], y + away_m * perch.out[1])
            for away_m in (perch.edge_m + before_m, perch.edge_m + before_m + _BEYOND_M)
        )
        self._out_yaw = float(np.arctan2(perch.out[1], perch.out[0]))
        self.yaw: float = self._out_yaw + np.pi
        self.piece, self.takes = perch.name, ((x, y),)
        figure, scale = animal_figure_of(actor.rig), actor.scale
        self._stride = figure.stride.scaled(scale)
        self._up, self._down = (
            leap_over_edge(
                figure,
                (perch.edge_m + away_m) / scale,
                (height_m - actor.floor_m) / scale,
                away_m / scale,
                down=down,
            )
            for away_m, down in ((before_m, False), (before_m + _BEYOND_M, True))
        )
        self._rest = LyingOnFloor(actor, (x, y))
        self._stages: Iterator[_Stage] = iter(())
        self._stage: _Stage | None = None
        self._rises = False

    @property
    def word(self) -> Activity:
        """Word for it now."""
        if self._rises:
            return "getting up"
        return self._rest.word if isinstance(self._stage, _Resting) else "lying down"

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the animal is on the floor again."""
        if self._stage is None:
            self._stages = self._begun(world_from_body, moment)
            self._stage = next(self._stages)
        if not self._stage.advance():
            following = next(self._stages, None)
            if following is None:
                return False
            self._stage = following
        return True

    def end(self) -> None:
        """Begin to get up."""
        self._rises = True
        self._rest.end()

    def moved(self, begin: Doubles) -> Doubles:
        """Return the pose of the body now."""
        return begin if self._stage is None else self._stage.matrix()

    def standing(self, now: Doubles) -> Doubles:
        """Return the pose on the floor in which it began."""
        if self._stage is None:
            return now
        feet = standing_feet(*self.feet, self.yaw, self._stride)
        return matrix_of(moment_of(feet, self._stride.lead_m), self._actor.floor_m)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        if self._stage is None:
            return _standing(self._actor, now)
        return self._stage.posture(now)

    def _begun(self, world_from_body: Doubles, moment: Moment) -> Iterator[_Stage]:
        """Yield what it does, one after another."""
        actor, stride, (x, y, z) = self._actor, self._stride, self._perch.place
        recline = self._rest.recline
        yield _Leaping(actor, self._up, recline, world_from_body, moment, (x, y, self.yaw))
        side = 1.0 if zlib.crc32(f"{actor.name} {x:.2f} {y:.2f}".encode()) % 2 else -1.0
        along = self._out_yaw + side * 0.5 * np.pi
        way = way_to_turn(standing_feet(x, y, self.yaw, stride), along, stride)
        way = way.then(self._rest.steps(_end(way)))
        yield _Stepping(actor, way, z)
        yield _Resting(actor, _end(way), stride.lead_m, z, self._rest)
        # Back to the middle of the perch, and towards the edge.
        prints = tuple((number, stride.foot(x, y, along, number)) for number in stride.order)
        back = replace(way, start=_end(way), prints=prints)
        out = back.then(way_to_turn(_end(back), self._out_yaw, stride))
        yield _Stepping(actor, out, z)
        stands = moment_of(_end(out), stride.lead_m)
        own = stands.scaled(1.0 / actor.scale)
        end = (*self.lands, self._out_yaw)
        yield _Leaping(actor, self._down, recline, matrix_of(stands, z), own, end)


class _Stage(ABC):
    """A part of it."""

    def __init__(self, actor: Actor) -> None:
        self._actor = actor
        self._done_s = 0.0

    @abstractmethod
    def advance(self) -> bool:
        """Continue by a step; return False once it is done."""

    @abstractmethod
    def matrix(self) -> Doubles:
        """Return the pose of the body now."""

    @abstractmethod
    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""


class _Leaping(_Stage):
    """A leap from a pose to a place and a direction there; `moment` is that of an unscaled body."""

    def __init__(
        self,
        actor: Actor,
        leap: Leap,
        recline: Recline,
        begin: Doubles,
        moment: Moment,
        end: tuple[float, float, float],
    ) -> None:
        super().__init__(actor)
        self._leap, self._recline = leap, recline
        self._begin, self._end = begin, end
        self._stands = moment

    def advance(self) -> bool:
        """Continue by a step; return False once it has landed."""
        self._done_s += STEP_S
        return self._done_s < self._leap.duration_s

    def matrix(self) -> Doubles:
        """Return the pose of the body now."""
        instant = self._leap.at(self._done_s)
        flown = instant.ahead_m / self._leap.ahead_m
        begin = self._begin
        yaw = float(np.arctan2(begin[1, 0], begin[0, 0]))
        turn = (self._end[2] - yaw + np.pi) % (2.0 * np.pi) - np.pi
        x, y = (begin[k, 3] + flown * (self._end[k] - begin[k, 3]) for k in (0, 1))
        here = replace(self._stands, x=float(x), y=float(y), yaw=yaw + flown * turn)
        return matrix_of(here, self._actor.floor_m + self._actor.scale * instant.above_m)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        instant = self._leap.at(self._done_s)
        flown = instant.ahead_m / self._leap.ahead_m
        room = now.moment.swing_room * (flown if self._leap.down else 1.0 - flown)
        moment = replace(self._stands, swing_room=room)
        return leaping_posture(
            *(self._actor.rig, moment, now.time_s, instant, self._recline),
            seed=now.seed,
            look=now.look,
            tail=tail_habit(self._actor.asset.category),
        )


class _Stepping(_Stage):
    """Steps at a height."""

    def __init__(self, actor: Actor, way: Way, height_m: float) -> None:
        super().__init__(actor)
        self._way, self._height_m = way, height_m

    def advance(self) -> bool:
        """Continue by a step; return False at the end of the way."""
        self._done_s += STEP_S
        return self._done_s < self._way.duration_s

    def matrix(self) -> Doubles:
        """Return the pose of the body now."""
        return matrix_of(self._way.at(self._done_s), self._height_m)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        return _standing(self._actor, _at(now, self._way.at(self._done_s), self._actor))


class _Resting(_Stage):
    """Lying at a height."""

    def __init__(
        self,
        actor: Actor,
        feet: tuple[FootPrint, ...],
        lead_m: float,
        height_m: float,
        rest: LyingOnFloor,
    ) -> None:
        super().__init__(actor)
        self._stands, self._height_m, self._rest = moment_of(feet, lead_m), height_m, rest

    def advance(self) -> bool:
        """Continue by a step; return False once it stands again."""
        return self._rest.advance(self.matrix(), self._stands)

    def matrix(self) -> Doubles:
        """Return the pose of the body now."""
        return matrix_of(self._stands, self._height_m)

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        return self._rest.posture(_at(now, self._stands, self._actor))


def _end(way: Way) -> tuple[FootPrint, ...]:
    return way.feet_after(len(way.prints))


def _at(now: Instant, moment: Moment, actor: Actor) -> Instant:
    """Return an instant with feet elsewhere, and without room for a tail."""
    return replace(now, moment=replace(moment.scaled(1.0 / actor.scale), swing_room=0.0))


def _standing(actor: Actor, now: Instant) -> Posture:
    posture = gait_of(actor.asset).posture
    return posture(actor.rig, now.moment, now.time_s, seed=now.seed, look=now.look)


def perches_for(actor: Actor, crowd: Crowd, size: BodySize) -> list[Perch]:
    """Return the perches that an animal has room on and that nobody else has taken."""
    if actor.asset.category not in _CLIMBERS:
        return []
    return [
        perch
        for perch in crowd.perches(size.radius_m)
        if crowd.is_free(actor.name, perch.place[:2]) and _is_empty(perch, crowd, size)
    ]


def _is_empty(perch: Perch, crowd: Crowd, size: BodySize) -> bool:
    """Return whether nothing lies on a perch, nor between it and the edge."""
    edge = np.array(perch.place) + perch.edge_m * np.array([*perch.out, 0.0])
    spots = np.array([perch.place, edge])
    return is_empty(spots, crowd.bodies(without=perch.name), size.radius_m)


def ways_to_perch(actor: Actor, crowd: Crowd, size: BodySize, name: str) -> list[Perching]:
    """Return the ways to jump on a piece and lie there, the nearest first."""
    before_m = size.radius_m + _BEFORE_M
    found = [
        Perching(actor, perch, before_m)
        for perch in perches_for(actor, crowd, size)
        if perch.name == name
    ]
    own = crowd.people.get(actor.name)
    x, y = (0.0, 0.0) if own is None else (own.x, own.y)
    free = [way for way in found if crowd.is_clear(size, np.array([way.feet, way.lands]))]
    return sorted(free, key=lambda way: np.hypot(way.feet[0] - x, way.feet[1] - y))
