"""Splits of a data set: which frame is for training, which for validation, which for testing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.validation import checked_number

__all__ = ["SPLITS", "Splits"]

SPLITS = ("train", "val", "test")

_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True)
class Splits:
    """Random assignment of frames to splits.

    The split of a frame follows from the seed and its number alone, so it is the same in each
    format, for each writer and after a break; shares are met on average.

    Attributes
    ----------
    shares : (3,) tuple of float
        Of ``train``, ``val`` and ``test``; they add up to 1.
    seed : int
        0 or more.

    Raises
    ------
    InvalidRequest
        If the shares do not add up to 1, or one of them is negative.
    """

    shares: tuple[float, ...]
    seed: int = 0

    def __post_init__(self) -> None:
        if not isinstance(self.shares, Sequence) or not 2 <= len(self.shares) <= len(SPLITS):
            raise InvalidRequest("split", self.shares, "the shares of train, val and test")
        for name, share in zip(SPLITS, self.shares, strict=False):
            checked_number(f"share of {name}", share, 0.0, 1.0)
        if abs(sum(self.shares) - 1.0) > _TOLERANCE:
            raise InvalidRequest("split", self.shares, "shares that add up to 1")
        if self.seed < 0:
            raise InvalidRequest("seed of the split", self.seed, "an integer from 0")

    def of_frame(self, number: int) -> str:
        """Return the split of the frame of that number."""
        at = np.random.default_rng([self.seed, number]).random()
        total = 0.0
        for name, share in zip(SPLITS, self.shares, strict=False):
            total += share
            if at < total:
                return name
        return next(n for n, s in reversed([*zip(SPLITS, self.shares, strict=False)]) if s > 0.0)
