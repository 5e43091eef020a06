"""A process that is killed at its n-th call to the disk, as `kill -9` and the system do."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable
from pathlib import Path

from tests.support.faulty_disk import FaultyDisk

__all__ = ["killed_at"]


class KillingDisk(FaultyDisk):
    """Ends its process where `FaultyDisk` would fail a call."""

    def check(self, what: str, path: object) -> None:
        """Count a call; be killed at the one that was asked for."""
        self.calls += 1
        if self.calls == self.fail_at:
            os.kill(os.getpid(), signal.SIGKILL)


def killed_at(call: int, folder: Path, act: Callable[[], object]) -> bool:
    """Do something in another process that is killed at a call to the disk below a folder.

    Returns
    -------
    killed : bool
        False if it ended before it made so many calls.
    """

    def run() -> None:
        with KillingDisk(folder, fail_at=call):
            act()

    process = multiprocessing.get_context("fork").Process(target=run)
    process.start()
    process.join()
    assert process.exitcode in (0, -signal.SIGKILL)
    return process.exitcode != 0
