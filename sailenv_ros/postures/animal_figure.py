"""Measures of a four-legged skeleton that its movements are made of; computed once for each."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.footsteps import Stride
from sailenv_ros.types.rig import Rig

__all__ = ["FORE", "HIND", "LEGS", "AnimalFigure", "animal_figure_of"]

Doubles = NDArray[np.float64]

FORE = ("upperarm", "forearm", "wrist", "forepaw")
HIND = ("thigh", "shank", "hock", "hindpaw")

LEGS = tuple((bones, side) for bones in (FORE, HIND) for side in "LR")
"""Joints of each leg from the top to the paw, and its side, in the order of feet."""

_SPEED = 1.15
"""Speed of walking over the root of the legs' height [sqrt(m)/s], a Froude number of 0.13."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class AnimalFigure:
    """Measures of one skeleton [m].

    Attributes
    ----------
    paws : (4, 3) float64
        Where the joints of the paws are at rest, in the order of feet.
    legs_m : (4,) float64
        Heights of the joints that carry the legs.
    base_m, width_m : float
        Between the paws at rest, along and across.
    middle : (3,) float64
        Of the trunk at rest.
    height_m : float
        Of the top of the head.
    radius_m : float
        Of a circle about the body's origin that it stands in, without its tail.
    tail_m : float
        How far its tail may reach out of that.
    """

    paws: Doubles
    legs_m: Doubles
    base_m: float
    width_m: float
    middle: Doubles
    height_m: float
    radius_m: float
    tail_m: float

    @property
    def stride(self) -> Stride:
        """Measures of steps at an easy pace."""
        tall = float(self.legs_m.mean())
        length = 0.43 * tall
        return Stride(
            length_m=length,
            width_m=self.width_m,
            step_s=length / (_SPEED * float(np.sqrt(tall))),
            base_m=self.base_m,
            lead_m=-float(self.paws[:, 0].mean()),
        )


_known: WeakKeyDictionary[Rig, AnimalFigure] = WeakKeyDictionary()


def animal_figure_of(rig: Rig) -> AnimalFigure:
    """Return the measures of a skeleton; the same object each time."""
    if rig not in _known:
        paws = np.array([rig.head(f"{bones[-1]}.{side}") for bones, side in LEGS])
        tops = np.array([rig.head(f"{bones[0]}.{side}") for bones, side in LEGS])
        head, nose, tail = (rig.head(name) for name in ("head", "nose", "tail01"))
        bones = [rig.head(name) for name in rig.names if name.startswith("tail")]
        size = float(np.linalg.norm(nose - head))
        _known[rig] = AnimalFigure(
            paws=paws,
            legs_m=tops[:, 2],
            base_m=float(paws[0, 0] - paws[2, 0]),
            width_m=float(paws[0, 1] - paws[1, 1]),
            middle=0.5 * (rig.head("root") + rig.head("spine03")),
            height_m=float(head[2]) + 0.9 * size,
            radius_m=max(float(nose[0]), -float(tail[0])) + 0.11 * size,
            tail_m=float(np.linalg.norm(np.diff(bones, axis=0), axis=1).sum()),
        )
    return _known[rig]
