"""Arrays that take long to make, kept in the user's cache: a key in, arrays out, made or read.

For what follows from its key alone: decoded models, procedural textures, reflections. The key holds
the code that makes the arrays, its libraries and the processor's instructions, so that what is read
equals what would be made, byte for byte. A file that is damaged or cannot be written costs time,
nothing else.
"""

from __future__ import annotations

import json
import logging
import os
import platform
import zlib
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import lru_cache
from hashlib import blake2b
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.system.files import file_lock, remove_unfinished, write_file
from sailenv_ros.system.mapped_file import mapped_file
from sailenv_ros.system.user_folders import cache_folder, remove_oldest

__all__ = ["Arrays", "array_folder", "cached_arrays", "code_digest", "damaged_arrays"]

Arrays = Mapping[str, NDArray[Any]]

MAGIC = b"sailenv_ros arrays 1\n"

SUFFIX = ".arrays"

MOST_BYTES = 2 << 30
"""Limit of the folder [B]; what was not used for longest is removed first."""

TIDY_EACH_BYTES = 64 << 20
"""The folder is tidied each time that a process has written so much [B], and at its first file."""

LOCK_TIMEOUT_S = 5.0
"""Nothing is kept while another process holds the folder's lock for so long [s]."""

ALIGNMENT = 64
"""Arrays begin at multiples of this in a file [B]."""

_PACKAGE = Path(__file__).parents[1]

_log = logging.getLogger(__name__)
_untidied_bytes = TIDY_EACH_BYTES


def cached_arrays(
    kind: str,
    key: Iterable[object],
    make: Callable[[], Arrays],
    *,
    code: str = "",
    keep: bool = True,
) -> Arrays:
    """Return the arrays of a key: those that are kept, or new ones, which are kept then.

    Parameters
    ----------
    kind : str
        Of what they are of; a part of the key.
    key : iterable
        All that they depend on beside the code; compared by `repr`.
    make : callable
        Returns them. An error of it goes through, and nothing is kept.
    code : str
        What `code_digest` says of the code that makes them.
    keep : bool
        False returns new ones as they were made, and keeps nothing.

    Returns
    -------
    arrays : mapping of str to array
        Read-only and mapped, so that their pages can be given back; as they were made where they
        could not be kept.
    """
    told = repr((kind, code, _processor(), *key)).encode()
    path = array_folder() / f"{kind}-{blake2b(told, digest_size=16).hexdigest()}{SUFFIX}"
    kept = _read(path)
    if kept is not None:
        return kept
    made = make()
    return _kept(path, made) if keep else made


def array_folder() -> Path:
    """Return the folder of all arrays that are kept."""
    return cache_folder() / "arrays"


def damaged_arrays() -> dict[Path, str]:
    """Check every file; return what is wrong, in words, by file."""
    problems = {}
    for path in sorted(array_folder().glob(f"*{SUFFIX}")):
        try:
            _parsed(np.fromfile(path, np.uint8))
        except (OSError, ValueError, KeyError, TypeError) as problem:
            problems[path] = str(problem)
    return problems


@lru_cache
def code_digest(*folders: str, libraries: tuple[str, ...] = ()) -> str:
    """Return what changes with the code of some folders of this package, and with libraries.

    Parameters
    ----------
    *folders : str
        Relative to the package: ``"assets/surfaces"``; their modules count, not folders in them.
    libraries : tuple of str
        Names of installed distributions.
    """
    digest = blake2b(digest_size=16)
    for folder in folders:
        digest.update(_modules_digest(folder))
    for library in ("numpy", *libraries):
        digest.update(f"{library} {_version(library)}".encode())
    return digest.hexdigest()


@lru_cache
def _modules_digest(folder: str) -> bytes:
    digest = blake2b(digest_size=16)
    for file in sorted((_PACKAGE / folder).glob("*.py")):
        digest.update(file.name.encode())
        digest.update(file.read_bytes())
    return digest.digest()


@lru_cache
def _version(library: str) -> str:
    return metadata.version(library)


@lru_cache
def _processor() -> str:
    """Return what distinguishes processors for which libraries round differently."""
    flags = ""
    with suppress(OSError), open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
        flags = next((line for line in file if line.startswith(("flags", "Features"))), "")
    return f"{platform.machine()} {blake2b(flags.encode(), digest_size=8).hexdigest()}"


def _read(path: Path) -> Arrays | None:
    try:
        data = mapped_file(path)
    except FileNotFoundError:
        return None
    except OSError as problem:
        _log.warning("%s cannot be read (%s)", path, problem)
        return None
    try:
        arrays = _parsed(data)
    except (ValueError, KeyError, TypeError) as problem:
        _log.warning("%s is damaged and is made anew (%s)", path, problem)
        return None
    with suppress(OSError):
        os.utime(path)  # in use: not the first to be thrown away
    return arrays


def _parsed(data: NDArray[np.uint8]) -> Arrays:
    begin = len(MAGIC) + 12
    head = data[:begin].tobytes()
    if not head.startswith(MAGIC):
        raise ValueError("it is no file of arrays")
    checksum, length = int.from_bytes(head[-12:-8], "little"), int.from_bytes(head[-8:], "little")
    if checksum != zlib.crc32(data[begin:].data):
        raise ValueError("its checksum is wrong")
    arrays = {}
    for name, dtype, shape, place in json.loads(data[begin : begin + length].tobytes()):
        kind = np.dtype(dtype)
        stop = place + kind.itemsize * int(np.prod(shape))
        arrays[name] = data[place:stop].view(kind).reshape(shape)
    return arrays


def _kept(path: Path, arrays: Arrays) -> Arrays:
    """Keep arrays; return them as they are read, or as they are if they could not be written."""
    data = _packed(arrays)
    folder = path.parent
    try:
        with file_lock(folder / ".lock", "the folder of arrays", timeout_s=LOCK_TIMEOUT_S):
            # Whoever reads sees by the checksum what a power failure left.
            write_file(path, data, durable=False)
            _tidy(folder, len(data))
    except OSError as problem:
        _log.warning("%s cannot be written (%s); it is made anew each time", path, problem)
        return arrays
    return _read(path) or arrays


def _packed(arrays: Arrays) -> bytearray:
    given = {name: np.asarray(array, order="C") for name, array in arrays.items()}
    # The places stand in the head, whose length they change: room for the longest is left.
    room = 256 + sum(160 + len(name) for name in given)
    place = -(-(len(MAGIC) + 12 + room) // ALIGNMENT) * ALIGNMENT
    first, entries = place, []
    for name, array in given.items():
        entries.append((name, array.dtype.str, array.shape, place))
        place = -(-(place + array.nbytes) // ALIGNMENT) * ALIGNMENT
    data = bytearray(place)
    begin = len(MAGIC) + 12
    head = json.dumps(entries).encode()
    data[begin : begin + len(head)] = head
    assert begin + len(head) <= first
    for (_, _, _, at), array in zip(entries, given.values(), strict=True):
        data[at : at + array.nbytes] = array.reshape(-1).view(np.uint8).data
    checksum = zlib.crc32(memoryview(data)[begin:])
    data[:begin] = MAGIC + checksum.to_bytes(4, "little") + len(head).to_bytes(8, "little")
    return data


def _tidy(folder: Path, written: int) -> None:
    """Remove what is beyond the limit, and what killed writers left, now and then."""
    global _untidied_bytes
    _untidied_bytes += written
    if _untidied_bytes >= TIDY_EACH_BYTES:
        _untidied_bytes = 0
        remove_unfinished(folder)
        remove_oldest(folder.glob(f"*{SUFFIX}"), most_bytes=MOST_BYTES)
