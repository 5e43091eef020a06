"""How shards are dealt out, and that a room is baked once whoever needs it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.dataset import shard_maker
from sailenv_ros.dataset.engines import dealt


@given(shards=st.lists(st.integers(), unique=True, max_size=50), workers=st.integers(1, 12))
def test_every_shard_is_dealt_once(shards: list[int], workers: int) -> None:
    assert sorted(dealt(shards, workers)) == sorted(shards)


def test_each_worker_gets_neighbours() -> None:
    order = dealt(range(12), 3)
    # All of them take one in turn.
    assert [order[worker::3] for worker in range(3)] == [
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [8, 9, 10, 11],
    ]


class _Room:
    """A world of a room as `_bake_missing` asks it."""

    def __init__(self) -> None:
        self.contents = type("Contents", (), {"baked": None})
        self.described = type("Described", (), {"room": object()})
        self.light: object = None

    def snapshot(self) -> object:
        return self

    def set_baked(self, baked: object) -> None:
        self.light = baked


def test_two_workers_bake_a_room_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    stored: dict[str, object] = {}
    baked: list[object] = []
    second_waits = threading.Event()

    def bake(snapshot: object) -> object:
        # The second one has come to the lock before there is anything to load.
        assert second_waits.wait(30.0)
        baked.append(snapshot)
        return "light"

    real = shard_maker.file_lock
    asked: list[None] = []

    @contextmanager
    def lock(*args: Any, **options: Any) -> Iterator[None]:
        asked.append(None)
        if len(asked) == 2:
            second_waits.set()
        with real(*args, **options):
            yield

    monkeypatch.setattr(shard_maker, "file_lock", lock)
    monkeypatch.setattr(shard_maker, "light_folder", lambda: tmp_path)
    monkeypatch.setattr(shard_maker, "fingerprint", lambda snapshot: "ab")
    monkeypatch.setattr(shard_maker, "load_baked", stored.get)
    monkeypatch.setattr(shard_maker, "bake", bake)
    monkeypatch.setattr(shard_maker, "store_baked", lambda light: stored.update(ab=light))
    rooms: list[Any] = [_Room(), _Room()]
    threads = [threading.Thread(target=shard_maker._bake_missing, args=(one,)) for one in rooms]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    assert [one.light for one in rooms] == ["light", "light"]
    assert len(baked) == 1
