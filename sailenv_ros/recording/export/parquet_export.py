"""Frames → Parquet: tables of pictures and objects, as Hugging Face's `datasets` loads them.

A row is a frame. Pictures of 8 and 16 bits are PNG files, which `datasets` shows as images; other
views are arrays of numbers. ``objects`` is a list, an entry for each visible object.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import RecordingError
from sailenv_ros.extras import need
from sailenv_ros.recording.export.annotated_objects import annotated_objects
from sailenv_ros.recording.export.data_files import discard_drafts, png_bytes
from sailenv_ros.recording.export.dataset_format import DatasetFormat, Made, Record, Sample
from sailenv_ros.recording.export.image_formats import frame_record
from sailenv_ros.recording.export.object_records import object_record
from sailenv_ros.system.files import make_folder, written_file

__all__ = ["ParquetExport"]

ROWS_PER_GROUP = 32


class ParquetExport(DatasetFormat):
    """``data/<split>-00000.parquet``, one for each split, or for each shard of a large data set."""

    is_shard: ClassVar[bool] = True
    resumable: ClassVar[bool] = False

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._arrow: Any = need("pyarrow", "the format parquet")
        self._parquet: Any = need("pyarrow.parquet", "the format parquet")
        self._open = ExitStack()
        self._writers: dict[str, Any] = {}
        self._rows: dict[str, list[dict[str, Any]]] = {}
        self._schemas: dict[str, Any] = {}

    def add(self, sample: Sample) -> Made:
        """Append a frame."""
        split = sample.split or "train"
        frame = sample.frame
        row = {"sequence": sample.sequence, **frame_record(sample.number, frame)}
        row["frame"] = row.pop("sequence")
        row["sequence"] = sample.sequence
        row["K"] = np.ravel(row["K"]).tolist()
        row["world_from_camera"] = np.ravel(row["world_from_camera"]).tolist()
        found = annotated_objects(sample, "Parquet")
        row["objects"] = [object_record(found.table, index) for index in range(len(found.table))]
        for view, values in frame.views.items():
            row[view] = _cell(values)
        if split not in self._writers:
            self._begin(split, frame.views)
        self._rows[split].append(row)
        if len(self._rows[split]) == ROWS_PER_GROUP:
            self._flush(split)
        return Made(written={"rows": 1}, left_out=found.left_out)

    def finish(self, records: Sequence[Record]) -> None:
        """Write what is left and close the files."""
        for split, writer in self._writers.items():
            self._flush(split)
            writer.close()
        self._open.close()
        self._writers.clear()

    def close(self) -> None:
        """Remove what is not complete."""
        self._writers.clear()
        discard_drafts(self._open)

    def _begin(self, split: str, views: Mapping[str, NDArray[Any]]) -> None:
        path = self.folder / "data" / f"{split}-{self.part:05d}.parquet"
        try:
            make_folder(path.parent)
            file = self._open.enter_context(written_file(path, durable=False))
        except OSError as problem:
            raise RecordingError(f"{path} cannot be written: {problem.strerror}") from None
        self._schemas[split] = _schema(self._arrow, views)
        self._rows[split] = []
        self._writers[split] = self._parquet.ParquetWriter(
            file, self._schemas[split], compression="zstd"
        )

    def _flush(self, split: str) -> None:
        rows, self._rows[split] = self._rows[split], []
        if rows:
            table = self._arrow.Table.from_pylist(rows, schema=self._schemas[split])
            try:
                self._writers[split].write_table(table)
            except OSError as problem:
                raise RecordingError(f"the Parquet file cannot be written: {problem}") from None


def _is_image(values: NDArray[Any]) -> bool:
    return values.dtype in (np.uint8, np.uint16, np.bool_)


def _cell(values: NDArray[Any]) -> Any:
    if values.dtype == np.bool_:
        values = values.astype(np.uint8) * np.uint8(255)
    if _is_image(values):
        return {"bytes": png_bytes(values), "path": None}
    return [row if row.ndim == 1 else list(row) for row in values]


def _schema(pa: Any, views: Mapping[str, NDArray[Any]]) -> Any:
    """Return the columns, and what they mean to `datasets`."""
    numbers = pa.list_(pa.float64())
    item = {
        "id": pa.int64(), "name": pa.string(), "parent": pa.int64(), "category": pa.string(),
        "category_id": pa.int64(), "asset": pa.string(), "visible_pixels": pa.int64(),
        "box": pa.list_(pa.int64()), "amodal_pixels": pa.int64(),
        "amodal_box": pa.list_(pa.int64()), "visible_share": pa.float64(),
        "distance": pa.float64(), "size": numbers, "camera_from_object": numbers,
    }  # fmt: skip
    columns = {
        "number": pa.int64(), "frame": pa.int64(), "sequence": pa.string(), "scene": pa.string(),
        "stamp_ns": pa.int64(), "dt_ns": pa.int64(), "K": numbers, "world_from_camera": numbers,
        "objects": pa.list_(pa.struct(item)),
    }  # fmt: skip
    features = {name: _feature(kind) for name, kind in columns.items() if name != "objects"}
    features["objects"] = [{name: _feature(kind) for name, kind in item.items()}]
    for view, values in views.items():
        if _is_image(values):
            columns[view] = pa.struct({"bytes": pa.binary(), "path": pa.string()})
            features[view] = {"_type": "Image"}
        else:
            kind = pa.from_numpy_dtype(values.dtype)
            for _ in values.shape:
                kind = pa.list_(kind)
            columns[view] = kind
            shape = {"shape": list(values.shape), "dtype": str(values.dtype)}
            features[view] = {**shape, "_type": f"Array{values.ndim}D"}
    told = json.dumps({"info": {"features": features}})
    return pa.schema(list(columns.items()), metadata={"huggingface": told})


def _feature(kind: Any) -> Any:
    """Return the name that `datasets` has for a type."""
    if hasattr(kind, "value_type"):
        return {"feature": _feature(kind.value_type), "_type": "Sequence"}
    name = {"double": "float64"}.get(str(kind), str(kind))
    return {"dtype": name, "_type": "Value"}
