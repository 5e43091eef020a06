"""Frames → the MOT challenge's sequences: `img1`, `gt/gt.txt`, `seqinfo.ini`.

The format is that of A. Milan et al., "MOT16: A Benchmark for Multi-Object Tracking", 2016: a line
for each object in each picture, whose columns are frame, id, left, top, width, height, 1, class,
visibility. Frames and pixels count from 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from sailenv_ros.dataset.formats.annotated_objects import (
    annotated_objects,
    categories_of,
    merged_categories,
)
from sailenv_ros.dataset.formats.data_files import write_bytes, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult

__all__ = ["MotExport"]


class MotExport(DatasetFormat):
    """One sequence.

    Boxes are those of whole objects, as far as they lie in the picture, where amodal masks are
    known; else those of what is visible, with visibility 1. Objects of which nothing is visible are
    left out.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")
    is_sequence: ClassVar[bool] = True

    def add(self, sample: Sample) -> WriteResult:
        """Write the picture of a frame and take its objects."""
        found = annotated_objects(sample, "MOT")
        frame, table = sample.frame, found.table
        write_png(self.folder / "img1" / f"{sample.number + 1:06d}.png", frame["rgb"])
        whole = table.amodal_pixels > 0
        boxes = np.where(whole[:, None], table.amodal_boxes, table.visible_boxes)
        shares = np.where(whole, table.visible_share, 1.0)
        lines = []
        for row, (left, top, right, bottom) in enumerate(boxes.tolist()):
            size = f"{right - left + 1},{bottom - top + 1}"
            lines.append(
                f"{sample.number + 1},{table.ids[row]},{left + 1},{top + 1},{size},1,"
                f"{table.category_ids[row]},{shares[row]:.5f}"
            )
        height, width = frame["instance"].shape
        return WriteResult(
            record={
                "lines": lines,
                "size": [width, height],
                "stamp_ns": frame.stamp_ns,
                "categories": categories_of(sample, "MOT"),
                "scene": frame.scene,
            },
            written={"pictures": 1, "boxes": len(lines)},
            left_out=found.left_out,
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the ground truth, names of classes, and what is known of the sequence."""
        lines = [line for record in records for line in record.value["lines"]]
        text = "".join(f"{line}\n" for line in lines)
        write_bytes(self.folder / "gt" / "gt.txt", text.encode())
        names = merged_categories(record.value["categories"] for record in records)
        listed = "".join(f"{id_},{name}\n" for id_, name in names.items())
        write_bytes(self.folder / "gt" / "classes.txt", listed.encode())
        nothing = {"size": [0, 0], "scene": "", "stamp_ns": 0}
        first: Mapping[str, Any] = records[0].value if records else nothing
        steps = np.diff([record.value["stamp_ns"] for record in records])
        rate = 1e9 / float(np.median(steps)) if len(steps) and np.median(steps) > 0 else 30.0
        width, height = first["size"]
        info = (
            "[Sequence]\n"
            f"name={first['scene']}\nimDir=img1\nframeRate={rate:g}\nseqLength={len(records)}\n"
            f"imWidth={width}\nimHeight={height}\nimExt=.png\n"
        )
        write_bytes(self.folder / "seqinfo.ini", info.encode())
