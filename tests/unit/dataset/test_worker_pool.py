"""Pieces are shared out to workers in runs, and survive the death of a worker."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import pytest

from sailenv_ros.dataset.engine import ATTEMPTS
from sailenv_ros.dataset.worker_pool import WorkerPool
from sailenv_ros.errors import RecordingError
from tests.support.waiting import until


def _maker(
    folder: Path, waits: Mapping[int, int], deaths: Mapping[int, int], on_frame: Callable[[], None]
) -> Callable[[int], tuple[int, int]]:
    return partial(_make, folder, waits, deaths)


def _make(
    folder: Path, waits: Mapping[int, int], deaths: Mapping[int, int], number: int
) -> tuple[int, int]:
    """Begin a piece, wait for the begin of another one, and return the number and the process."""
    begun = folder / f"{number}"
    begun.open("ab").write(b".")
    if begun.stat().st_size <= deaths.get(number, 0):
        os.kill(os.getpid(), signal.SIGKILL)
    if number in waits:
        until((folder / f"{waits[number]}").exists, f"piece {waits[number]}", timeout_s=60.0)
    return number, os.getpid()


def _made(
    folder: Path, waits: Mapping[int, int], deaths: Mapping[int, int] | None = None
) -> dict[int, int]:
    """Return the process of each of four pieces by two workers."""
    pool = WorkerPool(
        workers=2, maker=_maker, arguments=(folder, waits, deaths or {}), piece="shard"
    )
    return dict(pool.run(range(4), lambda made: None))


def test_neighbours_have_the_same_worker(tmp_path: Path) -> None:
    # Neither worker is through with its first piece, or its second, before the other begins that.
    made = _made(tmp_path, {0: 2, 2: 0, 1: 3, 3: 1})
    assert made[0] == made[1]
    assert made[2] == made[3]
    assert made[0] != made[2]


def test_an_idle_worker_helps(tmp_path: Path) -> None:
    # The first worker ends its first piece when the other one has begun the second of its run.
    made = _made(tmp_path, {0: 1})
    assert made[1] == made[2] == made[3]
    assert made[0] != made[1]


def test_a_killed_worker_is_replaced(tmp_path: Path) -> None:
    made = _made(tmp_path, {}, {1: ATTEMPTS - 1})
    assert sorted(made) == [0, 1, 2, 3]


def test_a_piece_that_kills_its_workers_is_told(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=rf"shard 1 was killed {ATTEMPTS} times"):
        _made(tmp_path, {}, {1: ATTEMPTS})


def test_ctrl_c_waits_until_nothing_is_half_done(tmp_path: Path) -> None:
    """It comes while frames are counted, is told after that, and takes the workers along."""
    counted: list[int] = []

    def on_frames(made: int) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        counted.append(made)

    pool = WorkerPool(workers=2, maker=_maker, arguments=(tmp_path, {0: 9, 2: 9}, {}), piece="one")
    with pytest.raises(KeyboardInterrupt):
        list(pool.run(range(4), on_frames))
    assert len(counted) == 1
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert not multiprocessing.active_children()
