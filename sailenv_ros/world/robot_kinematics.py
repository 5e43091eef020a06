"""Forward and inverse kinematics of robots: arithmetic alone, no engine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.postures.standing import about
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import RobotJoint, RobotLink, RobotModel

__all__ = ["all_positions", "base_from_frame", "carrier", "joint_links", "reaching"]

Doubles = NDArray[np.float64]

MOST_TURNS = 200
DAMPING = 0.02
CLOSE_M, CLOSE_RAD = 1e-5, 1e-4
STARTS = 8
LARGEST_STEP_RAD = 0.3


def joint_links(model: RobotModel) -> dict[str, RobotLink]:
    """Return the links on joints that move, by the names of the joints."""
    return {link.joint.name: link for link in model.moving}


def all_positions(model: RobotModel, given: Mapping[str, float]) -> dict[str, float]:
    """Return positions of all joints: what is not given is 0, or the nearest limit.

    Joints that follow others go with them.
    """
    found: dict[str, float] = {}
    for link in model.moving:
        joint = link.joint
        low, high = joint.limits or (-np.inf, np.inf)
        found[joint.name] = given.get(joint.name, min(max(0.0, low), high))
    for link in model.moving:
        mimic = link.joint.mimic
        if mimic is not None and link.joint.name not in given:
            found[link.joint.name] = mimic.multiplier * found[mimic.joint] + mimic.offset
    return found


def base_from_frame(model: RobotModel, frame: str, positions: Mapping[str, float]) -> Doubles:
    """Return the (4, 4) pose of a link, or a frame upon one, in the first link's frame.

    Parameters
    ----------
    model : RobotModel
    frame : str
        Name of a link or a frame.
    positions : mapping of str to float
        Of every joint that moves.

    Raises
    ------
    UnknownName
        If there is no such link or frame.
    """
    link, matrix = carrier(model, frame)
    by_name = {one.name: one for one in model.links}
    while True:
        one = by_name[link]
        if not one.parent:
            return matrix
        matrix = parent_from_link(one.joint, positions.get(one.joint.name, 0.0)) @ matrix
        link = one.parent


def carrier(model: RobotModel, frame: str) -> tuple[str, Doubles]:
    """Return the link that a link or frame is or goes with, and its (4, 4) pose there.

    Raises
    ------
    UnknownName
        If there is no such link or frame.
    """
    for link in model.links:
        if link.name == frame:
            return frame, np.eye(4)
    for one in model.frames:
        if one.name == frame:
            return one.link, one.pose.matrix()
    known = [*(link.name for link in model.links), *(one.name for one in model.frames)]
    raise UnknownName("link of the robot", frame, known)


def parent_from_link(joint: RobotJoint, position: float) -> Doubles:
    """Return the (4, 4) pose of a link in its parent's frame."""
    rest = joint.parent_from_rest.matrix()
    if joint.type == "fixed" or not position:
        return rest
    axis = np.asarray(joint.axis, np.float64) / np.linalg.norm(joint.axis)
    move = np.eye(4)
    if joint.type == "slide":
        move[:3, 3] = axis * position
    else:
        turn = about(axis, position)
        origin = np.asarray(joint.origin_m)
        move[:3, :3], move[:3, 3] = turn, origin - turn @ origin
    return np.asarray(rest @ move)


def reaching(
    model: RobotModel,
    frame: str,
    base_from_goal: Pose,
    start: Mapping[str, float],
    only: Sequence[str] = (),
) -> dict[str, float]:
    """Return positions of the joints that bring a frame to a pose in the first link's frame.

    Parameters
    ----------
    start : mapping of str to float
        Of every joint; the search begins there, and what does not carry the frame stays.
    only : sequence of str
        The joints that may move; empty means all that carry the frame.

    Raises
    ------
    InvalidRequest
        If the pose cannot be reached within the limits, to 0.1 mm and 0.1 mrad.

    Notes
    -----
    Damped least squares (Wampler, IEEE Transactions on Systems, Man, and Cybernetics 16, 1986),
    from `start` and then from other places within the limits, always the same ones.
    """
    carrying = _chain(model, frame)
    joints = [one.joint for one in carrying if not only or one.joint.name in only]
    if not joints:
        raise InvalidRequest("link", frame, "one that a joint moves")
    goal = base_from_goal.matrix()
    lows = np.array([(one.limits or (-np.pi, np.pi))[0] for one in joints])
    highs = np.array([(one.limits or (-np.pi, np.pi))[1] for one in joints])
    draws = np.random.default_rng(0)
    best = np.inf
    for attempt in range(STARTS):
        q = np.array([start.get(one.name, 0.0) for one in joints])
        if attempt:
            q = draws.uniform(lows, highs)
        q, error = _descend(model, frame, goal, joints, q, (lows, highs), dict(start))
        best = min(best, error)
        if error <= 1.0:
            found = zip((one.name for one in joints), q.tolist(), strict=True)
            return all_positions(model, {**_without_followers(model, start), **dict(found)})
    shown = tuple(round(value, 3) for value in base_from_goal.position_m)
    raise InvalidRequest("pose", shown, f"one that {frame!r} reaches within the joints' limits")


def _without_followers(model: RobotModel, positions: Mapping[str, float]) -> dict[str, float]:
    following = {one.joint.name for one in model.moving if one.joint.mimic is not None}
    return {name: value for name, value in positions.items() if name not in following}


def _chain(model: RobotModel, frame: str) -> list[RobotLink]:
    """Return the links on joints that move between the first link and a frame."""
    by_name = {one.name: one for one in model.links}
    link = by_name[carrier(model, frame)[0]]
    found = []
    while link.parent:
        if link.joint.type != "fixed" and link.joint.mimic is None:
            found.append(link)
        link = by_name[link.parent]
    return found[::-1]


def _descend(
    model: RobotModel,
    frame: str,
    goal: Doubles,
    joints: Sequence[RobotJoint],
    q: Doubles,
    bounds: tuple[Doubles, Doubles],
    positions: dict[str, float],
) -> tuple[Doubles, float]:
    """Return positions and the error that is left, 1 for what is close enough."""
    names = [one.name for one in joints]
    lows, highs = bounds
    error = np.inf
    for _ in range(MOST_TURNS):
        positions.update(zip(names, q.tolist(), strict=True))
        now = base_from_frame(model, frame, positions)
        difference = _difference(now, goal)
        error = max(
            float(np.linalg.norm(difference[:3])) / CLOSE_M,
            float(np.linalg.norm(difference[3:])) / CLOSE_RAD,
        )
        if error <= 0.1:
            break
        columns = []
        for place, name in enumerate(names):
            moved = {**positions, name: q[place] + 1e-6}
            columns.append(_difference(now, base_from_frame(model, frame, moved)) / 1e-6)
        jacobian = np.stack(columns, axis=1)
        damped = jacobian @ jacobian.T + DAMPING**2 * min(1.0, error * 1e-3) * np.eye(6)
        step = jacobian.T @ np.linalg.solve(damped, difference)
        step *= min(1.0, LARGEST_STEP_RAD / max(float(np.abs(step).max()), 1e-12))
        q = np.clip(q + step, lows, highs)
    return q, error


def _difference(now: Doubles, goal: Doubles) -> Doubles:
    """Return (6,): the way and the turn from one pose to another, in the base's axes."""
    turn = goal[:3, :3] @ now[:3, :3].T
    cosine = np.clip((np.trace(turn) - 1.0) / 2.0, -1.0, 1.0)
    angle = float(np.arccos(cosine))
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    sine = float(np.linalg.norm(axis)) / 2.0
    if sine > 1e-9:
        axis = axis / (2.0 * sine) * angle
    elif cosine < 0.0:  # half a turn, about whichever axis
        axis = np.sqrt(np.maximum((np.diag(turn) + 1.0) / 2.0, 0.0)) * np.pi
    return np.concatenate([goal[:3, 3] - now[:3, 3], axis])
