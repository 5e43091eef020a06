"""Frames → questions in words with answers and proofs, for models that see and read.

A line of JSON for each question, and the same as LLaVA's conversations:
https://github.com/haotian-liu/LLaVA/blob/main/docs/Finetune_Custom_Data.md
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.frame.language import questions, referring_expressions, scene_graph

__all__ = ["VqaExport"]


class VqaExport(DatasetFormat):
    """``images/``, and for each split ``….jsonl``, ``…_llava.json``, ``…_referring.jsonl``."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Write the picture, and keep what is asked of it."""
        info, name = sample.scene_info("vqa"), f"{sample.stem}.png"
        graph = scene_graph(sample.frame)
        write_png(self.folder / "images" / name, sample.frame["rgb"])
        seen = {one.category for one in graph.objects.values()}
        elsewhere = {one.category for one in info.instances if one.category_id} - seen
        asked = questions(graph, seed=sample.number, absent=elsewhere)
        meant = [
            {"object": one.object, "text": one.text, "box": list(graph.objects[one.object].box)}
            for one in referring_expressions(graph)
        ]
        return WriteResult(
            record={"questions": [dataclasses.asdict(one) for one in asked], "referring": meant},
            written={"pictures": 1, "questions": len(asked), "expressions": len(meant)},
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the files of each split."""
        for split in sorted({record.split for record in records}):
            own = [record for record in records if record.split == split]
            lines, turns, meant = [], [], []
            for record in own:
                image = f"images/{record.number:06d}.png"
                for number, one in enumerate(record.value["questions"]):
                    id_ = f"{record.number:06d}_{number}"
                    lines.append({"id": id_, "image": image, **one})
                    turns.append({"id": id_, "image": image, "conversations": _turns(one)})
                meant += [{"image": image, **one} for one in record.value["referring"]]
            stem = split or "all"
            write_bytes(self.folder / f"{stem}.jsonl", _lines(lines))
            write_bytes(self.folder / f"{stem}_referring.jsonl", _lines(meant))
            write_bytes(self.folder / f"{stem}_llava.json", json.dumps(turns, indent=1).encode())


def _turns(one: dict[str, Any]) -> list[dict[str, str]]:
    return [
        {"from": "human", "value": f"<image>\n{one['text']}"},
        {"from": "gpt", "value": one["answer"]},
    ]


def _lines(entries: Sequence[dict[str, Any]]) -> bytes:
    return "".join(f"{json.dumps(entry)}\n" for entry in entries).encode()
