"""Clothes: MakeHuman's tights and skirt, cut by landmarks and moved off the skin.

A kind of garment is where it ends on the body and how loosely it sits. It needs no sewing pattern:
where it is looser, hollows of the body are bridged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.landmarks import Landmarks

__all__ = ["GARMENTS", "SOLE_M", "GarmentKind"]

Doubles = NDArray[np.float64]

SOLE_M = 0.018
"""Of shoes [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GarmentKind:
    """One kind of garment.

    Attributes
    ----------
    label : str
        Name of its part; what covers the same has the same label.
    group : str
        Of MakeHuman's mesh that it is cut from.
    field : callable
        ``field(landmarks)`` returns (V,): below 0 where it is, in metres from its edge.
    ease_m : float
        How far off the body it lies at least [m].
    flare_m : float
        How much farther at its lower edges [m].
    bridging : int
        Rounds of smoothing by which hollows are bridged.
    fabric : str
        ``weave``, ``denim`` or ``leather``.
    tile_m : float
        Edge of what its texture shows, as a share of the pattern's.
    """

    label: str
    group: str
    field: Callable[[Landmarks], Doubles]
    ease_m: float
    flare_m: float = 0.0
    bridging: int = 0
    fabric: str = "weave"


def _top(sleeve_m: float, hem_m: float, neck_m: float) -> Callable[[Landmarks], Doubles]:
    def field(marks: Landmarks) -> Doubles:
        low = np.where(marks.is_arm, -1.0, hem_m - marks.height_m)
        highest = np.maximum.reduce([marks.arm_m - sleeve_m, low, marks.neck_m - neck_m])
        return np.asarray(highest, np.float64)

    return field


def _trousers(hem_m: float, waist_m: float = 0.12) -> Callable[[Landmarks], Doubles]:
    def field(marks: Landmarks) -> Doubles:
        body = np.maximum(marks.height_m - waist_m, hem_m - marks.height_m)
        return np.where(marks.is_arm, 1.0, body)

    return field


def _skirt(hem_m: float) -> Callable[[Landmarks], Doubles]:
    return _trousers(hem_m, 0.16)


def _shoes(top_m: float) -> Callable[[Landmarks], Doubles]:
    def field(marks: Landmarks) -> Doubles:
        tilt = 0.25 * (marks.base[:, 0] - 0.02)
        height = marks.height_m - top_m + np.maximum(tilt, 0.0)
        return np.where(marks.is_leg, height, 1.0)

    return field


_TIGHTS, _SKIRT = "helper-tights", "helper-skirt"

GARMENTS: Mapping[str, GarmentKind] = MappingProxyType(
    {
        "t-shirt": GarmentKind(
            label="shirt", group=_TIGHTS, field=_top(0.16, 0.03, 0.012),
            ease_m=0.010, flare_m=0.012, bridging=14,
        ),
        "vest": GarmentKind(
            label="shirt", group=_TIGHTS, field=_top(0.035, 0.03, -0.012),
            ease_m=0.009, flare_m=0.008, bridging=12,
        ),
        "blouse": GarmentKind(
            label="shirt", group=_TIGHTS, field=_top(0.33, 0.03, 0.0),
            ease_m=0.012, flare_m=0.020, bridging=18,
        ),
        "shirt": GarmentKind(
            label="shirt", group=_TIGHTS, field=_top(0.435, 0.02, 0.032),
            ease_m=0.012, flare_m=0.012, bridging=16,
        ),
        "pullover": GarmentKind(
            label="shirt", group=_TIGHTS, field=_top(0.44, 0.025, 0.022),
            ease_m=0.018, flare_m=0.006, bridging=24,
        ),
        "jacket": GarmentKind(
            label="jacket", group=_TIGHTS, field=_top(0.445, 0.005, 0.045),
            ease_m=0.024, flare_m=0.022, bridging=28, fabric="denim",
        ),
        "trousers": GarmentKind(
            label="trousers", group=_TIGHTS, field=_trousers(-0.755),
            ease_m=0.008, flare_m=0.018, bridging=8,
        ),
        "jeans": GarmentKind(
            label="trousers", group=_TIGHTS, field=_trousers(-0.745),
            ease_m=0.006, flare_m=0.008, bridging=5, fabric="denim",
        ),
        "shorts": GarmentKind(
            label="trousers", group=_TIGHTS, field=_trousers(-0.30),
            ease_m=0.009, flare_m=0.018, bridging=8,
        ),
        "leggings": GarmentKind(
            label="trousers", group=_TIGHTS, field=_trousers(-0.74), ease_m=0.004, bridging=2,
        ),
        "skirt": GarmentKind(label="skirt", group=_SKIRT, field=_skirt(-0.40), ease_m=0.012),
        "long skirt": GarmentKind(label="skirt", group=_SKIRT, field=_skirt(-0.64), ease_m=0.012),
        "shoes": GarmentKind(
            label="shoes", group=_TIGHTS, field=_shoes(-0.738), ease_m=0.007, bridging=4,
            fabric="leather",
        ),
        "boots": GarmentKind(
            label="shoes", group=_TIGHTS, field=_shoes(-0.66), ease_m=0.009, bridging=6,
            fabric="leather",
        ),
    }
)  # fmt: skip
