"""Data set → whether its files are those that were written, and that the recipe makes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.making import job_of
from sailenv_ros.dataset.manifest import (
    MANIFEST,
    FileHash,
    ShardSummary,
    ToldContents,
    dataset_hash,
    done_shards,
    file_hash,
    shard_path,
    told_contents,
)
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import RecordingError

__all__ = ["Difference", "verify_dataset"]


@dataclass(frozen=True, slots=True)
class Difference:
    """A file that is not what it should be: its path, and why in words."""

    path: str
    why: str


def verify_dataset(
    where: str | Path,
    *,
    sample: int = 1,
    seed: int = 0,
    on_shard: Callable[[int, int], None] = lambda done, of: None,
) -> list[Difference]:
    """Compare all files with their hashes, and make some shards again and compare those.

    Parameters
    ----------
    where : str or Path
    sample : int
        How many shards are made again.
    seed : int
        Of the choice among them.
    on_shard : callable
        Told how many shards were looked at, of how many.

    Returns
    -------
    differences : list of Difference
        None if all is well.

    Raises
    ------
    RecordingError
        If there is no data set, or this machine would make another one.
    """
    storage = open_storage(where)
    job = job_of(storage)
    if sample:
        job.check_machine()
    found: list[Difference] = []
    done = done_shards(storage, on_damage=lambda *damage: found.append(_damage(*damage)))
    chosen: Sequence[int] = []
    if done and sample:
        numbers = np.array(list(done))
        random = np.random.default_rng(seed)
        chosen = sorted(random.choice(numbers, min(sample, len(numbers)), replace=False).tolist())
    steps = len(done) + len(chosen)
    try:
        told = told_contents(storage)
    except RecordingError as problem:
        told = ToldContents()
        found.append(_damage(MANIFEST, problem))
    found += _contradicted({one.path for one in found}, done, told)
    found += _changed(storage, told.files)
    for index, summary in enumerate(done.values(), 1):
        found += _changed(storage, summary.files)
        on_shard(index, steps)
    with ShardMaker(job, storage) as maker:
        for index, number in enumerate(chosen, 1):
            with TemporaryDirectory(prefix="sailenv-verify-") as folder:
                again = maker.make_into(number, Path(folder))
            known_files = done[number].files
            for path in sorted({*known_files, *again.files}):
                one, other = known_files.get(path), again.files.get(path)
                if one is None or other is None or one.sha256 != other.sha256:
                    found.append(Difference(path, "is another one when it is made anew"))
            on_shard(len(done) + index, steps)
    return found


def _damage(path: str, problem: RecordingError) -> Difference:
    """Return a file that cannot be read, whose path stands in the sentence already."""
    return Difference(path, str(problem).partition(path)[2].strip() or str(problem))


def _contradicted(
    damaged: Collection[str], done: Mapping[int, ShardSummary], told: ToldContents
) -> Iterator[Difference]:
    """Yield the summaries that can be read and are not those of which the manifest tells."""
    for number, sha256 in told.shards.items():
        path = shard_path(number)
        if number in done:
            if dataset_hash(done[number].files.items()) != sha256:
                yield Difference(path, f"tells of other files than {MANIFEST}")
        elif path not in damaged:
            yield Difference(path, "is not there")


def _changed(storage: Storage, files: Mapping[str, FileHash]) -> Iterator[Difference]:
    """Yield the files that are not as they were written."""
    for path, known in files.items():
        try:
            digest = _hash(storage, path)
        except RecordingError as problem:
            yield _damage(path, problem)
            continue
        if digest is None:
            yield Difference(path, "is not there")
        elif digest != known.sha256:
            yield Difference(path, "has another content than was written")


def _hash(storage: Storage, path: str) -> str | None:
    if isinstance(storage, FolderStorage):
        file = storage.folder / path
        try:
            return file_hash(file) if file.is_file() else None
        except OSError as problem:
            raise RecordingError(f"{file} cannot be read: {problem.strerror}") from None
    data = storage.read(path)
    return None if data is None else hashlib.sha256(data).hexdigest()
