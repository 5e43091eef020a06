"""The upper body: spine, head, arms and hands, standing at ease or walking."""

from __future__ import annotations

import itertools
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.limbs import bend_arm
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import turn_about
from sailenv_ros.types.rig import Rig

__all__ = ["SIDES", "about", "breathing", "curl_axis", "hands_at_ease", "hanging_arms", "looking"]

Doubles = NDArray[np.float64]

SIDES: tuple[tuple[Literal["L", "R"], float], ...] = (("L", 1.0), ("R", -1.0))

_DROP_DEG = 9.0

_CURL_DEG = (16.0, 22.0, 14.0)
_MOST_LOOK_DEG = (62.0, 32.0)
"""Of the head, sideways and up or down [deg]."""


_CLOSE_DEG, _CLOSE_IN = 34.0, 0.45
"""How far lower arms are bent that are held close [deg], and how far they point inwards."""


def hanging_arms(
    rig: Rig,
    chest: Doubles,
    swing_deg: tuple[float, float],
    ease_deg: float = 10.0,
    spread: float = 0.16,
    out: float = 0.0,
    close: float = 0.0,
) -> dict[str, Doubles]:
    """Return the turns of arms that hang, swung forward by angles, left and right [deg].

    `spread` is the tangent of the angle from which upper arms hang straight down. Where that is
    less than the tangent `out` of straight arms needs, lower arms hang outwards, too. `close`, 0 to
    1, is how far hands are held before the body, where there is no room beside it.
    """
    spread = max(spread, out)
    lengths = [
        float(np.linalg.norm(rig.head(f"{end}.L") - rig.head(f"{begin}.L")))
        for begin, end in itertools.pairwise(("upperarm01", "lowerarm01", "wrist", "finger3-3"))
    ]
    below = lengths[1] + 1.3 * lengths[2]
    lower_out = max(0.03, (out * (lengths[0] + below) - spread * lengths[0]) / below)
    turns: dict[str, Doubles] = {}
    for (side, sign), swing in zip(SIDES, swing_deg, strict=True):
        angle = np.radians(swing)
        bend = angle + np.radians(ease_deg + 0.6 * max(swing, 0.0) + _CLOSE_DEG * close)
        upper = np.array([np.sin(angle), spread * sign, -np.cos(angle)])
        aside = lower_out - (lower_out + _CLOSE_IN) * close
        lower = np.array([np.sin(bend), aside * sign, -np.cos(bend)])
        turns |= bend_arm(rig, side, chest, None, upper, lower)
        # Shoulders are raised at rest, where arms are spread.
        turns[f"shoulder01.{side}"] = chest @ turn_about("x", -_DROP_DEG * sign)
    return turns


def hands_at_ease(rig: Rig, turns: dict[str, Doubles]) -> dict[str, Doubles]:
    """Return the turns of fingers that are curled a little, for arms that are turned already."""
    return {
        joint: turns[f"lowerarm01.{side}"] @ turn
        for side, joints in _curls(rig).items()
        for joint, turn in joints.items()
    }


_known: WeakKeyDictionary[Rig, dict[str, dict[str, Doubles]]] = WeakKeyDictionary()


def _curls(rig: Rig) -> dict[str, dict[str, Doubles]]:
    """Return the turns of curled fingers from the forearm, by sides and joints."""
    if rig not in _known:
        found: dict[str, dict[str, Doubles]] = {}
        for side, _ in SIDES:
            found[side] = {}
            for finger in range(1, 6):
                axis = curl_axis(rig, side, finger)
                turn = np.eye(3)
                for joint, curl in enumerate(_CURL_DEG, start=1):
                    degrees = curl * (0.4 if finger == 1 else 0.7 + 0.1 * finger)
                    turn = turn @ about(axis, np.radians(degrees))
                    found[side][f"finger{finger}-{joint}.{side}"] = turn
        _known[rig] = found
    return _known[rig]


def curl_axis(rig: Rig, side: str, finger: int) -> Doubles:
    """Return (3,): the unit axis about which a finger curls inwards, at rest."""
    across = rig.head(f"finger2-1.{side}") - rig.head(f"finger5-1.{side}")
    along = rig.head(f"finger{finger}-2.{side}") - rig.head(f"finger{finger}-1.{side}")
    axis = across - (across @ along) * along / (along @ along)
    return np.asarray((-1.0 if side == "L" else 1.0) * axis / np.linalg.norm(axis))


def breathing(time_s: float, seed: int) -> float:
    """Return how far a chest is raised, -1 to 1."""
    return float(np.sin(2.0 * np.pi * (time_s / 3.7 + 0.37 * seed)))


def looking(chest: Doubles, look: Look) -> dict[str, Doubles]:
    """Return the turns of neck and head that look somewhere, from the chest."""
    yaw, pitch = look.within(_MOST_LOOK_DEG)

    def share(part: float) -> Doubles:
        return chest @ turn_about("z", part * yaw) @ turn_about("y", part * pitch)

    return {"neck02": share(0.3), "neck03": share(0.55), "head": share(1.0)}


def about(axis: Doubles, angle: float) -> Doubles:
    """Return the rotation about a unit axis by an angle [rad]."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Doubles = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
    return turn
