"""Walking and standing: the posture of a body between two prints of its feet.

The hips go along the way at a height that the legs reach; feet stand exactly on their prints, roll
over heel and ball, and swing in between. Legs follow by two-bone inverse kinematics.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.figure import Figure, figure_of
from sailenv_ros.postures.footsteps import FootPrint, Moment
from sailenv_ros.postures.limbs import bend_leg
from sailenv_ros.postures.look import AHEAD, Look
from sailenv_ros.postures.skeleton import Posture, turn_about
from sailenv_ros.postures.standing import (
    SIDES,
    breathing,
    hands_at_ease,
    hanging_arms,
    looking,
)
from sailenv_ros.types.rig import Rig

__all__ = ["own_print", "walking_posture"]

Doubles = NDArray[np.float64]

_LIFTS, _LANDS = 0.12, 0.92
"""Shares of a step at which the swinging foot leaves the floor and touches it."""

_CLOSE_ROOM = 0.4
"""Share of the room that arms need, below which they are held close."""

_STRAIGHT = 0.985
"""Share of its length to which a leg that stands is stretched."""

_TOE_OFF_DEG, _HEEL_STRIKE_DEG = 26.0, 14.0


def walking_posture(
    rig: Rig,
    moment: Moment,
    time_s: float,
    *,
    seed: int = 0,
    look: Look = AHEAD,
) -> Posture:
    """Return the posture of a body on its way, in the frame of the body there.

    Parameters
    ----------
    rig : Rig
    moment : Moment
        Of its way.
    time_s : float
        Of its breath [s].
    seed : int
        Sets people's breaths apart.
    look : Look
        Where it looks, from the chest.
    """
    figure = figure_of(rig)
    stands = moment.swinging < 0
    own = [own_print(moment, place) for place in moment.feet]
    swing = moment.swinging
    vigour = 0.0 if stands else min(moment.ahead_m / (1.5 * figure.leg_m), 1.0)
    feet = [_standing_foot(figure, place, 0.0, 0.0) for place in own]
    if not stands:
        assert moment.goal is not None
        goal = own_print(moment, moment.goal)
        stance = 1 - swing
        early = max(0.0, 1.0 - (moment.share + 1.0 - _LANDS) / 0.2)
        length = min(moment.before_m / (1.5 * figure.leg_m), 1.0)
        feet[stance] = _standing_foot(figure, own[stance], _HEEL_STRIKE_DEG * early * length, 0.0)
        feet[swing] = _swinging_foot(figure, own[swing], goal, moment.share, vigour)
    ankles = [ankle for ankle, _ in feet]
    # The hips: over the feet, as high as the legs reach.
    middle = 0.5 * (own[0].y + own[1].y)
    sway = 0.0
    if not stands:
        sway = 0.022 * figure.leg_m * float(np.sin(np.pi * moment.share)) * (1 if swing else -1)
    support = ankles[1 - swing] if not stands else 0.5 * (ankles[0] + ankles[1])
    away = 0.72 * abs(float(support[0]))
    reach = _STRAIGHT * figure.leg_m
    high = figure.ankle_m + float(np.sqrt(max(reach**2 - away**2, (0.6 * reach) ** 2)))
    ahead = (ankles[0][0] - ankles[1][0]) / max(1.44 * figure.leg_m, 1e-6)
    twist = 9.0 * float(np.clip(ahead, -1.0, 1.0)) * (1.0 if not stands else 0.3)
    hips = np.array([0.0, middle + sway if stands else sway, high])
    pelvis = turn_about("z", -twist) @ turn_about("y", 2.0 * vigour)
    root = hips + pelvis @ (rig.heads[0] - figure.hips)
    turns: dict[str, Doubles] = {"root": pelvis}
    for k, (side, sign) in enumerate(SIDES):
        hip = hips + pelvis @ (rig.head(f"upperleg01.{side}") - figure.hips)
        ankle, foot = _within_reach(figure, feet[k], own[k], hip)
        pole = np.array([np.cos(own[k].yaw), np.sin(own[k].yaw) + 0.05 * sign, 0.0])
        turns |= bend_leg(rig, side, hip, ankle, foot, pole)
        turns[f"toe1-1.{side}"] = _toes(foot)
    breath = breathing(time_s, seed)
    chest = turn_about("z", twist) @ turn_about("y", 2.5 * vigour + 0.25 * breath)
    turns["spine03"] = turn_about("z", -0.3 * twist) @ turn_about("y", 2.0 * vigour)
    turns["spine01"] = chest
    arm = 46.0 * moment.swing_room * float(np.clip(ahead, -1.0, 1.0))
    swings_deg = -arm + 0.6 * breath, arm + 0.6 * breath
    room = moment.swing_room
    close = smooth_step(float(np.clip(1.0 - room / _CLOSE_ROOM, 0.0, 1.0)))
    turns |= hanging_arms(
        *(rig, chest, swings_deg),
        spread=0.09 + 0.07 * room - 0.06 * close,
        out=room * rig.arms_out,
        close=close,
    )
    turns |= looking(turn_about("y", 1.0), look)
    turns |= hands_at_ease(rig, turns)
    return Posture(root_m=root, turns=turns)


def own_print(moment: Moment, place: FootPrint) -> FootPrint:
    """Return a print in the frame of the body."""
    c, s = float(np.cos(moment.yaw)), float(np.sin(moment.yaw))
    x, y = place.x - moment.x, place.y - moment.y
    turn = (place.yaw - moment.yaw + np.pi) % (2.0 * np.pi) - np.pi
    return FootPrint(c * x + s * y, c * y - s * x, float(turn))


Foot = tuple[Doubles, Doubles]
"""Place of an ankle [m], and the turn of the foot."""


def _standing_foot(figure: Figure, place: FootPrint, toe_up_deg: float, heel_up_deg: float) -> Foot:
    """Return a foot that stands flat, or on its heel, or on its ball."""
    flat = turn_about("z", np.degrees(place.yaw))
    ankle = np.array([place.x, place.y, figure.ankle_m])
    if toe_up_deg:
        return _rolled(figure.heel, ankle, flat, -toe_up_deg)
    return _rolled(figure.ball, ankle, flat, heel_up_deg) if heel_up_deg else (ankle, flat)


def _rolled(pivot: Doubles, ankle: Doubles, flat: Doubles, degrees: float) -> Foot:
    foot = flat @ turn_about("y", degrees)
    return ankle + flat @ pivot - foot @ pivot, foot


def _swinging_foot(
    figure: Figure, begin: FootPrint, goal: FootPrint, share: float, vigour: float
) -> Foot:
    push = _TOE_OFF_DEG * vigour
    if share < _LIFTS:
        return _standing_foot(figure, begin, 0.0, push * share / _LIFTS)
    strike = _HEEL_STRIKE_DEG * vigour
    if share > _LANDS:
        left = max(0.0, 1.0 - (share - _LANDS) / 0.2)
        return _standing_foot(figure, goal, strike * left, 0.0)
    part = (share - _LIFTS) / (_LANDS - _LIFTS)
    eased = smooth_step(part)
    first, _ = _standing_foot(figure, begin, 0.0, push)
    last, _ = _standing_foot(figure, goal, strike, 0.0)
    ankle = first + eased * (last - first)
    ankle[2] += (0.05 + 0.05 * vigour) * figure.leg_m * np.sin(np.pi * part)
    turn = (goal.yaw - begin.yaw + np.pi) % (2.0 * np.pi) - np.pi
    pitch = push * (1.0 - eased) ** 1.5 - strike * eased
    yaw = np.degrees(begin.yaw + eased * turn)
    return ankle, turn_about("z", yaw) @ turn_about("y", pitch)


def _within_reach(figure: Figure, foot: Foot, place: FootPrint, hip: Doubles) -> Foot:
    """Return a foot whose heel rises as far as its leg needs to reach it."""
    ankle, _ = foot
    most = 0.9985 * figure.leg_m
    if float(np.linalg.norm(ankle - hip)) <= most or ankle[2] > figure.ankle_m + 1e-3:
        return foot
    low, high = 0.0, 60.0
    for _ in range(18):
        middle = 0.5 * (low + high)
        tried, _ = _standing_foot(figure, place, 0.0, middle)
        if float(np.linalg.norm(tried - hip)) > most:
            low = middle
        else:
            high = middle
    return _standing_foot(figure, place, 0.0, high)


def _toes(foot: Doubles) -> Doubles:
    """Return the turn of toes that stay on the floor while the heel rises."""
    pitch = float(np.degrees(np.arcsin(np.clip(-foot[2, 0], -1.0, 1.0))))
    return foot @ turn_about("y", -pitch) if pitch > 0.0 else foot
