"""Places on the body by which clothes are cut, on the neutral body that all others are made of.

Each is a number for each vertex of MakeHuman's mesh, in metres of the neutral body: how far along
an arm it lies, how high, how near the neck. Cuts are where such a number has a value.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.makehuman import BodyData

__all__ = ["Landmarks"]

Doubles = NDArray[np.float64]

_ARM = ("upperarm", "lowerarm", "wrist", "finger", "metacarpal")
_LEG = ("upperleg", "lowerleg", "foot", "toe")
_HAIRLINE_DEG = (0.0, 22.0, 32.0, 40.0, 48.0, 58.0, 72.0, 80.0, 92.0, 104.0, 125.0, 150.0, 180.0)
_HAIRLINE_M = (
    *(0.796, 0.797, 0.790, 0.774, 0.755, 0.738, 0.716, 0.728, 0.742, 0.730, 0.685, 0.655, 0.648),
)

_NOT_ON_IT = -0.3
"""Along an arm, of what is no arm [m]."""


class Landmarks:
    """Numbers of the vertices of the neutral body.

    Parameters
    ----------
    data : BodyData
    """

    def __init__(self, data: BodyData) -> None:
        self._data = data
        self.base = data.base

    @cached_property
    def arm_m(self) -> Doubles:
        """(V,): distance from the shoulder along the arm."""
        shoulder, elbow, wrist = (
            self._joint(name) for name in ("upperarm01.L", "lowerarm01.L", "wrist.L")
        )
        mirrored = self.base * np.where(self.base[:, 1:2] < 0.0, [1.0, -1.0, 1.0], 1.0)
        upper, lower = elbow - shoulder, wrist - elbow
        length = float(np.linalg.norm(upper))
        along = (mirrored - shoulder) @ (upper / length)
        beyond = (mirrored - elbow) @ (lower / np.linalg.norm(lower))
        along = np.where(along > length, length + np.maximum(beyond, 0.0), along)
        return np.where(self._share(_ARM) > 0.3, along, _NOT_ON_IT)

    @cached_property
    def height_m(self) -> Doubles:
        """(V,): height, 0 at the root's height; the soles are at -0.817."""
        found: Doubles = self.base[:, 2]
        return found

    @cached_property
    def neck_m(self) -> Doubles:
        """(V,): height above a plane through the base of the neck, lower in front."""
        x, y, z = self.base.T
        # Shoulders are as high as the neck begins, and are not it.
        beside = np.maximum(np.abs(y) - 0.075, 0.0)
        height: Doubles = z - 0.59 + 0.45 * x - 0.6 * beside
        return height

    @cached_property
    def is_arm(self) -> NDArray[np.bool_]:
        """(V,): what moves with an arm."""
        found: NDArray[np.bool_] = self._share(_ARM) > 0.5
        return found

    @cached_property
    def is_leg(self) -> NDArray[np.bool_]:
        """(V,): what moves with a leg."""
        found: NDArray[np.bool_] = self._share(_LEG) > 0.5
        return found

    @cached_property
    def scalp_m(self) -> Doubles:
        """(V,): below 0 where hair grows, by how far from the hairline."""
        x, y, z = self.base.T
        # By the angle from the front: forehead, temples, before and over the ears, nape.
        around = np.degrees(np.arctan2(np.abs(y), x - 0.02))
        line = np.interp(around, _HAIRLINE_DEG, _HAIRLINE_M)
        ear = np.maximum(0.0, 0.030 - np.hypot(x - 0.030, z - 0.716)) * (np.abs(y) > 0.062)
        return np.where(z > 0.6, line - z + ear, 1.0)

    def _joint(self, name: str) -> Doubles:
        return self._data.joint(self.base, self._data.bones[name]["head"])

    def _share(self, words: tuple[str, ...]) -> Doubles:
        total, chosen = np.zeros(len(self.base)), np.zeros(len(self.base))
        for name, pairs in self._data.bone_weights.items():
            if not pairs:
                continue
            places, weights = np.array(pairs, np.float64).T
            at = places.astype(np.int64)
            total[at] += weights
            if name.startswith(words):
                chosen[at] += weights
        return chosen / np.maximum(total, 1e-9)
