"""Small pictures of the catalogue's objects, made on demand beside the simulation and kept.

A catalogue name in, a future of PNG bytes out. Pictures of what packs have are kept in the user's
cache by what their pack says of itself; those of uploaded models in memory alone.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import threading
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Protocol

from sailenv_ros.assets.places import cache_folder
from sailenv_ros.model import Asset
from sailenv_ros.render.backend import BackendName
from sailenv_ros.simulation.portrait_process import PortraitProcess
from sailenv_ros.simulation.work_queue import WorkQueue

__all__ = ["Thumbnails"]

MAX_WAITING = 1000

IDLE_S = 60.0
"""A process that nobody has asked anything for so long ends, and its memory is free [s]."""

LOOK = 1
"""Grows when portraits come to look different: those of before are made anew."""

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"

_log = logging.getLogger(__name__)


class Catalogue(Protocol):
    """What is known of the assets; `SceneLibrary` does."""

    def canonical_asset(self, name: str) -> str:
        """Give the catalogue name of a catalogue or display name."""
        ...

    def asset_fingerprint(self, name: str) -> str:
        """Give what changes whenever the asset does; empty for one that no pack has."""
        ...

    def peek_asset(self, name: str) -> Asset:
        """Give the asset."""
        ...


class Thumbnails:
    """The pictures of one simulation.

    Parameters
    ----------
    catalogue : callable
        Gives the `Catalogue`, once there is one.
    backend, device
        As `make_backend` takes them.
    """

    def __init__(
        self, catalogue: Callable[[], Catalogue], backend: BackendName, device: int | None
    ) -> None:
        self._catalogue = catalogue
        self._backend: BackendName = backend
        self._device = device
        self._queue: WorkQueue[str, bytes] = WorkQueue(
            "thumbnails",
            self._picture,
            idle_s=lambda: None if self._process is None else IDLE_S,
            rest=self._end_process,
        )
        self._process: PortraitProcess | None = None
        self._of_uploads: dict[str, bytes] = {}

    def begin(self, asset: str) -> Future[bytes]:
        """Ask for the PNG of an asset, 160 by 120 pixels.

        Raises
        ------
        UnknownName
            If there is no such asset.
        InvalidRequest
            If too many are waiting.
        SimulationClosed
            If the simulation has ended.
        """
        return self._queue.begin(self._catalogue().canonical_asset(asset), most=MAX_WAITING)

    def close(self) -> None:
        """Refuse those that wait and take no more; a second call does nothing."""
        self._queue.close()
        process = self._process
        if process is not None:
            process.kill()
        self._queue.join(10.0)

    # -- in the thread ---------------------------------------------------------------------

    def _picture(self, name: str) -> bytes:
        catalogue = self._catalogue()
        fingerprint = catalogue.asset_fingerprint(name)
        if not fingerprint:
            if name not in self._of_uploads:
                self._of_uploads[name] = self._drawn(catalogue.peek_asset(name))
            return self._of_uploads[name]
        key = hashlib.sha256(f"{LOOK} {fingerprint} {name}".encode()).hexdigest()[:32]
        path = cache_folder() / "thumbnails" / f"{key}.png"
        return _kept(path) or _keep(path, self._drawn(name))

    def _drawn(self, asset: str | Asset) -> bytes:
        if self._process is None or not self._process.is_alive:
            self._end_process()
            self._process = PortraitProcess(self._backend, self._device)
        return self._process.portrait(asset)

    def _end_process(self) -> None:
        if self._process is not None:
            self._process.close()
            self._process = None


def _kept(path: Path) -> bytes | None:
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return data if data.startswith(PNG_SIGNATURE) else None


def _keep(path: Path, data: bytes) -> bytes:
    """Keep a picture if that is possible; give it."""
    unfinished = path.with_suffix(f".{os.getpid()}.{threading.get_ident()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_bytes(data)
        unfinished.replace(path)
    except OSError as problem:
        _log.warning("thumbnails cannot be kept in %s: %s", path.parent, problem)
        with contextlib.suppress(OSError):
            unfinished.unlink(missing_ok=True)
    return data
