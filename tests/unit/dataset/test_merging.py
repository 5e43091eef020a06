"""Shards → the whole: records in their order, summaries and hashes, and what is damaged is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.formats.formats import FORMATS, format_class
from sailenv_ros.dataset.manifest import (
    MANIFEST,
    FileHash,
    ShardSummary,
    ToldContents,
    dataset_hash,
    done_shards,
    summaries_of_files,
    told_contents,
)
from sailenv_ros.dataset.merging import RECORDS_FOLDER, ShardRecords, frame_records, merges
from sailenv_ros.errors import RecordingError

FRAMES = {0: 3, 1: 0, 4: 2}
"""Frames of each shard; shards that were not made are not there."""


def summary(number: int, **changes: Any) -> ShardSummary:
    values: dict[str, Any] = {
        "shard": number, "split": "train", "first_clip": number, "clips": 1,
        "frames": FRAMES[number], "files": {"a/b.txt": FileHash(3, "0" * 64)},
        "written": {"coco": {"images": 1}}, "left_out": {}, "skipped": {"no place": 1},
    }  # fmt: skip
    return ShardSummary(**{**values, **changes})


@pytest.fixture
def storage(tmp_path: Path) -> FolderStorage:
    """Shards with records of two formats; the second format has none of some frames."""
    storage = FolderStorage(tmp_path / "set")
    number = 0
    for shard, frames in FRAMES.items():
        lines = []
        for _ in range(frames):
            records = {"coco": {"id": number}} | ({"voc": number} if number % 2 else {})
            lines.append(json.dumps({"number": number, "split": "train", "records": records}))
            number += 1
        text = "".join(f"{line}\n" for line in lines)
        storage.write(f"{RECORDS_FOLDER}/{shard:05d}.jsonl", text.encode())
        storage.write(summary(shard).path, summary(shard).to_json())
    return storage


def test_records_are_those_of_all_shards_in_order(storage: FolderStorage) -> None:
    """Whether they are gone through, counted, or asked for by number."""
    shards = done_shards(storage)
    assert shards == {number: summary(number) for number in FRAMES}
    records = ShardRecords(storage, shards, "coco")
    values = [{"id": number} for number in range(5)]
    assert [one.value for one in records] == values
    assert [one.value for one in records] == values, "they can be gone through again"
    assert len(records) == 5
    for place in range(-5, 5):
        assert records[place].value == values[place]
        assert records[place].number == place % 5
    assert [one.value for one in records[1:4]] == values[1:4]
    for place in (5, -6):
        with pytest.raises(IndexError, match="there are 5 records"):
            records[place]
    assert [one.value for one in ShardRecords(storage, shards, "voc")] == [None, 1, None, 3, None]
    assert len(ShardRecords(storage, {}, "coco")) == 0


def test_records_that_are_damaged_or_missing_are_named(storage: FolderStorage) -> None:
    (storage.folder / RECORDS_FOLDER / "00004.jsonl").write_bytes(b'{"number": 3\n')
    with pytest.raises(RecordingError, match=r"records/00004\.jsonl .* cannot be read"):
        list(frame_records(storage, FRAMES))
    (storage.folder / RECORDS_FOLDER / "00004.jsonl").unlink()
    with pytest.raises(RecordingError, match=r"lacks records/00004\.jsonl"):
        list(frame_records(storage, FRAMES))


@pytest.mark.parametrize("data", [b"", b"{", b"3", b"{}", b'{"files": 3}', b'{"files": {"a": {}}}'])
def test_a_summary_that_is_none_is_named(storage: FolderStorage, data: bytes) -> None:
    (storage.folder / "shards" / "00001.json").write_bytes(data)
    with pytest.raises(RecordingError, match=r"shards/00001\.json is no summary"):
        done_shards(storage)


def test_a_summary_that_is_being_written_is_no_summary(storage: FolderStorage) -> None:
    """As a worker leaves it that is killed while it writes."""
    path = storage.folder / "shards" / "00001.json"
    path.rename(path.with_name(".00001.json.abc.unfinished"))
    assert list(done_shards(storage)) == [0, 4]


@given(
    files=st.dictionaries(st.text(min_size=1), st.binary(min_size=32, max_size=32), min_size=1),
    random=st.randoms(),
)
def test_the_hash_of_all_files_knows_no_order(files: dict[str, bytes], random: Any) -> None:
    """But on every name and every content."""
    pairs = [(name, FileHash(1, digest.hex())) for name, digest in files.items()]
    shuffled = list(pairs)
    random.shuffle(shuffled)
    known = dataset_hash(pairs)
    assert dataset_hash(shuffled) == known
    name, one = pairs[0]
    assert dataset_hash([(f"{name}x", one), *pairs[1:]]) != known
    assert dataset_hash([(name, FileHash(1, "f" * 63 + "e")), *pairs[1:]]) != known
    assert dataset_hash(pairs[1:]) != known


def test_files_of_the_whole(storage: FolderStorage) -> None:
    """None before it is finished; a manifest that cannot be read is named."""
    assert told_contents(storage) == ToldContents()
    found = summaries_of_files(storage.folder)
    assert list(found) == sorted(found)
    assert found["shards/00000.json"].bytes == len(summary(0).to_json())
    told = {name: {"bytes": one.bytes, "sha256": one.sha256} for name, one in found.items()}
    shards = [{"shard": 0, "sha256": "0" * 64}]
    storage.write(MANIFEST, json.dumps({"files": told, "shards": shards}).encode())
    assert told_contents(storage) == ToldContents(found, {0: "0" * 64})
    storage.write(MANIFEST, b"{}")
    with pytest.raises(RecordingError, match=r"manifest\.json in .* cannot be read"):
        told_contents(storage)


def test_which_formats_have_something_to_merge() -> None:
    """Not those that write one file for each clip or shard alone."""
    assert {name for name in FORMATS if merges(format_class(name))} == {
        "png", "coco", "kitti", "flo", "bop", "yolo", "yolo_segments", "voc", "movi", "lerobot",
        "vqa",
    }  # fmt: skip
