"""How many threads work at a time."""

from __future__ import annotations

import os

import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.threads import THREADS_VARIABLE, thread_count


def test_the_number_of_threads_can_be_set(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the environment, else it is that of the processors."""
    monkeypatch.delenv(THREADS_VARIABLE, raising=False)
    assert thread_count() == len(os.sched_getaffinity(0))
    monkeypatch.setenv(THREADS_VARIABLE, "3")
    assert thread_count() == 3
    for wrong in ("0", "-2", "many", "1000"):
        monkeypatch.setenv(THREADS_VARIABLE, wrong)
        with pytest.raises(InvalidRequest, match="SAILENV_THREADS"):
            thread_count()
