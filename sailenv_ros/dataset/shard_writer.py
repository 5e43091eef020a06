"""Frames of a shard → files of all its formats, at the places that they have in the data set.

Pictures and their labels are files of the data set at once; what a format can only write when all
is known, such as one table of all annotations, is kept as records (see `merging`).
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from sailenv_ros.dataset.formats.annotated_objects import NO_CATEGORY
from sailenv_ros.dataset.formats.data_files import write_bytes
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.formats import format_class
from sailenv_ros.dataset.merging import RECORDS_FOLDER, merges
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.shard_plan import Clip, Shard
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.pictures.codecs import encode_jpeg

__all__ = ["PICTURES_FOLDER", "ShardWriter"]

PICTURES_FOLDER = "pictures"
"""Folder with a small picture of each shard's first frames, for the data set's card."""

PICTURES = 4
PICTURE_WIDTH = 320


@dataclass(eq=False, slots=True)
class _Sequence:
    """One camera's frames of the clip that is being written; sequences are numbered from 0."""

    name: str
    number: int
    formats: dict[str, DatasetFormat]
    records: dict[str, list[Record]]
    count: int = 0
    before: Frame | None = None
    held: Frame | None = None


class ShardWriter:
    """Writes one shard.

    Parameters
    ----------
    folder : Path
        Becomes a part of the data set.
    recipe : DatasetRecipe
    shard : Shard

    Attributes
    ----------
    written, left_out : mapping of str to Counter
        How many of what each format wrote, and did not by the reason.
    """

    def __init__(self, folder: Path, recipe: DatasetRecipe, shard: Shard) -> None:
        self.written: dict[str, Counter[str]] = {name: Counter() for name in recipe.formats}
        self.left_out: dict[str, Counter[str]] = {name: Counter() for name in recipe.formats}
        self._folder = folder
        self._recipe = recipe
        self._shard = shard
        self._lines: dict[int, str] = {}
        self._pictures = 0
        self._sequences: dict[str, _Sequence] = {}
        self._clip: Clip | None = None
        self._own: dict[str, DatasetFormat] = {}
        for name in recipe.formats:
            kind = format_class(name)
            if not kind.is_sequence or kind.has_sequences:
                made = self._own[name] = kind(format_folder(folder, kind, name, shard.split))
                made.part, made.flow = shard.number, recipe.flow
                made.compression = recipe.compression_of_views

    def begin_clip(self, clip: Clip) -> None:
        """Begin with the frames of a clip."""
        self._clip = clip
        cameras = len(self._recipe.cameras)
        for place, camera in enumerate(self._recipe.cameras):
            name = f"{clip.number:06d}"
            if cameras > 1:
                name += f"_{camera.name}"
            formats: dict[str, DatasetFormat] = {}
            shared: dict[Any, Any] = {}
            for entry in self._recipe.formats:
                kind = format_class(entry)
                if entry in self._own:
                    formats[entry] = self._own[entry]
                else:
                    formats[entry] = kind(self._folder / entry / clip.split / name)
                    formats[entry].flow, formats[entry].shared = self._recipe.flow, shared
            self._sequences[camera.name] = _Sequence(
                name, clip.sequence(place, cameras), formats, {one: [] for one in formats}
            )

    def add(self, camera: str, frame: Frame) -> None:
        """Write one frame of a camera, or the one before, if it has waited for this one."""
        sequence = self._sequences[camera]
        held, sequence.held = sequence.held, frame
        if held is not None:
            self._write(sequence, camera, held, frame)

    def end_clip(self) -> None:
        """Finish what belongs to one clip alone."""
        for camera, sequence in self._sequences.items():
            if sequence.held is not None:
                self._write(sequence, camera, sequence.held, None)
            for name, made in sequence.formats.items():
                if name not in self._own:
                    made.finish(sequence.records[name])
        self._sequences.clear()

    def finish(self) -> None:
        """Finish what belongs to the shard alone, and write the records."""
        for made in self._own.values():
            if type(made).is_shard:
                made.finish([])
        text = "".join(f"{self._lines[number]}\n" for number in sorted(self._lines))
        write_bytes(self._folder / RECORDS_FOLDER / f"{self._shard.name}.jsonl", text.encode())

    def close(self) -> None:
        """Free what is open, when the shard is given up."""
        for sequence in self._sequences.values():
            for made in sequence.formats.values():
                made.close()
        for made in self._own.values():
            made.close()

    def _write(
        self, sequence: _Sequence, camera: str, frame: Frame, following: Frame | None
    ) -> None:
        assert self._clip is not None
        sample = Sample(
            number=sequence.number * self._recipe.clip.frames + sequence.count,
            frame=frame,
            split=self._clip.split,
            previous=sequence.before,
            following=following,
            sequence=sequence.name,
            sequence_number=sequence.number + 1,
            rules=self._recipe.annotation_rules,
        )
        kept: dict[str, Any] = {}
        for name, made in sequence.formats.items():
            own = name in self._own
            in_clip = replace(sample, number=sequence.count, split="")
            result: WriteResult = made.add(in_clip if type(made).is_sequence else sample)
            self.written[name].update(result.written)
            self.left_out[name].update(result.left_out)
            if not own:
                record = Record(number=sequence.count, split="", value=result.record)
                sequence.records[name].append(record)
            elif result.record is not None and merges(type(made)):
                kept[name] = result.record
        self._lines[sample.number] = json.dumps(
            {
                "number": sample.number,
                "split": sample.split,
                "clip": self._clip.number,
                "camera": camera,
                "time": sequence.count,
                "scene": frame.scene,
                "objects": _object_rows(frame),
                "records": kept,
            }
        )
        if sequence.count == 0 and self._pictures < PICTURES and "rgb" in frame.views:
            self._pictures += 1
            name = f"{self._shard.name}_{self._pictures}.jpg"
            write_bytes(self._folder / PICTURES_FOLDER / name, _small_picture(frame))
        sequence.count += 1
        sequence.before = frame


def format_folder(folder: Path, kind: type[DatasetFormat], name: str, split: str) -> Path:
    """Return the folder that a format is told to write into, within a data set."""
    return folder / name / split if kind.has_sequences else folder / name


def _object_rows(frame: Frame) -> list[list[Any]]:
    """Return category, visible pixels, visible share and distance of each visible object."""
    if frame.info is None or "instance" not in frame.views:
        return []
    table = frame.objects if frame.draw_amodal is None else frame.objects.with_amodal(frame.amodal)
    rows = []
    for row in np.flatnonzero(table.visible).tolist():
        if table.category_ids[row] in NO_CATEGORY:
            continue
        share, distance = float(table.visible_share[row]), float(table.distances[row])
        rows.append(
            [
                table.categories[row],
                int(table.visible_pixels[row]),
                round(share, 6) if np.isfinite(share) else None,
                round(distance, 6) if np.isfinite(distance) else None,
            ]
        )
    return rows


def _small_picture(frame: Frame) -> bytes:
    height, width = frame["rgb"].shape[:2]
    size = PICTURE_WIDTH, max(1, round(PICTURE_WIDTH * height / width))
    small = cv2.resize(frame["rgb"], size, interpolation=cv2.INTER_AREA)
    return encode_jpeg(np.asarray(small, np.uint8), quality=85)
