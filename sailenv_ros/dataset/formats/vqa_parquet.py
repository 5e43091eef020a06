"""Frames → a Parquet table of questions, answers and proofs, each with its picture.

A row is a question. Hugging Face's `datasets` loads it with pictures as images.
"""

from __future__ import annotations

import json
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.dataset_format import Sample, WriteResult
from sailenv_ros.dataset.formats.row_tables import TableFormat
from sailenv_ros.dataset.formats.vqa import questions_of
from sailenv_ros.frame.language import scene_graph
from sailenv_ros.frame.pictures.codecs import encode_png

__all__ = ["VqaParquetExport"]

_TEXTS = ("id", "kind", "question", "answer", "proof")


class VqaParquetExport(TableFormat):
    """``data/<split>-00000.parquet``, one for each split, or for each shard of a large data set."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Append the questions on a frame."""
        asked = questions_of(sample, scene_graph(sample.frame))
        data = encode_png(sample.frame["rgb"], "fastest")
        table = self._table(sample.split, self._schema)
        for number, one in enumerate(asked):
            table.append(
                {
                    "id": f"{sample.stem}_{number}",
                    "kind": one.kind,
                    "question": one.text,
                    "answer": one.answer,
                    "proof": json.dumps([dict(fact) for fact in one.proof]),
                    "image": {"bytes": data, "path": f"{sample.stem}.png"},
                }
            )
        return WriteResult(written={"questions": len(asked)})

    def _schema(self) -> Any:
        pa = self._arrow
        columns = {name: pa.string() for name in _TEXTS}
        columns["image"] = pa.struct({"bytes": pa.binary(), "path": pa.string()})
        features: dict[str, Any] = {name: {"dtype": "string", "_type": "Value"} for name in _TEXTS}
        features["image"] = {"_type": "Image"}
        told = json.dumps({"info": {"features": features}})
        return pa.schema(list(columns.items()), metadata={"huggingface": told})
