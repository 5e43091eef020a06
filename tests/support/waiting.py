"""Waiting for a condition with a deadline, instead of sleeping for a guess."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

SHORTEST_S, LONGEST_S = 0.0005, 0.01
"""Between two looks: much of what is waited for is there at once."""


def until(condition: Callable[[], object], what: str, timeout_s: float = 60.0) -> None:
    """Wait until a condition holds; fail by naming what was waited for."""
    deadline = time.monotonic() + timeout_s
    pause, pause_s = threading.Event(), SHORTEST_S
    while not condition():
        assert time.monotonic() < deadline, (
            f"timed out after {timeout_s:g} s while waiting for {what}"
        )
        pause.wait(pause_s)
        pause_s = min(2 * pause_s, LONGEST_S)
