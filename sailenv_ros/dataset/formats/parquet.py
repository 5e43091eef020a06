"""Frames → Parquet: tables of pictures and objects, as Hugging Face's `datasets` loads them.

A row is a frame. Pictures of 8 and 16 bits are PNG files, which `datasets` shows as images; other
views are arrays of numbers. ``objects`` is a list, an entry for each visible object; ``randomised``
a JSON text of what was drawn at random, if anything was.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.annotated_objects import annotated_objects
from sailenv_ros.dataset.formats.dataset_format import Sample, WriteResult
from sailenv_ros.dataset.formats.images import frame_record
from sailenv_ros.dataset.formats.object_records import object_record
from sailenv_ros.dataset.formats.row_tables import TableFormat
from sailenv_ros.frame.pictures.codecs import encode_png

__all__ = ["ParquetExport"]


class ParquetExport(TableFormat):
    """``data/<split>-00000.parquet``, one for each split, or for each shard of a large data set."""

    def add(self, sample: Sample) -> WriteResult:
        """Append a frame."""
        frame = sample.frame
        told = frame_record(sample.number, frame)
        found = annotated_objects(sample, "Parquet")
        row = {
            **told,
            "frame": told["sequence"],
            "sequence": sample.sequence,
            "K": np.ravel(told["K"]).tolist(),
            "world_from_camera": np.ravel(told["world_from_camera"]).tolist(),
            **{key: told.get(key) for key in ("distortion_model", "D", "max_angle_deg")},
            "randomised": json.dumps(told["randomised"]) if "randomised" in told else None,
            "objects": [object_record(found.table, index) for index in range(len(found.table))],
            **{view: _cell(values) for view, values in frame.views.items()},
        }
        table = self._table(sample.split, lambda: _schema(self._arrow, frame.views))
        table.append(row)
        return WriteResult(written={"rows": 1}, left_out=found.left_out)


def _is_image(values: NDArray[Any]) -> bool:
    return values.dtype in (np.uint8, np.uint16, np.bool_)


def _cell(values: NDArray[Any]) -> Any:
    if _is_image(values):
        return {"bytes": encode_png(values, "fastest"), "path": None}
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
        "distortion_model": pa.string(), "D": numbers, "max_angle_deg": pa.float64(),
        "randomised": pa.string(),
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
