"""Models that users upload: bytes and a file's name in, an `Asset` out.

Importing takes up to minutes and needs no simulation, so it is done outside of the loop; only what
comes of it is added there. Knows no thread and no catalogue.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from sailenv_ros.assets.importing import import_asset
from sailenv_ros.errors import AssetError, InvalidRequest
from sailenv_ros.system.files import storage_errors
from sailenv_ros.system.temporary_folders import temporary_folder
from sailenv_ros.types.model import Asset
from sailenv_ros.types.validation import IDENTIFIER

__all__ = ["MAX_UPLOAD_BYTES", "asset_from_upload", "checked_upload", "name_from_filename"]

MAX_UPLOAD_BYTES = 64 * 2**20

SUFFIXES = (".zip", ".glb")


def asset_from_upload(
    data: bytes,
    *,
    name: str,
    filename: str,
    category: str | None = None,
    height_m: float | None = None,
) -> Asset:
    """Import a model.

    Parameters
    ----------
    data : bytes
        Of a zip archive (one obj with its mtl and textures, or one glTF), or of a glb; 64 MB.
    name : str
        Catalogue name; empty makes one of the file's.
    filename : str
        Says by its ending what the bytes are.
    category : str or None
        None means unlabelled.
    height_m : float or None
        Height that it is scaled to [m]; None takes its unit for the metre.

    Raises
    ------
    InvalidRequest
        If a name, the ending or the size cannot be accepted.
    AssetError
        If the file is malformed or malicious.
    """
    chosen, suffix = checked_upload(data, name=name, filename=filename)
    with (
        storage_errors(f"the model {filename!r}", Path(tempfile.gettempdir())),
        temporary_folder("sailenv-upload-") as folder,
    ):
        # The user's file name goes to no file system.
        path = folder / f"{chosen}{suffix}"
        path.write_bytes(data)
        try:
            return import_asset(
                path, name=chosen, category=category or "unlabelled", height_m=height_m
            )
        except (MemoryError, RecursionError):
            raise AssetError(filename, "it is too large or nested too deep") from None


def checked_upload(data: bytes, *, name: str, filename: str) -> tuple[str, str]:
    """Check what can be told without reading the model; return its name and the file's ending.

    Raises
    ------
    InvalidRequest
        If a name, the ending or the size cannot be accepted.
    """
    suffix = Path(_text("filename", filename)).suffix.lower()
    if suffix not in SUFFIXES:
        raise InvalidRequest("filename", filename, f"one that ends in {' or '.join(SUFFIXES)}")
    if not isinstance(data, bytes | bytearray | memoryview) or not data:
        raise InvalidRequest("data", type(data).__name__, "the bytes of the file, at least one")
    if len(data) > MAX_UPLOAD_BYTES:
        accepted = f"at most {MAX_UPLOAD_BYTES // 2**20} MB"
        raise InvalidRequest("size of the file", f"{len(data) / 2**20:.1f} MB", accepted)
    chosen = _text("name", name) or name_from_filename(filename)
    if not IDENTIFIER.fullmatch(chosen):
        raise InvalidRequest("name", name, "lower-case letters, digits and _, at most 63")
    return chosen, suffix


def name_from_filename(filename: str) -> str:
    """Make a catalogue name of a file's: ``Old Chair (2).zip`` becomes ``old_chair_2``."""
    stem = re.sub(r"[^a-z0-9]+", "_", Path(filename).stem.lower()).strip("_")[:50]
    return stem if stem[:1].isalpha() else f"model_{stem}".rstrip("_")


def _text(what: str, value: object) -> str:
    if not isinstance(value, str):
        raise InvalidRequest(what, value, "a text")
    return value
