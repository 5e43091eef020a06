"""Keeping freed memory: the same big arrays are not faulted in again and again."""

from __future__ import annotations

import subprocess
import sys

COUNT_FAULTS = """
import resource, sys
import numpy as np
from sailenv_ros.system.memory import keep_freed_memory
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
def make():
    return [np.full(1_000_000 + 1000 * n, 7, np.uint8) for n in range(10)]
if sys.argv[1] == "keep":
    assert keep_freed_memory()
for _ in range(3):
    make()
before = faults()
for _ in range(10):
    make()
print(faults() - before)
"""


def faults(how: str) -> int:
    """Count the page faults of making big arrays, in a process of its own."""
    command = [sys.executable, "-c", COUNT_FAULTS, how]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def test_kept_memory_is_not_faulted_in_again() -> None:
    """Arrays of ten megabytes, made anew ten times, cost next to no page faults."""
    assert faults("keep") < 100
    assert faults("as it is") > 10_000
