"""Frames → COCO's instance annotations: masks as run lengths, boxes, categories.

The format is that of https://cocodataset.org/#format-data. An annotation is one object in one
picture; `instance_id` joins those of one object.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.recording.export.coco_rle import run_lengths, run_lengths_text
from sailenv_ros.recording.export.data_files import write_json, write_png
from sailenv_ros.recording.export.dataset_format import DatasetFormat, Made, Record, Sample
from sailenv_ros.recording.export.image_formats import frame_record

__all__ = ["CocoExport"]

_NO_CATEGORY = (0, 255)
"""Background and unlabelled."""


class CocoExport(DatasetFormat):
    """`images/*.png` and `annotations.json`, in each split's folder."""

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> Made:
        """Write the picture of a frame and take its objects."""
        info, frame, number = sample.scene_info("COCO"), sample.frame, sample.number
        name = f"{sample.stem}.png"
        write_png(self.folder / sample.split / "images" / name, frame["rgb"])
        height, width = frame["instance"].shape
        image = {"id": number, "file_name": name, "width": width, "height": height}
        categories = {
            str(category.id): category.name
            for category in info.categories.values()
            if category.id not in _NO_CATEGORY
        }
        objects = {instance.id: instance for instance in info.instances}
        annotations = []
        left_out: Counter[str] = Counter()
        for instance_id in np.unique(frame["instance"]).tolist():
            instance = objects.get(instance_id)
            if instance is None or instance.category_id in _NO_CATEGORY:
                left_out["no category"] += instance_id != 0
                continue
            annotations.append(
                {
                    "image_id": number,
                    "category_id": instance.category_id,
                    "instance_id": instance_id,
                    "instance_name": instance.name,
                    **_annotation(frame["instance"] == instance_id),
                }
            )
        return Made(
            record={
                "image": {**frame_record(number, frame), **image},
                "categories": categories,
                "annotations": annotations,
            },
            written={"images": 1, "annotations": len(annotations)},
            left_out=+left_out,
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the annotations of each split; ids of annotations count on over all of them."""
        count = 0
        for split in sorted({record.split for record in records}):
            own = [record.value for record in records if record.split == split]
            categories: dict[int, str] = {}
            annotations = []
            for value in own:
                categories.update({int(id_): name for id_, name in value["categories"].items()})
                for annotation in value["annotations"]:
                    count += 1
                    annotations.append({"id": count, **annotation})
            table = {
                "info": {"description": "recorded by sailenv_ros"},
                "images": [value["image"] for value in own],
                "annotations": annotations,
                "categories": [
                    {"id": number, "name": name, "supercategory": ""}
                    for number, name in sorted(categories.items())
                ],
            }
            write_json(self.folder / split / "annotations.json", table)


def _annotation(mask: NDArray[np.bool_]) -> dict[str, Any]:
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    x, y = int(columns[0]), int(rows[0])
    return {
        "segmentation": {
            "size": list(mask.shape),
            "counts": run_lengths_text(run_lengths(mask)),
        },
        "area": int(mask.sum()),
        "bbox": [x, y, int(columns[-1]) - x + 1, int(rows[-1]) - y + 1],
        "iscrowd": 0,
    }
