"""Postures between postures: joints turn from one to another by the shortest way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.skeleton import Posture, joint_frames
from sailenv_ros.types.instance_states import rotation_matrices
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.rotations import between, quaternions_of

__all__ = ["JointTurns"]

Doubles = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class JointTurns:
    """A posture by the turns of joints from their parents.

    Attributes
    ----------
    root_m : (3,) float64
        Body frame [m].
    quaternions : (J, 4) float64
        x, y, z, w of each joint, from its parent; of the root from the body frame.
    """

    root_m: Doubles
    quaternions: Doubles

    @classmethod
    def of(cls, rig: Rig, posture: Posture) -> JointTurns:
        """Return a posture's turns."""
        turns, _ = joint_frames(rig, posture)
        own = turns.copy()
        own[1:] = np.einsum("jki,jkl->jil", turns[rig.parents[1:]], turns[1:])
        return cls(root_m=posture.root_m, quaternions=quaternions_of(own))

    def towards(self, other: JointTurns, share: float) -> JointTurns:
        """Return what lies between this, 0, and another, 1."""
        return JointTurns(
            root_m=self.root_m + share * (other.root_m - self.root_m),
            quaternions=between(self.quaternions, other.quaternions, share),
        )

    def posture(self, rig: Rig) -> Posture:
        """Return the posture; all joints are turned in it."""
        own = rotation_matrices(self.quaternions)
        turns = own.copy()
        for number, parent in enumerate(rig.parents.tolist()):
            if parent >= 0:
                turns[number] = turns[parent] @ own[number]
        return Posture(root_m=self.root_m, turns=dict(zip(rig.names, turns, strict=True)))
