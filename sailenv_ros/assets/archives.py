"""Unpacking untrusted archives: nothing leaves the folder, nothing is without a limit."""

from __future__ import annotations

import stat
import struct
import zipfile
import zlib
from pathlib import Path, PurePosixPath

from sailenv_ros.errors import AssetError

__all__ = ["MAX_ARCHIVE_BYTES", "unpack_zip"]

MAX_ARCHIVE_BYTES = 200 * 2**20
"""Greatest size of an archive, and of its unpacked contents [B]."""

MAX_MEMBERS = 2000
MAX_RATIO = 200
"""Largest factor by which a member may grow: beyond is a bomb."""

SMALL_BYTES = 1 << 20
"""Members up to this size may have been packed as tightly as they like."""

_CHUNK = 1 << 20


def unpack_zip(archive: Path, folder: Path) -> tuple[Path, ...]:
    """Unpack a zip archive into an empty folder; return the files.

    Raises
    ------
    AssetError
        If it is no zip archive, too large, or holds what an honest one does not: paths that lead
        out of it, links, encrypted or overlapping names. The folder may hold a part then.
    """
    if archive.stat().st_size > MAX_ARCHIVE_BYTES:
        raise AssetError(archive.name, f"it is larger than {MAX_ARCHIVE_BYTES // 2**20} MB")
    try:
        with zipfile.ZipFile(archive) as opened:
            members = [info for info in opened.infolist() if not info.is_dir()]
            _check(archive.name, members)
            return _extracted(archive.name, opened, members, folder)
    except (zipfile.BadZipFile, NotImplementedError, EOFError, OSError, RuntimeError) as problem:
        raise AssetError(
            archive.name, f"it is no zip archive that can be read ({problem})"
        ) from None
    except AssetError:
        raise
    except zlib.error as problem:
        raise AssetError(archive.name, f"its data are damaged ({problem})") from None
    except (ValueError, IndexError, struct.error) as problem:
        # What the zip reader stumbles over in headers that were made up.
        raise AssetError(archive.name, f"its list of files is malformed ({problem})") from None


def _check(name: str, members: list[zipfile.ZipInfo]) -> None:
    if len(members) > MAX_MEMBERS:
        raise AssetError(name, f"it holds {len(members)} files, and {MAX_MEMBERS} are accepted")
    if sum(info.file_size for info in members) > MAX_ARCHIVE_BYTES:
        raise AssetError(name, f"it unpacks to more than {MAX_ARCHIVE_BYTES // 2**20} MB")
    seen: set[PurePosixPath] = set()
    for info in members:
        path = _safe_path(name, info.filename)
        if path in seen:
            raise AssetError(name, f"it holds {info.filename!r} twice")
        seen.add(path)
        if stat.S_IFMT(info.external_attr >> 16) not in (0, stat.S_IFREG):
            raise AssetError(name, f"{info.filename!r} is a link or a device, not a file")
        if info.flag_bits & 0x1:
            raise AssetError(name, f"{info.filename!r} is encrypted")
        if info.file_size > SMALL_BYTES and info.file_size > MAX_RATIO * info.compress_size:
            raise AssetError(name, f"{info.filename!r} unpacks to far more than it should")


def _safe_path(name: str, member: str) -> PurePosixPath:
    path = PurePosixPath(member.replace("\\", "/"))
    outside = path.is_absolute() or ".." in path.parts or not path.parts
    odd = any(ord(letter) < 32 for letter in member) or ":" in member
    if outside or odd or len(member) > 300:
        raise AssetError(name, f"the path {member!r} in it leads out of it or is malformed")
    return path


def _extracted(
    name: str, opened: zipfile.ZipFile, members: list[zipfile.ZipInfo], folder: Path
) -> tuple[Path, ...]:
    files = []
    left = MAX_ARCHIVE_BYTES
    for info in members:
        target = folder.joinpath(*_safe_path(name, info.filename).parts)
        target.parent.mkdir(parents=True, exist_ok=True)
        # What the archive says of sizes may be a lie: what comes out is counted.
        with opened.open(info) as source, target.open("xb") as out:
            while chunk := source.read(_CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise AssetError(
                        name, f"it unpacks to more than {MAX_ARCHIVE_BYTES // 2**20} MB"
                    )
                out.write(chunk)
        files.append(target)
    return tuple(files)
