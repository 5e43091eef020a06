"""Prequential evaluation: a learner is tested on each example before it learns from it.

Accuracy over all, with a forgetting factor as in Gama, Sebastião and Rodrigues, *On evaluating
stream learning algorithms* (Machine Learning 90, 2013), and forgetting per class as in Chaudhry et
al. (ECCV 2018): the best accuracy so far less the present one.
"""

from __future__ import annotations

from collections.abc import Mapping

from sailenv_ros.types.validation import Bounds

__all__ = ["Prequential"]

_FADING = Bounds(above=0.0, most=1.0)


class Prequential:
    """Scores predictions as they come.

    Parameters
    ----------
    fading : float
        Factor by which each example counts less than the one after it, above 0 to 1.

    Raises
    ------
    InvalidRequest
        If the factor is not accepted.
    """

    def __init__(self, fading: float = 0.999) -> None:
        self._fading = _FADING.number("fading", fading)
        self._all = _Faded()
        self._classes: dict[int, _Faded] = {}
        self._right = self._count = 0

    def add(self, predicted: int, label: int) -> None:
        """Score one prediction."""
        hit = float(predicted == label)
        self._right += predicted == label
        self._count += 1
        self._all.add(hit, self._fading)
        self._classes.setdefault(label, _Faded()).add(hit, self._fading)

    @property
    def count(self) -> int:
        """Number of examples so far."""
        return self._count

    @property
    def accuracy(self) -> float:
        """Share of right predictions over all examples; NaN before the first."""
        return self._right / self._count if self._count else float("nan")

    @property
    def recent(self) -> float:
        """The same with fading; NaN before the first."""
        return self._all.mean

    @property
    def of_classes(self) -> Mapping[int, float]:
        """Faded accuracy of each class, by its label."""
        return {label: one.mean for label, one in sorted(self._classes.items())}

    @property
    def forgetting(self) -> Mapping[int, float]:
        """Best faded accuracy of each class so far less its present one, 0 to 1."""
        return {label: one.best - one.mean for label, one in sorted(self._classes.items())}


class _Faded:
    """A mean in which later values count more."""

    __slots__ = ("best", "sum", "weight")

    def __init__(self) -> None:
        self.sum = self.weight = self.best = 0.0

    def add(self, value: float, fading: float) -> None:
        self.sum = value + fading * self.sum
        self.weight = 1.0 + fading * self.weight
        self.best = max(self.best, self.mean)

    @property
    def mean(self) -> float:
        return self.sum / self.weight if self.weight else float("nan")
