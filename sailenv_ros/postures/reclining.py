"""Reclining, as cats and dogs lie: upon the belly, the legs in front ahead, those behind folded.

How low the trunk is, and where the paws are for it, from a skeleton and the skin below its trunk.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.animal_figure import FORE, HIND, animal_figure_of
from sailenv_ros.postures.skeleton import turn_about
from sailenv_ros.types.rig import Rig

__all__ = ["HOCK_DEG", "WRIST_DEG", "Recline", "recline_of"]

Doubles = NDArray[np.float64]

WRIST_DEG, HOCK_DEG = -58.0, -58.0
"""Roll of the bones above the paws, which lie upon the floor then [deg]."""

_HIP = 0.30
"""Height of the hips, over that at rest."""

_ELBOW, _WRIST = 0.12, 0.10
"""Heights of the joints of the legs in front, over that of the shoulders at rest."""

_FOLD = 0.02
"""How far the hocks are ahead of the hips, over the height of the hips at rest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recline:
    """One skeleton that lies upon its belly.

    Attributes
    ----------
    pitch_deg : float
        Of the trunk, downwards.
    root_m : (2,) tuple of float
        Where the root is: ahead of the middle of the paws behind, and above the floor.
    ahead_m : (2,) tuple of float
        How far the paws in front, and behind, step forward before [m].
    """

    pitch_deg: float
    root_m: tuple[float, float]
    ahead_m: tuple[float, float]


_known: WeakKeyDictionary[Rig, Recline] = WeakKeyDictionary()


def recline_of(rig: Rig, belly_m: float) -> Recline:
    """Return how an animal lies; the same object each time.

    Parameters
    ----------
    rig : Rig
    belly_m : float
        Height of the lowest skin of its chest and belly at rest.
    """
    if rig not in _known:
        _known[rig] = _recline(rig, belly_m)
    return _known[rig]


def _recline(rig: Rig, belly_m: float) -> Recline:
    figure = animal_figure_of(rig)
    fore, hind = ([rig.head(f"{bone}.L") for bone in bones] for bones in (FORE, HIND))
    root, chest = rig.head("root"), rig.head("spine03")
    # The chest sinks until the belly lies, the hips sink further.
    shoulder_m, hip_m = float(figure.legs_m[0]), float(figure.legs_m[2])
    drops = hip_m * (1.0 - _HIP), belly_m
    pitch = -float(np.degrees(np.arcsin((drops[0] - drops[1]) / (chest[0] - root[0]))))
    turn = turn_about("y", pitch)
    height = float(root[2]) - drops[0]
    shoulder, hip = (turn @ (place - root) + [0.0, 0.0, height] for place in (fore[0], hind[0]))
    upper, lower, _ = (float(np.linalg.norm(b - a)) for a, b in itertools.pairwise(fore))
    elbow_m, wrist_m = _ELBOW * shoulder_m, _WRIST * shoulder_m
    back = float(np.sqrt(max(upper**2 - (shoulder[2] - elbow_m) ** 2, 0.0)))
    onwards = float(np.sqrt(max(lower**2 - (elbow_m - wrist_m) ** 2, 0.0)))
    wrist = turn_about("y", WRIST_DEG) @ (fore[2] - fore[3])
    hock = turn_about("y", HOCK_DEG) @ (hind[2] - hind[3])
    in_front = float(shoulder[0]) - back + onwards - float(wrist[0])
    behind = float(hip[0]) + _FOLD * hip_m - float(hock[0])
    # So that the trunk moves as far ahead before as it moves back then.
    longer = in_front - behind - figure.base_m
    moves = float(root[0]) - float(figure.paws[2, 0]) + behind
    steps = 0.5 * (moves - 0.5 * longer)
    return Recline(pitch_deg=pitch, root_m=(-behind, height), ahead_m=(steps + longer, steps))
