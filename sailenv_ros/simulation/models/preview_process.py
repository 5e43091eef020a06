"""Thumbnails from a process of its own: asked for over a pipe, answered as PNG.

Drawing holds Python's lock for as long as OpenGL takes; in the simulator's process it would hold
up the simulation. An asset (its name, or itself) in, bytes of a picture out. The child runs at a
low priority and ends when the pipe does, whatever its parent died of.
"""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import struct
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, TYPE_CHECKING

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.errors import DeadlineExceeded, RenderError, SailenvError
from sailenv_ros.render.contract import BackendName
from sailenv_ros.types.model import Asset

if TYPE_CHECKING:
    from PIL import Image

__all__ = ["HEIGHT_PX", "WIDTH_PX", "PreviewProcess"]

WIDTH_PX, HEIGHT_PX = 160, 120

DETAIL = 2
"""Supersampling factor along each axis, so that fine parts are visible."""

ANSWER_S = 60.0
"""Time limit for a thumbnail, the start of the process included [s]."""

END_S = 5.0

NICENESS = 10

_HEADER = struct.Struct("<?Q")
"""True for a picture, False for the sentence of an error; bytes that follow."""


class PreviewProcess:
    """The parent's end; used by one thread.

    Parameters
    ----------
    backend : {'auto', 'native', 'gl'}
    device : int or None
        Number of the EGL device.
    """

    def __init__(self, backend: BackendName, device: int | None) -> None:
        package_parent = str(Path(__file__).resolve().parents[3])
        path = os.environ.get("PYTHONPATH", "")
        self._process = subprocess.Popen(
            [sys.executable, "-m", __name__, backend, "" if device is None else str(device)],
            env={
                **os.environ,
                "PYTHONPATH": os.pathsep.join([package_parent, *([path] if path else [])]),
                "PYTHONSAFEPATH": "1",  # not a package of this name that lies in the current folder
            },
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            # A Ctrl-C at the terminal is for the simulator, which then closes this.
            start_new_session=True,
        )

    def thumbnail(self, asset: str | Asset) -> bytes:
        """Return the PNG of an asset that a pack has, by its catalogue name, or of any asset.

        Raises
        ------
        RenderError
            If it cannot be pictured, or the process has died.
        DeadlineExceeded
            If it took longer than `ANSWER_S`; the process is ended then.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        late = threading.Event()

        def give_up() -> None:
            late.set()
            self.kill()

        alarm = threading.Timer(ANSWER_S, give_up)
        alarm.daemon = True
        alarm.start()
        try:
            _send(self._process.stdin, pickle.dumps(asset))
            is_picture, answer = _receive(self._process.stdout)
        except (OSError, EOFError):
            if late.is_set():
                raise DeadlineExceeded("a thumbnail", ANSWER_S) from None
            status = self._process.wait(END_S)
            raise RenderError(f"the process that pictures assets ended with {status}") from None
        finally:
            alarm.cancel()
        if not is_picture:
            raise RenderError(answer.decode())
        return answer

    @property
    def is_alive(self) -> bool:
        """True while it can be asked."""
        return self._process.poll() is None

    def kill(self) -> None:
        """End what it is doing, from any thread."""
        self._process.kill()

    def close(self) -> None:
        """End the process, by force if need be; a second call does nothing."""
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with contextlib.suppress(OSError):  # it died with something unread
                pipe.close()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait(END_S)


def _send(pipe: IO[bytes], data: bytes, *, is_picture: bool = True) -> None:
    pipe.write(_HEADER.pack(is_picture, len(data)))
    pipe.write(data)
    pipe.flush()


def _receive(pipe: IO[bytes]) -> tuple[bool, bytes]:
    is_picture, length = _HEADER.unpack(_read(pipe, _HEADER.size))
    return is_picture, _read(pipe, length)


def _read(pipe: IO[bytes], length: int) -> bytes:
    data = pipe.read(length)
    if len(data) < length:
        raise EOFError
    return data


# -- the child -----------------------------------------------------------------------------


def _serve(backend: BackendName, device: int | None) -> None:
    """Answer until nobody asks any more."""
    # What libraries print must not come between the pictures.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    os.nice(NICENESS)
    from PIL import Image

    from sailenv_ros.simulation.models.preview_renderer import PreviewRenderer

    library = AssetLibrary(installed_sources())
    with PreviewRenderer(backend, device) as previews:
        while True:
            try:
                _, asked = _receive(sys.stdin.buffer)
            except EOFError:
                return
            try:
                asset = pickle.loads(asked)
                found = library.peek(asset) if isinstance(asset, str) else asset
                size = {"width": WIDTH_PX * DETAIL, "height": HEIGHT_PX * DETAIL}
                drawn = previews.thumbnail(found, **size)
            except SailenvError as problem:
                _send(answers, str(problem).encode(), is_picture=False)
            else:
                _send(answers, _png(Image.fromarray(drawn)))


def _png(drawn: Image.Image) -> bytes:
    from PIL import Image

    small = drawn.resize((WIDTH_PX, HEIGHT_PX), Image.Resampling.LANCZOS)
    data = io.BytesIO()
    small.save(data, "PNG", optimize=True)
    return data.getvalue()


if __name__ == "__main__":
    _serve(sys.argv[1], int(sys.argv[2]) if sys.argv[2] else None)  # type: ignore[arg-type]  # as given above
