"""Lying: which beds one can lie on, and getting in, lying, getting up.

One sits down on the edge first, draws up the knees, turns along the bed and lies back. On the way
the body stays above what is below it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.blending import JointTurns
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.lying import SINK_M, Ground, depths, lying_posture, tucked_posture
from sailenv_ros.postures.skeleton import Posture, turn_about
from sailenv_ros.postures.standing import breathing
from sailenv_ros.types.rig import Rig
from sailenv_ros.world.activities.base import Actor, Instant, Place, SpotActivity
from sailenv_ros.world.activities.sitting import HIGHEST, Sitting
from sailenv_ros.world.beds import Lane
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.seats import Seat
from sailenv_ros.world.skin import contact_skin
from sailenv_ros.world.surfaces import is_empty

__all__ = ["LIE_S", "Lying", "lanes_for", "ways_to_lie"]

Doubles = NDArray[np.float64]

LIE_S = 4.2
"""Time from sitting on the edge to lying, and back [s]."""

_TUCKED, _TURNED = 0.3, 0.62
"""Shares of that time at which the knees are drawn up, and the body is along the bed."""

_SAMPLES = 49
_RISE_M = 0.006
"""How far the body rises from one sample to the next at most [m]."""

_BESIDE_M = (0.05, 0.2)
"""Depth from which something is not below the body but beside it, as the back of a couch is: of one
who lies, and of one on the way [m]."""

_HEAD_TOP = 0.115
"""From the head's joint to the top of the head, over the joint's height."""

_OVER_M, _TOES = 0.06, 0.05
"""How far feet may reach over an open end [m]; their length when stretched, over the height."""

_SPACING_M, _BESIDE_LANE_M = 0.15, 0.15
"""Between places at which a lane must be empty, and how far around them [m]."""

_NECK_M = -0.04
"""From the end of the pillow to the neck [m]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class _Plan:
    """How one gets from the edge into a bed, in the frame of the body before the edge."""

    stages: tuple[JointTurns, JointTurns, JointTurns]
    lifts: Doubles

    def lift(self, share: float) -> float:
        """Return how far the body is raised at a share of the way [m]."""
        return float(
            np.interp(share * (len(self.lifts) - 1), np.arange(len(self.lifts)), self.lifts)
        )


class Lying(SpotActivity):
    """A person in a bed.

    Parameters
    ----------
    actor : Actor
    lane : Lane
    seat : Seat
        Of `Lane.seat`.
    hips_m : float
        From the lane's head to the hips [m].
    """

    def __init__(self, actor: Actor, lane: Lane, seat: Seat, hips_m: float) -> None:
        self._actor, self._lane = actor, lane
        self._hips = lane.head - hips_m * lane.way
        self._sitting = Sitting(actor, seat, lane.field.at)
        self.feet, self.yaw, self.piece = self._sitting.feet, self._sitting.yaw, lane.name
        self.takes = _taken(lane, hips_m)
        self._done_s = 0.0
        self._rises = False
        self._plan: _Plan | None = None

    @property
    def word(self) -> Activity:
        """Word for it now."""
        if self._rises:
            return "getting up"
        return "lying" if self._done_s >= LIE_S else "lying down"

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once the person stands again."""
        if self._plan is None:
            self._plan = self._made(world_from_body)
        if self._rises and self._done_s <= 0.0:
            self._sitting.end()
            return self._sitting.advance(world_from_body, moment)
        if self._sitting.word == "seated":
            step = -STEP_S if self._rises else STEP_S
            self._done_s = float(np.clip(self._done_s + step, 0.0, LIE_S))
            return True
        return self._sitting.advance(world_from_body, moment)

    def end(self) -> None:
        """Begin to get up."""
        self._rises = True

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body before the bed."""
        sits = self._sitting.posture(now)
        if self._plan is None or self._done_s <= 0.0:
            return sits
        share = self._done_s / LIE_S
        rig = self._actor.rig
        found = _between(rig, JointTurns.of(rig, sits), self._plan.stages, share)
        breath = breathing(now.time_s, now.seed)
        turns = dict(found.turns)
        chest = turns["spine01"] @ turn_about("y", 0.25 * breath * share) @ turns["spine01"].T
        for name in _above_chest(rig):
            turns[name] = chest @ turns[name]
        lift = np.array([0.0, 0.0, self._plan.lift(share)])
        return Posture(root_m=found.root_m + lift, turns=turns)

    def _made(self, world_from_body: Doubles) -> _Plan:
        """Plan the way into the bed."""
        actor, rig, scale = self._actor, self._actor.rig, self._actor.scale
        turn, origin = world_from_body[:2, :2], world_from_body[:2, 3]

        def own(over: Callable[[Doubles], Doubles]) -> Callable[[Doubles], Doubles]:
            return lambda at: (over(scale * at @ turn.T + origin) - actor.floor_m) / scale

        heights, skin = own(self._lane.field.at), contact_skin(actor.asset)
        ground = Ground(heights=heights, skin=skin.places, joints=skin.joints)
        hips = turn.T @ (self._hips - origin) / scale
        head_way = turn.T @ self._lane.way
        lies = lying_posture(rig, ground, hips, head_way)
        exact = depths(replace(ground, heights=own(self._lane.field.exact)), lies)
        raised = np.array([0.0, 0.0, _too_deep(exact, _BESIDE_M[0])])
        lies = replace(lies, root_m=lies.root_m + raised)
        seated = self._sitting.seated_posture()
        at_edge = seated.root_m - rig.heads[0] + actor.figure.hips
        soles = float(heights(hips[None])[0]) + 0.06
        height = max(float(at_edge[2]), soles + 0.06) + 0.04
        away = np.degrees(np.arctan2(-head_way[1], -head_way[0]))
        stages = (
            tucked_posture(rig, np.array([*at_edge[:2], height]), np.eye(3), soles),
            tucked_posture(rig, np.array([*hips, height]), turn_about("z", float(away)), soles),
            lies,
        )
        first, second, third = (JointTurns.of(rig, stage) for stage in stages)
        begin = JointTurns.of(rig, seated)
        needed = np.zeros(_SAMPLES)
        hanging = [f"{bone}.{side}" for side in "LR" for bone in ("lowerleg01", "foot", "toe1-1")]
        shanks = np.isin(ground.joints, [rig.joint_of[name] for name in hanging])
        for number in range(1, _SAMPLES):
            share = number / (_SAMPLES - 1)
            depth = depths(ground, _between(rig, begin, (first, second, third), share))
            if share < _TUCKED:
                depth = depth[~shanks]  # they hang before the edge
            needed[number] = _too_deep(depth, _BESIDE_M[1])
        # Between two samples, what the worse of them needs.
        lifts = np.maximum(needed, np.maximum(np.roll(needed, 1), np.append(needed[1:], 0.0)))
        lifts[-1] = needed[-1]
        # From how deep one sits, not at once.
        lifts = np.minimum(lifts, _RISE_M * np.arange(_SAMPLES))
        return _Plan(stages=(first, second, third), lifts=lifts)


def lanes_for(actor: Actor, crowd: Crowd) -> list[tuple[Lane, float]]:
    """Return the lanes that one has room in and that nobody else has taken.

    Each is with the distance from its head to the hips [m].
    """
    figure, found = actor.figure, []
    neck = actor.scale * float(actor.rig.head("neck01")[2])
    tall = actor.scale * figure.height_m + _HEAD_TOP * actor.scale * figure.height_m
    hips = actor.scale * float(figure.hips[2])
    for lane in crowd.lanes():
        # The shoulders where the pillow ends, as far as there is room for the feet.
        to_neck = max(lane.pillow_m + _NECK_M, tall - neck + 0.02)
        feet = _OVER_M if lane.open_end else -_TOES * actor.scale * figure.height_m
        to_neck = min(to_neck, lane.length_m + feet - neck)
        places = _taken(lane, to_neck + neck - hips)
        free = all(crowd.is_free(actor.name, place) for place in places)
        if to_neck >= tall - neck - 0.02 and free and _is_empty(lane, crowd):
            found.append((lane, to_neck + neck - hips))
    return found


def _taken(lane: Lane, hips_m: float) -> tuple[Place, ...]:
    """Return the places of head, hips and feet of one who lies with the hips there."""
    return tuple(
        (float(x), float(y))
        for x, y in (lane.head + (away - hips_m) * lane.way for away in (-0.6, 0.0, 0.6))
    )


def _is_empty(lane: Lane, crowd: Crowd) -> bool:
    """Return whether nothing lies on a lane."""
    way = np.arange(0.1, lane.length_m, _SPACING_M)
    places = lane.head - way[:, None] * lane.way
    spots = np.column_stack([places, lane.field.at(places)])
    return is_empty(spots, crowd.bodies(without=lane.name), _BESIDE_LANE_M)


def ways_to_lie(actor: Actor, crowd: Crowd, name: str) -> list[Lying]:
    """Return the ways to lie on a piece, the nearest first."""
    highest = HIGHEST * actor.figure.leg_m * actor.scale
    found = []
    for lane, hips_m in lanes_for(actor, crowd):
        for edge in lane.edges if lane.name == name else ():
            seat = lane.seat(edge, hips_m)
            if seat is not None and seat.height_m - actor.floor_m <= highest:
                found.append(Lying(actor, lane, _perch(actor, seat), hips_m))
    own = crowd.people.get(actor.name)
    x, y = (0.0, 0.0) if own is None else (own.x, own.y)
    return sorted(found, key=lambda way: np.hypot(way.feet[0] - x, way.feet[1] - y))


def _perch(actor: Actor, seat: Seat) -> Seat:
    """Return a seat on an edge: the higher it is, the nearer to the edge one sits."""
    knee = actor.scale * float(actor.rig.head("lowerleg01.L")[2])
    above = seat.height_m - actor.floor_m - 0.8 * knee
    return replace(seat, depth_m=float(np.clip(0.36 - 1.6 * above, 0.06, seat.depth_m)))


def _between(
    rig: Rig,
    begin: JointTurns,
    stages: tuple[JointTurns, JointTurns, JointTurns],
    share: float,
) -> Posture:
    """Return the posture at a share of the way from the edge into the bed."""
    tucked, turned, lies = stages
    if share < _TUCKED:
        return begin.towards(tucked, smooth_step(share / _TUCKED)).posture(rig)
    if share < _TURNED:
        turning = smooth_step((share - _TUCKED) / (_TURNED - _TUCKED))
        return tucked.towards(turned, turning).posture(rig)
    return turned.towards(lies, smooth_step((share - _TURNED) / (1.0 - _TURNED))).posture(rig)


def _too_deep(found: Doubles, beside_m: float) -> float:
    """Return how far a body is to be raised, by the depths of its vertices [m]."""
    return max(float(found[found < beside_m].max(initial=0.0)) - 1.5 * SINK_M, 0.0)


def _above_chest(rig: Rig) -> list[str]:
    """Return the joints that the chest carries, and its own."""
    chest = rig.joint_of["spine01"]
    found = {chest}
    for number, parent in enumerate(rig.parents.tolist()):
        if parent in found:
            found.add(number)
    return [rig.names[number] for number in sorted(found)]
