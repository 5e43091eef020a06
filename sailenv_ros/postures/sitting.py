"""Sitting down, sitting and getting up: the feet stand, the hips go to the seat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.easing import smoother_step
from sailenv_ros.postures.figure import Figure, figure_of
from sailenv_ros.postures.footsteps import Moment
from sailenv_ros.postures.limbs import bend_arm, bend_leg, two_bones
from sailenv_ros.postures.look import AHEAD, Look
from sailenv_ros.postures.skeleton import Posture, joint_frames, turn_about
from sailenv_ros.postures.standing import SIDES, breathing, hands_at_ease, looking
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.types.rig import Rig

__all__ = ["SIT_S", "SeatPlace", "seat_distance_m", "sitting_posture"]

Doubles = NDArray[np.float64]

SIT_S = 1.7
"""Time to sit down, and to get up [s]."""

_SEAT = 0.075
"""Height of the hips over what is sat upon, as a share of the leg's length on its own height."""

_SLOPES = 0.12
"""How far knees are below the hips of one whose feet reach the floor, over the leg's length."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeatPlace:
    """A seat, from where the feet of one who sits on it stand.

    Attributes
    ----------
    back_m : float
        How far behind the ankles the hips are [m].
    height_m : float
        Of the seat over the floor [m].
    """

    back_m: float
    height_m: float


def seat_distance_m(rig: Rig, height_m: float) -> float:
    """Return how far behind the ankles the hips are on a seat of a height [m]."""
    figure = figure_of(rig)
    thigh, knee = _thigh_and_knee_m(rig, figure)
    drop = knee - (height_m + _hip_over_seat(figure)) + _lift_m(rig, height_m)
    return float(np.sqrt(max(thigh**2 - drop**2, (0.5 * thigh) ** 2))) - 0.05 * figure.leg_m


def sitting_posture(
    rig: Rig,
    moment: Moment,
    seat: SeatPlace,
    share: float,
    time_s: float,
    *,
    seed: int = 0,
    look: Look = AHEAD,
) -> Posture:
    """Return the posture of one who sits down: 0 stands, 1 sits.

    Parameters
    ----------
    moment : Moment
        Of feet that stand before the seat, with their back to it.
    """
    figure = figure_of(rig)
    eased = smoother_step(share)
    standing = walking_posture(rig, moment, time_s, seed=seed, look=look)
    if eased <= 0.0:
        return standing
    start = standing.root_m - standing.turns["root"] @ (rig.heads[0] - figure.hips)
    end = np.array([-seat.back_m, start[1], seat.height_m + _hip_over_seat(figure)])
    # First back, then down: the hips pass above the edge of the seat.
    back = eased**0.85
    hips = np.array([
        start[0] + back * (end[0] - start[0]),
        start[1],
        start[2] + eased**1.25 * (end[2] - start[2]),
    ])  # fmt: skip
    lean = 38.0 * float(np.sin(np.pi * eased)) - 9.0 * eased
    pelvis = turn_about("y", 0.7 * lean - 4.0 * eased)
    root = hips + pelvis @ (rig.heads[0] - figure.hips)
    lift = eased**2 * _lift_m(rig, seat.height_m)
    turns: dict[str, Doubles] = {"root": pelvis}
    ankles = []
    for k, (side, sign) in enumerate(SIDES):
        hip = hips + pelvis @ (rig.head(f"upperleg01.{side}") - figure.hips)
        place = moment.feet[k]
        c, s = float(np.cos(moment.yaw)), float(np.sin(moment.yaw))
        x, y = place.x - moment.x, place.y - moment.y
        ankle = np.array([c * x + s * y, c * y - s * x, figure.ankle_m + lift])
        ankles.append(ankle)
        foot = turn_about("z", np.degrees(place.yaw - moment.yaw))
        turns |= bend_leg(rig, side, hip, ankle, foot, np.array([1.0, 0.12 * sign, 0.25]))
    breath = breathing(time_s, seed)
    chest = turn_about("y", lean + 0.25 * breath)
    turns["spine03"] = turn_about("y", 0.85 * lean)
    turns["spine01"] = chest
    turns |= _hands_on_thighs(rig, Posture(root_m=root, turns=turns), chest, eased, standing)
    turns |= looking(turn_about("y", 0.25 * lean), look)
    turns |= hands_at_ease(rig, turns)
    return Posture(root_m=root, turns=turns)


def _thigh_and_knee_m(rig: Rig, figure: Figure) -> tuple[float, float]:
    """Return the length of the thigh, and the height of the knee above a foot that stands [m]."""
    thigh = float(np.linalg.norm(rig.head("lowerleg01.L") - rig.head("upperleg01.L")))
    return thigh, figure.ankle_m + 0.985 * (figure.leg_m - thigh)


def _lift_m(rig: Rig, height_m: float) -> float:
    """Return how far the feet hang above the floor from a seat of a height [m]."""
    figure = figure_of(rig)
    above = height_m + _hip_over_seat(figure) - _thigh_and_knee_m(rig, figure)[1]
    return max(above - _SLOPES * figure.leg_m, 0.0)


def _hip_over_seat(figure: Figure) -> float:
    return _SEAT * figure.leg_m / 0.85 + 0.012


def _hands_on_thighs(
    rig: Rig, posture: Posture, chest: Doubles, share: float, standing: Posture
) -> dict[str, Doubles]:
    """Return the turns of arms that go from hanging to the thighs."""
    frames, places = joint_frames(rig, posture)
    del frames
    turns: dict[str, Doubles] = {}
    for side, sign in SIDES:
        numbers = [rig.joint_of[f"{bone}.{side}"] for bone in (
            "upperarm01", "lowerarm01", "wrist", "upperleg01", "lowerleg01"
        )]  # fmt: skip
        shoulder = places[numbers[0]]
        upper = float(np.linalg.norm(rig.heads[numbers[1]] - rig.heads[numbers[0]]))
        lower = float(np.linalg.norm(rig.heads[numbers[2]] - rig.heads[numbers[1]]))
        hip, knee = places[numbers[3]], places[numbers[4]]
        rest = hip + 0.62 * (knee - hip) + np.array([0.0, 0.0, 0.105 * upper / 0.28])
        hangs = shoulder + np.array([0.04, 0.05 * sign, -0.97 * (upper + lower)])
        hand = hangs + share * (rest - hangs)
        pole = np.array([-0.7, 0.55 * sign, -0.45])
        elbow, end = two_bones(shoulder, hand, upper, lower, pole)
        own = chest.T
        turns |= bend_arm(
            rig, side, chest, own @ pole, own @ (elbow - shoulder), own @ (end - elbow)
        )
    return turns
