"""Imports uploaded models one after the other, in a thread of its own, beside the simulation.

Bytes in, a future of the catalogue name out. Knows no world; what is imported is handed to `add`.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from sailenv_ros.errors import InvalidRequest, SimulationClosed
from sailenv_ros.model import Asset
from sailenv_ros.simulation.uploads import asset_from_upload

__all__ = ["UploadQueue"]

MAX_WAITING = 8
"""Uploads that wait for their turn, each of many megabytes."""


class UploadQueue:
    """Uploads of one simulation; its thread begins with the first and is a daemon.

    Parameters
    ----------
    add : callable
        ``add(asset, rename)`` puts an asset into the catalogue and gives a future of its name.
    """

    def __init__(self, add: Callable[[Asset, bool], Future[str]]) -> None:
        self._add = add
        self._waiting: queue.Queue[tuple[Future[str], dict[str, Any]] | None] = queue.Queue()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._closed = False

    def begin(self, data: bytes, *, name: str, filename: str, **settings: Any) -> Future[str]:
        """Queue an upload; see `uploads.asset_from_upload` for the arguments.

        Raises
        ------
        InvalidRequest
            If too many are waiting.
        SimulationClosed
            If the simulation has ended.
        """
        future: Future[str] = Future()
        upload = {"data": data, "name": name, "filename": filename, **settings}
        with self._lock:
            if self._closed:
                raise SimulationClosed()
            if self._waiting.qsize() >= MAX_WAITING:
                accepted = f"at most {MAX_WAITING} at a time; wait for one to be done"
                raise InvalidRequest("number of uploads", MAX_WAITING + 1, accepted)
            self._waiting.put((future, upload))
            if self._thread is None:
                self._thread = threading.Thread(
                    target=self._run, name="sailenv-uploads", daemon=True
                )
                self._thread.start()
        return future

    def close(self) -> None:
        """Refuse those that wait and take no more; what is being imported is given up."""
        with self._lock:
            self._closed = True
            while not self._waiting.empty():
                _fail(self._waiting.get_nowait(), SimulationClosed())
            self._waiting.put(None)

    def _run(self) -> None:
        while (upload := self._waiting.get()) is not None:
            future, arguments = upload
            if not future.set_running_or_notify_cancel():
                continue
            try:
                asset = asset_from_upload(**arguments)
                future.set_result(self._add(asset, not arguments["name"]).result())
            except BaseException as error:  # whatever it is, whoever waits is told
                future.set_exception(error)


def _fail(upload: tuple[Future[str], dict[str, Any]] | None, error: Exception) -> None:
    if upload is not None and upload[0].set_running_or_notify_cancel():
        upload[0].set_exception(error)
