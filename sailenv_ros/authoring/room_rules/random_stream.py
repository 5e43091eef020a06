"""Random numbers of a generator: one source for each purpose, named; the same on every machine."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import blake2b
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["RandomStream"]

T = TypeVar("T")


class RandomStream:
    """Draws numbers for one purpose.

    Parameters
    ----------
    *names : object
        Kind of room, seed, attempt, purpose: equal names draw equal numbers.
    """

    def __init__(self, *names: object) -> None:
        digest = blake2b("\x1f".join(map(str, names)).encode(), digest_size=16).digest()
        self._generator = np.random.Generator(np.random.PCG64(int.from_bytes(digest, "little")))

    def between(self, span: tuple[float, float]) -> float:
        """Return a number from a span."""
        return float(span[0] + (span[1] - span[0]) * self._generator.random())

    def whole(self, span: tuple[int, int]) -> int:
        """Return an integer from a span, both ends included."""
        return int(self._generator.integers(span[0], span[1] + 1))

    def chance(self, share: float) -> bool:
        """Return true for so large a share of all draws."""
        return bool(self._generator.random() < share)

    def one(self, choices: Sequence[T]) -> T:
        """Return one of several."""
        return choices[int(self._generator.integers(len(choices)))]

    def weighted(self, choices: Sequence[T], weights: Sequence[float]) -> T:
        """Return one of several, each as often as its weight says."""
        ends = np.cumsum(weights)
        return choices[int(np.searchsorted(ends, self._generator.random() * ends[-1], "right"))]

    def mixed(self, choices: Sequence[T]) -> list[T]:
        """Return all of several in another order."""
        return [choices[index] for index in self._generator.permutation(len(choices))]

    def places(self, total: int, count: int) -> NDArray[np.int64]:
        """Return (count,) different places of a list of so many."""
        return self._generator.choice(total, count, replace=False)
