"""Data sets of what an agent sees from now on, as files to download; one is captured at a time."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import tempfile
import threading
import time
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from aiohttp import web

from sailenv_ros.errors import InvalidState, UnknownName
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.files import storage_errors
from sailenv_ros.viewer.access_control import AccessControl
from sailenv_ros.viewer.messages import CapturedDataSet
from sailenv_ros.viewer.viewer_limits import ViewerLimits

__all__ = ["DataSetCaptures", "DataSetMaker"]


class DataSetMaker(Protocol):
    """Writes data sets of a running simulation; the program that starts the viewer gives one."""

    @property
    def formats(self) -> Sequence[str]:
        """Names of the formats that can be written."""

    def write(
        self,
        simulation: Simulation,
        folder: Path,
        format_name: str,
        *,
        agent: str,
        frames: int,
        rate_hz: float,
        stopped: threading.Event,
        on_frame: Callable[[int], None],
    ) -> int:
        """Write so many frames into a folder, fewer once it is stopped; return how many."""


class DataSetCaptures:
    """Captures data sets for pages, and answers requests for the last one.

    Parameters
    ----------
    simulation : Simulation
    access : AccessControl
    limits : ViewerLimits
    maker : DataSetMaker or None
        None offers no formats.

    Attributes
    ----------
    progress : str
        How far the present capture is, in words; empty for none.
    """

    def __init__(
        self,
        simulation: Simulation,
        access: AccessControl,
        limits: ViewerLimits,
        maker: DataSetMaker | None,
    ) -> None:
        self.progress = ""
        self._simulation, self._access, self._limits = simulation, access, limits
        self._maker = maker
        self._stopped, self._given_up = threading.Event(), threading.Event()
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._last: tuple[str, Path] | None = None

    @property
    def formats(self) -> list[str]:
        """Names of the formats that are offered."""
        return [] if self._maker is None else list(self._maker.formats)

    async def capture(
        self, format_name: str, agent: str, frames: int, rate_hz: float
    ) -> CapturedDataSet:
        """Capture frames of an agent; who asked and goes away ends it, and leaves nothing.

        Raises
        ------
        UnknownName, InvalidRequest
            If format, agent or a number cannot be accepted.
        InvalidState
            If another one is being captured, or it grows too large.
        RecordingError, StorageError
            If it cannot be written.
        """
        maker = self._maker
        if maker is None or format_name not in maker.formats:
            raise UnknownName("format", format_name[:80], self.formats)
        if self.progress:
            raise InvalidState("another data set is being captured; stop it first")
        self._stopped, self._given_up = threading.Event(), threading.Event()
        self.progress = "waiting for the first frame"

        async def made() -> CapturedDataSet:
            try:
                return await asyncio.to_thread(
                    self._captured, maker, format_name, agent, frames, rate_hz
                )
            finally:
                self.progress = ""

        making = asyncio.create_task(made())
        try:
            return await asyncio.shield(making)
        except asyncio.CancelledError:
            self.give_up()
            making.add_done_callback(lambda done: done.cancelled() or done.exception())
            raise

    def stop(self) -> None:
        """End the present capture with what was seen until now."""
        self._stopped.set()

    def give_up(self) -> None:
        """End the present capture, and leave nothing of it."""
        self._given_up.set()
        self._stopped.set()

    def close(self) -> None:
        """End the present capture; delete all files."""
        self.give_up()
        if self._folder is not None:
            with contextlib.suppress(OSError):  # what is being written goes by itself
                self._folder.cleanup()

    async def answer(self, request: web.Request) -> web.StreamResponse:
        """Return the file of a key, as long as it is the last one."""
        reason = self._access.refusal_of_token(request.query.get("token", ""))
        if reason:
            return web.Response(status=403, text=f"{reason}\n")
        if self._last is None or request.match_info["key"] != self._last[0]:
            return web.Response(status=404, text="there is no such data set here any more\n")
        file = self._last[1]
        told = {"Content-Disposition": f'attachment; filename="{file.name}"'}
        return web.FileResponse(file, headers={"Content-Type": "application/zip", **told})

    def _captured(
        self, maker: DataSetMaker, format_name: str, agent: str, frames: int, rate_hz: float
    ) -> CapturedDataSet:
        """Write a data set and pack it; in a thread of its own."""
        stopped, given_up = self._stopped, self._given_up
        until_s = time.monotonic() + self._limits.capture_s
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="sailenv-captured-")
        scene = "".join(x if x.isalnum() or x in "_-" else "_" for x in self._simulation.info.scene)
        stem = f"{scene}_{format_name}"
        with tempfile.TemporaryDirectory(dir=self._folder.name) as work:
            folder = Path(work) / stem

            def written(count: int) -> None:
                self.progress = f"{count} of {frames} frames as {format_name}"
                _require_waiting(given_up)
                _require_small(folder, self._limits.capture_bytes)
                if time.monotonic() > until_s:
                    stopped.set()

            count = maker.write(
                self._simulation,
                folder,
                format_name,
                agent=agent,
                frames=frames,
                rate_hz=rate_hz,
                stopped=stopped,
                on_frame=written,
            )
            self.progress = f"{count} frames are being packed"
            packed = Path(work) / f"{stem}.zip"
            with (
                storage_errors("the data set", packed),
                zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
            ):
                for path in sorted(path for path in folder.rglob("*") if path.is_file()):
                    _require_waiting(given_up)
                    archive.write(path, path.relative_to(work))
            # Of all that was captured the last one stays.
            if self._last is not None:
                self._last[1].unlink(missing_ok=True)
            file = packed.replace(Path(self._folder.name) / packed.name)
        self._last = secrets.token_urlsafe(12), file
        size = file.stat().st_size
        return {"key": self._last[0], "name": file.name, "frames": count, "bytes": size}


def _require_waiting(given_up: threading.Event) -> None:
    if given_up.is_set():
        raise InvalidState("the capture was given up, as nobody waits for it")


def _require_small(folder: Path, most_bytes: int) -> None:
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    if size > most_bytes:
        most = f"{most_bytes / 1e6:g} MB"
        raise InvalidState(f"the data set grows beyond {most}; ask for fewer or smaller frames")
