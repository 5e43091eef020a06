"""Measures of a skeleton that movements are made of; computed once for each."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.footsteps import Stride
from sailenv_ros.types.rig import Rig

__all__ = ["Figure", "figure_of"]

Doubles = NDArray[np.float64]

_SPEED = 1.35
"""Speed of walking over the root of the leg's length [sqrt(m)/s], a Froude number of 0.19."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Figure:
    """Measures of one skeleton [m].

    Attributes
    ----------
    leg_m : float
        From the hip to the ankle.
    ankle_m : float
        Height of the ankles.
    hips : (3,) float64
        Middle of the hips at rest.
    ball, heel : (3,) float64
        Where the left foot turns on the floor, from its ankle.
    half_width_m : float
        Of the hips.
    height_m : float
        Of the head's joint.
    """

    leg_m: float
    ankle_m: float
    hips: Doubles
    ball: Doubles
    heel: Doubles
    half_width_m: float
    height_m: float

    @property
    def stride(self) -> Stride:
        """Measures of steps at an easy pace."""
        length = 0.72 * self.leg_m
        speed = _SPEED * float(np.sqrt(self.leg_m))
        return Stride(
            length_m=length, width_m=1.5 * self.half_width_m, step_s=max(length / speed, 0.36)
        )


_known: WeakKeyDictionary[Rig, Figure] = WeakKeyDictionary()


def figure_of(rig: Rig) -> Figure:
    """Return the measures of a skeleton; the same object each time."""
    if rig not in _known:
        hip, knee, ankle, toe = (
            rig.head(f"{bone}.L") for bone in ("upperleg01", "lowerleg01", "foot", "toe1-1")
        )
        other = rig.head("upperleg01.R")
        leg = float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))
        height = float(ankle[2])
        forward = float(toe[0] - ankle[0])
        _known[rig] = Figure(
            leg_m=leg,
            ankle_m=height,
            hips=0.5 * (hip + other),
            ball=np.array([forward, 0.0, -height]),
            heel=np.array([-0.52 * forward, 0.0, -height]),
            half_width_m=0.5 * float(hip[1] - other[1]),
            height_m=float(rig.head("head")[2]),
        )
    return _known[rig]
