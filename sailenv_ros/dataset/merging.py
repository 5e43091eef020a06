"""Records of all shards → what formats write once all is known: tables of annotations, models."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.dataset_recipe import DatasetRecipe
from sailenv_ros.dataset.stores import Store
from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.export.dataset_format import DatasetFormat, Record
from sailenv_ros.recording.export.formats import format_class

__all__ = ["RECORDS_FOLDER", "merges", "finish_formats", "frame_records"]


RECORDS_FOLDER = "records"
"""Folder of the data set with a file of each shard: a line of JSON for each frame."""


def merges(kind: type[DatasetFormat]) -> bool:
    """Return whether a format writes something once all shards are known."""
    return not kind.is_sequence and (not kind.is_shard or kind.needs_records)


def frame_records(store: Store, shards: Iterable[int]) -> Iterator[dict[str, Any]]:
    """Yield what is known of each frame, in the order of the shards.

    Raises
    ------
    RecordingError
        If a shard's records are not there or cannot be read.
    """
    for number in shards:
        path = f"{RECORDS_FOLDER}/{number:05d}.jsonl"
        data = store.read(path)
        if data is None:
            raise RecordingError(f"{store.shown} lacks {path}")
        try:
            yield from (json.loads(line) for line in data.splitlines())
        except ValueError as problem:
            raise RecordingError(f"{path} in {store.shown} cannot be read: {problem}") from None


def finish_formats(
    recipe: DatasetRecipe, store: Store, shards: Iterable[int], folder: Path
) -> None:
    """Write into a folder what the formats of a recipe write at their end."""
    kinds = {name: format_class(name) for name in recipe.formats}
    kinds = {name: kind for name, kind in kinds.items() if merges(kind)}
    records: dict[str, list[Record]] = {name: [] for name in kinds}
    for line in frame_records(store, shards) if kinds else ():
        for name in kinds:
            value = line["records"].get(name)
            records[name].append(Record(number=line["number"], split=line["split"], value=value))
    for name, kind in kinds.items():
        kind(folder / name).finish(records[name])
