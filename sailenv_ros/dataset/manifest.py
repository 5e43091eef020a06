"""Contents of a data set by number of bytes and SHA-256: summaries of shards, and of the whole."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import RecordingError

__all__ = [
    "MANIFEST",
    "SHARDS_FOLDER",
    "FileHash",
    "ShardSummary",
    "ToldContents",
    "dataset_hash",
    "done_shards",
    "file_hash",
    "shard_path",
    "summaries_of_files",
    "told_contents",
]

MANIFEST = "manifest.json"
SHARDS_FOLDER = "shards"

_DAMAGE = (ValueError, TypeError, KeyError, AttributeError, RecursionError)
"""Errors where JSON of something else is taken for a summary or a manifest."""


@dataclass(frozen=True, slots=True)
class FileHash:
    """A file's size [B] and SHA-256 in hexadecimal digits."""

    bytes: int
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ShardSummary:
    """Summary of one shard.

    Attributes
    ----------
    shard : int
        Its number.
    split : str
    first_clip, clips, frames : int
        Its clips; frames that were written.
    files : mapping of str to FileHash
        By their paths in the data set.
    written, left_out : mapping of str to mapping of str to int
        Of each format: how many of what, and how many not by the reason.
    skipped : mapping of str to int
        Clips that could not be made, by the reason.
    findings : mapping of str to mapping of str to int
        What people should know: how often in which scene; see `findings`.
    made : mapping
        On which machine and how fast; not a part of the content.
    """

    shard: int
    split: str
    first_clip: int
    clips: int
    frames: int
    files: Mapping[str, FileHash]
    written: Mapping[str, Mapping[str, int]]
    left_out: Mapping[str, Mapping[str, int]]
    skipped: Mapping[str, int]
    findings: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    made: Mapping[str, Any] = field(default_factory=dict)

    @property
    def path(self) -> str:
        """Path of the summary in the data set."""
        return shard_path(self.shard)

    def to_json(self) -> bytes:
        """Return the text of its file."""
        return (json.dumps(asdict(self), indent=1) + "\n").encode()

    @classmethod
    def from_json(cls, data: bytes, path: str) -> ShardSummary:
        """Read what `to_json` wrote.

        Raises
        ------
        RecordingError
            If it is something else, or that of another shard.
        """
        try:
            value = json.loads(data)
            summary = cls(files=_hashes(value.pop("files")), **value)
            if summary.path != path:
                raise ValueError(f"it tells of shard {summary.shard}")
        except _DAMAGE as problem:
            raise RecordingError(f"{path} is no summary of a shard: {problem}") from None
        return summary


def shard_path(number: int) -> str:
    """Return the path of a shard's summary in a data set."""
    return f"{SHARDS_FOLDER}/{number:05d}.json"


def _hashes(told: Mapping[str, Any]) -> dict[str, FileHash]:
    hashes = {name: FileHash(**one) for name, one in told.items()}
    if any(type(one.bytes) is not int or type(one.sha256) is not str for one in hashes.values()):
        raise TypeError("a file's size is no integer, or its hash no text")
    return hashes


def summaries_of_files(folder: Path) -> dict[str, FileHash]:
    """Return the summaries of all files below a folder, by their relative paths, sorted."""
    found = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        name = path.relative_to(folder).as_posix()
        found[name] = FileHash(path.stat().st_size, file_hash(path))
    return found


def file_hash(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def done_shards(
    storage: Storage,
    *,
    on_damage: Callable[[str, RecordingError], None] | None = None,
) -> dict[int, ShardSummary]:
    """Return the summaries of the shards that are whole, by their numbers.

    Parameters
    ----------
    storage : Storage
    on_damage : callable or None
        Told the path of each summary that cannot be read, and why; it is left out then.

    Raises
    ------
    RecordingError
        If one cannot be read and nobody is to be told.
    """
    found = {}
    for name in storage.names(SHARDS_FOLDER):
        path = f"{SHARDS_FOLDER}/{name}"
        try:
            data = storage.read(path)
            if data is not None:
                summary = ShardSummary.from_json(data, path)
                found[summary.shard] = summary
        except RecordingError as problem:
            if on_damage is None:
                raise
            on_damage(path, problem)
    return dict(sorted(found.items()))


@dataclass(frozen=True, slots=True)
class ToldContents:
    """Contents of the whole data set, as the manifest tells them; nothing while it has none.

    Attributes
    ----------
    files : mapping of str to FileHash
        Those that belong to no shard.
    shards : mapping of int to str
        Hash of the files of each shard, by its number.
    """

    files: Mapping[str, FileHash] = field(default_factory=dict)
    shards: Mapping[int, str] = field(default_factory=dict)


def told_contents(storage: Storage) -> ToldContents:
    """Return what the manifest tells.

    Raises
    ------
    RecordingError
        If it cannot be read.
    """
    data = storage.read(MANIFEST)
    if data is None:
        return ToldContents()
    try:
        value = json.loads(data)
        shards = {int(one["shard"]): str(one["sha256"]) for one in value["shards"]}
        return ToldContents(_hashes(value["files"]), shards)
    except _DAMAGE as problem:
        raise RecordingError(f"{MANIFEST} in {storage.shown} cannot be read: {problem}") from None


def dataset_hash(files: Iterable[tuple[str, FileHash]]) -> str:
    """Return one SHA-256 of all files, their names and contents, in any order."""
    digest = hashlib.sha256()
    for name, one in sorted(files, key=lambda pair: pair[0]):
        digest.update(f"{one.sha256}  {name}\n".encode())
    return digest.hexdigest()
