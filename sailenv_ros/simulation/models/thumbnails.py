"""Small pictures of the catalogue's objects, made on demand beside the simulation and kept.

A catalogue name in, a future of PNG bytes out. Pictures of what packs have are kept in the user's
cache by what their pack says of itself; those of uploaded models in memory alone.
"""

from __future__ import annotations

import hashlib
import io
import logging
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Protocol

from sailenv_ros.render.contract import BackendName
from sailenv_ros.simulation.models.preview_process import PreviewProcess
from sailenv_ros.simulation.models.work_queue import WorkQueue
from sailenv_ros.system.files import make_folder, write_file
from sailenv_ros.system.user_folders import cache_folder
from sailenv_ros.types.model import Asset

__all__ = ["Thumbnails", "is_whole_png", "thumbnail_folder"]

MAX_WAITING = 1000

IDLE_S = 60.0
"""A process that nobody has asked anything for so long ends, and its memory is free [s]."""

LOOK = 1
"""Grows when thumbnails come to look different: those of before are made again."""

PNG_END = b"\0\0\0\0IEND\xaeB`\x82"

_log = logging.getLogger(__name__)


class Catalogue(Protocol):
    """Queries about assets that thumbnails need; `SceneLibrary` answers them."""

    def canonical_asset(self, name: str) -> str:
        """Return the catalogue name of a catalogue or display name."""
        ...

    def asset_fingerprint(self, name: str) -> str:
        """Return what changes whenever the asset does; empty for one that no pack has."""
        ...

    def peek_asset(self, name: str) -> Asset:
        """Return the asset."""
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
        self._process: PreviewProcess | None = None
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
        path = thumbnail_folder() / f"{key}.png"
        return _kept(path) or _keep(path, self._drawn(name))

    def _drawn(self, asset: str | Asset) -> bytes:
        if self._process is None or not self._process.is_alive:
            self._end_process()
            self._process = PreviewProcess(self._backend, self._device)
        return self._process.thumbnail(asset)

    def _end_process(self) -> None:
        if self._process is not None:
            self._process.close()
            self._process = None


def thumbnail_folder() -> Path:
    """Return the folder of the pictures that are kept."""
    return cache_folder() / "thumbnails"


def _kept(path: Path) -> bytes | None:
    try:
        data = path.read_bytes()
    except OSError:
        return None
    if is_whole_png(data):
        return data
    _log.warning("the thumbnail %s is damaged and is made anew", path)
    return None


def is_whole_png(data: bytes) -> bool:
    """Return whether every part of a PNG file is there and has the checksum that stands in it."""
    from PIL import Image

    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as picture:
            picture.verify()
    except Exception:  # whatever a damaged file leads to
        return False
    return data.endswith(PNG_END)


def _keep(path: Path, data: bytes) -> bytes:
    """Keep a picture if that is possible; return it."""
    try:
        make_folder(path.parent)
        write_file(path, data)
    except OSError as problem:
        _log.warning("thumbnails cannot be kept in %s: %s", path.parent, problem)
    return data
