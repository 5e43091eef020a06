"""Pictures and drafts of data sets: exact, whole, refused in one sentence."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.dataset.formats.bop import BopExport
from sailenv_ros.dataset.formats.coco import CocoExport
from sailenv_ros.dataset.formats.data_files import (
    discard_drafts,
    json_pieces,
    open_draft,
    write_json,
)
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record
from sailenv_ros.errors import RecordingError


def test_drafts_take_their_places_together_or_not_at_all(tmp_path: Path) -> None:
    for keep in (True, False):
        path = tmp_path / str(keep) / "file"
        drafts = ExitStack()
        open_draft(drafts, path).write(b"whole")
        assert not path.exists()
        if keep:
            drafts.close()
        else:
            discard_drafts(drafts)
        assert path.exists() == keep
        assert len(list(path.parent.iterdir())) == keep


def test_a_draft_that_cannot_be_opened_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"")
    with ExitStack() as drafts, pytest.raises(RecordingError, match="file/below cannot be written"):
        open_draft(drafts, tmp_path / "file" / "below")


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=12,
)


@given(value=JSON)
def test_json_in_pieces_is_the_json_of_the_whole(value: Any) -> None:
    assert "".join(json_pieces(value)) == json.dumps(value, indent=1)


@given(first=st.lists(JSON, max_size=4), second=st.lists(JSON, max_size=4))
def test_iterators_are_lists(first: list[Any], second: list[Any]) -> None:
    whole = json.dumps({"first": first, "more": {"second": second}}, indent=1)
    pieces = json_pieces({"first": iter(first), "more": {"second": iter(second)}})
    assert "".join(pieces) == whole
    assert "".join(json_pieces(iter(first))) == json.dumps(first, indent=1)


def test_json_is_not_there_if_its_values_cannot_be_read(tmp_path: Path) -> None:
    def values() -> Iterator[int]:
        yield 1
        raise RecordingError("lost")

    with pytest.raises(RecordingError, match="lost"):
        write_json(tmp_path / "table.json", {"values": values()})
    assert not list(tmp_path.iterdir())


class _Made(Sequence[Record]):
    """Records that are made when they are asked for, each of some 20 kB."""

    def __init__(self, count: int, value: Callable[[int], Any]) -> None:
        self._count = count
        self._value = value

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, index: Any) -> Any:
        if not 0 <= index < self._count:
            raise IndexError(index)
        return Record(number=index, split=("train", "val")[index % 2], value=self._value(index))


def _coco(index: int) -> Any:
    annotation = {"image_id": index, "segmentation": {"counts": "x" * 1000 + str(index)}}
    return {"image": {"id": index}, "categories": {"1": "bed"}, "annotations": [annotation] * 20}


def _bop(index: int) -> Any:
    truth = {"cam_R_m2c": [index] * 9, "cam_t_m2c": [0], "instance_id": 1, "parent_id": 0}
    return {
        "scene": index // 4,
        "camera": {"cam_K": [float(index)] * 9},
        "size": [4, 4],
        "truths": [{**truth, "asset": "cube", "scale": [1.0, 1.0, 1.0]}] * 3,
        "infos": [{"px_count_all": index, "note": "x" * 9000}],
    }


@pytest.mark.parametrize(("kind", "value"), [(CocoExport, _coco), (BopExport, _bop)])
def test_tables_of_annotations_need_not_fit_into_memory(
    kind: type[DatasetFormat], value: Callable[[int], Any], tmp_path: Path
) -> None:
    peaks = []
    for count in (60, 600):
        tried = []
        # What other threads of the process have left to do adds to a peak: the least counts.
        for number in range(3):
            folder = tmp_path / f"{count} {number}"
            tracemalloc.start()
            kind(folder).finish(_Made(count, value))
            tried.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
        peaks.append(min(tried))
    written = sum(path.stat().st_size for path in folder.rglob("*.json"))
    assert written > 3_000_000
    assert peaks[1] < peaks[0] + 0.1 * written


def test_annotations_are_numbered_through_all_splits(tmp_path: Path) -> None:
    CocoExport(tmp_path).finish(_Made(6, _coco))
    tables = [json.loads((tmp_path / s / "annotations.json").read_text()) for s in ("train", "val")]
    assert [one["id"] for table in tables for one in table["annotations"]] == [*range(1, 121)]
    assert [[one["id"] for one in table["images"]] for table in tables] == [[0, 2, 4], [1, 3, 5]]
