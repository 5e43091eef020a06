"""Records of all shards → what formats write once all is known: tables of annotations, models."""

from __future__ import annotations

import json
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import accumulate, islice
from pathlib import Path
from typing import Any, overload

from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record
from sailenv_ros.dataset.formats.formats import format_class
from sailenv_ros.dataset.manifest import ShardSummary
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.errors import RecordingError

__all__ = ["RECORDS_FOLDER", "ShardRecords", "finish_formats", "frame_records", "merges"]


RECORDS_FOLDER = "records"
"""Folder of the data set with a file of each shard: a line of JSON for each frame."""


def merges(kind: type[DatasetFormat]) -> bool:
    """Return whether a format writes something once all shards are known."""
    return not kind.is_sequence and (not kind.is_shard or kind.needs_records)


def frame_records(storage: Storage, shards: Iterable[int]) -> Iterator[dict[str, Any]]:
    """Yield what is known of each frame, in the order of the shards.

    Raises
    ------
    RecordingError
        If a shard's records are not there or cannot be read.
    """
    for number in shards:
        path = f"{RECORDS_FOLDER}/{number:05d}.jsonl"
        data = storage.read(path)
        if data is None:
            raise RecordingError(f"{storage.shown} lacks {path}")
        try:
            yield from (json.loads(line) for line in data.splitlines())
        except ValueError as problem:
            raise RecordingError(f"{path} in {storage.shown} cannot be read: {problem}") from None


class ShardRecords(Sequence[Record]):
    """Records of one format, one for each frame: read shard by shard, never in memory as a whole.

    Parameters
    ----------
    storage : Storage
    shards : mapping of int to ShardSummary
    name : str
        Of the format.
    """

    def __init__(self, storage: Storage, shards: Mapping[int, ShardSummary], name: str) -> None:
        self._storage = storage
        self._name = name
        self._numbers = list(shards)
        self._ends = list(accumulate(shards[number].frames for number in self._numbers))

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    def __iter__(self) -> Iterator[Record]:
        return self._of(self._numbers)

    @overload
    def __getitem__(self, index: int) -> Record: ...
    @overload
    def __getitem__(self, index: slice) -> list[Record]: ...
    def __getitem__(self, index: int | slice) -> Record | list[Record]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        place = index + len(self) if index < 0 else index
        if not 0 <= place < len(self):
            raise IndexError(f"there are {len(self)} records, none of number {index}")
        shard = bisect_right(self._ends, place)
        before = self._ends[shard - 1] if shard else 0
        return next(islice(self._of([self._numbers[shard]]), place - before, None))

    def _of(self, shards: Iterable[int]) -> Iterator[Record]:
        for line in frame_records(self._storage, shards):
            value = line["records"].get(self._name)
            yield Record(number=line["number"], split=line["split"], value=value)


def finish_formats(
    recipe: DatasetRecipe, storage: Storage, shards: Mapping[int, ShardSummary], folder: Path
) -> None:
    """Write into a folder what the formats of a recipe write at their end."""
    for name in recipe.formats:
        kind = format_class(name)
        if merges(kind):
            kind(folder / name).finish(ShardRecords(storage, shards, name))
