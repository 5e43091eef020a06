"""Arms and legs of a posture: two bones that reach for a place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.skeleton import aligned
from sailenv_ros.types.rig import Rig

__all__ = ["bend_arm", "bend_bones", "bend_leg", "leg_length_m", "two_bones", "cross"]

Doubles = NDArray[np.float64]

_FORWARD = np.array([1.0, 0.0, 0.0])
_STRETCH = 0.9995
"""Share of its length to which a limb is stretched at most."""


def two_bones(
    start: Doubles, end: Doubles, first_m: float, second_m: float, pole: Doubles
) -> tuple[Doubles, Doubles]:
    """Return the middle joint of two bones, and where their end is.

    Parameters
    ----------
    start, end : (3,) float64
        Where they begin, and where the end is wanted [m].
    first_m, second_m : float
        Their lengths [m].
    pole : (3,) float64
        Towards where the middle joint points.
    """
    way = end - start
    distance = float(np.linalg.norm(way))
    reach = float(
        np.clip(distance, abs(first_m - second_m) + 1e-6, _STRETCH * (first_m + second_m))
    )
    along = way / max(distance, 1e-9)
    side = pole - (pole @ along) * along
    length = float(np.linalg.norm(side))
    side = side / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
    share = (first_m**2 - second_m**2 + reach**2) / (2.0 * reach)
    height = np.sqrt(max(first_m**2 - share**2, 0.0))
    return start + share * along + height * side, start + reach * along


def leg_length_m(rig: Rig) -> float:
    """Return the length of a leg from the hip to the ankle [m]."""
    hip, knee, ankle = (rig.head(f"{bone}.L") for bone in ("upperleg01", "lowerleg01", "foot"))
    return float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))


def bend_bones(
    rest: Sequence[Doubles], bent: Sequence[Doubles], rest_pole: Doubles, pole: Doubles
) -> tuple[Doubles, Doubles]:
    """Return the turns of two bones.

    Parameters
    ----------
    rest, bent : sequence of three (3,) float64
        Where they begin, meet and end [m].
    rest_pole, pole : (3,) float64
        Where the joint between them points.
    """
    (begin, middle, end), (top, joint, tip) = rest, bent
    normal = cross(tip - top, pole)
    # In the plane of the limb: a bone that passes the pole's direction must not turn over.
    upper, lower = joint - top, tip - joint
    return (
        aligned(middle - begin, rest_pole, upper, cross(normal, upper)),
        aligned(end - middle, rest_pole, lower, cross(normal, lower)),
    )


def cross(one: Doubles, other: Doubles) -> Doubles:
    """Return the vector product of two vectors (3,): NumPy's takes twenty times as long."""
    (x, y, z), (a, b, c) = one.tolist(), other.tolist()
    return np.array([y * c - z * b, z * a - x * c, x * b - y * a])


def bend_leg(
    rig: Rig, side: str, hip: Doubles, ankle: Doubles, foot: Doubles, pole: Doubles
) -> dict[str, Doubles]:
    """Return the turns of a leg that stands at a place.

    Parameters
    ----------
    side : {'L', 'R'}
    hip, ankle : (3,) float64
        Body frame [m].
    foot : (3, 3) float64
        Turn of the foot.
    pole : (3,) float64
        Where the knee points.
    """
    rest = [rig.head(f"{bone}.{side}") for bone in ("upperleg01", "lowerleg01", "foot")]
    upper, lower = rest[1] - rest[0], rest[2] - rest[1]
    knee, end = two_bones(
        hip, ankle, float(np.linalg.norm(upper)), float(np.linalg.norm(lower)), pole
    )
    thigh, shank = bend_bones(rest, (hip, knee, end), _FORWARD, pole)
    return {f"upperleg01.{side}": thigh, f"lowerleg01.{side}": shank, f"foot.{side}": foot}


def bend_arm(
    rig: Rig, side: str, upper_turn: Doubles, elbow: Doubles | None, upper: Doubles, lower: Doubles
) -> dict[str, Doubles]:
    """Return the turns of an arm whose two bones point along directions.

    Parameters
    ----------
    side : {'L', 'R'}
    upper_turn : (3, 3) float64
        Of what carries the arm.
    elbow : (3,) float64 or None
        Where the back of the elbow points; None for backwards.
    upper, lower : (3,) float64
        In the axes of what carries the arm.
    """
    rest = [rig.head(f"{bone}.{side}") for bone in ("upperarm01", "lowerarm01", "wrist")]
    back = np.array([-1.0, 0.0, 0.0]) if elbow is None else elbow
    first = aligned(rest[1] - rest[0], -_FORWARD, upper, back)
    second = aligned(rest[2] - rest[1], -_FORWARD, lower, back)
    return {
        f"upperarm01.{side}": upper_turn @ first,
        f"lowerarm01.{side}": upper_turn @ second,
    }
