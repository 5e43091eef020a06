"""Samples in, the numbers that stand in a table out."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypedDict

import numpy as np
from scipy import stats

__all__ = ["Summary", "mean_and_deviation", "summary_ms"]


class Summary(TypedDict):
    """Of a sample of times [ms]; ``half_interval`` is half of the mean's 95 % interval."""

    mean: float
    half_interval: float
    median: float
    p90: float
    count: int


def summary_ms(times_s: Iterable[float]) -> Summary:
    """Summarise wall times [s] in milliseconds.

    The 95 % interval is Student's; with fewer than two samples it is infinite.
    """
    values = 1e3 * np.asarray(list(times_s), np.float64)
    count = len(values)
    if count == 0:
        nan = float("nan")
        return Summary(mean=nan, half_interval=nan, median=nan, p90=nan, count=0)
    half = float("inf")
    if count > 1:
        half = float(stats.t.ppf(0.975, count - 1) * values.std(ddof=1) / np.sqrt(count))
    return Summary(
        mean=float(values.mean()),
        half_interval=half,
        median=float(np.median(values)),
        p90=float(np.percentile(values, 90)),
        count=count,
    )


def mean_and_deviation(values: Iterable[float]) -> tuple[float, float]:
    """Return mean and standard deviation (of the sample itself, n in the denominator); nan if none.

    The paper's tables have mean ± deviation over the views.
    """
    array = np.asarray(list(values), np.float64)
    if not len(array):
        return float("nan"), float("nan")
    return float(array.mean()), float(array.std())
