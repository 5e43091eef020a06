"""Frames → questions in words with answers and proofs, for models that see and read.

A line of JSON for each question, and the same as LLaVA's conversations:
https://github.com/haotian-liu/LLaVA/blob/main/docs/Finetune_Custom_Data.md
Then all questions on a picture as one conversation, as ShareGPT has it.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.frame.language import (
    Question,
    SceneGraph,
    SeenObject,
    balanced,
    questions,
    referring_expressions,
    scene_graph,
)
from sailenv_ros.frame.language.seen_objects import seen_objects

__all__ = ["VqaExport", "questions_of"]

_IMAGE = "<image>\n"
"""Stands for the picture in a conversation."""


class VqaExport(DatasetFormat):
    """``images/``, and files for each split.

    ``SPLIT.jsonl``, ``SPLIT_referring.jsonl``, ``SPLIT_llava.json``, ``SPLIT_sharegpt.json``. Where
    frames have the view ``albedo``, colours are asked for; with amodal masks, what is hidden; with
    `SceneFacts`, as recipes have them, materials, contacts, contents and ways.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")
    needs_neighbours: ClassVar[bool] = True
    needs_facts: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write the picture, and keep what is asked of it."""
        graph = scene_graph(sample.frame)
        write_png(self.folder / "images" / f"{sample.stem}.png", sample.frame["rgb"])
        asked = questions_of(sample, graph)
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
            kept = _kept(own)
            lines, turns, talks, meant = [], [], [], []
            for record in own:
                image = f"images/{record.number:06d}.png"
                asked = [record.value["questions"][number] for number in kept[record.number]]
                for number, one in zip(kept[record.number], asked, strict=True):
                    id_ = f"{record.number:06d}_{number}"
                    lines.append({"id": id_, "image": image, **one})
                    turns.append({"id": id_, "image": image, "conversations": _turns(one)})
                said = [turn for one in asked for turn in _turns(one, "")]
                if said:
                    said[0]["value"] = f"{_IMAGE}{said[0]['value']}"
                    talks.append({"conversations": said, "images": [image]})
                meant += [{"image": image, **one} for one in record.value["referring"]]
            stem = split or "all"
            write_bytes(self.folder / f"{stem}.jsonl", _lines(lines))
            write_bytes(self.folder / f"{stem}_referring.jsonl", _lines(meant))
            for form, told in (("llava", turns), ("sharegpt", talks)):
                path = self.folder / f"{stem}_{form}.json"
                write_bytes(path, json.dumps(told, indent=1).encode())


def questions_of(sample: Sample, graph: SceneGraph) -> tuple[Question, ...]:
    """Return the questions on a frame; those on what is not there are of its scene's categories."""
    seen = {one.category for one in graph.objects.values()}
    known = {one.category for one in sample.scene_info("vqa").instances if one.category_id}
    frame, previous = sample.frame, sample.previous
    before: Mapping[int, SeenObject] | None = None
    if previous is not None and (previous.scene, previous.epoch) == (frame.scene, frame.epoch):
        before = {one.id: one for one in seen_objects(previous)}
    return questions(graph, seed=sample.number, absent=known - seen, before=before)


def _kept(records: Sequence[Record]) -> dict[int, list[int]]:
    """Return the places of the questions of each record that balance leaves."""
    places = [
        (record.number, place, one["kind"], one["answer"])
        for record in records
        for place, one in enumerate(record.value["questions"])
    ]
    kept: dict[int, list[int]] = {record.number: [] for record in records}
    for which in balanced([(kind, answer) for _, _, kind, answer in places]):
        number, place, _, _ = places[which]
        kept[number].append(place)
    return kept


def _turns(one: dict[str, Any], begin: str = _IMAGE) -> list[dict[str, str]]:
    return [
        {"from": "human", "value": f"{begin}{one['text']}"},
        {"from": "gpt", "value": one["answer"]},
    ]


def _lines(entries: Sequence[dict[str, Any]]) -> bytes:
    return "".join(f"{json.dumps(entry)}\n" for entry in entries).encode()
