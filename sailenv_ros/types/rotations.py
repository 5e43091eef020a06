"""Many rotations at once: quaternions of matrices, and what lies between two of them.

Quaternions are in the order x, y, z, w; their matrices: `instance_states.rotation_matrices`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["between", "quaternions_of"]

Doubles = NDArray[np.float64]


def quaternions_of(turns: Doubles) -> Doubles:
    """Return (N, 4) unit quaternions of (N, 3, 3) rotations."""
    xx, yy, zz = turns[:, 0, 0], turns[:, 1, 1], turns[:, 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], 1)
    a = turns[:, 2, 1], turns[:, 0, 2], turns[:, 1, 0]
    b = turns[:, 1, 2], turns[:, 2, 0], turns[:, 0, 1]
    xw, yw, zw = (p - q for p, q in zip(a, b, strict=True))
    yz, xz, xy = (p + q for p, q in zip(a, b, strict=True))
    # Each by its largest component, so that nothing is divided by what is near 0.
    rows = np.stack([
        np.stack([squares[:, 0], xy, xz, xw], 1),
        np.stack([xy, squares[:, 1], yz, yw], 1),
        np.stack([xz, yz, squares[:, 2], zw], 1),
        np.stack([xw, yw, zw, squares[:, 3]], 1),
    ])  # fmt: skip
    found = rows[squares.argmax(axis=1), np.arange(len(turns))]
    unit: Doubles = found / np.linalg.norm(found, axis=1, keepdims=True)
    return unit


def between(one: Doubles, two: Doubles, share: float) -> Doubles:
    """Return (N, 4): quaternions between two, at 0 and at 1, by the shorter way."""
    cosine = np.einsum("jk,jk->j", one, two)
    two = np.where(cosine[:, None] < 0.0, -two, two)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    sine = np.sin(angle)
    near = sine < 1e-6
    divided = np.where(near, 1.0, sine)
    first = np.where(near, 1.0 - share, np.sin((1.0 - share) * angle) / divided)
    second = np.where(near, share, np.sin(share * angle) / divided)
    found = first[:, None] * one + second[:, None] * two
    unit: Doubles = found / np.linalg.norm(found, axis=1, keepdims=True)
    return unit
