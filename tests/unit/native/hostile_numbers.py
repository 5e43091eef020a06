"""Numbers that nobody should give to a kernel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["NUMBERS", "THREADS", "wild_floats"]

THREADS = (1, 3)

NUMBERS = (np.nan, np.inf, -np.inf, -1.0, 0.0, 1e-45, 1e-9, 0.3, 1e30, 65535.0, 65536.0, 3e9)
"""What surfaces, motions and lenses are made of."""


def wild_floats(rng: np.random.Generator, *shape: int) -> NDArray[np.float32]:
    """Make an array of hostile numbers."""
    return rng.choice(np.array(NUMBERS, np.float32), shape)
