"""Frames → data sets for YOLO trainers: a text file of boxes, or of outlines, for each picture.

The layout is that of https://docs.ultralytics.com/datasets/detect/: ``images/train/000000.png``
with ``labels/train/000000.txt``, and ``data.yaml``. Numbers are shares of the picture's width and
height, from its left upper corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import cv2
import numpy as np
import yaml

from sailenv_ros.dataset.formats.annotated_objects import (
    AnnotatedObjects,
    annotated_objects,
    categories_of,
    merged_categories,
)
from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.frame.frame import Frame

__all__ = ["YoloExport", "YoloSegmentsExport"]

UNSPLIT = "train"
"""The folder of a data set that is not split: trainers want at least this one."""

LEAST_CORNERS = 3


class YoloExport(DatasetFormat):
    """Boxes around what is visible: class, centre x and y, width, height."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Write the picture of a frame and take its objects."""
        found = annotated_objects(sample, "YOLO")
        split = sample.split or UNSPLIT
        write_png(self.folder / "images" / split / f"{sample.stem}.png", sample.frame["rgb"])
        rows, left_out = self._rows(sample.frame, found)
        return WriteResult(
            record={"categories": categories_of(sample, "YOLO"), "rows": rows},
            written={"pictures": 1, "objects": len(rows)},
            left_out={**found.left_out, **left_out},
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the labels, for which all categories must be known, and `data.yaml`."""
        names = merged_categories(record.value["categories"] for record in records)
        classes = {id_: number for number, id_ in enumerate(names)}
        splits = []
        for record in records:
            split = record.split or UNSPLIT
            splits.append(split)
            lines = [
                " ".join([str(classes[id_]), *(f"{value:.6f}" for value in numbers)])
                for id_, *numbers in record.value["rows"]
            ]
            path = self.folder / "labels" / split / f"{record.number:06d}.txt"
            write_bytes(path, "".join(f"{line}\n" for line in lines).encode())
        table = {
            "path": ".",
            **{split: f"images/{split}" for split in dict.fromkeys(splits)},
            "names": {number: names[id_] for id_, number in classes.items()},
        }
        # Trainers refuse a data set without one for validation.
        table.setdefault("val", table.get("train", ""))
        text = yaml.safe_dump(table, sort_keys=False, allow_unicode=True)
        write_bytes(self.folder / "data.yaml", text.encode())

    def _rows(
        self, frame: Frame, found: AnnotatedObjects
    ) -> tuple[list[list[Any]], dict[str, int]]:
        """Return category id and numbers of each object, and how many were left out and why."""
        height, width = frame["instance"].shape
        rows: list[list[Any]] = []
        boxes = found.table.visible_boxes.tolist()
        for id_, (left, top, right, bottom) in zip(
            found.table.category_ids.tolist(), boxes, strict=True
        ):
            across, down = right - left + 1, bottom - top + 1
            rows.append(
                [
                    id_,
                    (left + 0.5 * across) / width,
                    (top + 0.5 * down) / height,
                    across / width,
                    down / height,
                ]
            )
        return rows, {}


class YoloSegmentsExport(YoloExport):
    """Outlines of what is visible: class, then x and y of each corner.

    An object in several pieces has a line for each piece; holes are filled, as the format has none.
    """

    def _rows(
        self, frame: Frame, found: AnnotatedObjects
    ) -> tuple[list[list[Any]], dict[str, int]]:
        height, width = frame["instance"].shape
        rows: list[list[Any]] = []
        specks = 0
        table = found.table
        for row, id_ in enumerate(table.category_ids.tolist()):
            left, top, right, bottom = table.visible_boxes[row].tolist()
            crop = frame["instance"][top : bottom + 1, left : right + 1] == table.ids[row]
            # Corners of pixels, not their centres: at twice the size each pixel has four.
            doubled = np.repeat(np.repeat(crop.astype(np.uint8), 2, axis=0), 2, axis=1)
            outlines, _ = cv2.findContours(doubled, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
            for outline in outlines:
                if len(outline) < LEAST_CORNERS:
                    specks += 1
                    continue
                # A place k of the doubled mask lies in pixel k // 2; its outer edge is wanted.
                points = (outline.reshape(-1, 2) + 1) // 2 + (left, top)
                shares = points / (width, height)
                rows.append([id_, *shares.reshape(-1).tolist()])
        return rows, {"piece without an area": specks} if specks else {}
