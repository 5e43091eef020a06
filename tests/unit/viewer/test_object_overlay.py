"""What is drawn over a frame of its objects, as the page is told."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.viewer.object_overlay import overlay_of
from tests.unit.frame.truth.test_object_table import frame_of


def masks_of(only: int = 0) -> AmodalMasks:
    assert only == 3, "no other object is drawn"
    return AmodalMasks(
        height=30, width=40, ids=np.array([3], np.uint16), pixels=np.array([100]),
        whole_pixels=np.array([100]), boxes=np.array([[5, 6, 14, 15]], np.int32),
        whole_boxes=np.array([[5, 6, 14, 15]], np.int32), crops=(np.ones((10, 10), bool),),
    )  # fmt: skip


def test_boxes_edges_and_the_outline_are_told() -> None:
    """Of visible objects alone; JSON holds it; what is not asked for is empty."""
    instance = np.zeros((30, 40), np.uint16)
    instance[5:20, 7:31] = 3
    frame = replace(frame_of(instance=instance), draw_amodal=masks_of)
    told = json.loads(json.dumps(overlay_of(frame, boxes=True, space=True, whole=3)))
    assert told["boxes"] == [[3, 7, 5, 30, 19]]
    ((id_, edges),) = told["edges"]
    assert (id_, len(edges)) == (3, 12)
    corner = np.round(frame.objects.corner_pixels[0, 0], 1).tolist()
    assert edges[0][:2] == corner
    (line,) = told["whole"]
    assert sorted(zip(line[::2], line[1::2], strict=True)) == [(5, 6), (5, 15), (14, 6), (14, 15)]
    nothing = overlay_of(frame, boxes=False, space=False, whole=0)
    assert nothing == {"boxes": [], "edges": [], "whole": []}
    with pytest.raises(InvalidState, match="no amodal masks"):
        overlay_of(frame_of(instance=instance), boxes=False, space=False, whole=3)
