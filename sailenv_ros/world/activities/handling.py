"""Taking a thing in the hand, and putting it down: where one stands for it, and the hand's way."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S
from sailenv_ros.postures.easing import smoother_step
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.grasping import Grip, with_fingers
from sailenv_ros.postures.reaching import reaching_posture, with_carrying_arm
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import invert
from sailenv_ros.world.activities.base import Actor, Held, Instant, Place
from sailenv_ros.world.activities.hand import GRIP_S, REACH_S, HandActivity, reaching_hand
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.surfaces import free_spots

__all__ = ["Putting", "Taking", "can_be_taken", "ways_to_put", "ways_to_take"]

Doubles = NDArray[np.float64]

_HEAVIEST_KG, _WIDEST_M, _LONGEST_M = 4.0, 0.11, 0.45
"""Of what one hand takes: its mass, its width between palm and fingers, its longest side."""

_FARTHEST_M = 0.85
"""From a free place to what one takes there, at most [m]."""

_NEAR_M, _LEANS_M = 0.6, 0.1
"""From where one stands to what one takes, as far as one can get so near: by a step towards the
table, which is so much nearer than one walks past it [m]."""

_ALONGSIDE = 0.8
"""Cosine from which a thing's longer side is along the fingers."""

_ABOVE_M = 0.003
"""From which a thing is let go [m]."""


class _Handling(HandActivity):
    """A hand that goes somewhere and comes back."""

    def __init__(
        self, actor: Actor, name: str, goal: Doubles, grip: Grip, feet: Place, yaw: float
    ) -> None:
        super().__init__(actor, GRIP_S)
        self._goal, self._grip = goal, grip
        self.feet, self.yaw, self.piece = feet, yaw, name
        self._turn = np.eye(3)
        self._reaches: Posture | None = None

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once it is done, or cannot be done."""
        if self._done_s == 0.0:
            self._turn = world_from_body[:3, :3]
            own = invert(world_from_body)
            goal = (own[:3, :3] @ self._goal + own[:3, 3]) / self._actor.scale
            stands = walking_posture(self._actor.rig, moment, 0.0)
            self._reaches = reaching_posture(self._actor.rig, stands, moment, goal, self._grip)
        self._done_s += STEP_S
        return self._reaches is not None and self._goes_on

    @property
    def _gripped(self) -> bool:
        return self._done_s >= REACH_S + 0.5 * GRIP_S

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        rig = self._actor.rig
        stands = walking_posture(rig, now.moment, now.time_s, seed=now.seed, look=now.look)
        begin = with_carrying_arm(rig, stands, self._grip) if self._carries else stands
        if self._reaches is None:
            return begin
        share = smoother_step(self._share_of_time)
        reaches = with_fingers(rig, self._reaches, self._grip, self._holds)
        return self._between(begin, reaches, share, now.moment)

    @property
    @abstractmethod
    def _carries(self) -> bool:
        """Whether something is in the hand now."""

    @property
    @abstractmethod
    def _holds(self) -> float:
        """How far the fingers are closed where the hand is at the thing."""


class Taking(_Handling):
    """A person who takes a thing; parameters as `_Handling`, and the thing."""

    def __init__(self, actor: Actor, body: Body, grip: Grip, feet: Place, yaw: float) -> None:
        super().__init__(actor, body.placement.name, _middle(body), grip, feet, yaw)
        self._body = body
        self._held: Held | None = None

    def held(self, before: Held | None) -> Held | None:
        """Return what is in the hand now."""
        if not self._gripped or self._reaches is None:
            return before
        if self._held is None:
            matrix = self._body.world_from_body()
            self._held = Held(
                name=self.piece,
                grip=self._grip,
                middle=_own_middle(self._body),
                turn=self._turn.T @ matrix[:3, :3],
            )
        return self._held

    @property
    def _carries(self) -> bool:
        return self._gripped

    @property
    def _holds(self) -> float:
        return self._closed(REACH_S)


class Putting(_Handling):
    """A person who puts down what it holds; parameters as `_Handling`, what is held, and where."""

    def __init__(self, actor: Actor, held: Held, goal: Doubles, feet: Place, yaw: float) -> None:
        super().__init__(actor, held.name, goal, held.grip, feet, yaw)

    def held(self, before: Held | None) -> Held | None:
        """Return what is in the hand now."""
        return None if self._gripped and self._reaches is not None else before

    @property
    def _carries(self) -> bool:
        return not self._gripped

    @property
    def _holds(self) -> float:
        return 1.0 - self._closed(REACH_S)


def grip_of(body: Body, scale: float, yaw: float) -> Grip:
    """Return how a hand of one who looks somewhere holds a thing: by its narrower level side."""
    half = 0.5 * _size(body) / scale
    narrow = int(half[1] < half[0])
    across = np.array([-np.sin(yaw), np.cos(yaw)])
    # A thing that is turned the other way is held as if it were round.
    flat = abs(float(across @ body.world_from_body()[:2, narrow])) > _ALONGSIDE
    return Grip(
        half_m=float(half[narrow]),
        half_length_m=float(half[1 - narrow] if flat else half[narrow]),
        half_height_m=float(half[2]),
    )


def can_be_taken(body: Body) -> bool:
    """Return whether a hand can take a thing."""
    placement, size = body.placement, _size(body)
    return (
        not placement.static
        and placement.joint is None
        and placement.asset.rig is None
        and body.collides
        and body.mass_kg <= _HEAVIEST_KG
        and float(min(size[0], size[1])) <= _WIDEST_M
        and float(size.max()) <= _LONGEST_M
    )


def ways_to_take(actor: Actor, crowd: Crowd, size: BodySize, name: str) -> Iterator[Taking]:
    """Yield the ways to take a thing, from the nearest places to stand."""
    body = crowd.body(name)
    if body is None or not can_be_taken(body):
        return
    goal = _middle(body)
    x, y, _ = goal.tolist()
    for place in crowd.places_beside(actor.name, size, (x, y), _FARTHEST_M):
        feet, yaw = _before(place, (x, y))
        grip = grip_of(body, actor.scale, yaw)
        side = reaching_hand(actor, grip, feet, yaw, goal[None])
        if side is not None:
            yield Taking(actor, body, grip.by(side), feet, yaw)


def ways_to_put(
    actor: Actor, crowd: Crowd, size: BodySize, held: Held, name: str
) -> Iterator[Putting]:
    """Yield the ways to put what is held on a piece."""
    body, thing = crowd.body(name), crowd.body(held.name)
    if body is None or thing is None:
        return
    extent = _size(thing)
    around = 0.5 * float(np.hypot(extent[0], extent[1]))
    for spot in free_spots(body, crowd.bodies(without=held.name), around):
        x, y, _ = spot.tolist()
        for place in crowd.places_beside(actor.name, size, (x, y), _FARTHEST_M, count=1):
            goal = spot + np.array([0.0, 0.0, 0.5 * float(extent[2]) + _ABOVE_M])
            feet, yaw = _before(place, (x, y))
            if reaching_hand(actor, held.grip, feet, yaw, goal[None], (held.grip.side,)):
                yield Putting(actor, held, goal, feet, yaw)


def _before(place: Place, goal: Place) -> tuple[Place, float]:
    """Return where one stands who comes by a free place, and which way one looks [rad]."""
    x, y = goal[0] - place[0], goal[1] - place[1]
    away = max(float(np.hypot(x, y)), 1e-6)
    nearer = float(np.clip(away - _NEAR_M, 0.0, _LEANS_M)) / away
    return (place[0] + nearer * x, place[1] + nearer * y), float(np.arctan2(y, x))


def _size(body: Body) -> Doubles:
    """Return (3,): the sides of a thing's box [m]."""
    return np.asarray(np.ptp(body.placement.asset.model.bounds(), axis=0) * body.placement.scale)


def _own_middle(body: Body) -> Doubles:
    bounds = body.placement.asset.model.bounds()
    return np.asarray(bounds.mean(axis=0) * body.placement.scale)


def _middle(body: Body) -> Doubles:
    matrix = body.world_from_body()
    return np.asarray(matrix[:3, :3] @ _own_middle(body) + matrix[:3, 3])
