"""Opening and closing what moves on a joint: the hand goes to its edge, and along with it."""

from __future__ import annotations

from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S, JointMotion, running_motion
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.grasping import Grip, Side, with_fingers
from sailenv_ros.postures.reaching import reaching_posture
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.space.free_space import BodySize
from sailenv_ros.types.geometry import Pose, invert
from sailenv_ros.world.activities.base import Actor, Instant, Place
from sailenv_ros.world.activities.hand import GRIP_S, REACH_S, HandActivity, reaching_hand
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.crowd import Crowd
from sailenv_ros.world.kinematics import link_pose
from sailenv_ros.world.placement import JointPlacement

__all__ = ["Opening", "ways_to_open"]

Doubles = NDArray[np.float64]

_MOVE_S = 2.2
"""Time in which it opens or closes [s]."""

_NEAREST_M, _FARTHEST_M = 0.3, 0.68
"""From where one stands to what the hand holds [m]."""

_CLEAR_M = 0.26
"""From where one stands to a door that swings, or a drawer that is open, at least [m]."""

_EDGE_M, _BEFORE_M = 0.05, 0.03
"""From the edge, and before the face, to the middle of what the hand holds [m]."""

_MOST_WAYS = 3
_LOW_M, _HIGH_M = 0.55, 1.35
_GRIP = Grip(half_m=0.01, half_length_m=0.01, half_height_m=0.1)
_SHARES = (1.0, 0.8, 0.6, 0.45)
"""How far it is opened, where there is room for it."""


class Jointed(Protocol):
    """A body on a hinge or a slide."""

    joint: JointPlacement

    def joint_state(self) -> tuple[float, float]:
        """Return position and velocity."""

    def rest_pose(self) -> Pose:
        """Return where it is while the position is 0."""


class Opening(HandActivity):
    """A person who opens or closes something.

    Parameters
    ----------
    actor : Actor
    body : Body
        On a hinge or a slide.
    handle : (3,) float64
        What the hand holds, in the frame of the body, scale included [m].
    goal : float
        Position of the joint at the end [rad] or [m].
    feet : (2,) tuple of float
        Where one stands for it [m].
    yaw : float
        Which way one looks [rad].
    side : {'L', 'R'}
        The hand.
    """

    def __init__(
        self,
        actor: Actor,
        body: Body,
        handle: Doubles,
        goal: float,
        feet: Place,
        yaw: float,
        side: Side,
    ) -> None:
        super().__init__(actor, _MOVE_S)
        self._body, self._handle, self._grip = body, handle, _GRIP.by(side)
        self.feet, self.yaw, self.piece = feet, yaw, body.placement.name
        first = cast(Jointed, body).joint_state()[0]
        motion = JointMotion(first=first, position=goal, seconds=_MOVE_S)
        self._motion = running_motion(motion, 0.0)
        self._own = np.eye(4)
        self._first: Posture | None = None

    def advance(self, world_from_body: Doubles, moment: Moment) -> bool:
        """Continue by a step; return False once it is done, or cannot be done."""
        if self._done_s == 0.0:
            self._own = invert(world_from_body)
            stands = walking_posture(self._actor.rig, moment, 0.0)
            self._first = self._reached(stands, moment)
        if self._first is None:
            return False
        moved_s = self._done_s - REACH_S
        if 0.0 <= moved_s < _MOVE_S + 0.5 * STEP_S:
            self._body.behave(self._motion, moved_s, lambda agent, distance_m: np.zeros((0, 4)))
        self._done_s += STEP_S
        return self._goes_on

    def posture(self, now: Instant) -> Posture:
        """Return the posture, in the frame of the body."""
        rig = self._actor.rig
        stands = walking_posture(rig, now.moment, now.time_s, seed=now.seed, look=now.look)
        if self._first is None:
            return stands
        reaches = self._reached(stands, now.moment) or self._first
        holds = self._closed(REACH_S - GRIP_S) - self._closed(REACH_S + _MOVE_S)
        reaches = with_fingers(rig, reaches, self._grip, holds)
        return self._between(stands, reaches, smooth_step(self._share_of_time), now.moment)

    def _reached(self, stands: Posture, moment: Moment) -> Posture | None:
        matrix = self._own @ self._body.world_from_body()
        goal = (matrix[:3, :3] @ self._handle + matrix[:3, 3]) / self._actor.scale
        return reaching_posture(self._actor.rig, stands, moment, goal, self._grip)


def ways_to_open(actor: Actor, crowd: Crowd, size: BodySize, name: str) -> list[Opening]:
    """Return the ways to open what is closed, or to close what is open; the widest first."""
    body = crowd.body(name)
    joint = None if body is None else body.placement.joint
    if body is None or joint is None or not joint.spec.moves or joint.spec.limits is None:
        return []
    closed, opened = sorted(joint.spec.bounds, key=abs)
    now = cast(Jointed, body).joint_state()[0]
    opens = abs(now - closed) < 0.5 * abs(opened - closed)
    handle = _handle(body, joint, np.sign(opened - closed))
    found = []
    for share in _SHARES if opens else (0.0,):
        goal = closed + share * (opened - closed)
        path = np.array([_at(body, joint, handle, q) for q in np.linspace(now, goal, 7)])
        middle = path.mean(axis=0)
        axis = _at(body, joint, np.asarray(joint.spec.origin) * body.placement.scale, now)
        box = _box(body, joint, max(now, goal, key=abs))
        for feet in crowd.places_beside(actor.name, size, (middle[0], middle[1]), 1.1, count=16):
            if _fits(np.asarray(feet), path[:, :2], axis[:2], box, joint):
                yaw = float(np.arctan2(middle[1] - feet[1], middle[0] - feet[0]))
                side = reaching_hand(actor, _GRIP, feet, yaw, path[::3])
                if side is not None:
                    found.append(Opening(actor, body, handle, goal, feet, yaw, side))
            if len(found) >= _MOST_WAYS:
                return found
    return found


def _fits(feet: Doubles, path: Doubles, axis: Doubles, box: Doubles, joint: JointPlacement) -> bool:
    """Return whether the hand gets to all of a path, and nothing moves into the body."""
    away = np.linalg.norm(path - feet, axis=1)
    if away.min() < _NEAREST_M or away.max() > _FARTHEST_M:
        return False
    if joint.spec.type == "slide":
        return bool(
            np.linalg.norm(np.maximum(np.maximum(box[0] - feet, feet - box[1]), 0.0)) > _CLEAR_M
        )
    ways = path - axis
    lengths = np.maximum(np.linalg.norm(ways, axis=1), 1e-6)
    along = np.clip(((feet - axis) * ways).sum(axis=1) / lengths**2, 0.0, 1.1)
    nearest = np.linalg.norm(axis + along[:, None] * ways - feet, axis=1)
    return bool(nearest.min() >= _CLEAR_M)


def _at(body: Body, joint: JointPlacement, own: Doubles, position: float) -> Doubles:
    """Return where a point of a body is at a position of its joint, world [m]."""
    matrix = link_pose(cast(Jointed, body).rest_pose(), joint, position).matrix()
    return np.asarray(matrix[:3, :3] @ own + matrix[:3, 3])


def _box(body: Body, joint: JointPlacement, position: float) -> Doubles:
    """Return (2, 2): lowest and highest x and y of a body at a position of its joint [m]."""
    bounds = body.placement.asset.model.bounds() * np.asarray(body.placement.scale)
    corners = np.array([
        _at(body, joint, np.array([bounds[i, 0], bounds[k, 1], 0.0]), position)
        for i in (0, 1) for k in (0, 1)
    ])  # fmt: skip
    return np.stack([corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)])


def _handle(body: Body, joint: JointPlacement, sign: float) -> Doubles:
    """Return what the hand holds: the edge away from the hinge, or the middle of the front."""
    scale = np.asarray(body.placement.scale)
    low, high = body.placement.asset.model.bounds() * scale
    middle, axis = 0.5 * (low + high), sign * np.asarray(joint.spec.unit_axis)
    half = 0.5 * (high - low)
    if joint.spec.type == "slide":
        return np.asarray(middle + axis * (np.abs(axis) @ half + _BEFORE_M))
    origin = np.asarray(joint.spec.origin) * scale
    arm = middle - origin
    arm = arm - (arm @ axis) * axis
    out = arm / max(float(np.linalg.norm(arm)), 1e-6)
    way = np.cross(axis, out)
    place = middle + out * (np.abs(out) @ half - _EDGE_M) + way * (np.abs(way) @ half + _BEFORE_M)
    height = float(body.world_from_body()[2, 3])
    if abs(axis[2]) > 0.9:  # at the height of a hand, as far as the door has that
        place[2] = float(np.clip(place[2], _LOW_M - height, _HIGH_M - height))
        place[2] = float(np.clip(place[2], low[2] + 0.03, high[2] - 0.03))
    return np.asarray(place)
