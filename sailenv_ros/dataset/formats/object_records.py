"""Objects of a frame as plain values: one record each, for formats of tables and JSON."""

from __future__ import annotations

import math
from typing import Any

from sailenv_ros.dataset.formats.annotated_objects import annotated_objects
from sailenv_ros.dataset.formats.coco_rle import amodal_segmentation
from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.frame.truth.object_table import ObjectTable

__all__ = ["object_record", "told_objects"]


def told_objects(sample: Sample, format_name: str) -> tuple[list[dict[str, Any]], dict[str, int]]:
    """Return a record of each annotated object of a frame, and how many were left out and why.

    Where the frame has amodal masks, each has its own as ``amodal_segmentation``.
    """
    found = annotated_objects(sample, format_name)
    objects = [object_record(found.table, row) for row in range(len(found.table))]
    if found.masks is not None:
        lens = sample.frame.camera.intrinsics
        size = (lens.height, lens.width)
        for row, one in enumerate(objects):
            one["amodal_segmentation"] = amodal_segmentation(found.masks, found.table, row, size)
    return objects, dict(found.left_out)


def object_record(table: ObjectTable, row: int) -> dict[str, Any]:
    """Return what is known of one object; None stands for what is not known.

    ``box`` is around what is visible: left, top, right, bottom [px], the last ones included;
    ``amodal_box`` around all of it that lies in the picture. ``camera_from_object`` is a rigid
    4 x 4 matrix to the optical frame, row by row [m]; ``size`` along the object's own axes [m].
    """
    drawn = int(table.amodal_pixels[row]) >= 0
    return {
        "id": int(table.ids[row]),
        "name": table.names[row],
        "parent": int(table.parents[row]),
        "category": table.categories[row],
        "category_id": int(table.category_ids[row]),
        "asset": table.assets[row],
        "visible_pixels": int(table.visible_pixels[row]),
        "box": table.visible_boxes[row].tolist(),
        "amodal_pixels": int(table.amodal_pixels[row]) if drawn else None,
        "amodal_box": table.amodal_boxes[row].tolist() if drawn else None,
        "visible_share": _known(float(table.visible_share[row])) if drawn else None,
        "distance": _known(float(table.distances[row])),
        "size": [_known(value) for value in table.box_sizes[row].tolist()],
        "camera_from_object": [
            _known(value) for value in table.camera_from_object[row].reshape(-1).tolist()
        ],
    }


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
