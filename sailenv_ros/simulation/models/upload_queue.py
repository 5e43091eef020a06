"""Imports uploaded models one after the other, beside the simulation, each in a process of its own.

Bytes in, a future of the catalogue name out. Knows no world; what is imported is handed to `add`.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from sailenv_ros.simulation.models.import_process import import_upload_apart
from sailenv_ros.simulation.models.work_queue import WorkQueue
from sailenv_ros.types.model import Asset

__all__ = ["UploadQueue"]

MAX_WAITING = 8
"""Uploads that wait for their turn, each of many megabytes."""


class UploadQueue:
    """Uploads of one simulation.

    Parameters
    ----------
    add : callable
        ``add(asset, rename)`` puts an asset into the catalogue and gives a future of its name.
    """

    def __init__(self, add: Callable[[Asset, bool], Future[str]]) -> None:
        self._add = add
        self._queue: WorkQueue[dict[str, Any], str] = WorkQueue("uploads", self._import)

    def begin(self, data: bytes, *, name: str, filename: str, **settings: Any) -> Future[str]:
        """Queue an upload; see `uploads.asset_from_upload` for the arguments.

        Raises
        ------
        InvalidRequest
            If too many are waiting.
        SimulationClosed
            If the simulation has ended.
        """
        upload = {"data": data, "name": name, "filename": filename, **settings}
        return self._queue.begin(upload, most=MAX_WAITING)

    def close(self) -> None:
        """Refuse those that wait and take no more; what is being imported is given up."""
        self._queue.close()

    def _import(self, upload: dict[str, Any]) -> str:
        asset = import_upload_apart(**upload)
        return self._add(asset, not upload["name"]).result()
