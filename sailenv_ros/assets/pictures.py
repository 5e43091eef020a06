"""Pictures that users give for materials: decoded with care, found by name, kept.

Bytes or files in, textures out. A picture that was sent is named by its content, so that the same
bytes have the same name on every machine.
"""

from __future__ import annotations

import hashlib
import io
import threading
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sailenv_ros.errors import AssetError, InvalidRequest, InvalidState
from sailenv_ros.types.model import Texture

__all__ = [
    "MAX_PICTURE_BYTES",
    "MAX_PICTURE_PX",
    "PICTURE_FOLDER",
    "Pictures",
    "checked_picture",
    "decoded_picture",
]

MAX_PICTURE_BYTES = 8_000_000
MAX_PICTURE_PX = 16_000_000
"""Greatest number of pixels; a larger picture is refused before it is decoded."""

MAX_SENT = 64
"""Pictures that users may send in a simulator's life, so that they cannot fill the memory."""

TEXTURE_PX = 1024
"""Longest side that is kept: renderers hold no finer texture [px]."""

PICTURE_FOLDER = "pictures"
"""Beside a scene file, where its pictures may lie."""

_ENDINGS = {"PNG": "png", "JPEG": "jpg"}


def checked_picture(data: object) -> tuple[bytes, str]:
    """Look at a picture's head; return its bytes and the ending of its kind, decode nothing.

    Raises
    ------
    InvalidRequest
        If it is no PNG or JPEG, or too large.
    """
    from PIL import Image

    if not isinstance(data, bytes | bytearray | memoryview) or not data:
        raise InvalidRequest("picture", type(data).__name__, "the bytes of a PNG or JPEG file")
    if len(data) > MAX_PICTURE_BYTES:
        accepted = f"at most {MAX_PICTURE_BYTES // 1_000_000} MB"
        raise InvalidRequest("size of the picture", f"{len(data) / 1e6:.1f} MB", accepted)
    content = bytes(data)
    try:
        with Image.open(io.BytesIO(content), formats=list(_ENDINGS)) as picture:
            size, ending = picture.size, _ENDINGS[str(picture.format)]
    except Exception as problem:  # whatever a broken file makes the reader stumble over
        raise InvalidRequest("picture", f"{len(content)} bytes", "a PNG or JPEG file") from problem
    if size[0] * size[1] > MAX_PICTURE_PX:
        accepted = f"at most {MAX_PICTURE_PX // 1_000_000} million pixels"
        raise InvalidRequest("size of the picture", f"{size[0]} x {size[1]} px", accepted)
    return content, ending


def decoded_picture(data: object) -> Texture:
    """Return the (H, W, 4) uint8 texture of a picture file, opaque, at most 1024 px long.

    Raises
    ------
    InvalidRequest
        As `checked_picture`, and if the file is damaged.
    """
    from PIL import Image

    content, _ = checked_picture(data)
    try:
        with Image.open(io.BytesIO(content), formats=list(_ENDINGS)) as picture:
            picture.load()
            whole = picture.convert("RGB")
    except Exception as problem:  # whatever a broken file makes the reader stumble over
        raise InvalidRequest(
            "picture", f"{len(content)} bytes", "a PNG or JPEG file that is whole"
        ) from problem
    if max(whole.size) > TEXTURE_PX:
        share = TEXTURE_PX / max(whole.size)
        width, height = (max(1, round(share * side)) for side in whole.size)
        whole = whole.resize((width, height), Image.Resampling.LANCZOS)
    texture = np.full((whole.height, whole.width, 4), 255, np.uint8)
    texture[..., :3] = np.asarray(whole)
    texture.flags.writeable = False
    return texture


class Pictures:
    """Pictures by name: those that were sent, and those of folders; for several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sent: dict[str, tuple[bytes, Texture]] = {}
        self._read: dict[tuple[Path, int, int], Texture] = {}

    def add(self, data: object) -> str:
        """Take a picture that was sent; return its name, the same for the same bytes.

        Raises
        ------
        InvalidRequest, InvalidState
            If it cannot be used, or there are `MAX_SENT` already.
        """
        content, ending = checked_picture(data)
        name = f"picture_{hashlib.sha256(content).hexdigest()[:16]}.{ending}"
        with self._lock:
            if name in self._sent:
                return name
            if len(self._sent) >= MAX_SENT:
                raise InvalidState(
                    f"{MAX_SENT} pictures have been sent, which is the most in a simulator's life"
                )
        texture = decoded_picture(content)
        with self._lock:
            self._sent[name] = content, texture
        return name

    def texture(self, name: str, folders: Sequence[Path]) -> Texture:
        """Return a picture: one that was sent, else a file in one of the folders.

        The same object for the same picture while its file is unchanged.

        Raises
        ------
        InvalidRequest, AssetError
            If there is none of that name, or it cannot be used.
        """
        with self._lock:
            if name in self._sent:
                return self._sent[name][1]
        path = _found(name, folders)
        status = path.stat()
        key = path, status.st_mtime_ns, status.st_size
        with self._lock:
            if key in self._read:
                return self._read[key]
        texture = decoded_picture(_content(path))
        with self._lock:
            if len(self._read) >= MAX_SENT:
                self._read.pop(next(iter(self._read)))
            return self._read.setdefault(key, texture)

    def content(self, name: str, folders: Sequence[Path]) -> bytes:
        """Return the bytes of a picture's file; see `texture` for errors."""
        with self._lock:
            if name in self._sent:
                return self._sent[name][0]
        return _content(_found(name, folders))

    def fault(self, name: str, folders: Sequence[Path]) -> str:
        """Return why a picture cannot be used, empty if it can."""
        try:
            self.texture(name, folders)
        except InvalidRequest as problem:
            return f"{name!r} cannot be used: {problem.what} must be {problem.accepted}"
        except (AssetError, OSError) as problem:
            return str(problem)
        return ""


def _found(name: str, folders: Sequence[Path]) -> Path:
    if "/" not in name and "\\" not in name and name not in ("", ".", ".."):
        for folder in folders:
            for path in (folder / name, folder / PICTURE_FOLDER / name):
                if path.is_file():
                    return path
    where = ", ".join(str(folder) for folder in folders) or "no folder"
    raise AssetError(name, f"there is no such picture in {where} or in pictures there")


def _content(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(MAX_PICTURE_BYTES + 1)
    except OSError as problem:
        raise AssetError(path.name, f"it cannot be read ({problem.strerror})") from None
