"""Many small cases in one test, which then tells of all that are wrong."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeVar

T = TypeVar("T")


def faults_of(check: Callable[[T], object], cases: Mapping[str, T]) -> dict[str, str]:
    """Try a check on each case; return the errors that it raised, by the names of the cases."""
    faults = {}
    for name, case in cases.items():
        try:
            check(case)
        except Exception as problem:
            faults[name] = f"{type(problem).__name__}: {problem}"
    return faults
