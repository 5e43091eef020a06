"""How tall people are, by their age and sex, and by their place among those of the same."""

from __future__ import annotations

import numpy as np

__all__ = ["stature_m"]

_AGES = (2.0, 4.0, 6.0, 8.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 18.0, 20.0, 50.0, 80.0)
_MALE = (
    *(0.868, 1.025, 1.157, 1.281, 1.388, 1.437, 1.493, 1.562, 1.638, 1.701, 1.736, 1.761),
    *(1.768, 1.765, 1.735),
)
_FEMALE = (
    *(0.854, 1.010, 1.149, 1.278, 1.382, 1.448, 1.515, 1.571, 1.604, 1.619, 1.625, 1.631),
    *(1.633, 1.630, 1.600),
)
"""Medians of the growth charts of the CDC (2000) up to 20 years; then they shrink a little [m]."""

_DEVIATION = 0.04
"""Standard deviation of statures over their median."""

_SPREAD = 4.0
"""Standard deviations from a share of 0 to one of 1."""


def stature_m(age_years: float, female: float, share: float = 0.5) -> float:
    """Return how tall a person is, without shoes [m].

    Parameters
    ----------
    age_years : float
        2 to 80; those beyond are as tall as these.
    female : float
        0 to 1.
    share : float
        0 two standard deviations below the median, 0.5 at it, 1 as far above.
    """
    male, other = (float(np.interp(age_years, _AGES, table)) for table in (_MALE, _FEMALE))
    median = male + female * (other - male)
    return median * (1.0 + _DEVIATION * _SPREAD * (share - 0.5))
