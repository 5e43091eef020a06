"""Reaching with a hand: the trunk leans and the knees bend as far as the arm needs to get there.

A hand grips beside its palm. What is carried stands before the chest, on a bent arm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.limbs import bend_arm, bend_leg, two_bones
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import Posture, aligned, joint_frames, turn_about
from sailenv_ros.postures.standing import SIDES, hands_at_ease, looking
from sailenv_ros.postures.walking import own_print
from sailenv_ros.types.rig import Rig

__all__ = ["HAND", "Grip", "grip_place", "on_its_feet", "reaching_posture", "with_carrying_arm"]

Doubles = NDArray[np.float64]

HAND = "R"
"""Side of the hand that takes things."""

_SIGN = -1.0
_PALM_M = 0.012
"""From the middle of the hand to the palm's skin [m]."""

_STRETCH = 0.985
_HALVINGS = 10
_LEAN_DEG = (24.0, 50.0, 68.0)
"""Of pelvis, belly and chest when one bends down as far as one can [deg]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Grip:
    """How a hand holds something.

    Attributes
    ----------
    half_m : float
        From the palm to the middle of what is held, before the scale [m].
    """

    half_m: float


def reaching_posture(
    rig: Rig, standing: Posture, moment: Moment, goal: Doubles, grip: Grip
) -> Posture | None:
    """Return the posture in which the hand holds something; None if it is out of reach.

    Parameters
    ----------
    standing : Posture
        Of one who stands; the other arm and the feet stay as in it.
    moment : Moment
        Of the feet.
    goal : (3,) float64
        Middle of what is held, body frame [m].
    """
    figure = figure_of(rig)
    hand = _level_hand(rig, goal)
    wrist = goal - hand @ _grip_offset(rig, grip)
    hips = standing.root_m - standing.turns["root"] @ (rig.heads[0] - figure.hips)
    upper, lower = _arm_lengths(rig)

    def bent(share: float) -> tuple[Posture, Doubles]:
        """Return the posture without the arm, and the place of its shoulder."""
        crouch = 0.95 * max(0.0, share - 0.4) * figure.leg_m if goal[2] < hips[2] else 0.0
        back = 0.16 * share * figure.leg_m
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
        return posture, places[rig.joint_of[f"upperarm01.{HAND}"]]

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
    pole = np.array([-0.35, 0.5 * _SIGN, -0.8])
    elbow, end = two_bones(shoulder, wrist, upper, lower, pole)
    own = chest.T
    arm = bend_arm(rig, HAND, chest, own @ pole, own @ (elbow - shoulder), own @ (end - elbow))
    return replace(posture, turns=_with_hand(rig, {**posture.turns, **arm}, hand))


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


def with_carrying_arm(rig: Rig, posture: Posture) -> Posture:
    """Return a posture whose hand carries something before the chest."""
    chest = posture.turns["spine01"]
    arm = bend_arm(
        *(rig, HAND, chest, np.array([-1.0, 0.3 * _SIGN, 0.0])),
        *(np.array([0.02, 0.14 * _SIGN, -1.0]), np.array([1.0, -0.06 * _SIGN, 0.12])),
    )
    ahead = np.array([chest[0, 0], chest[1, 0], 0.0])
    turns = {**posture.turns, **arm}
    return replace(posture, turns=_with_hand(rig, turns, _level_hand(rig, ahead)))


def grip_place(rig: Rig, turns: Doubles, places: Doubles, grip: Grip) -> Doubles:
    """Return (3,): the middle of what the hand holds, by frames of joints, body frame [m]."""
    wrist = rig.joint_of[f"wrist.{HAND}"]
    found: Doubles = places[wrist] + turns[wrist] @ _grip_offset(rig, grip)
    return found


def _hand_at_rest(rig: Rig) -> tuple[Doubles, Doubles, float]:
    """Return the unit directions of fingers and of the thumb's side, and the length of the palm."""
    wrist = rig.head(f"wrist.{HAND}")
    knuckles = [rig.head(f"finger{number}-1.{HAND}") for number in (2, 3, 5)]
    along = knuckles[1] - wrist
    length = float(np.linalg.norm(along))
    thumb = knuckles[0] - knuckles[2]
    thumb = thumb - (thumb @ along) * along / length**2
    return along / length, thumb / np.linalg.norm(thumb), length


def _grip_offset(rig: Rig, grip: Grip) -> Doubles:
    """Return (3,): from the wrist to the middle of what is held, at rest [m]."""
    along, thumb, length = _hand_at_rest(rig)
    palm = _SIGN * np.cross(along, thumb)
    return np.asarray(1.05 * length * along + (grip.half_m + _PALM_M) * palm)


def _level_hand(rig: Rig, ahead: Doubles) -> Doubles:
    """Return the turn of a hand whose fingers point along the floor, with its thumb up."""
    along, thumb, _ = _hand_at_rest(rig)
    level = np.array([ahead[0], ahead[1], 0.0])
    return aligned(along, thumb, level, np.array([0.0, 0.0, 1.0]))


def _with_hand(rig: Rig, turns: dict[str, Doubles], hand: Doubles) -> dict[str, Doubles]:
    """Return turns with that of the hand, whose fingers close."""
    other = {f"lowerarm01.{side}": turns[f"lowerarm01.{side}"] for side, _ in SIDES if side != HAND}
    grips = hands_at_ease(rig, {**other, f"lowerarm01.{HAND}": hand})
    return {**turns, f"wrist.{HAND}": hand, **grips}


def _arm_lengths(rig: Rig) -> tuple[float, float]:
    shoulder, elbow, wrist = (
        rig.head(f"{bone}.{HAND}") for bone in ("upperarm01", "lowerarm01", "wrist")
    )
    return float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(wrist - elbow))
