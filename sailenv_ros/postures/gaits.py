"""Gaits: how the body of an asset goes and stands, on two legs or on four."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Protocol

from sailenv_ros.postures.animal_bearing import tail_habit
from sailenv_ros.postures.animal_figure import animal_figure_of
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.footsteps import Moment, Stride
from sailenv_ros.postures.four_legs import four_legged_posture
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.types.model import Asset
from sailenv_ros.types.rig import Rig

__all__ = ["Gait", "gait_of"]

_RADIUS, _SWING = 0.142, 0.22
"""Of a person, and what arms need beside it to swing, as shares of the height."""

_LEAST_SWING = 0.1
"""Share of their swing that arms have beside furniture: hands come before the cylinder."""


class _PostureFunction(Protocol):
    def __call__(
        self, rig: Rig, moment: Moment, time_s: float, *, seed: int, look: Look
    ) -> Posture:
        """Return the posture of a body on its way; see `walking_posture`."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Gait:
    """How one body goes; all before the scale.

    Attributes
    ----------
    stride : Stride
    height_m, eyes_m : float
        Of the body, and of its eyes.
    radius : float
        Of the cylinder that it turns in, over the height.
    swing_m : float
        Room around it in which arms, or a tail, swing as they like.
    least_swing : float
        Share of their swing that they have without it.
    posture : callable
        As `walking_posture`.
    """

    stride: Stride
    height_m: float
    eyes_m: float
    radius: float
    swing_m: float
    least_swing: float
    posture: _PostureFunction


def gait_of(asset: Asset) -> Gait:
    """Return the gait of an asset with a rig."""
    assert asset.rig is not None
    if asset.rig.legs == 2:
        figure = figure_of(asset.rig)
        return Gait(
            stride=figure.stride,
            height_m=figure.height_m * 1.12,
            eyes_m=figure.height_m,
            radius=_RADIUS,
            swing_m=_SWING * figure.height_m * 1.12,
            least_swing=_LEAST_SWING,
            posture=walking_posture,
        )
    animal = animal_figure_of(asset.rig)
    return Gait(
        stride=animal.stride,
        height_m=animal.height_m,
        eyes_m=float(asset.rig.head("head")[2]),
        radius=animal.radius_m / animal.height_m,
        swing_m=animal.tail_m,
        least_swing=0.0,
        posture=partial(four_legged_posture, tail=tail_habit(asset.category)),
    )
