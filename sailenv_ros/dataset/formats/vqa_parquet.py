"""Frames → a Parquet table of questions, answers and proofs, each with its picture.

A row is a question. Hugging Face's `datasets` loads it with pictures as images. Pictures wait in a
hidden folder until all questions are known, of which balance leaves some.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import Record, Sample, WriteResult
from sailenv_ros.dataset.formats.row_tables import TableFormat
from sailenv_ros.dataset.formats.vqa import questions_of
from sailenv_ros.frame.language import balanced, scene_graph
from sailenv_ros.frame.pictures.codecs import encode_png

__all__ = ["VqaParquetExport"]

_TEXTS = ("id", "kind", "question", "answer", "proof")


class VqaParquetExport(TableFormat):
    """``data/<split>-00000.parquet``, one for each split, or for each shard of a large data set."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")
    needs_neighbours: ClassVar[bool] = True
    needs_facts: ClassVar[bool] = True

    def __init__(self, folder: Path) -> None:
        super().__init__(folder)
        self._asked: dict[str, list[tuple[str, dict[str, str]]]] = {}

    def add(self, sample: Sample) -> WriteResult:
        """Keep the picture and the questions on a frame."""
        asked = questions_of(sample, scene_graph(sample.frame))
        write_bytes(self._picture(sample.stem), encode_png(sample.frame["rgb"], "fastest"))
        rows = self._asked.setdefault(sample.split, [])
        for number, one in enumerate(asked):
            texts = (
                f"{sample.stem}_{number}",
                one.kind,
                one.text,
                one.answer,
                json.dumps([dict(fact) for fact in one.proof]),
            )
            rows.append((sample.stem, dict(zip(_TEXTS, texts, strict=True))))
        return WriteResult(written={"questions": len(asked)})

    def finish(self, records: Sequence[Record]) -> None:
        """Write what balance leaves, and close the files."""
        for split, rows in self._asked.items():
            table = self._table(split, self._schema)
            for place in balanced([(row["kind"], row["answer"]) for _, row in rows]):
                stem, row = rows[place]
                data = self._picture(stem).read_bytes()
                table.append({**row, "image": {"bytes": data, "path": f"{stem}.png"}})
        super().finish(records)
        self._forget()

    def close(self) -> None:
        """Remove what is not complete."""
        super().close()
        self._forget()

    def _picture(self, stem: str) -> Path:
        return self.folder / f".pictures_{self.part:05d}" / f"{stem}.png"

    def _forget(self) -> None:
        self._asked.clear()
        shutil.rmtree(self._picture("").parent, ignore_errors=True)

    def _schema(self) -> Any:
        pa = self._arrow
        columns = {name: pa.string() for name in _TEXTS}
        columns["image"] = pa.struct({"bytes": pa.binary(), "path": pa.string()})
        features: dict[str, Any] = {name: {"dtype": "string", "_type": "Value"} for name in _TEXTS}
        features["image"] = {"_type": "Image"}
        told = json.dumps({"info": {"features": features}})
        return pa.schema(list(columns.items()), metadata={"huggingface": told})
