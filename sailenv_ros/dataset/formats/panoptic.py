"""Things and stuff of a frame as COCO's panoptic annotations: every pixel is of one segment.

The format is that of https://cocodataset.org/#format-data: a picture of segment ids (red + 256
green + 65536 blue; 0 is nothing) and a list of the segments. A thing has its instance id; all of
a category that is stuff is one segment.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.dataset_format import Sample
from sailenv_ros.frame.truth.object_table import ObjectTable
from sailenv_ros.types.labels import BACKGROUND

__all__ = ["STUFF_ID", "panoptic_segments"]

STUFF_ID = 65536
"""Added to the category id of stuff, so that it is no instance id."""


def panoptic_segments(
    sample: Sample, things: ObjectTable
) -> tuple[NDArray[np.uint8], list[dict[str, Any]]]:
    """Return the segments of a frame.

    Parameters
    ----------
    sample : Sample
        With the views of `CocoExport`.
    things : ObjectTable
        Its annotated objects.

    Returns
    -------
    picture : (H, W, 3) uint8
    segments : list of mapping
        COCO's ``segments_info``.
    """
    instances, table = sample.frame["instance"], sample.frame.objects
    segment_of = np.zeros(65536, np.uint32)
    category_of: dict[int, int] = {}
    segment_of[things.ids] = things.ids
    category_of |= dict(zip(things.ids.tolist(), things.category_ids.tolist(), strict=True))
    for row, name in enumerate(table.categories):
        category = int(table.category_ids[row])
        if name in sample.rules.stuff and category != BACKGROUND:
            segment_of[table.ids[row]] = STUFF_ID + category
            category_of[STUFF_ID + category] = category
    ids = segment_of[instances]
    segments = []
    for segment in np.unique(ids).tolist():
        if not segment:
            continue
        mask = ids == segment
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        top, left = int(rows[0]), int(columns[0])
        segments.append(
            {
                "id": segment,
                "category_id": category_of[segment],
                "area": int(mask.sum()),
                "bbox": [left, top, int(columns[-1]) - left + 1, int(rows[-1]) - top + 1],
                "iscrowd": 0,
            }
        )
    picture = np.stack([ids & 255, ids >> 8 & 255, ids >> 16], axis=-1).astype(np.uint8)
    return picture, segments
