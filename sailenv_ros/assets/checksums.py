"""Checksums of files: one file's, and a manifest of a whole folder, as `sha256sum` writes it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

from sailenv_ros.system.files import write_file

__all__ = ["MANIFEST", "damaged_by_manifest", "file_checksum", "write_manifest"]

MANIFEST = "SHA256SUMS"
"""Name of the manifest, in the folder that it is of."""


def file_checksum(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits.

    Raises
    ------
    OSError
        If it cannot be read.
    """
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def write_manifest(folder: Path) -> None:
    """Write the checksums of every file in a folder into the folder.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    files = sorted(path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    lines = [f"{file_checksum(path)}  {path.relative_to(folder)}\n" for path in files]
    write_file(folder / MANIFEST, "".join(lines).encode())


def damaged_by_manifest(folder: Path) -> Mapping[str, str]:
    """Check the files of a folder by its manifest.

    Returns
    -------
    problems : mapping of str to str
        What is wrong, in words, by the file's path in the folder; empty where there is no manifest.
    """
    try:
        lines = (folder / MANIFEST).read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        return {}
    except (OSError, UnicodeDecodeError) as problem:
        return {MANIFEST: f"cannot be read ({problem})"}
    problems = {}
    for line in lines:
        checksum, _, name = line.partition("  ")
        try:
            if file_checksum(folder / name) != checksum:
                problems[name] = "is damaged (its checksum is wrong)"
        except FileNotFoundError:
            problems[name] = "is missing"
        except (OSError, ValueError) as problem:
            problems[name] = f"cannot be read ({problem})"
    return problems
