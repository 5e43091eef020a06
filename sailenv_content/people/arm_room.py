"""Room for arms: how far from the body they hang, so that hands and sleeves keep off clothes."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.dressing import PersonPart
from sailenv_ros.types.rig import Rig

__all__ = ["arms_out"]

Doubles = NDArray[np.float64]

_ARM = re.compile(r"(clavicle|shoulder01|upperarm01|lowerarm01|wrist|finger.*)\.[LR]|head|neck.*")
_OFF_M = 0.014
"""Between an arm and what is worn on the body [m]."""

_CURLED = 0.15
"""How much farther in than a forearm the fingers of a hand at ease reach, over its length."""

_BESIDE_M = 0.14
"""How far before or behind an arm a body is beside it [m]."""

_RESTS = 0.3
"""Part of the forearm that may lie on the body, as the upper arm may, over its length."""

_WRIST = 0.75
"""Part of the forearm after which it is as thick as wrist and hand, over its length."""

_MOST = 0.45


def arms_out(rig: Rig, parts: Sequence[PersonPart]) -> float:
    """Return `Rig.arms_out` of a person in clothes."""
    shoulder, elbow, wrist = (
        rig.head(f"{bone}.L") for bone in ("upperarm01", "lowerarm01", "wrist")
    )
    upper, lower = (float(np.linalg.norm(b - a)) for a, b in ((shoulder, elbow), (elbow, wrist)))
    hand = 1.3 * float(np.linalg.norm(rig.head("finger3-3.L") - wrist))
    is_arm = np.array([_ARM.fullmatch(name) is not None for name in rig.names])
    forearm = rig.joint_of["lowerarm01.L"]
    body, sleeves = [], []
    for part in parts:
        main = part.bones[np.arange(len(part.bones)), part.weights.argmax(axis=1)]
        body.append(part.positions[~is_arm[main]])
        sleeves.append(part.positions[main == forearm])
    along = (wrist - elbow) / lower
    from_elbow = np.concatenate(sleeves) - elbow
    way = from_elbow @ along
    thick = np.linalg.norm(from_elbow - way[:, None] * along, axis=1)[way > _WRIST * lower]
    places = np.concatenate(body)
    below = shoulder[2] - places[:, 2]
    near = (below > upper + _RESTS * lower) & (below < upper + lower + hand)
    near &= np.abs(places[:, 0] - shoulder[0]) < _BESIDE_M
    wide = places[near, 1] + float(np.median(thick)) + _OFF_M - shoulder[1]
    wide += np.where(below[near] > upper + lower, _CURLED * hand, 0.0)
    return float(np.clip((wide / below[near]).max(initial=0.0), 0.0, _MOST))
