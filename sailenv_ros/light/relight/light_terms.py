"""Terms of the light on objects, see `irradiance_of_terms` of light_law.h: fitted and summed up."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

__all__ = ["fitted_terms", "terms_at"]

Doubles: TypeAlias = NDArray[np.float64]

STIFFNESS = np.array([0.0] + 3 * [1.3] + 24 * [0.26])
"""How strongly each term is held back where points do not tell it: as by so many points."""


def terms_at(positions: Doubles, normals: Doubles, axes: Doubles) -> Doubles:
    """Return how much each term counts at points of a surface.

    Parameters
    ----------
    positions, normals : (P, 3) float64
    axes : (3, 3) float64
        Of the body, one a row.

    Returns
    -------
    counts : (P, LIGHT_TERMS) float64
    """
    along = normals @ axes.T
    sides = np.concatenate([np.maximum(along, 0.0), np.minimum(along, 0.0)], axis=1) ** 2
    places = np.concatenate([np.ones((len(normals), 1)), positions], axis=1)
    of_sides = (sides[:, :, None] * places[:, None, :]).reshape(len(normals), -1)
    return np.concatenate([np.ones((len(normals), 1)), normals, of_sides], axis=1)


def fitted_terms(positions: Doubles, normals: Doubles, weights: Doubles, axes: Doubles) -> Doubles:
    """Return (LIGHT_TERMS, P): from values at points to terms, by weighted least squares."""
    middle = (weights[:, None] * positions).sum(axis=0) / weights.sum()
    reach = max(float(np.linalg.norm(positions - middle, axis=1).max()), 1e-6)
    basis = terms_at((positions - middle) / reach, normals, axes)
    normal = (basis * weights[:, None]).T @ basis + np.diag(STIFFNESS * weights.mean())
    fit = np.asarray(np.linalg.solve(normal, (basis * weights[:, None]).T), np.float64)
    by_side = fit[4:].reshape(6, 4, -1)
    by_side[:, 1:] /= reach
    by_side[:, 0] -= np.einsum("x,sxp->sp", middle, by_side[:, 1:])
    return fit
