"""Inertia of a rigid body about its centre of mass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose

__all__ = ["Inertia"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertia:
    """Principal moments and axes.

    Attributes
    ----------
    moments_kg_m2 : (3,) tuple of float
        About the principal axes.
    axes_xyzw : (4,) tuple of float
        Orientation of these axes in the body frame.
    """

    moments_kg_m2: tuple[float, float, float]
    axes_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    @classmethod
    def of_tensor(cls, tensor_kg_m2: NDArray[np.float64]) -> Inertia:
        """Return the inertia of a symmetric (3, 3) tensor in the body frame."""
        if not np.any(tensor_kg_m2 - np.diag(np.diag(tensor_kg_m2))):
            x, y, z = np.diag(tensor_kg_m2).tolist()
            return cls(moments_kg_m2=(x, y, z))
        moments, axes = np.linalg.eigh(tensor_kg_m2)
        if np.linalg.det(axes) < 0.0:
            axes[:, 2] *= -1.0
        matrix = np.eye(4)
        matrix[:3, :3] = axes
        x, y, z = moments.tolist()
        return cls(moments_kg_m2=(x, y, z), axes_xyzw=Pose.from_matrix(matrix).orientation_xyzw)
