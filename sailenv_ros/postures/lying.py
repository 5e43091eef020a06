"""Lying on the back: skin rests upon what is below it, part of the body after part.

The hips go down until they touch, the chest is raised by what lies below the shoulders, the head by
its pillow; legs and elbows sink upon what is below them.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.limbs import bend_arm, two_bones
from sailenv_ros.postures.skeleton import Posture, aligned, joint_frames, turn_about
from sailenv_ros.postures.standing import SIDES, hands_at_ease
from sailenv_ros.types.rig import Rig

__all__ = ["SINK_M", "Ground", "depths", "lying_posture", "tucked_posture"]

Doubles = NDArray[np.float64]

SINK_M = 0.01
"""How far skin presses into what it lies upon [m]."""

_LEGS = ("upperleg01", "lowerleg01", "foot", "toe1-1")
_ARMS = ("upperarm01", "lowerarm01", "wrist")
_HEAD = ("neck02", "neck03", "head")
_CHEST = (
    "spine02",
    "spine01",
    "clavicle.L",
    "clavicle.R",
    "shoulder01.L",
    "shoulder01.R",
    "neck01",
)
_HIPS = ("root", "spine05", "spine04", "spine03")
_STRETCHES_DEG = (28.0, 16.0, 4.0, -8.0)
"""Of a foot, from the first on until its leg rests [deg]."""

_SAME_M = 0.001
"""Difference in height that is no reason to stretch a foot less [m]."""

_HALVINGS = 12


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Ground:
    """Surface below a body, and the skin that lies upon it; body frame before the scale.

    Attributes
    ----------
    heights : callable
        ``heights(places)``: (N,) heights of what is below (N, 2) places; -inf for none [m].
    skin : callable
        ``skin(posture)``: (V, 3) places of the skin's vertices [m].
    joints : (V,) int64
        The joint that moves each vertex most.
    """

    heights: Callable[[Doubles], Doubles]
    skin: Callable[[Posture], Doubles]
    joints: NDArray[np.int64]


def depths(ground: Ground, posture: Posture) -> Doubles:
    """Return (V,): how far each vertex is below the surface; negative above it [m]."""
    points = ground.skin(posture)
    found: Doubles = ground.heights(points[:, :2]) - points[:, 2]
    return found


def lying_posture(rig: Rig, ground: Ground, hips: Doubles, head_way: Doubles) -> Posture:
    """Return the posture of one who lies on the back.

    Parameters
    ----------
    hips : (2,) float64
        Place of the hips' middle [m].
    head_way : (2,) float64
        Unit vector from there to the head.
    """
    figure = figure_of(rig)
    up, head = np.array([0.0, 0.0, 1.0]), np.array([*head_way, 0.0])
    level = np.stack([up, np.cross(head, up), head], axis=1)
    turns: dict[str, Doubles] = {"root": level}
    for side, sign in SIDES:
        turns[f"shoulder01.{side}"] = level @ turn_about("x", -9.0 * sign)
    offset = level @ (rig.heads[0] - figure.hips)

    def placed(height: float) -> Posture:
        return Posture(root_m=np.array([*hips, height]) + offset, turns=turns)

    high = 3.0
    depth = depths(ground, placed(high))[_chosen(rig, ground, [*_HIPS, *_sided("upperleg01")])]
    posture = placed(high + float(depth.max()) - SINK_M)
    # From the hips outwards: what one part lies upon sets where the next begins.
    spine = ("spine03", "spine02", "spine01")
    posture = _raised(rig, ground, posture, level, _CHEST, spine, (-12.0, 40.0))
    # Where a pillow's end raises the loins, the shoulders sink behind it.
    chest = posture.turns["spine01"]
    posture = _raised(rig, ground, posture, chest, _CHEST[1:], ("spine01",), (-30.0, 0.0))
    chest = posture.turns["spine01"]
    posture = _raised(rig, ground, posture, chest, _HEAD, ("neck01", *_HEAD), (-70.0, 60.0))
    for side, sign in SIDES:
        outwards = level @ turn_about("z", 18.0 * sign)
        posture = _leg_laid(rig, ground, posture, outwards, side)
    for side, sign in SIDES:
        posture = _hand_on_belly(rig, ground, posture, level, side, sign)
    turned = dict(posture.turns)
    flat = {f"lowerarm01.{side}": turned[f"wrist.{side}"] for side, _ in SIDES}
    return replace(posture, turns=turned | hands_at_ease(rig, flat))


def tucked_posture(rig: Rig, hips: Doubles, facing: Doubles, soles_m: float) -> Posture:
    """Return one who leans back with knees drawn up, on the way between sitting and lying.

    Parameters
    ----------
    hips : (3,) float64
        Place of the hips [m].
    facing : (3, 3) float64
        Turn about the vertical.
    soles_m : float
        Height of the soles [m].
    """
    figure = figure_of(rig)
    pelvis = facing @ turn_about("y", -28.0)
    turns: dict[str, Doubles] = {"root": pelvis}
    for side, sign in SIDES:
        hip = hips + pelvis @ (rig.head(f"upperleg01.{side}") - figure.hips)
        ankle = hip + facing @ np.array([0.46 * figure.leg_m, 0.03 * sign, 0.0])
        ankle[2] = soles_m + figure.ankle_m
        turns |= _hinged_leg(rig, side, hip, ankle, facing)
    chest = facing @ turn_about("y", -12.0)
    turns["spine03"], turns["spine01"] = facing @ turn_about("y", -20.0), chest
    turns |= {joint: facing @ turn_about("y", 6.0) for joint in ("neck02", "neck03", "head")}
    for side, sign in SIDES:
        upper = np.array([-0.35, 0.25 * sign, -0.9])
        turns |= bend_arm(rig, side, chest, None, upper, np.array([0.35, 0.1 * sign, -0.9]))
    return Posture(
        root_m=hips + pelvis @ (rig.heads[0] - figure.hips), turns=turns | hands_at_ease(rig, turns)
    )


def _hinged_leg(
    rig: Rig, side: str, hip: Doubles, ankle: Doubles, facing: Doubles
) -> dict[str, Doubles]:
    """Return the turns of a leg whose knee points up, all about the axis across the body."""
    rest = [rig.head(f"{bone}.{side}") for bone in ("upperleg01", "lowerleg01", "foot")]
    bones = [b - a for a, b in itertools.pairwise(rest)]
    upper, lower = (float(np.linalg.norm(bone)) for bone in bones)
    knee, end = two_bones(hip, ankle, upper, lower, np.array([0.0, 0.0, 1.0]))
    turns = {f"foot.{side}": facing}
    for name, bone, way in zip(_LEGS[:2], bones, (knee - hip, end - knee), strict=True):
        own = facing.T @ way
        angle = np.arctan2(own[0], own[2]) - np.arctan2(bone[0], bone[2])
        turns[f"{name}.{side}"] = facing @ turn_about("y", float(np.degrees(angle)))
    return turns


def _chosen(rig: Rig, ground: Ground, names: Collection[str]) -> NDArray[np.bool_]:
    numbers = [rig.joint_of[name] for name in names if name in rig.joint_of]
    return np.isin(ground.joints, numbers)


def _sided(*bones: str) -> list[str]:
    return [f"{bone}.{side}" for bone in bones for side, _ in SIDES]


def _raised(
    rig: Rig,
    ground: Ground,
    posture: Posture,
    carrier: Doubles,
    resting: Collection[str],
    bending: tuple[str, ...],
    limits_deg: tuple[float, float],
) -> Posture:
    """Return a posture in which joints bend as far as a part of the body needs to rest.

    Parameters
    ----------
    carrier : (3, 3) float64
        From whose turn they bend.
    resting : collection of str
        Joints whose skin rests.
    bending : tuple of str
        Joints that share the angle, from the first to the last; legs bend at the hip alone.
    limits_deg : (2,) tuple of float
        Of the angle [deg]: the part is lowest at the first.
    """
    chosen = _chosen(rig, ground, resting)
    if not chosen.any():
        return posture
    stiff = bending[0].startswith(_LEGS[0])

    def bent(degrees: float) -> Posture:
        turns = dict(posture.turns)
        for number, joint in enumerate(bending, start=1):
            part = 1.0 if stiff else number / len(bending)
            turns[joint] = carrier @ turn_about("y", part * degrees)
        if "spine01" in bending:
            for side, sign in SIDES:
                turns[f"shoulder01.{side}"] = turns["spine01"] @ turn_about("x", -9.0 * sign)
        return replace(posture, turns=turns)

    def sinks(degrees: float) -> bool:
        return float(depths(ground, bent(degrees))[chosen].max()) > SINK_M

    low, high = limits_deg
    if not sinks(low):
        return bent(low)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sinks(middle) else (low, middle)
    return bent(high)


def _leg_laid(rig: Rig, ground: Ground, posture: Posture, outwards: Doubles, side: str) -> Posture:
    """Return a posture whose leg rests: its foot stretches as far as there is room beyond it."""
    legs = tuple(f"{bone}.{side}" for bone in _LEGS)
    chosen = _chosen(rig, ground, legs[1:3])
    found, best, level = posture, -np.inf, posture.turns["root"]
    for stretch in _STRETCHES_DEG:
        foot = outwards @ turn_about("y", stretch)
        begin = replace(posture, turns={**posture.turns, legs[2]: foot})
        laid = _raised(rig, ground, begin, level, legs, legs[:2], (25.0, -10.0))
        depth = float(np.max(depths(ground, laid)[chosen], initial=-np.inf))
        if depth > best + _SAME_M:
            found, best = laid, depth
        if best > 0.0:
            break
    return found


def _hand_on_belly(
    rig: Rig, ground: Ground, posture: Posture, level: Doubles, side: str, sign: float
) -> Posture:
    """Return a posture whose hand lies upon the belly, and its elbow beside the body."""
    numbers = [rig.joint_of[f"{bone}.{side}"] for bone in _ARMS]
    turns, places = joint_frames(rig, posture)
    shoulder, hips = places[numbers[0]], places[rig.joint_of["spine05"]]
    upper, lower = (
        float(np.linalg.norm(rig.heads[b] - rig.heads[a])) for a, b in itertools.pairwise(numbers)
    )
    chest = turns[rig.joint_of["spine01"]]
    middle = 0.62 * hips + 0.38 * places[rig.joint_of["spine01"]]
    wrist = middle + 0.34 * lower * sign * level[:, 1]
    skin = ground.skin(posture)
    trunk = skin[_chosen(rig, ground, [*_HIPS, *_CHEST])]
    near = np.linalg.norm(trunk[:, :2] - wrist[:2], axis=1) < 0.3 * lower
    wrist[2] = float(np.max(trunk[near, 2], initial=middle[2])) + 0.15 * lower
    chosen = _chosen(rig, ground, [f"{bone}.{side}" for bone in _ARMS[:2]])
    # The hand lies flat: its fingers across the body, its palm down.
    first, third, fifth = (rig.head(f"finger{number}-1.{side}") for number in (2, 3, 5))
    along = third - rig.heads[numbers[2]]
    fingers = -0.8 * sign * level[:, 1] - 0.6 * level[:, 2]
    thumb = np.cross(fingers, level[:, 0]) * -sign
    hand = aligned(along, first - fifth, fingers, thumb)

    def reaching(degrees: float) -> Posture:
        angle = np.radians(degrees)
        pole = sign * np.cos(angle) * level[:, 1] - np.sin(angle) * level[:, 0]
        elbow, end = two_bones(shoulder, wrist, upper, lower, pole)
        own = chest.T
        arm = bend_arm(rig, side, chest, own @ pole, own @ (elbow - shoulder), own @ (end - elbow))
        return replace(posture, turns={**posture.turns, **arm, f"wrist.{side}": hand})

    low, high = -70.0, 75.0
    for _ in range(_HALVINGS if chosen.any() else 0):
        middle_deg = 0.5 * (low + high)
        sinks = float(depths(ground, reaching(middle_deg))[chosen].max()) > SINK_M
        low, high = (low, middle_deg) if sinks else (middle_deg, high)
    return reaching(low)
