"""Way of a person or an animal through the world: where it walks and looks, what it does there.

Told by behaviours, moved by time. Knows the crowd around, and not the engine. What it does where a
way ends is an activity of `world.activities`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity, ClipPlay
from sailenv_ros.postures.reaching import with_carrying_arm
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.activities.base import Held, Instant, SpotActivity
from sailenv_ros.world.activities.floor import (
    FLOOR,
    LyingOnFloor,
    RestingOnFloor,
    SittingOnFloor,
)
from sailenv_ros.world.activities.handling import ways_to_put, ways_to_take
from sailenv_ros.world.activities.lying import lanes_for, ways_to_lie
from sailenv_ros.world.activities.opening import ways_to_open
from sailenv_ros.world.activities.perching import perches_for, ways_to_perch
from sailenv_ros.world.activities.playing import Playing
from sailenv_ros.world.activities.sitting import seats_for, ways_to_sit
from sailenv_ros.world.crowd import Inhabitant
from sailenv_ros.world.stepper import Place, Stepper, yaw_of

__all__ = ["Walker"]

Doubles = NDArray[np.float64]

_STAND_OFF_M = 0.42
"""Distance from which one looks at a thing [m]."""


class Walker(Stepper):
    """One person, or an animal, on its way; a `behaviours.person.Person`.

    Parameters
    ----------
    name : str
        Of it.
    asset : Asset
        With a rig.
    scale : float
    pose : Pose
        Where it stands at first.

    Attributes
    ----------
    matrix_before : (4, 4) float64
        World from the body a step ago.
    pass_through : callable
        ``pass_through(name, passes)`` lets limbs pass through a piece of furniture, or not.
    """

    def __init__(self, name: str, asset: Asset, scale: float, pose: Pose) -> None:
        super().__init__(name, asset, scale)
        self.pass_through: Callable[[str, bool], None] = lambda name, passes: None
        self._time_s = 0.0
        self._does: SpotActivity | None = None
        self.held: Held | None = None
        self.stand_at(pose)

    def stand_at(self, pose: Pose) -> None:
        """Stand at a pose from now on."""
        self.leave()
        self._let_go()
        self._stand_at(pose)
        self.matrix_before = self.matrix

    def advance(self, time_s: float) -> None:
        """Do what is to be done in the step that begins at a simulated time [s]."""
        self._time_s = time_s + STEP_S
        self.matrix_before = self.matrix
        walks = self._way is not None
        self._attention.advance(self.crowd, self.matrix, self._time_s, walks=walks)
        if walks:
            self._walk_on()
        elif self._does is not None:
            goes_on = self._does.advance(self.matrix, self._own_moment())
            self.matrix = self._does.moved(self._matrix_of_moment())
            self.held = self._does.held(self.held)
            if not goes_on:
                self.leave()
        if self.crowd is not None:
            x, y = self._place
            eyes_m = float(self.matrix[2, 3]) + self._gait.eyes_m * self._scale
            self.crowd.people[self._name] = Inhabitant(x, y, self._radius_m, eyes_m)

    @property
    def posture(self) -> Posture:
        """Where its root and joints are now, in the body frame before the scale."""
        now = Instant(
            moment=self._own_moment(),
            time_s=self._time_s,
            seed=self._seed,
            look=self._attention.look,
        )
        if self._does is not None and self._way is None:
            return self._does.posture(now)
        posture = self._gait.posture(
            self._actor.rig, now.moment, now.time_s, seed=now.seed, look=now.look
        )
        if self.held is None:
            return posture
        return with_carrying_arm(self._actor.rig, posture, self.held.grip)

    @property
    def standing_pose(self) -> Pose:
        """Pose in which it would stand on the floor if it did nothing."""
        does = None if self._way is not None else self._does
        return Pose.from_matrix(self.matrix if does is None else does.standing(self.matrix))

    # -- what behaviours tell it (see behaviours.person.Person) --------------------------------

    @property
    def activity(self) -> Activity:
        """Activity now."""
        if self._way is not None:
            return "walking"
        return "standing" if self._does is None else self._does.word

    def random_place(self, rng: np.random.Generator) -> Place | None:
        """Return a free place that it can reach [m]; None if there is none."""
        if self.crowd is None:
            return None
        return self.crowd.random_place(self._size, self._place, rng)

    def walk_to(self, place: Place) -> bool:
        """Begin to walk to a place [m]; False, and nothing begins, if no way leads there."""
        return self._walk(place, None)

    def walk_near(self, name: str) -> bool:
        """Begin to walk to where it stands before an object and faces it; False if it cannot."""
        if self.crowd is None:
            return False
        before = self.crowd.before(name, _STAND_OFF_M + self._radius_m)
        return before is not None and self._walk(*before)

    def sit_on(self, name: str) -> bool:
        """Begin to walk to a seat and sit down; False if it cannot."""
        if self._on_four:
            return name == FLOOR and self._rest(SittingOnFloor)
        return self.crowd is not None and self._go_and(ways_to_sit(self._actor, self.crowd, name))

    def lie_on(self, name: str) -> bool:
        """Begin to walk to a bed and lie down; False if it cannot."""
        if self._on_four and name == FLOOR:
            return self._rest(LyingOnFloor)
        if self.crowd is None:
            return False
        if self._on_four:
            return self._go_and(ways_to_perch(self._actor, self.crowd, self._size, name))
        return self._go_and(ways_to_lie(self._actor, self.crowd, name))

    def play(self, play: ClipPlay) -> bool:
        """Begin to walk to where a clip is played, and play it; False if it cannot."""
        if self.crowd is None:
            return False
        playing = Playing(self._actor, play, self._place, yaw_of(self.matrix))
        if not self.crowd.is_clear(self._size, playing.way()):
            self.problem = f"there is no room for the clip {play.clip!r}"
            return False
        return self._go_and([playing])

    @property
    def holds(self) -> str:
        """Name of what it has in its hand; empty for nothing."""
        return "" if self.held is None else self.held.name

    def take(self, name: str) -> bool:
        """Begin to walk to a thing and take it in the hand; False if it cannot."""
        if self.crowd is None or self.held is not None:
            return False
        return self._go_and(ways_to_take(self._actor, self.crowd, self._size, name))

    def put_on(self, name: str) -> bool:
        """Begin to walk to a piece and put on it what it holds; False if it cannot."""
        if self.crowd is None or self.held is None:
            return False
        return self._go_and(ways_to_put(self._actor, self.crowd, self._size, self.held, name))

    def open(self, name: str) -> bool:
        """Begin to walk to a door or a drawer and open or close it; False if it cannot."""
        if self.crowd is None or self.held is not None:
            return False
        return self._go_and(ways_to_open(self._actor, self.crowd, self._size, name))

    def get_up(self) -> None:
        """Begin to get up, if it sits or lies."""
        if self._does is not None and self._way is None:
            self._does.end()

    def seats(self) -> tuple[str, ...]:
        """Return the names of seats that nobody has taken."""
        if self.crowd is None:
            return ()
        if self._on_four:
            return (FLOOR,)
        return tuple(dict.fromkeys(seat.name for seat in seats_for(self._actor, self.crowd)))

    def beds(self) -> tuple[str, ...]:
        """Return the names of what it can lie on and nobody has taken."""
        if self.crowd is None:
            return ()
        if self._on_four:
            perches = perches_for(self._actor, self.crowd, self._size)
            return (FLOOR, *dict.fromkeys(perch.name for perch in perches))
        lanes = lanes_for(self._actor, self.crowd)
        return tuple(dict.fromkeys(lane.name for lane, _ in lanes))

    def things(self) -> tuple[str, ...]:
        """Return the names of furniture that one may look at."""
        return () if self.crowd is None else self.crowd.things()

    def look_at(self, name: str) -> None:
        """Look at an object from now on; the empty name looks ahead."""
        self._attention.target = name

    # -- inside ----------------------------------------------------------------------------

    def _walk(self, place: Place, yaw: float | None) -> bool:
        """Begin to walk to a place, round others if that leads there."""
        return any(self._begins(place, yaw, round_others=do) for do in (True, False))

    def _begins(self, place: Place, yaw: float | None, *, round_others: bool) -> bool:
        """Begin to walk to a place; False if no way leads there, or something is being done."""
        return self._does is None and self._go(place, yaw, round_others=round_others)

    @property
    def _on_four(self) -> bool:
        return self._actor.rig.legs == 4

    def _rest(self, kind: type[RestingOnFloor]) -> bool:
        """Begin to rest on the floor; False if something is being done."""
        if self._does is not None or self._way is not None:
            return False
        self._does = kind(self._actor, self._place)
        self._way, self._way_s, self._goal = self._does.steps(self._feet), 0.0, None
        return True

    def _stopped(self) -> None:
        self.leave()

    def _go_and(self, ways: Iterable[SpotActivity]) -> bool:
        """Begin to go where something is done, by the first way to do it that can be reached."""
        if self.crowd is None or self._does is not None or self._way is not None:
            return False
        for activity, round_others in _attempts(ways):
            if self._begins(activity.feet, activity.yaw, round_others=round_others):
                self._does = activity
                self.crowd.taken[self._name] = activity.takes
                if activity.piece:
                    self.pass_through(activity.piece, True)
                return True
        return False

    def leave(self) -> None:
        """Do nothing on the spot any more."""
        if self._does is not None and self._does.travels and self._way is None:
            self._feet = self._feet_at(self.matrix)
        if self._does is not None and self._does.piece and self._does.piece != self.holds:
            self.pass_through(self._does.piece, False)
        self._does = None
        if self.crowd is not None:
            self.crowd.taken.pop(self._name, None)

    def _let_go(self) -> None:
        """Drop what it holds."""
        if self.held is not None:
            self.pass_through(self.held.name, False)
        self.held = None


def _attempts(ways: Iterable[SpotActivity]) -> Iterator[tuple[SpotActivity, bool]]:
    """Yield each way with True, to go round others to it; then each with False."""
    tried = []
    for way in ways:
        tried.append(way)
        yield way, True
    yield from ((way, False) for way in tried)
