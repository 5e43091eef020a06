"""Data set → whether its files are those that were written, and that the recipe makes."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.making import job_of
from sailenv_ros.dataset.manifest import FileHash, done_shards, file_hash, whole_files
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.dataset.storage import Storage

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
    """Compare all files with their hashes, and make some shards anew and compare those.

    Parameters
    ----------
    where : str or Path
    sample : int
        How many shards are made anew.
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
    done = done_shards(storage)
    chosen: Sequence[int] = []
    if done and sample:
        numbers = np.array(list(done))
        random = np.random.default_rng(seed)
        chosen = sorted(random.choice(numbers, min(sample, len(numbers)), replace=False).tolist())
    found: list[Difference] = []
    steps = len(done) + len(chosen)
    found += _changed(storage, whole_files(storage))
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


def _changed(storage: Storage, files: Mapping[str, FileHash]) -> Iterator[Difference]:
    """Yield the files that are not as they were written."""
    for path, known in files.items():
        digest = _hash(storage, path)
        if digest is None:
            yield Difference(path, "is not there")
        elif digest != known.sha256:
            yield Difference(path, "has another content than was written")


def _hash(storage: Storage, path: str) -> str | None:
    if isinstance(storage, FolderStorage):
        file = storage.folder / path
        return file_hash(file) if file.is_file() else None
    data = storage.read(path)
    return None if data is None else hashlib.sha256(data).hexdigest()
