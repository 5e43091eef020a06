"""A room is baked once, however many processes need its light."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from sailenv_ros.simulation import finished_light


class _Room:
    """A world of a room as `bake_missing` asks it."""

    def __init__(self) -> None:
        self.contents = type("Contents", (), {"baked": None})
        self.described = type("Described", (), {"room": object()})
        self.light: object = None

    def snapshot(self) -> object:
        return self

    def set_baked(self, baked: object) -> None:
        self.light = baked


def test_two_processes_bake_a_room_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    stored: dict[str, object] = {}
    baked: list[object] = []
    second_waits = threading.Event()

    def bake(snapshot: object) -> object:
        # The second one has come to the lock before there is anything to load.
        assert second_waits.wait(30.0)
        baked.append(snapshot)
        return "light"

    real = finished_light.file_lock
    asked: list[None] = []

    @contextmanager
    def lock(*args: Any, **options: Any) -> Iterator[None]:
        asked.append(None)
        if len(asked) == 2:
            second_waits.set()
        with real(*args, **options):
            yield

    monkeypatch.setattr(finished_light, "file_lock", lock)
    monkeypatch.setattr(finished_light, "light_folder", lambda: tmp_path)
    monkeypatch.setattr(finished_light, "fingerprint", lambda snapshot: "ab")
    monkeypatch.setattr(finished_light, "load_baked", stored.get)
    monkeypatch.setattr(finished_light, "bake", bake)
    monkeypatch.setattr(finished_light, "store_baked", lambda light: stored.update(ab=light))
    rooms: list[Any] = [_Room(), _Room()]
    threads = [threading.Thread(target=finished_light.bake_missing, args=(one,)) for one in rooms]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60.0)
    assert [one.light for one in rooms] == ["light", "light"]
    assert len(baked) == 1
