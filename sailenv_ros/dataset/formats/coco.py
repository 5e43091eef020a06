"""Frames → COCO's instance annotations: masks as run lengths, boxes, categories.

The format is that of https://cocodataset.org/#format-data. An annotation is one object in one
picture; `instance_id` joins those of one object, and `parent_id` is that of the object that it is a
part of, 0 for none. With amodal masks `amodal_segmentation`, its box
and area, and `occlusion` (the share of the object that is hidden) are added.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.category_names import NAMING_SCHEMES, names_in
from sailenv_ros.dataset.formats.annotated_objects import (
    annotated_objects,
    categories_of,
    merged_categories,
    stuff_of,
)
from sailenv_ros.dataset.formats.coco_rle import amodal_segmentation, segmentation
from sailenv_ros.dataset.formats.data_files import write_json, write_png
from sailenv_ros.dataset.formats.dataset_format import DatasetFormat, Record, Sample, WriteResult
from sailenv_ros.dataset.formats.images import frame_record
from sailenv_ros.dataset.formats.panoptic import panoptic_segments
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.types.skeleton import COCO_KEYPOINTS, COCO_SKELETON

__all__ = ["CocoExport"]


class CocoExport(DatasetFormat):
    """`images/*.png` and `annotations.json`, in each split's folder.

    Where categories are stuff, `panoptic/*.png` and `panoptic.json`, too.
    """

    views: ClassVar[tuple[str, ...]] = ("rgb", "instance")

    def add(self, sample: Sample) -> WriteResult:
        """Write the picture of a frame and take its objects."""
        frame, number = sample.frame, sample.number
        found = annotated_objects(sample, "COCO")
        name = f"{sample.stem}.png"
        write_png(self.folder / sample.split / "images" / name, frame["rgb"])
        height, width = frame["instance"].shape
        image = {"id": number, "file_name": name, "width": width, "height": height}
        table, masks = found.table, found.masks
        annotations = []
        for row, instance_id in enumerate(table.ids.tolist()):
            left, top, right, bottom = table.visible_boxes[row].tolist()
            seen = frame["instance"][top : bottom + 1, left : right + 1] == instance_id
            annotation = {
                "image_id": number,
                "category_id": int(table.category_ids[row]),
                "instance_id": instance_id,
                "instance_name": table.names[row],
                "parent_id": int(table.parents[row]),
                "segmentation": segmentation(seen, left, top, (height, width)),
                "area": int(table.visible_pixels[row]),
                "bbox": _bbox(table.visible_boxes[row]),
                "iscrowd": 0,
            }
            annotation |= _keypoints(frame, instance_id)
            if masks is not None:
                annotation |= _amodal(table, row)
                annotation["amodal_segmentation"] = amodal_segmentation(
                    masks, table, row, (height, width)
                )
            annotations.append(annotation)
        record: dict[str, Any] = {
            "image": {**frame_record(number, frame), **image},
            "categories": categories_of(sample, "COCO"),
            "annotations": annotations,
        }
        if sample.rules.stuff:
            picture, segments = panoptic_segments(sample, table)
            write_png(self.folder / sample.split / "panoptic" / name, picture)
            record["stuff"] = stuff_of(sample, "COCO")
            record["panoptic"] = {"image_id": number, "file_name": name, "segments_info": segments}
        return WriteResult(
            record=record,
            written={"images": 1, "annotations": len(annotations)},
            left_out=found.left_out,
        )

    def finish(self, records: Sequence[Record]) -> None:
        """Write the annotations of each split; ids of annotations count on over all of them."""
        splits: set[str] = set()
        stuff: dict[str, str] = {}

        def tables() -> Iterator[Mapping[str, str]]:
            for record in records:
                splits.add(record.split)
                stuff.update(record.value.get("stuff", {}))
                yield record.value["categories"]

        categories = merged_categories(tables())
        ids = itertools.count(1)
        others = {scheme: names_in(scheme) for scheme in NAMING_SCHEMES}

        def listed(id_: int, name: str) -> dict[str, Any]:
            schemes: dict[str, str] = {
                scheme: names.get(name, "") for scheme, names in others.items()
            }
            return {"id": id_, "name": name, "supercategory": "", **schemes}

        things = [
            listed(id_, name) | (_PERSON if name == "person" else {})
            for id_, name in categories.items()
        ]
        # All records may be more than fits into memory: each list is read and written as it goes.
        for split in sorted(splits):
            table = {
                "info": {"description": "recorded by sailenv_ros"},
                "images": (value["image"] for value in _of_split(records, split)),
                "annotations": (
                    {"id": next(ids), **annotation}
                    for value in _of_split(records, split)
                    for annotation in value["annotations"]
                ),
                "categories": things,
            }
            write_json(self.folder / split / "annotations.json", table)
            if stuff:
                every = [{**one, "isthing": 1} for one in things] + [
                    {**listed(int(id_), name), "isthing": 0}
                    for id_, name in sorted(stuff.items(), key=lambda pair: int(pair[0]))
                ]
                panoptic = {
                    "info": table["info"],
                    "images": (value["image"] for value in _of_split(records, split)),
                    "annotations": (value["panoptic"] for value in _of_split(records, split)),
                    "categories": every,
                }
                write_json(self.folder / split / "panoptic.json", panoptic)


def _of_split(records: Iterable[Record], split: str) -> Iterator[Any]:
    return (record.value for record in records if record.split == split)


def _amodal(table: ObjectTable, row: int) -> dict[str, Any]:
    return {
        "amodal_area": int(table.amodal_pixels[row]),
        "amodal_bbox": _bbox(table.amodal_boxes[row]),
        "occlusion": float(1.0 - table.visible_share[row]),
        "truncation": float(table.truncated_share[row]),
    }


_PERSON = {
    "keypoints": [name.replace(" ", "_") for name in COCO_KEYPOINTS],
    "skeleton": [list(pair) for pair in COCO_SKELETON],
}


def _keypoints(frame: Frame, instance_id: int) -> dict[str, Any]:
    """Return COCO's keypoints of a person: x, y and 2 seen, 1 hidden, 0 0 0 out of view."""
    if frame.states is None or instance_id not in frame.states.skeletons:
        return {}
    points = frame.keypoints(instance_id)
    if points.names != COCO_KEYPOINTS:
        return {}  # those of an animal are not COCO's
    found: list[float] = []
    for number in range(len(COCO_KEYPOINTS)):
        if points.hidden_by[number] < 0:
            found += [0, 0, 0]
            continue
        x, y = points.pixels[number].tolist()
        # COCO counts from the corner of the picture's first pixel.
        found += [round(x + 0.5, 2), round(y + 0.5, 2), 2 if points.visible[number] else 1]
    return {"keypoints": found, "num_keypoints": sum(v > 0 for v in found[2::3])}


def _bbox(box: NDArray[np.int32]) -> list[int]:
    left, top, right, bottom = box.tolist()
    return [left, top, right - left + 1, bottom - top + 1]
