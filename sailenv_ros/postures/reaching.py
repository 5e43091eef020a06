"""Reaching with a hand: the trunk leans and the knees bend as far as the arm needs to get there.

A hand grips beside its palm. What is carried stands before the chest, on a bent arm.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.grasping import Grip, Side, grip_offset, hand_at_rest, with_fingers
from sailenv_ros.postures.limbs import bend_arm, bend_leg, two_bones
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import Posture, aligned, joint_frames, turn_about
from sailenv_ros.postures.standing import SIDES, looking
from sailenv_ros.postures.walking import own_print
from sailenv_ros.types.rig import Rig

__all__ = ["grip_place", "on_its_feet", "reaching_posture", "with_carrying_arm"]

Doubles = NDArray[np.float64]

_STRETCH = 0.985
_HALVINGS = 10
_LEAN_DEG = (24.0, 50.0, 68.0)
"""Of pelvis, belly and chest when one bends down as far as one can [deg]."""


_LOW, _SQUAT = 0.5, 0.38
"""Height over that of the hips below which one squats, and how much deeper for what is on the
floor, over the length of the legs."""


def reaching_posture(
    rig: Rig, standing: Posture, moment: Moment, goal: Doubles, grip: Grip
) -> Posture | None:
    """Return the posture in which a hand is open at something; None if it is out of reach.

    Parameters
    ----------
    standing : Posture
        Of one who stands; the other arm and the feet stay as in it.
    moment : Moment
        Of the feet.
    goal : (3,) float64
        Middle of what is held, body frame [m].
    """
    figure, own_side = figure_of(rig), grip.side
    hand = _level_hand(rig, own_side, goal)
    wrist = goal - hand @ grip_offset(rig, grip)
    hips = standing.root_m - standing.turns["root"] @ (rig.heads[0] - figure.hips)
    upper, lower = _arm_lengths(rig, own_side)

    squats = float(np.clip(1.0 - goal[2] / (_LOW * hips[2]), 0.0, 1.0))

    def bent(share: float) -> tuple[Posture, Doubles]:
        """Return the posture without the arm, and the place of its shoulder."""
        down = (0.95 + _SQUAT * squats) * max(0.0, share - 0.4) * figure.leg_m
        crouch = down if goal[2] < hips[2] else 0.0
        back = (0.16 - 0.1 * squats) * share * figure.leg_m
        pelvis, belly, chest = (turn_about("y", share * angle) for angle in _LEAN_DEG)
        middle = hips - [back, 0.0, crouch + 0.04 * share]
        turns = dict(standing.turns)
        turns |= {"root": pelvis, "spine03": belly, "spine01": chest}
        for side, sign in SIDES:
            turns[f"shoulder01.{side}"] = chest @ turn_about("x", -6.0 * sign)
        away = goal - middle
        down = float(np.degrees(np.arctan2(0.9 * figure.leg_m - away[2], max(away[0], 0.2))))
        look = Look(down_deg=0.6 * down, heed=1.0)
        turns |= looking(turn_about("y", 0.45 * share * _LEAN_DEG[2]), look)
        root = middle + pelvis @ (rig.heads[0] - figure.hips)
        posture = on_its_feet(rig, Posture(root_m=root, turns=turns), moment)
        _, places = joint_frames(rig, posture)
        return posture, places[rig.joint_of[f"upperarm01.{own_side}"]]

    def within(share: float) -> bool:
        return float(np.linalg.norm(bent(share)[1] - wrist)) <= _STRETCH * (upper + lower)

    low, high = 0.0, 1.0
    if within(low):
        high = low
    elif not within(high):
        return None
    for _ in range(_HALVINGS if high > low else 0):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if within(middle) else (middle, high)
    posture, shoulder = bent(high)
    chest = posture.turns["spine01"]
    pole = np.array([-0.35, 0.5 * dict(SIDES)[own_side], -0.8])
    elbow, end = two_bones(shoulder, wrist, upper, lower, pole)
    own = chest.T
    arm = bend_arm(rig, own_side, chest, own @ pole, own @ (elbow - shoulder), own @ (end - elbow))
    turns = {**posture.turns, **arm, f"wrist.{own_side}": hand}
    return with_fingers(rig, replace(posture, turns=turns), grip, 0.0)


def on_its_feet(rig: Rig, posture: Posture, moment: Moment) -> Posture:
    """Return a posture whose legs reach to where the feet stand."""
    figure, turns = figure_of(rig), dict(posture.turns)
    pelvis = turns["root"]
    hips = posture.root_m - pelvis @ (rig.heads[0] - figure.hips)
    for (side, sign), place in zip(SIDES, moment.feet, strict=True):
        own = own_print(moment, place)
        hip = hips + pelvis @ (rig.head(f"upperleg01.{side}") - figure.hips)
        ankle = np.array([own.x, own.y, figure.ankle_m])
        foot = turn_about("z", float(np.degrees(own.yaw)))
        turns |= bend_leg(rig, side, hip, ankle, foot, np.array([1.0, 0.08 * sign, 0.1]))
        turns[f"toe1-1.{side}"] = foot
    return replace(posture, turns=turns)


def with_carrying_arm(rig: Rig, posture: Posture, grip: Grip) -> Posture:
    """Return a posture whose hand carries something before the chest."""
    chest, side, sign = posture.turns["spine01"], grip.side, dict(SIDES)[grip.side]
    arm = bend_arm(
        *(rig, side, chest, np.array([-1.0, 0.3 * sign, 0.0])),
        *(np.array([0.02, 0.14 * sign, -1.0]), np.array([1.0, -0.06 * sign, 0.12])),
    )
    ahead = np.array([chest[0, 0], chest[1, 0], 0.0])
    turns = {**posture.turns, **arm, f"wrist.{side}": _level_hand(rig, side, ahead)}
    return with_fingers(rig, replace(posture, turns=turns), grip, 1.0)


def grip_place(rig: Rig, turns: Doubles, places: Doubles, grip: Grip) -> Doubles:
    """Return (3,): the middle of what the hand holds, by frames of joints, body frame [m]."""
    wrist = rig.joint_of[f"wrist.{grip.side}"]
    found: Doubles = places[wrist] + turns[wrist] @ grip_offset(rig, grip)
    return found


def _level_hand(rig: Rig, side: Side, ahead: Doubles) -> Doubles:
    """Return the turn of a hand whose fingers point along the floor, with its thumb up."""
    along, thumb, _, _ = hand_at_rest(rig, side)
    level = np.array([ahead[0], ahead[1], 0.0])
    return aligned(along, thumb, level, np.array([0.0, 0.0, 1.0]))


def _arm_lengths(rig: Rig, side: Side) -> tuple[float, float]:
    shoulder, elbow, wrist = (
        rig.head(f"{bone}.{side}") for bone in ("upperarm01", "lowerarm01", "wrist")
    )
    return float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(wrist - elbow))
