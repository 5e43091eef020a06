"""One row of the table of figures, and how rows become JSON and come back."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

__all__ = ["Measurement", "from_plain", "median_s", "plain"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """A figure, and a second one that was measured in turn with it.

    Attributes
    ----------
    name : str
        The thing measured.
    value : float
        Its median, in `unit`.
    unit : str
    other : str
        The thing that it is compared with, or empty.
    other_value : float or None
        The median of that, in `unit`.
    """

    name: str
    value: float
    unit: str
    other: str = ""
    other_value: float | None = None

    @property
    def ratio(self) -> float | None:
        """`value` divided by `other_value`; None if there is no other one."""
        return self.value / self.other_value if self.other_value else None


def plain(measurement: Measurement) -> dict[str, Any]:
    """Return a measurement as JSON can hold it, with its ratio."""
    return {**asdict(measurement), "ratio": measurement.ratio}


def from_plain(entry: Mapping[str, Any]) -> Measurement:
    """Return the measurement that `plain` wrote."""
    return Measurement(**{name: value for name, value in entry.items() if name != "ratio"})


def median_s(
    work: Callable[[], object], rounds: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Return the median time of a call [s] over some rounds."""
    times = []
    for _ in range(rounds):
        began = clock()
        work()
        times.append(clock() - began)
    return statistics.median(times)
